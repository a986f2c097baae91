"""A snake of three links on wheels, its joints let loose: its velocity is that of its joints."""

from functools import cache

import numpy as np
from _card import Curve, card
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

READY = nh.examples.snake()


@cache
def run() -> CoordinateOrbit:
    """Return the motion until it has turned once."""
    return READY.simulate(steps=600)


def numbers() -> dict[str, tuple[float, float, float]]:
    """The energy of a step at its middle is that of the start, but for h^2."""
    middle = run().configuration + run().displacement / 2
    energy = READY.conserved["energy"](middle[:-1], run().body_velocity[:-1])
    first = READY.conserved["energy"](READY.configuration, READY.body_velocity)
    return {"energy, by its first": (float(energy[-1] / first), 1.0, 0.05**2)}


def draw() -> Figure:
    """Draw the middles of the links, and the joints."""
    q = run().configuration
    place, links = q[:, 0] + 1j * q[:, 1], np.exp(1j * (q[:, 2:3] + np.stack([-q[:, 3], 0 * q[:, 3], q[:, 4]], axis=1)))
    middles = {
        "first": place - 0.5 * (links[:, 0] + links[:, 1]),
        "middle": place,
        "last": place + 0.5 * (links[:, 1] + links[:, 2]),
    }
    tracks = [Curve(each.real, each.imag, name) for name, each in middles.items()]
    joints = [Curve(run().time, q[:, 3 + k], rf"$\alpha_{k + 1}$") for k in range(2)]
    return card("Snake: middles of the links", tracks, joints, axis=("time", "joints"))
