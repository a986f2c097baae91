"""A top that hangs from its fixed point, with friction: it swings out, and never gains energy."""

import numpy as np
from _card import Curve, card
from matplotlib.figure import Figure

import nonholo as nh

TOP = nh.SuslovTop(np.diag([0.3, 0.4, 1.0]))
HEAVY = nh.Forced(TOP, nh.Gravity(force=[0.0, 0.0, -1.0], point=[0.0, 0.0, -1.0]), nh.Friction([0.06, 0.06, 0.06]))


def orbit() -> nh.Orbit:
    """Return an orbit from the lowest place, pushed."""
    return nh.simulate(nh.discretize(HEAVY, 0.05), body_velocity=(0.9, 0.5, 0.0), steps=4000)


def numbers() -> dict[str, tuple[float, float, float]]:
    """In the end it hangs still: the energy is that of its weight at the depth 1."""
    return {"energy in the end": (float(orbit().energy[-1]), -1.0, 1e-3)}


def draw() -> Figure:
    """Draw the path of the weight from above, and the energy."""
    run = orbit()
    weight = run.configuration @ np.array([0.0, 0.0, -1.0])
    energy = [Curve(run.time, run.energy)]
    return card(
        "Hanging top with friction: weight from above", [Curve(*weight[:, :2].T)], energy, axis=("time", "energy")
    )
