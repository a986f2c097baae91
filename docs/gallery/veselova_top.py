"""The Veselova top never spins about the vertical: a constraint fixed in space, not in the body."""

import numpy as np
from _card import Curve, card
from matplotlib.figure import Figure

import nonholo as nh

TOP = nh.VeselovaTop(np.diag([1.0, 0.7, 0.4]))
STEP = 0.05


def orbit() -> nh.Orbit:
    """Return an orbit of the discrete map."""
    return nh.simulate(nh.discretize(TOP, STEP), body_velocity=(0.9, 0.5, 0.0), steps=1200)


def numbers() -> dict[str, tuple[float, float, float]]:
    """The spin about the vertical, of each step in space; rounding of 1200 steps."""
    spatial = orbit().spatial_displacement
    spin = np.abs(spatial[:, 1, 0] - spatial[:, 0, 1]).max() / (2 * STEP)
    return {"largest spin about the vertical": (float(spin), 0.0, 1e-11)}


def draw() -> Figure:
    """Draw where the third body axis points, seen from above, and the body velocity."""
    run = orbit()
    curves = [Curve(run.time, row, rf"$\omega_{i}$") for i, row in enumerate(run.body_velocity.T, 1)]
    return card("Veselova top: third body axis from above", [Curve(*run.configuration[:, :2, 2].T)], curves)
