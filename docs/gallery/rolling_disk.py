"""A disk that rolls upright: its contact point stays on a circle, that of the midpoint rule."""

from functools import cache

import numpy as np
from _card import Curve, card, start
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

READY = nh.examples.rolling_disk()
STEP, ROLLING, TURNING = 0.1, 1.0, 0.5


@cache
def run() -> CoordinateOrbit:
    """Return one turn of the disk about its vertical axis, and a little more."""
    return nh.simulate(nh.discretize(READY.system, STEP), **start(READY), steps=140)


def numbers() -> dict[str, tuple[float, float, float]]:
    """With m R^2 = 1 and I = 1/2 the radius is R theta'_h h / (2 sin(h phi'/2)); rounding of 140 steps."""
    rolling = 1.5 * ROLLING / (np.cos(STEP * TURNING / 2) + 0.5)
    radius = rolling * STEP / (2 * np.sin(STEP * TURNING / 2))
    x, y = run().configuration[:, :2].T
    return {"radius of the circle": (float(np.hypot(x, y - radius).mean()), float(radius), 1e-12)}


def draw() -> Figure:
    """Draw the contact point, and how far it is from the circle of the flow."""
    x, y = run().configuration[:, :2].T
    away = Curve(run().time, np.hypot(x, y - ROLLING / TURNING) - ROLLING / TURNING)
    return card("Rolling disk: contact point", [Curve(x, y)], [away], axis=("time", "distance from the flow's circle"))
