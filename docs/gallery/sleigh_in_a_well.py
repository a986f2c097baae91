"""A balanced sleigh drawn to a point by a spring: its rate of turning stays, its speed is that of an oscillator."""

from functools import cache

import numpy as np
from _card import Curve, card, start
from matplotlib.figure import Figure

import nonholo as nh

READY = nh.examples.sleigh_in_a_well()


@cache
def run(h: float) -> nh.Orbit:
    """Return the discrete orbit to time 100."""
    return nh.simulate(nh.discretize(READY.system, h), **start(READY), steps=round(100 / h))


def numbers() -> dict[str, tuple[float, float, float]]:
    """The energy is kept to rounding, the turning rate to the square of the step."""
    change = [float(np.ptp(run(h).body_velocity[:, 0])) for h in (0.1, 0.05)]
    energy = float(np.ptp(run(0.05).energy))
    return {"change of the energy": (energy, 0.0, 1e-12), "turning rates, ratio": (change[0] / change[1], 4.0, 0.2)}


def draw() -> Figure:
    """Draw the path about the origin, and the speed."""
    orbit = run(0.05)
    speed = [Curve(orbit.time, orbit.body_velocity[:, 1])]
    return card("Sleigh in a well", [Curve(*orbit.position.T)], speed, axis=("time", "speed along the blade"))
