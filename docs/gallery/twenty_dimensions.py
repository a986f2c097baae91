"""A Suslov top in twenty dimensions: nineteen momenta go over from one rotation to the opposite one, at O(n) a step."""

import numpy as np
from _card import Curve, card
from matplotlib.figure import Figure

import nonholo as nh

N = 20
TOP = nh.SuslovTop.arrowhead(np.linspace(1.0, 2.0, N), 0.1 * np.cos(np.arange(1, N)))


def orbit() -> nh.Orbit:
    """Return an orbit from near the repelling rotation, momenta alone."""
    start = -TOP.constraint_subspace @ nh.equilibria(TOP, energy=0.5).velocity + 0.01 * np.eye(N - 1)[0]
    discrete = nh.discretize(TOP, 0.2)
    return nh.simulate(discrete, restricted_velocity=start, steps=2500, reconstruct=False)


def numbers() -> dict[str, tuple[float, float, float]]:
    """The relative energy error of 2500 steps is rounding."""
    energy = orbit().energy
    return {"relative energy drift": (float(np.ptp(energy) / energy[0]), 0.0, 1e-14)}


def draw() -> Figure:
    """Draw two of the momenta against each other, and some over time."""
    run = orbit()
    r = run.restricted_momentum.T
    curves = [Curve(run.time, r[i], f"$r_{{{i + 1}}}$") for i in (0, 2, 5, 18)]
    return card(
        "Top in 20 dimensions", [Curve(r[0], r[2])], curves, plane=("$r_1$", "$r_3$"), axis=("time", "momentum")
    )
