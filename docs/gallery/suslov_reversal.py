"""Suslov's top leaves one permanent rotation and ends in the opposite one."""

import numpy as np
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.plot import theme

TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])


def orbit() -> nh.Orbit:
    """Return an orbit from near the repelling rotation."""
    start = -nh.equilibria(TOP, energy=0.5).velocity + [0.005, 0.0, 0.0]
    return nh.simulate(nh.discretize(TOP, 0.1), body_velocity=start, steps=700)


def numbers() -> dict[str, tuple[float, float, float]]:
    """The angle in the body between the first and the last angular velocity is half a turn, nearly: it began aside."""
    omega = orbit().body_velocity[[0, -1]]
    cosine = omega[0] @ omega[1] / np.linalg.norm(omega[0]) / np.linalg.norm(omega[1])
    return {"angle between the rotations, degrees": (float(np.degrees(np.arccos(cosine))), 180.0, 1.0)}


@theme.in_style
def draw() -> Figure:
    """Draw the momenta with all energy levels, and the forbidden axis in space."""
    figure = Figure(figsize=(10.0, 4.8), layout="constrained")
    plane = figure.add_subplot(1, 2, 1)
    nh.plot.phase_portrait(TOP, orbit(), axes=plane)
    nh.plot.body_axis_track(orbit(), axes=figure.add_subplot(1, 2, 2))
    return figure
