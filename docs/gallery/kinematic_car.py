"""The kinematic car: with its steering at rest a circle, and steered the curve of a growing turn."""

from functools import cache

import numpy as np
from _card import Curve, along, card, start
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

CIRCLE = nh.examples.kinematic_car()
STEERED = nh.examples.kinematic_car(configuration=(0.0, 0.0, 0.0, 0.0, -0.6), steering_rate=0.1)


@cache
def run(steered: bool) -> CoordinateOrbit:
    """Return the discrete orbit to time 12."""
    ready = STEERED if steered else CIRCLE
    return nh.simulate(nh.discretize(ready.system, 0.02), **start(ready), steps=600)


def numbers() -> dict[str, tuple[float, float, float]]:
    """The circle has the radius wheelbase / tan(steering angle)."""
    x, y = run(steered=False).configuration[:, :2].T
    radius = 1 / np.tan(0.3)
    return {"radius of the circle": (float(np.hypot(x, y - radius).mean()), radius, 1e-4)}


def draw() -> Figure:
    """Draw both paths of the rear axle, and the speeds."""
    orbits = {"steering at rest": run(steered=False), "steered": run(steered=True)}
    paths = [Curve(*orbit.configuration[:, :2].T, name) for name, orbit in orbits.items()]
    speeds = [Curve(orbit.time, along(orbit), name) for name, orbit in orbits.items()]
    return card("Kinematic car", paths, speeds, axis=("time", "speed"))
