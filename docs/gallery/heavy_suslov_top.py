"""A Suslov top in the potential of Klebsch and Tisserand: its equations separate, so there are two integrals."""

from functools import cache

import numpy as np
from _card import Curve, card, start
from matplotlib.figure import Figure

import nonholo as nh

READY = nh.examples.heavy_suslov_top()


@cache
def run(h: float) -> nh.Orbit:
    """Return the discrete orbit to time 60."""
    return nh.simulate(nh.discretize(READY.system, h), **start(READY), steps=round(60 / h))


def spread(h: float) -> float:
    """Return by how much the first integral changes."""
    first = next(iter(READY.conserved.values()))
    return float(np.ptp(first(run(h).configuration, run(h).body_velocity)))


def numbers() -> dict[str, tuple[float, float, float]]:
    """Under a potential the map keeps integrals to the square of the step: a fourth with half of it."""
    return {"change for h = 0.1 over that for h = 0.05": (spread(0.1) / spread(0.05), 4.0, 0.3)}


def draw() -> Figure:
    """Draw where the third body axis points, seen from above, and the two integrals."""
    orbit = run(0.05)
    curves = [Curve(orbit.time, f(orbit.configuration, orbit.body_velocity), n) for n, f in READY.conserved.items()]
    path = [Curve(*orbit.configuration[:, :2, 2].T)]
    return card("Heavy Suslov top: third body axis from above", path, curves, axis=("time", "integrals"))
