"""A sleigh on which a mass is moved to and fro: it speeds up without bound, or settles, by where the mass runs."""

from functools import cache

import numpy as np
from _card import Curve, along, card, start
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

PERIOD = 64
"""Saved states in a period."""


@cache
def run(ahead: float) -> CoordinateOrbit:
    """Return the flow over 32 periods of the moving mass, whose line is this far ahead of the contact."""
    ready = nh.examples.driven_sleigh(ahead=ahead)
    return nh.flow(ready.system, **start(ready), times=np.linspace(0.0, 64 * np.pi, 32 * PERIOD + 1))


def numbers() -> dict[str, tuple[float, float, float]]:
    """In the one case the speed grows in every period, in the other it settles; to errors of the solver."""
    grows = np.diff(along(run(-0.3))[::PERIOD]) > 0
    settled = float(np.ptp(along(run(0.0))[16 * PERIOD :]))
    return {
        "periods of 32 in which it speeds up, behind": (float(grows.sum()), 32.0, 0.0),
        "change of the speed in the last 16, through the contact": (settled, 0.0, 1e-6),
    }


def draw() -> Figure:
    """Draw the path of the contact, and both speeds."""
    names = {-0.3: "mass behind the contact", 0.0: "through the contact"}
    curves = [Curve(run(ahead).time, along(run(ahead)), name) for ahead, name in names.items()]
    return card("Driven sleigh", [Curve(*run(-0.3).configuration[: 10 * PERIOD, :2].T)], curves, axis=("time", "speed"))
