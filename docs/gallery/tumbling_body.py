"""A free body thrown about its middle axis tumbles, over and over: no constraint, the step of Moser and Veselov."""

import numpy as np
from _card import Curve, card
from matplotlib.figure import Figure

import nonholo as nh

BODY = nh.RigidBody(np.diag([1.0, 0.6, 0.3]))


def orbit() -> nh.Orbit:
    """Return an orbit from nearly the middle axis."""
    return nh.simulate(nh.discretize(BODY, 0.1), body_velocity=(0.001, 1.0, 0.001), steps=1500)


def numbers() -> dict[str, tuple[float, float, float]]:
    """The angular momentum in space stays where it is, to the rounding of 1500 steps."""
    momentum = orbit().spatial_momentum
    return {"change of the angular momentum in space": (float(np.abs(momentum - momentum[0]).max()), 0.0, 1e-12)}


def draw() -> Figure:
    """Draw where the middle axis points, seen from the side, and the body velocity."""
    run = orbit()
    curves = [Curve(run.time, row, rf"$\omega_{i}$") for i, row in enumerate(run.body_velocity.T, 1)]
    path = [Curve(run.configuration[:, 0, 1], run.configuration[:, 1, 1])]
    return card("Free body: its middle axis in space", path, curves, plane=("x", "y"))
