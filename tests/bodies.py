"""Bodies on SO(n) and SE(n): random mass tensors and subspaces, and one of each kind of general system."""

from typing import Any

import numpy as np

import nonholo as nh
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import AbstractSystem


def mass_tensor(group: AbstractMatrixGroup, rng: np.random.Generator) -> np.ndarray:
    """Draw the tensor of a body of a few mass points, about the origin; homogeneous on SE(n)."""
    N = group.identity.shape[0]
    points = rng.normal(size=(N + 2, N))
    if not np.any(group.basis[:, -1]):
        points[:, -1] = 1.0
    return points.T @ points / len(points)


def random_rows(group: AbstractMatrixGroup, k: int, rng: np.random.Generator) -> np.ndarray:
    """Draw k orthonormal rows of algebra coordinates."""
    return np.linalg.qr(rng.normal(size=(group.dim, k)))[0].T


def tensor(n: int, rng: np.random.Generator) -> np.ndarray:
    """Draw the tensor of a body that is nowhere flat."""
    A = rng.normal(size=(n, n))
    return A @ A.T + np.eye(n)


def elsewhere(system: Any, rng: np.random.Generator) -> nh.LLSystem:
    """Return the same body as an `LLSystem` in random axes, with random rows of its subspace."""
    group, k, g = system.group, system.rank, system.group.random(rng)
    rows = (np.eye(k) + 0.3 * rng.normal(size=(k, k))) @ system.constraint_subspace @ group.adjoint(g).T
    return nh.LLSystem(group, g @ system.homogeneous_mass_tensor @ g.T, rows)


def _general() -> dict[str, tuple[AbstractSystem, np.ndarray]]:
    rng = np.random.default_rng(11)
    rotations, motions = mass_tensor(nh.SO(4), rng), mass_tensor(nh.SE(3), rng)
    found: dict[str, AbstractSystem] = {
        "suslov 4": nh.SuslovTop(rotations),
        "suslov 6": nh.SuslovTop(mass_tensor(nh.SO(6), rng)),
        "sleigh 3": nh.MultidimensionalSleigh(1.3, [0.3, 0.2, -0.1], np.diag([0.5, 0.7, 0.4]) + 0.1),
        "sleigh 5": nh.MultidimensionalSleigh(0.8, [-0.3, 0.2, 0.1, 0.0, 0.4], mass_tensor(nh.SO(5), rng)),
        "any d on SO(4)": nh.LLSystem(nh.SO(4), rotations, random_rows(nh.SO(4), 3, rng)),
        "any d on SE(3)": nh.LLSystem(nh.SE(3), motions, random_rows(nh.SE(3), 4, rng)),
        "point in a plane on SE(3)": nh.LLSystem(nh.SE(3), motions, nh.reference_point_subspace(3, np.eye(3)[:2])),
        "free on SO(4)": nh.RigidBody(rotations),
        "free on SE(3)": nh.RigidBody(motions, nh.SE(3)),
        "veselova 3": nh.VeselovaTop(mass_tensor(nh.SO(3), rng)),
        "veselova 4": nh.VeselovaTop(rotations),
        "right-invariant on SE(3)": nh.LRSystem(nh.SE(3), motions, random_rows(nh.SE(3), 3, rng)),
    }
    return {name: (system, 0.7 * rng.normal(size=len(system.constraint_subspace))) for name, system in found.items()}


GENERAL = _general()
