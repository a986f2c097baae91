"""The rotation group SO(n) for n = 2 and n >= 4; the compact pose is the matrix, row by row."""

import dataclasses
import functools
from typing import ClassVar

import numpy as np

from nonholo.base.limits import within_memory
from nonholo.base.numerics import cayley_increment
from nonholo.base.types import Array, Float
from nonholo.groups import _rotations
from nonholo.groups._base import AbstractMatrixGroup
from nonholo.groups._coordinates import SeparatedCoordinates


@dataclasses.dataclass(frozen=True, repr=False)
class SpecialOrthogonalN(AbstractMatrixGroup):
    r"""Rotations of n-dimensional space; coordinates are the coefficients of $e_i\wedge e_j$, i < j, lexicographic."""

    n: int
    is_rigid: ClassVar[bool] = True

    def __repr__(self) -> str:
        return f"SO({self.n})"

    @property
    def dim(self) -> int:
        """Dimension, n (n - 1) / 2."""
        return self.n * (self.n - 1) // 2

    @property
    def size(self) -> int:
        """Rows of a matrix, n."""
        return self.n

    @property
    def pose_size(self) -> int:
        """Numbers in a compact pose, the entries of the matrix."""
        return self.n * self.n

    @functools.cached_property
    def coordinates(self) -> SeparatedCoordinates:
        """The maps between coordinate vectors and skew-symmetric matrices."""
        return SeparatedCoordinates(self.n, *_rotations.planes(self.n))

    @functools.cached_property
    def basis(self) -> np.ndarray:
        """The basis of the algebra, shape (dim, n, n)."""
        within_memory(f"{self!r}.basis", 8.0 * self.dim * self.size**2, "Use what needs no basis.")
        return self.hat(np.eye(self.dim))

    def exp_increment(self, x: Float[Array, "... dim"]) -> Float[Array, "... n n"]:
        """Return `exp(x)` minus the identity, without cancellation."""
        return _rotations.exp_increment(self.hat(x))

    def log(self, g: Float[Array, "... n n"]) -> Float[Array, "... dim"]:
        """Return coordinates of the logarithm with angles up to pi (JAX: up to 3.14); a pair of -1 is a half turn."""
        return self.vee(_rotations.logarithm(self._matrix(g), f"{self!r}.log(g=...)"))

    def cayley_increment(self, x: Float[Array, "... dim"]) -> Float[Array, "... n n"]:
        """Return `cayley(x)` minus the identity, without cancellation."""
        X = self.hat(x)
        return _rotations.cayley_increment(X) if isinstance(X, np.ndarray) else cayley_increment(X)

    def inverse(self, g: Float[Array, "... n n"]) -> Float[Array, "... n n"]:
        """Return the transpose."""
        return self.form_adjoint(self._matrix(g))

    def residual(self, g: Float[Array, "... n n"]) -> Float[Array, "..."]:
        """Return the largest entry of g g^T - I; at least 2 for a reflection."""
        return _rotations.residual(self._matrix(g))

    def angle(self, x: Float[Array, "... dim"]) -> Float[Array, "..."]:
        """Return the largest angle through which `exp(x)` turns a plane: the spectral norm of `hat(x)`."""
        X = self.hat(x)
        return X.__array_namespace__().linalg.norm(X, ord=2, axis=(-2, -1))

    def random(self, rng: np.random.Generator) -> Float[np.ndarray, "n n"]:
        """Draw a uniformly distributed rotation."""
        return _rotations.random(self.n, self._generator(rng))

    def matrix_from_pose(self, pose: Float[Array, "... size"]) -> Float[Array, "... n n"]:
        """Return the rotation nearest to the matrix with these rows."""
        pose = self._pose(pose)
        return _rotations.nearest(pose.reshape(*pose.shape[:-1], self.n, self.n))

    def pose_rate(self, pose: Float[Array, "... size"], x: Float[Array, "... dim"]) -> Float[Array, "... size"]:
        """Return the entries of R hat(x)."""
        pose, x = self._pose(pose), self._vector(x)
        rows = pose.reshape(*pose.shape[:-1], self.n, self.n)
        return self.pose_from_matrix(rows @ self.hat(x))
