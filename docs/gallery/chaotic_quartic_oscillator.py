"""A chaotic oscillator with one constraint: its energy error is of the size of the step squared."""

from functools import cache

import numpy as np
from _card import Curve, card, start
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

READY = nh.examples.chaotic_quartic_oscillator()


@cache
def run(h: float) -> CoordinateOrbit:
    """Return the discrete orbit to time 40."""
    return nh.simulate(nh.discretize(READY.system, h), **start(READY), steps=round(40 / h))


def numbers() -> dict[str, tuple[float, float, float]]:
    """The energy error of the midpoint rule is of the size h^2: a fourth with half the step, to a tenth of it."""
    spread = [float(np.ptp(run(h).energy)) for h in (0.1, 0.05)]
    return {"energy error of h = 0.1 over that of h = 0.05": (spread[0] / spread[1], 4.0, 0.4)}


def draw() -> Figure:
    """Draw the path in the plane of x and y1, and the energies over h^2."""
    path = [Curve(*run(0.05).configuration[:, :2].T)]
    energies = [Curve(run(h).time, (run(h).energy - run(h).energy[0]) / h**2, f"h = {h}") for h in (0.1, 0.05)]
    return card("Chaotic oscillator", path, energies, plane=("x", "y1"), axis=("time", r"$\Delta E/h^2$"))
