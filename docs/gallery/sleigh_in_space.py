"""A sleigh in space: its reference point moves along one body axis, it may turn but not twist. Energy is exact."""

import numpy as np
from _card import Curve, card
from matplotlib.figure import Figure

import nonholo as nh

SLEIGH = nh.MultidimensionalSleigh(1.0, [0.5, 0.1, 0.2], np.diag([0.5, 0.4, 0.3]))


def orbit() -> nh.Orbit:
    """Return an orbit pushed backwards."""
    return nh.simulate(nh.discretize(SLEIGH, 0.1), restricted_velocity=(0.02, 0.05, -1.0), steps=250)


def numbers() -> dict[str, tuple[float, float, float]]:
    """The relative energy error of 250 steps is rounding."""
    return {"relative energy drift": (nh.invariants(orbit()).energy_drift, 0.0, 2e-15)}


def draw() -> Figure:
    """Draw the path from above, and the velocities that are allowed."""
    run = orbit()
    rows = nh.discretize(SLEIGH, 0.1).system.constraint_subspace @ run.body_velocity.T
    curves = [Curve(run.time, row, label) for row, label in zip(rows, ("turning", "turning", "forwards"), strict=True)]
    return card("Sleigh in space, from above", [Curve(*run.position[:, :2].T)], curves)
