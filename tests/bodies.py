"""Bodies on SO(n) and SE(n): random mass tensors and subspaces, and one of each kind of general system."""

from typing import Any

import numpy as np
from groups.examples import HEISENBERG

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


PAST_PI = np.array([
    [1.97, 2.24, -1.96, -0.56], [2.24, 2.57, -2.24, -0.64], [-1.96, -2.24, 1.97, 0.56], [-0.56, -0.64, 0.56, 0.17]
])  # fmt: skip
"""The tensor of a rod on SO(4): its principal path turns past pi."""


def tensor(n: int, rng: np.random.Generator) -> np.ndarray:
    """Draw the tensor of a body that is nowhere flat."""
    A = rng.normal(size=(n, n))
    return A @ A.T + np.eye(n)


def elsewhere(system: Any, rng: np.random.Generator) -> nh.LLSystem:
    """Return the same body as an `LLSystem` in random axes, with random rows of its subspace."""
    group, k, g = system.group, system.rank, system.group.random(rng)
    rows = (np.eye(k) + 0.3 * rng.normal(size=(k, k))) @ system.constraint_subspace @ group.adjoint(g).T
    return nh.LLSystem(group, g @ system.homogeneous_mass_tensor @ g.T, rows)


def weight(system: Any) -> nh.Gravity:
    """Return a weight that pulls at no axis of a body."""
    n = system.group.size - system.group.is_affine
    return nh.Gravity(np.linspace(0.4, -1.0, n), np.linspace(0.1, 0.5, n))


def magnet(system: Any) -> nh.Linear:
    """Return a potential that is linear in all entries of the pose."""
    return nh.Linear(np.random.default_rng(3).normal(size=(system.group.size,) * 2))


def _of_inertias(group: AbstractMatrixGroup, rows: Any, inertias: Any) -> nh.LLSystem:
    return nh.LLSystem(group, constraint_subspace=rows, inertia_operator=np.diag(inertias))


def _others() -> dict[str, AbstractSystem]:
    rng, product = np.random.default_rng(31), nh.ProductGroup(nh.SE(2), nh.SO(3), nh.Translations(2))
    return {
        "top on SO(7)": nh.SuslovTop(mass_tensor(nh.SO(7), rng)),
        "free body on SE(3)": nh.RigidBody(mass_tensor(nh.SE(3), rng), nh.SE(3)),
        "Heisenberg": _of_inertias(HEISENBERG, [[1, 0, 0.25], [0, 1, 0]], [1.0, 2.0, 3.0]),
        "product": _of_inertias(product, rng.normal(size=(4, 8)), np.arange(1.0, 9.0)),
        "right-invariant on SE(2)": nh.LRSystem(nh.SE(2), mass_tensor(nh.SE(2), rng), [[1, 0.2, 0], [0, 1, 0.3]]),
        "nothing moves": _of_inertias(nh.SO(3), np.empty((0, 3)), [1.0, 2.0, 2.5]),
    }


def _general() -> dict[str, tuple[AbstractSystem, np.ndarray]]:
    rng = np.random.default_rng(11)
    rotations, motions = mass_tensor(nh.SO(4), rng), mass_tensor(nh.SE(3), rng)
    result: dict[str, AbstractSystem] = {
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
    return {name: (system, 0.7 * rng.normal(size=len(system.constraint_subspace))) for name, system in result.items()}


GENERAL = _general()
OTHERS = _others()


def _attracting() -> dict[str, AbstractSystem]:
    rng, inertia = np.random.default_rng(7), np.diag([0.5, 0.7, 0.4]) + 0.1
    four, six, tilted = mass_tensor(nh.SO(4), rng), mass_tensor(nh.SO(6), rng), np.diag([3.0, 2.0, 2.5])
    tilted += [[0.0, 0.1, 0.2], [0.1, 0.0, 0.3], [0.2, 0.3, 0.0]]
    return {
        "top 3": nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]),
        "top 3, tilted": nh.SuslovTop.from_inertia(tilted, (2 / 3, -1 / 3, 2 / 3)),
        "top 4": nh.SuslovTop(four),
        "top 6": nh.SuslovTop(six),
        "sleigh 2": nh.ChaplyginSleigh(1.3, 0.7, 0.4, 0.3),
        "sleigh 2, backward": nh.ChaplyginSleigh(1.3, 0.7, -0.4, 0.3),
        "sleigh 3": nh.MultidimensionalSleigh(1.3, [0.3, 0.2, -0.1], inertia),
        "sleigh 4": nh.MultidimensionalSleigh(0.8, [-0.3, 0.2, 0.1, 0.5], mass_tensor(nh.SO(4), rng)),
        "turning sleigh 3": nh.MultidimensionalSleigh(1.3, [0.0, 0.2, -0.1], inertia),
        "turning sleigh 4": nh.MultidimensionalSleigh(1.3, [0.0, 0.2, -0.1, 0.3], mass_tensor(nh.SO(4), rng)),
    }


ATTRACTING = _attracting()
"""Tops and sleighs with attracting equilibria: in three dimensions and the plane, and in more."""
