"""A ball on a table that turns: it is not thrown off, but runs on a circle, two turns while the table makes seven."""

from functools import cache

import numpy as np
from _card import Curve, card
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

READY = nh.examples.ball_on_turntable()


@cache
def run() -> CoordinateOrbit:
    """Return one turn of the ball."""
    return READY.simulate(steps=440)


def numbers() -> dict[str, tuple[float, float, float]]:
    """A step of the map turns by 2 arctan(h/7), where the table turns by h: seven halves but for h^2."""
    x, y = run().configuration[:, :2].T
    step = np.angle(np.diff(x + 1j * y)[1:] / np.diff(x + 1j * y)[:-1])
    return {"turns of the table for one of the ball": (float(0.05 / step.mean()), 3.5, 0.05**2)}


def draw() -> Figure:
    """Draw the middle of the ball in space and as it is seen from the table, and the energy."""
    orbit = run()
    x, y = orbit.configuration[:, :2].T
    relative = (x + 1j * y) * np.exp(-1j * orbit.time)
    paths = [Curve(x, y, "in space"), Curve(relative.real, relative.imag, "from the table")]
    return card("Ball on a turntable", paths, [Curve(orbit.time, orbit.energy)], axis=("time", "energy"))
