"""The groups that the tests run over, and how close numbers must come."""

import numpy as np

from nonholo.groups import SE, SO, AbstractMatrixGroup, MatrixGroup, ProductGroup, Translations

ROTATIONS = [SO(n) for n in (2, 3, 4, 5, 6)]
MOTIONS = [SE(n) for n in (2, 3, 4, 5)]
RIGID = [*ROTATIONS, *MOTIONS]

HEISENBERG = MatrixGroup([np.eye(3, k=1) * [0, 1, 0], np.eye(3, k=1) * [0, 0, 1], np.eye(3, k=2)])
SL2 = MatrixGroup([[[1, 0], [0, -1]], [[0, 1], [0, 0]], [[0, 0], [1, 0]]])
SL3 = MatrixGroup(
    [np.outer(np.eye(3)[i], np.eye(3)[j]) for i in range(3) for j in range(3) if i != j]
    + [np.diag([1.0, -1.0, 0.0]), np.diag([0.0, 1.0, -1.0])]
)
# so(3) in a basis whose matrices are neither orthogonal nor of equal size
OBLIQUE = MatrixGroup(np.tensordot(np.array([[1.0, 2.0, 0.0], [0.0, 3.0, -1.0], [0.5, 0.0, 2.0]]), SO(3).basis, axes=1))
WHEELED = ProductGroup(SE(2), Translations(2))
TWO_BODIES = ProductGroup(SO(3), SO(3))
OTHERS = [HEISENBERG, SL2, SL3, OBLIQUE, Translations(3), WHEELED, TWO_BODIES, ProductGroup(SL2, SE(3))]
GROUPS = [*RIGID, *OTHERS]


def close(result: np.ndarray, expected: np.ndarray, ulps: float = 100) -> bool:
    """Tell whether arrays agree to some rounding errors of their size."""
    return bool(np.abs(result - expected).max() <= ulps * np.finfo(float).eps * (1 + np.abs(expected).max()))


def vectors(group: AbstractMatrixGroup, count: int, scale: float = 1.0, seed: int = 0) -> np.ndarray:
    """Draw coordinates with the given largest entry, so that no angle of a vector of size 1/2 reaches pi."""
    x = np.random.default_rng(seed).normal(size=(count, group.dim))
    return scale * x / np.abs(x).max(axis=1, keepdims=True)
