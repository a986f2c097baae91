"""A snakeboard without a rider: it runs until its wheels are crossed, and the map reports the reason."""

from functools import cache

import numpy as np
from _card import Curve, card, start
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

READY = nh.examples.snakeboard()


@cache
def run() -> CoordinateOrbit:
    """Return the orbit to where it cannot continue."""
    return nh.simulate(nh.discretize(READY.system, 0.1), **start(READY), steps=600, throw=False)


def numbers() -> dict[str, tuple[float, float, float]]:
    """The steering angle falls at 0.05 from 1 and is -pi/2 at t = 51.4; the map ends within two steps of it."""
    return {"time of the end": (float(run().time[-1]), (np.pi / 2 + 1) / 0.05, 0.2)}


def draw() -> Figure:
    """Draw the path, and the momentum along the constraint, which the flow keeps."""
    orbit = run()
    (*_, momentum) = READY.conserved.values()
    middle = orbit.configuration + orbit.displacement / 2
    momenta = Curve(orbit.time, momentum(middle, orbit.body_velocity))
    path = Curve(*orbit.configuration[:, :2].T)
    return card("Snakeboard", [path], [momenta], axis=("time", "momentum along the constraint"))
