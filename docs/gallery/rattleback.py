"""A rattleback turned in the wrong direction: it rattles, stops, and turns back; in the other one it just turns."""

from functools import cache

from _card import Curve, card
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit


@cache
def run(spin: float) -> CoordinateOrbit:
    """Return ten seconds from a spin of five radians a second."""
    return nh.examples.rattleback(spin=spin).simulate()


def numbers() -> dict[str, tuple[float, float, float]]:
    """Once it has turned back its energy is in the spin alone, as at first: 5 the other way, but for h^2."""
    return {"spin in the end": (float(run(5.0).body_velocity[-1, 2]), -5.0, 0.1)}


def draw() -> Figure:
    """Draw how it rocks, and the spin from both starts."""
    orbit = run(5.0)
    spins = [Curve(run(spin).time, run(spin).body_velocity[:, 2], f"from {spin:+g}") for spin in (5.0, -5.0)]
    rocking = [Curve(*orbit.configuration[:, 3:].T)]
    axis = ("time in seconds", "spin")
    return card("Rattleback", rocking, spins, plane=("lean", "pitch"), axis=axis, equal=False)
