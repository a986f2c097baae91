"""The group of rigid motions SE(n), n >= 3; the compact pose is the rotation row by row, then the position."""

import dataclasses
import functools
from typing import ClassVar

import numpy as np

from nonholo.base.limits import within_memory
from nonholo.base.numerics import (
    cayley_increment,
    exponential_increment,
    half_cotangent,
    of_skew,
    principal_logarithm,
    sinc,
    versine,
)
from nonholo.base.types import Array, Float
from nonholo.groups import _rotations
from nonholo.groups._base import AbstractMatrixGroup
from nonholo.groups._coordinates import SeparatedCoordinates


@dataclasses.dataclass(frozen=True, repr=False)
class SpecialEuclideanN(AbstractMatrixGroup):
    r"""Motions $\begin{pmatrix} R & x \\ 0 & 1\end{pmatrix}$; coordinates of so(n), then $v_1, \dots, v_n$."""

    n: int
    is_rigid: ClassVar[bool] = True

    def __repr__(self) -> str:
        return f"SE({self.n})"

    @property
    def dim(self) -> int:
        """Dimension, n (n + 1) / 2."""
        return self.n * (self.n + 1) // 2

    @property
    def size(self) -> int:
        """Rows of a matrix, n + 1."""
        return self.n + 1

    @property
    def pose_size(self) -> int:
        """Numbers in a compact pose: the entries of the rotation and the position."""
        return self.n * (self.n + 1)

    @functools.cached_property
    def coordinates(self) -> SeparatedCoordinates:
        """The maps between coordinate vectors and matrices of the algebra."""
        rows, columns, values = _rotations.planes(self.n)
        axes, last = np.arange(self.n), np.full(self.n, self.n)
        moves = np.stack([axes, axes], axis=1), np.stack([last, last], axis=1), np.tile([1.0, 0.0], (self.n, 1))
        turns = rows, columns, values
        return SeparatedCoordinates(self.size, *(np.concatenate(pair) for pair in zip(turns, moves, strict=True)))

    @functools.cached_property
    def basis(self) -> np.ndarray:
        """The basis of the algebra, shape (dim, n + 1, n + 1)."""
        within_memory(f"{self!r}.basis", 8.0 * self.dim * self.size**2, "Use what needs no basis.")
        return self.hat(np.eye(self.dim))

    def exp_increment(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        r"""Return `exp(x)` minus the identity: rotation $e^X - I$, position $\varphi_1(X)v$."""
        X = self.hat(x)
        if not isinstance(X, np.ndarray):
            return exponential_increment(X)
        skew = X[..., : self.n, : self.n]
        return self._assembled(_rotations.exp_increment(skew), of_skew(skew, _mean) @ X[..., : self.n, self.n :])

    def log(self, g: Float[Array, "... N N"]) -> Float[Array, "... dim"]:
        r"""Return the body velocity with angles up to pi (JAX: up to 3.14): $X = \log R$, $v = \varphi_1(X)^{-1}x$."""
        g = self._matrix(g)
        if not isinstance(g, np.ndarray):
            return self.vee(principal_logarithm(g, halvings=1))
        skew = _rotations.logarithm(g[..., : self.n, : self.n], f"{self!r}.log(g=...)")
        return self.vee(self._assembled(skew, of_skew(skew, _inverse_mean) @ g[..., : self.n, self.n :]))

    def cayley_increment(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return `cayley(x)` minus the identity, without cancellation."""
        X = self.hat(x)
        return _rotations.motion_cayley_increment(X) if isinstance(X, np.ndarray) else cayley_increment(X)

    def inverse(self, g: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
        """Return the inverse motion."""
        return _rotations.motion_inverse(self._matrix(g))

    def residual(self, g: Float[Array, "... N N"]) -> Float[Array, "..."]:
        """Return the residual of the rotation or the largest error of the last row, whichever is larger."""
        return _rotations.motion_residual(self._matrix(g))

    def angle(self, x: Float[Array, "... dim"]) -> Float[Array, "..."]:
        """Return the largest angle through which `exp(x)` turns a plane."""
        X = self.hat(x)[..., : self.n, : self.n]
        return X.__array_namespace__().linalg.norm(X, ord=2, axis=(-2, -1))

    def random(self, rng: np.random.Generator) -> Float[np.ndarray, "N N"]:
        """Draw a uniformly distributed rotation and a standard normal position."""
        rng = self._generator(rng)
        g = self.identity
        g[: self.n, : self.n], g[: self.n, self.n] = _rotations.random(self.n, rng), rng.normal(size=self.n)
        return g

    def matrix_from_pose(self, pose: Float[Array, "... size"]) -> Float[Array, "... N N"]:
        """Return the matrix of a rotation and a position; the rotation is made the nearest one first."""
        pose = self._pose(pose)
        xp = pose.__array_namespace__()
        R, position = self._parts(pose)
        motion = self._assembled(_rotations.nearest(R), position)
        return motion + xp.asarray(np.diag(np.eye(self.size)[-1]), dtype=pose.dtype)

    def pose_from_matrix(self, g: Float[Array, "... N N"]) -> Float[Array, "... size"]:
        """Return the rotation row by row, then the position."""
        g = self._matrix(g)
        rotation = g[..., : self.n, : self.n].reshape(*g.shape[:-2], self.n * self.n)
        return g.__array_namespace__().concatenate([rotation, g[..., : self.n, self.n]], axis=-1)

    def pose_rate(self, pose: Float[Array, "... size"], x: Float[Array, "... dim"]) -> Float[Array, "... size"]:
        """Return the entries of R hat(x) and the body velocity turned to space."""
        pose, x = self._pose(pose), self._vector(x)
        upper = self._parts(pose)[0] @ self.hat(x)[..., : self.n, :]
        return self.pose_from_matrix(self._assembled(upper[..., : self.n], upper[..., self.n :]))

    def _parts(self, pose: Array) -> tuple[Array, Array]:
        squares = self.n * self.n
        return pose[..., :squares].reshape(*pose.shape[:-1], self.n, self.n), pose[..., squares:, None]

    def _assembled(self, rotation: Array, position: Array) -> Array:
        """Return the matrix with these upper blocks and zeros below."""
        xp = rotation.__array_namespace__()
        upper = xp.concatenate([rotation, position], axis=-1)
        return xp.concatenate([upper, xp.zeros_like(upper[..., :1, :])], axis=-2)


def _mean(angle: np.ndarray) -> np.ndarray:
    r"""The function $\varphi_1(z) = (e^z - 1)/z$ at z = i * angle."""
    return sinc(angle * angle) + 1j * angle * versine(angle * angle)


def _inverse_mean(angle: np.ndarray) -> np.ndarray:
    r"""The function $1/\varphi_1(z) = (z/2)\coth(z/2) - z/2$ at z = i * angle."""
    return half_cotangent(angle * angle) - 0.5j * angle
