"""Short runs that the tests of the pictures share."""

from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageSequence

import nonholo as nh

MASS_TENSOR = [[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]


def top_run(body_velocity: tuple[float, float, float], **options: int) -> nh.Orbit:
    """Run the generic top."""
    return nh.simulate(nh.discretize(nh.SuslovTop(MASS_TENSOR), 0.1), body_velocity=body_velocity, **options)


def sleigh_run(body_velocity: tuple[float, float, float], a: float = 0.5, b: float = 0.3, **options: int) -> nh.Orbit:
    """Run a sleigh of unit mass and inertia."""
    sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=a, b=b)
    return nh.simulate(nh.discretize(sleigh, 0.1), body_velocity=body_velocity, **options)


def body_tensor(n: int) -> np.ndarray:
    """Return the homogeneous mass tensor of a body in n dimensions, of four points in each that lie askew."""
    points = np.random.default_rng(n).normal(size=(4 * n, n))
    askew = np.column_stack([points, np.ones(4 * n)])
    return askew.T @ askew / (4 * n)


def run_of(system: nh.SuslovTop, steps: int = 40, speed: float = 0.6, **options: object) -> nh.Orbit:
    """Run any system from a start without symmetry."""
    velocity = speed * np.cos(np.arange(system.rank))
    return nh.simulate(nh.discretize(system, 0.1), restricted_velocity=velocity, steps=steps, **options)


def along(system: Any, q: np.ndarray) -> Any:
    """Return an orbit of a system in coordinates through given places, in a time of one."""
    from nonholo.lagrange_dalembert import CoordinateOrbit  # which the core lacks

    t = np.linspace(0.0, 1.0, len(q))
    return CoordinateOrbit(t, q, 0 * q, 0 * q, 0 * q, q[:, :0], t + 1, 0 * t, system=system, time_step=t[1])


def frames_of(film: str | Path) -> list[np.ndarray]:
    """Return the colors of each frame of a GIF."""
    with Image.open(film) as movie:
        return [np.asarray(frame.convert("RGB"), dtype=int) for frame in ImageSequence.Iterator(movie)]


def made_up(system: nh.LLSystem, states: int = 5) -> nh.Orbit:
    """Return an orbit at rest in its first pose: for groups whose steps would have to be compiled first."""
    k, group = len(system.constraint_subspace), system.group
    momentum = 1.0 + np.arange(states * k, dtype=float).reshape(states, k)
    pose = np.tile(group.pose_from_matrix(group.identity), (states, 1))
    return nh.Orbit(nh.discretize(system, 0.1), np.arange(states) / 10, momentum, np.zeros((states, k)), pose)
