"""A ball in a bowl: without spin a spherical pendulum of five sevenths of its weight; spin draws it aside."""

from functools import cache

import numpy as np
from _card import Curve, card
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.examples import Example
from nonholo.lagrange_dalembert import CoordinateOrbit

STEP, SPIN = 0.05, 8.0


def ready(spin: float) -> Example:
    """Return the example with a spin."""
    return nh.examples.ball_in_bowl(spin=spin)


@cache
def run(spin: float) -> CoordinateOrbit:
    """Return some swings."""
    return ready(spin).simulate(steps=300, time_step=STEP)


def numbers() -> dict[str, tuple[float, float, float]]:
    """The spin about the normal is that of the start, but for h^2."""
    orbit = run(SPIN)
    middle = orbit.configuration + orbit.displacement / 2
    spin = ready(SPIN).conserved["spin"](middle[:-1], orbit.body_velocity[:-1])
    return {"spin in the end": (float(spin[-1]), SPIN, SPIN * STEP**2)}


def draw() -> Figure:
    """Draw the middle of the ball from above, and its distance from the axis."""
    paths = [Curve(*run(spin).configuration[:, :2].T, f"spin {spin:g}") for spin in (0.0, SPIN)]
    far = [Curve(each.time, np.hypot(*each.configuration[:, :2].T)) for each in map(run, (0.0, SPIN))]
    return card("Ball in a bowl, from above", paths, far, axis=("time", "distance from the axis"))
