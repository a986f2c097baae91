"""A cart on two wheels whose mass is ahead of the axle: it speeds up and straightens like a sleigh."""

from functools import cache

import numpy as np
from _card import Curve, along, card, start
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

READY = nh.examples.two_wheeled_robot()
MASS, INERTIA = 1.0 + 2 * 0.01 / 0.25**2, 0.5 + 0.3**2 + 2 * 0.01 * 0.5**2 / 0.25**2  # with the wheels


@cache
def run() -> CoordinateOrbit:
    """Return the discrete orbit."""
    return nh.simulate(nh.discretize(READY.system, 0.05), **start(READY), steps=400)


def numbers() -> dict[str, tuple[float, float, float]]:
    """All kinetic energy ends in the speed, u = sqrt(2E/M); the energy of the map is off by less than h^2."""
    limit = float(np.sqrt(0.5**2 + INERTIA / MASS))
    return {"speed in the end": (float(along(run())[-1]), limit, 0.05**2)}


def draw() -> Figure:
    """Draw the path of the axle, speed and turning rate."""
    orbit = run()
    curves = [Curve(orbit.time, along(orbit), "speed"), Curve(orbit.time, orbit.body_velocity[:, 2], "turning rate")]
    return card("Two-wheeled robot", [Curve(*orbit.configuration[:, :2].T)], curves)
