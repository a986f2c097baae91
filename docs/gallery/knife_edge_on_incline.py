"""A knife edge let loose on a slope: it does not slide down, but sideways, along a cycloid."""

from functools import cache

import numpy as np
from _card import Curve, card, start
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

READY = nh.examples.knife_edge_on_incline()


@cache
def run() -> CoordinateOrbit:
    """Return the discrete orbit over two turns."""
    return nh.simulate(nh.discretize(READY.system, 0.05), **start(READY), steps=252)


def numbers() -> dict[str, tuple[float, float, float]]:
    """It never falls further than G/(2 phi'^2) = 1/2; the map is off by the square of the step 0.05."""
    return {"how far it falls": (float(run().configuration[:, 0].max()), 0.5, 0.05**2)}


def draw() -> Figure:
    """Draw the cycloid with the slope downwards, and the fall over time."""
    x, y, _ = run().configuration.T
    exact = READY.exact(run().time)
    path = [Curve(y, -x, "map"), Curve(exact[:, 1], -exact[:, 0], "exact")]
    fall = [Curve(run().time, np.abs(x - exact[:, 0]))]
    names = {"plane": ("y, across the slope", "-x, up the slope"), "axis": ("time", "error of x")}
    return card("Knife edge on an incline", path, fall, **names)
