"""A bicycle without a rider's steering, pushed sideways: it steers into the fall and rides on, if it is fast enough."""

from functools import cache

from _card import Curve, card
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

SPEEDS = {4.6: 300, 3.6: 250}  # m/s; steps of 0.02 s
READY = {speed: nh.examples.bicycle(speed=speed, lean_rate=0.25) for speed in SPEEDS}


@cache
def run(speed: float) -> CoordinateOrbit:
    """Return the ride from a push."""
    return READY[speed].simulate(steps=SPEEDS[speed])


def numbers() -> dict[str, tuple[float, float, float]]:
    """The front wheel stays on the ground, to rounding of positions of some meters."""
    height = READY[4.6].conserved["height of the front contact"](run(4.6).configuration, run(4.6).body_velocity)
    return {"largest height of the front contact": (float(abs(height).max()), 0.0, 1e-13)}


def draw() -> Figure:
    """Draw the tracks of the rear wheel, and the lean."""
    tracks = [Curve(*run(speed).configuration[:, :2].T, f"{speed} m/s") for speed in SPEEDS]
    leans = [Curve(run(speed).time, run(speed).configuration[:, 3], f"{speed} m/s") for speed in SPEEDS]
    return card("Bicycle: rear contact, in meters", tracks, leans, axis=("time in seconds", "lean"))
