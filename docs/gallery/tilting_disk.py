"""A disk that rolls and tilts: on a circle at constant lean, or nodding along it."""

from functools import cache

import numpy as np
from _card import Curve, card
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

STEADY = nh.examples.tilting_disk()
NODDING = nh.examples.tilting_disk(turning=0.5, lean_rate=0.1, rolling=1.0)


@cache
def run() -> CoordinateOrbit:
    """Return one turn of the circle."""
    return STEADY.simulate(steps=420)


def numbers() -> dict[str, tuple[float, float, float]]:
    """The contact is R rho' / theta' from the center of its circle; the map is off by less than h^2."""
    radius = STEADY.body_velocity[4] / -0.3
    x, y = run().configuration[:, :2].T
    return {"radius of the circle": (float(np.hypot(x, y - radius).mean()), float(-radius), 0.05**2)}


def draw() -> Figure:
    """Draw the contact point of both motions, and the lean."""
    runs = {"steady": run(), "nodding": NODDING.simulate(steps=500)}
    tracks = [Curve(*orbit.configuration[:, :2].T, name) for name, orbit in runs.items()]
    leans = [Curve(orbit.time, orbit.configuration[:, 3], name) for name, orbit in runs.items()]
    return card("Tilting disk: contact point", tracks, leans, axis=("time", "lean"))
