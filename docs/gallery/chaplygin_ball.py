"""The ball of Chaplygin rolls without sliding: its angular momentum about the contact stays in space."""

from functools import cache

import numpy as np
from _card import Curve, card, start
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import GroupOrbit

READY = nh.examples.chaplygin_ball()


@cache
def run() -> GroupOrbit:
    """Return the flow to time 60."""
    return nh.flow(READY.system, **start(READY), times=np.linspace(0.0, 60.0, 1201))


def numbers() -> dict[str, tuple[float, float, float]]:
    """Three components of the momentum about the contact; errors of the solver over 60 units of time."""
    spread = [float(np.ptp(f(run().configuration, run().body_velocity))) for f in READY.conserved.values()]
    return {"largest change of the momentum": (max(spread), 0.0, 1e-11)}


def draw() -> Figure:
    """Draw the contact point in the plane, and the angular velocity in the body."""
    omega = run().body_velocity[:, :3].T
    curves = [Curve(run().time, row, rf"$\omega_{i}$") for i, row in enumerate(omega, 1)]
    return card("Ball of Chaplygin: contact point", [Curve(*run().configuration[:, :2, 3].T)], curves)
