"""The groups of rigid motions SE(n): poses (cos, sin, x, y) of the plane, else rotation by rows and position."""

import dataclasses
import functools
import math
from typing import ClassVar

import numpy as np

from nonholo.base import numerics
from nonholo.base.checks import assign, dimension
from nonholo.base.types import Array, Float
from nonholo.groups import _rotations
from nonholo.groups._base import AbstractMatrixGroup, Coordinates, SeparatedCoordinates, coordinates_of
from nonholo.groups._special_orthogonal import AbstractBodyGroup, AbstractRodriguesGroup

_CUBIC = [(-1) ** k / math.factorial(2 * k + 3) for k in range(8, -1, -1)]  # exact to rounding for angles up to 1
_X, _Y, _Z = np.eye(3)


class AbstractMotions(AbstractMatrixGroup):
    """Motions: a rotation and a translation."""

    def __repr__(self) -> str:
        return f"SE({self.size - 1})"

    def inverse(self, g: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
        """Return the inverse matrix from the transposed rotation."""
        g = self._matrix(g)
        xp = g.__array_namespace__()
        transpose = g[..., :-1, :-1].mT
        upper = xp.concatenate([transpose, -(transpose @ g[..., :-1, -1:])], axis=-1)
        return xp.concatenate([upper, g[..., -1:, :]], axis=-2)

    def residual(self, g: Float[Array, "... N N"]) -> Float[Array, "..."]:
        """Return the residual of the rotation or the largest error of the last row, whichever is larger."""
        g = self._matrix(g)
        xp = g.__array_namespace__()
        last = xp.max(abs(g[..., -1, :] - numerics.identity_like(g)[-1]), axis=-1)
        return xp.maximum(_rotations.residual(g[..., :-1, :-1]), last)


@dataclasses.dataclass(frozen=True, repr=False)
class SpecialEuclidean2(AbstractMotions, AbstractRodriguesGroup):
    r"""Motions of the plane, $\begin{pmatrix} R & x \\ 0 & 1\end{pmatrix}$; coordinates $(\omega, v_1, v_2)$.

    `cayley(x)` is the motion with tan(angle / 2) = x[0] / 2 about the same center as `exp(x)`.
    """

    basis: ClassVar[np.ndarray] = np.stack([np.outer(_Y, _X) - np.outer(_X, _Y), np.outer(_X, _Z), np.outer(_Y, _Z)])
    coordinates: ClassVar[Coordinates] = coordinates_of(basis)
    unit_size: ClassVar[int] = 2
    curvature: ClassVar[float] = 0.0

    def _squared_angle(self, x: Float[Array, "... 3"]) -> Float[Array, "..."]:
        return x[..., 0] * x[..., 0]

    def log(self, g: Float[Array, "... 3 3"]) -> Float[Array, "... 3"]:
        """Return the body velocity that leads to `g` in unit time, turning by at most pi."""
        g = self._matrix(g)
        xp = g.__array_namespace__()
        angle = xp.arctan2(g[..., 1, 0], g[..., 0, 0])
        along, across = numerics.half_cotangent(angle * angle), angle / 2
        x, y = g[..., 0, 2], g[..., 1, 2]
        return xp.stack([angle, along * x + across * y, along * y - across * x], axis=-1)

    def angle(self, x: Float[Array, "... 3"]) -> Float[Array, "..."]:
        """Return the angle through which `exp(x)` turns."""
        return abs(self._vector(x)[..., 0])

    def random(self, rng: int | np.random.Generator) -> Float[np.ndarray, "3 3"]:
        """Draw a uniform heading and a standard normal position."""
        rng = self._generator(rng)
        angle = rng.uniform(-np.pi, np.pi)
        return self.matrix_from_pose(np.array([np.cos(angle), np.sin(angle), *rng.normal(size=2)]))

    def matrix_from_pose(self, pose: Float[Array, "... 4"]) -> Float[Array, "... 3 3"]:
        """Return the matrix of (cos, sin, x, y); the heading is normalized first."""
        unit = self.normalize_pose(pose)
        xp = unit.__array_namespace__()
        cos, sin, x, y = (unit[..., i] for i in range(4))
        zero, one = xp.zeros_like(cos), xp.ones_like(cos)
        rows = ((cos, -sin, x), (sin, cos, y), (zero, zero, one))
        return xp.stack([xp.stack(row, axis=-1) for row in rows], axis=-2)

    def pose_from_matrix(self, g: Float[Array, "... 3 3"]) -> Float[Array, "... 4"]:
        """Return (cos, sin, x, y)."""
        g = self._matrix(g)
        xp = g.__array_namespace__()
        return xp.stack([g[..., 0, 0], g[..., 1, 0], g[..., 0, 2], g[..., 1, 2]], axis=-1)

    def pose_product(self, pose: Float[Array, "... 4"], other: Float[Array, "... 4"]) -> Float[Array, "... 4"]:
        """Return (cos, sin, x, y) of the product: headings add, and the first one turns the second position."""
        poses = self.normalize_pose(pose), self.normalize_pose(other)
        xp = pose.__array_namespace__()
        (c, s, x, y), (d, t, u, v) = (tuple(each[..., i] for i in range(4)) for each in poses)
        return xp.stack([c * d - s * t, s * d + c * t, c * u - s * v + x, s * u + c * v + y], axis=-1)

    def pose_rate(self, pose: Float[Array, "... 4"], x: Float[Array, "... 3"]) -> Float[Array, "... 4"]:
        """Return the rates of (cos, sin, x, y): the body velocity turned by the heading."""
        pose, x = self._pose(pose), self._vector(x)
        xp = x.__array_namespace__()
        cos, sin = pose[..., 0], pose[..., 1]
        omega, v1, v2 = (x[..., i] for i in range(3))
        return xp.stack([-sin * omega, cos * omega, cos * v1 - sin * v2, sin * v1 + cos * v2], axis=-1)


@dataclasses.dataclass(frozen=True, repr=False)
class SpecialEuclideanN(AbstractMotions, AbstractBodyGroup):
    r"""Motions $\begin{pmatrix} R & x \\ 0 & 1\end{pmatrix}$; coordinates of so(n), then $v_1, \dots, v_n$."""

    n: int

    def __post_init__(self) -> None:
        assign(self, dim=self.n * (self.n + 1) // 2, size=self.n + 1, pose_size=self.n * (self.n + 1))

    @functools.cached_property
    def coordinates(self) -> SeparatedCoordinates:
        """The maps between coordinate vectors and matrices of the algebra."""
        axes, last = np.arange(self.n), np.full(self.n, self.n)
        moves = np.stack([axes, axes], axis=1), np.stack([last, last], axis=1), np.tile([1.0, 0.0], (self.n, 1))
        pairs = zip(_rotations.planes(self.n), moves, strict=True)
        return SeparatedCoordinates(self.size, *map(np.concatenate, pairs))

    def exp_increment(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        r"""Return `exp(x)` minus the identity: rotation $e^X - I$, position $\varphi_1(X)v$."""
        X = self.hat(x)
        if not isinstance(X, np.ndarray):
            return self._screw(X) if self.n == 3 else numerics.exponential_increment(X)
        skew = X[..., : self.n, : self.n]
        shift = numerics.of_skew(skew, _mean) @ X[..., : self.n, self.n :]
        return self._assemble(_rotations.exp_increment(skew), shift)

    def _screw(self, X: Float[Array, "... 4 4"]) -> Float[Array, "... 4 4"]:
        r"""Return $e^X - I = X + \frac{1-\cos\theta}{\theta^2}X^2 + \frac{\theta-\sin\theta}{\theta^3}X^3$ on se(3).

        The last quotient is a series for small angles; $X^3$ of the rotation is $-\theta^2X$.
        """
        xp, skew, v = X.__array_namespace__(), X[..., :3, :3], X[..., :3, 3:]
        square = (skew * skew).sum(axis=(-2, -1), keepdims=True) / 2
        small = square < 1
        inside, outside = xp.where(small, square, 0.0), xp.where(small, 1.0, square)
        series = functools.reduce(lambda y, c: c + inside * y, _CUBIC, 0.0 * inside)
        second, third = numerics.versine(square), xp.where(small, series, (1 - numerics.sinc(outside)) / outside)
        turn = skew @ v
        rotation = (1 - third * square) * skew + second * (skew @ skew)
        return self._assemble(rotation, v + second * turn + third * (skew @ turn))

    def log(self, g: Float[Array, "... N N"]) -> Float[Array, "... dim"]:
        r"""Return the body velocity with angles up to pi (JAX: up to 3.14): $X = \log R$, $v = \varphi_1(X)^{-1}x$."""
        g = self._matrix(g)
        if not isinstance(g, np.ndarray):
            return self.vee(numerics.principal_logarithm(g, halvings=1))
        skew = _rotations.logarithm(g[..., : self.n, : self.n], f"{self!r}.log(g=...)")
        return self.vee(self._assemble(skew, numerics.of_skew(skew, _inverse_mean) @ g[..., : self.n, self.n :]))

    def cayley_increment(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return `cayley(x)` minus the identity, without cancellation."""
        X = self.hat(x)
        return _rotations.motion_cayley_increment(X) if isinstance(X, np.ndarray) else numerics.cayley_increment(X)

    def random(self, rng: int | np.random.Generator) -> Float[np.ndarray, "N N"]:
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
        motion = self._assemble(_rotations.nearest(R), position)
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
        return self.pose_from_matrix(self._assemble(upper[..., : self.n], upper[..., self.n :]))

    def _parts(self, pose: Array) -> tuple[Array, Array]:
        squares = self.n * self.n
        return pose[..., :squares].reshape(*pose.shape[:-1], self.n, self.n), pose[..., squares:, None]

    def _assemble(self, rotation: Array, position: Array) -> Array:
        """Return the matrix with these upper blocks and zeros below."""
        xp = rotation.__array_namespace__()
        upper = xp.concatenate([rotation, position], axis=-1)
        return xp.concatenate([upper, xp.zeros_like(upper[..., :1, :])], axis=-2)


def _mean(angle: np.ndarray) -> np.ndarray:
    r"""The function $\varphi_1(z) = (e^z - 1)/z$ at z = i * angle."""
    return numerics.sinc(angle * angle) + 1j * angle * numerics.versine(angle * angle)


def _inverse_mean(angle: np.ndarray) -> np.ndarray:
    r"""The function $1/\varphi_1(z) = (z/2)\coth(z/2) - z/2$ at z = i * angle."""
    return numerics.half_cotangent(angle * angle) - 0.5j * angle


def SE(n: int) -> AbstractMatrixGroup:
    r"""Return the group $SE(n)$, $n \ge 2$, of rigid motions as $(n + 1) \times (n + 1)$ matrices.

    Algebra coordinates: for n = 2 $(\omega, v_1, v_2)$; otherwise those of so(n), then $v_1, \dots, v_n$.

    Raises:
        ValueError: `n` is not an integer of at least 2.

    Example:
        >>> SE(2).exp(np.array([0.0, 3.0, 4.0]))
        array([[1., 0., 3.],
               [0., 1., 4.],
               [0., 0., 1.]])
        >>> SE(3).dim, SE(3).hat(np.arange(1.0, 7.0))[:3].tolist()
        (6, [[0.0, -3.0, 2.0, 4.0], [3.0, 0.0, -1.0, 5.0], [-2.0, 1.0, 0.0, 6.0]])
    """
    n = dimension("SE(n=...)", n)
    return SpecialEuclidean2() if n == 2 else SpecialEuclideanN(n)


def components_of(group: AbstractMatrixGroup) -> tuple[str, ...]:
    """Return names of the coordinates of an algebra.

    Example:
        >>> components_of(SE(2)), components_of(SO(3))
        (('omega', 'v1', 'v2'), ('omega1', 'omega2', 'omega3'))
    """
    turns, shifts = group.dim, 0
    if group == SE(2):
        return "omega", "v1", "v2"
    if group == SE(3):
        turns = shifts = 3
    return (*(f"omega{i + 1}" for i in range(turns)), *(f"v{i + 1}" for i in range(shifts)))
