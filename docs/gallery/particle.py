"""The free particle with the constraint z' = y x': the map beside the exact motion."""

from functools import cache

import numpy as np
from _card import Curve, card, start
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

READY = nh.examples.particle()


@cache
def run(h: float) -> CoordinateOrbit:
    """Return the discrete orbit to time 6."""
    return nh.simulate(nh.discretize(READY.system, h), **start(READY), steps=round(6 / h))


def error(h: float) -> float:
    """Return how far the end is from the exact one."""
    return float(np.abs(run(h).configuration[-1] - READY.exact(np.array([6.0]))[0]).max())


def numbers() -> dict[str, tuple[float, float, float]]:
    """The error falls by four with half the step: order 2."""
    return {"error of h = 0.2 over that of h = 0.1": (error(0.2) / error(0.1), 4.0, 0.1)}


def draw() -> Figure:
    """Draw the path, and the energy over h^2, which settles."""
    path = [Curve(run(0.1).configuration[:, 0], run(0.1).configuration[:, 2])]
    energies = [Curve(run(h).time, (run(h).energy - run(h).energy[0]) / h**2, f"h = {h}") for h in (0.2, 0.1)]
    return card("Free particle, z' = y x'", path, energies, plane=("x", "z"), axis=("time", r"$\Delta E/h^2$"))
