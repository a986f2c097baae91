"""The roller racer: turned to and fro, its handle drives it from rest."""

from functools import cache

import numpy as np
from _card import Curve, along, card, start
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

READY = nh.examples.roller_racer()


@cache
def run(h: float) -> CoordinateOrbit:
    """Return the discrete orbit to time 40."""
    return nh.simulate(nh.discretize(READY.system, h), **start(READY), steps=round(40 / h))


def numbers() -> dict[str, tuple[float, float, float]]:
    """The distance from rest converges with order 2: differences of three runs are in the ratio 4."""
    far = [run(h).configuration[-1, 0] for h in (0.1, 0.05, 0.025)]
    return {"ratio of the differences": (float((far[0] - far[1]) / (far[1] - far[2])), 4.0, 0.4)}


def draw() -> Figure:
    """Draw the path of the rear axle, and its speed."""
    orbit = run(0.025)
    path = [Curve(*orbit.configuration[:, :2].T)]
    speed = [Curve(orbit.time, np.abs(along(orbit)))]
    return card("Roller racer", path, speed, axis=("time", "speed"), equal=False)
