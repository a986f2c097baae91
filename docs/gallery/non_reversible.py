"""A system that no reflection reverses: the energy of the midpoint rule drifts. Its companion's does not."""

from functools import cache

from _card import Curve, card, start
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit


@cache
def run(asymmetry: float, h: float = 0.1) -> CoordinateOrbit:
    """Return the discrete orbit to time 400."""
    ready = nh.examples.non_reversible(asymmetry=asymmetry)
    return nh.simulate(nh.discretize(ready.system, h), **start(ready), steps=round(400 / h))


def numbers() -> dict[str, tuple[float, float, float]]:
    """The drift is in proportion to the square of the step, and to the time: a ratio of 4, to the oscillation on it."""
    drifts = [float(run(0.5, h).energy[-1] - run(0.5, h).energy[0]) for h in (0.2, 0.1)]
    return {"drift of h = 0.2 over that of h = 0.1": (drifts[0] / drifts[1], 4.0, 0.5)}


def draw() -> Figure:
    """Draw the path for a while, and both energies."""
    path = [Curve(*run(0.5).configuration[:600, :2].T)]
    names = {0.5: "asymmetric", 0.0: "symmetric"}
    curves = [Curve(run(s).time, (run(s).energy - run(s).energy[0]) / 0.1**2, name) for s, name in names.items()]
    return card("Not reversible", path, curves, axis=("time", r"$\Delta E/h^2$"))
