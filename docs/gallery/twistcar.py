"""The Twistcar: the inertia of its handle says whether turns of it drive it backwards or forwards."""

from functools import cache

import numpy as np
from _card import Curve, along, card
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

INERTIAS = {"light handle": 0.01, "heavy handle": 0.1}


@cache
def run(inertia: float, amplitude: float) -> CoordinateOrbit:
    """Return the discrete orbit over 20 turns to and fro."""
    ready = nh.examples.twistcar(handle_inertia=inertia, amplitude=amplitude)
    return ready.simulate(steps=2000, time_step=np.pi / 100)


def numbers() -> dict[str, tuple[float, float, float]]:
    """The gain of speed in a period, beside the mean acceleration at small amplitudes."""
    result = {}
    for name, inertia, formula in zip(INERTIAS, INERTIAS.values(), (-0.0196759, 0.0324074), strict=True):
        orbit = run(inertia, 0.01)
        speed = along(orbit)
        result[f"mean acceleration, {name}"] = (float(1e4 * (speed[-1] - speed[0]) / orbit.time[-1]) / 2, formula, 1e-4)
    return result


def draw() -> Figure:
    """Draw the path of the rear axle, and the speed."""
    orbits = {name: run(inertia, 0.5) for name, inertia in INERTIAS.items()}
    path = [Curve(*orbit.configuration[:, :2].T, name) for name, orbit in orbits.items()]
    speed = [Curve(orbit.time, along(orbit), name) for name, orbit in orbits.items()]
    return card("Twistcar", path, speed, axis=("time", "speed"), equal=False)
