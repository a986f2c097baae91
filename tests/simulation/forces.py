"""Bodies of three families, forces that act on them, and a start of any body."""

from typing import Any

import numpy as np

import nonholo as nh
from nonholo.systems import AbstractSystem

TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3)
VESELOVA = nh.VeselovaTop(np.diag([1.0, 2.0, 3.0]))
HEAVY = nh.Gravity(force=[0.2, -0.3, -1.0], point=[0.1, 0.2, 0.3])
SLOPE = nh.Gravity(force=[0.4, -1.0], point=[0.5, 0.3])
RUB = nh.Friction(0.1 * np.eye(3) + 0.05 * np.ones((3, 3)) + np.array([[0, 0.1, 0], [-0.1, 0, 0], [0, 0, 0]]))


def drive(time: float, g: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Return a force of time, pose and velocity."""
    return np.cos(3 * time + np.arange(len(w))) - 0.4 * w * np.roll(w, 1) + 0.3 * g[0, 1] - 0.2 * w


def hill(g: np.ndarray) -> float:
    """Return a potential that is no weight."""
    return float(np.sum((g[:2] - 0.3) ** 2) / 2 + np.sin(g[0, 1]))


def start_of(system: AbstractSystem) -> dict[str, Any]:
    """Return a velocity and a pose."""
    pose = system.group.exp(np.random.default_rng(5).normal(size=system.group.dim))
    return {"restricted_velocity": [0.5, -0.3, 0.4, 0.2][: system.rank], "configuration": pose}
