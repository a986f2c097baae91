"""Bodies on SO(n) and SE(n): random mass tensors and subspaces, and one of each kind of general system."""

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
