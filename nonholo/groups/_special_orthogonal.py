r"""The rotation groups SO(n): the compact pose is a unit quaternion for n = 3, scalar first, else the matrix by rows.

On so(3), as on se(2), $X^3 = -\theta^2 X$: every analytic function of $X$ is $f_0 I + f_1 X + f_2 X^2$, free of
cancellation for all angles. The matrices of $\mathrm{ad}_x$ satisfy the same equation.
"""

import abc
import dataclasses
import functools
from typing import ClassVar

import numpy as np

from nonholo.base.checks import assign, dimension, error, is_traced, within_memory
from nonholo.base.numerics import cayley_increment, cotangent_deficit, identity_like, of_length_one, sinc, versine
from nonholo.base.types import Array, Float
from nonholo.groups import _rotations
from nonholo.groups._base import AbstractMatrixGroup, Coordinates, SeparatedCoordinates

_SMALL = 1e-5  # squared sine below which a series is exact, and derivatives of its quotient lose digits


class AbstractRotations(AbstractMatrixGroup):
    """Rotations: the inverse is the transpose."""

    def __repr__(self) -> str:
        return f"SO({self.size})"

    def inverse(self, g: Float[Array, "... n n"]) -> Float[Array, "... n n"]:
        """Return the transpose."""
        return self.form_adjoint(self._matrix(g))

    def residual(self, g: Float[Array, "... n n"]) -> Float[Array, "..."]:
        """Return the largest entry of g g^T - I; at least 2 for a reflection."""
        return _rotations.residual(self._matrix(g))


class AbstractBodyGroup(AbstractMatrixGroup):
    """Groups of motions of a body in n dimensions without formulas for its exponential."""

    n: int
    is_rigid: ClassVar[bool] = True

    @functools.cached_property
    def basis(self) -> np.ndarray:
        """The basis of the algebra, shape (dim, N, N)."""
        within_memory(f"{self!r}.basis", 8.0 * self.dim * self.size**2, "Use what needs no basis.")
        return self.hat(np.eye(self.dim))

    def angle(self, x: Float[Array, "... dim"]) -> Float[Array, "..."]:
        """Return the largest angle through which `exp(x)` turns a plane: the spectral norm of its rotation."""
        X = self.hat(x)[..., : self.n, : self.n]
        return X.__array_namespace__().linalg.norm(X, ord=2, axis=(-2, -1))


class AbstractRodriguesGroup(AbstractMatrixGroup):
    r"""A group of rigid motions with $X^3 = -\theta^2 X$, of dimension three."""

    dim: ClassVar[int] = 3
    size: ClassVar[int] = 3
    pose_size: ClassVar[int] = 4
    unit_size: ClassVar[int]
    """Numbers at the beginning of a compact pose whose squares have the sum one."""
    is_rigid: ClassVar[bool] = True

    def normalize_pose(self, pose: Float[Array, "... 4"]) -> Float[Array, "... 4"]:
        """Return the pose whose quaternion, or cosine and sine, has length one."""
        return of_length_one(self._with_direction(pose), self.unit_size)

    def _with_direction(self, pose: Array) -> Array:
        """Return a checked pose, whose quaternion, or cosine and sine, can be divided by its length."""
        pose = self._pose(pose)
        unit = None if pose.ndim > 1 or is_traced(pose) else pose[: self.unit_size]
        if unit is not None and not unit @ unit > 0:
            must = f"begin with {len(unit)} numbers whose squares have a positive sum"
            raise error(f"{self!r} (pose)", must, str(unit), "Use `pose_from_matrix` to turn a matrix into a pose.")
        return pose

    @abc.abstractmethod
    def _squared_angle(self, x: Float[Array, "... 3"]) -> Float[Array, "..."]:
        r"""Return $\theta^2$."""

    def exp_increment(self, x: Float[Array, "... 3"]) -> Float[Array, "... 3 3"]:
        r"""Return $\frac{\sin\theta}{\theta}X + \frac{1-\cos\theta}{\theta^2}X^2$, `exp(x)` minus the identity."""
        x = self._vector(x)
        X, square = self.coordinates.matrix(x), self._squared_angle(x)
        return sinc(square)[..., None, None] * X + versine(square)[..., None, None] * (X @ X)

    def cayley_increment(self, x: Float[Array, "... 3"]) -> Float[Array, "... 3 3"]:
        r"""Return $(I - X/2)^{-1}(I + X/2) - I = (X + X^2/2)/(1 + \theta^2/4)$ without the subtraction."""
        x = self._vector(x)
        X = self.coordinates.matrix(x)
        return (X + X @ X / 2) / (1 + self._squared_angle(x) / 4)[..., None, None]

    def dexp_inverse(self, x: Float[Array, "... 3"]) -> Float[Array, "... 3 3"]:
        r"""Return $I - \mathrm{ad}/2 + \theta^{-2}\bigl(1 - \frac\theta2\cot\frac\theta2\bigr)\mathrm{ad}^2$."""
        x = self._vector(x)
        ad = self.ad(x)
        return identity_like(ad) - ad / 2 + cotangent_deficit(self._squared_angle(x))[..., None, None] * (ad @ ad)


def matrix_from_quaternion(q: Float[Array, "... 4"]) -> Float[Array, "... 3 3"]:
    """Return the active rotation matrix of a quaternion, which is normalized first."""
    xp = q.__array_namespace__()
    unit = of_length_one(q, 4)
    w, x, y, z = (unit[..., i] for i in range(4))
    xx, yy, zz, xy, xz, yz, wx, wy, wz = x * x, y * y, z * z, x * y, x * z, y * z, w * x, w * y, w * z
    first = 1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy)
    second = 2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx)
    third = 2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy)
    return xp.stack([*first, *second, *third], axis=-1).reshape(*q.shape[:-1], 3, 3)


def quaternion_from_matrix(R: Float[Array, "... 3 3"]) -> Float[Array, "... 4"]:
    """Return the unit quaternion with non-negative scalar part; accurate for every angle.

    The symmetric matrix 4 q q^T is read off R; its row with the largest diagonal entry, normalized, is q.
    """
    xp = R.__array_namespace__()
    a, b, c, d, e, f, g, h, i = R.reshape(-1, 9).T.copy()
    more, less, wx, wy, wz, xy, xz, yz = 1 + a, 1 - a, h - f, c - g, d - b, b + d, c + g, f + h
    ww, xx, yy, zz = more + e + i, more - e - i, less + e - i, less - e + i
    products = xp.asarray([ww, wx, wy, wz, wx, xx, xy, xz, wy, xy, yy, yz, wz, xz, yz, zz])
    best = xp.argmax(products[::5], axis=0)
    q = of_length_one(products.reshape(4, 4, -1)[best, :, xp.arange(len(best))], 4)
    return xp.where(q[:, :1] < 0, -q, q).reshape(*R.shape[:-2], 4)


def quaternion_product(p: Float[Array, "... 4"], q: Float[Array, "... 4"]) -> Float[Array, "... 4"]:
    """Return Hamilton's product, divided by its length, its scalar non-negative: first the rotation q, then p."""
    xp = p.__array_namespace__()
    (a, b, c, d), (w, x, y, z) = (tuple(each[..., i] for i in range(4)) for each in (p, q))
    scalar = a * w - b * x - c * y - d * z
    vector = a * x + b * w + c * z - d * y, a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w
    product = of_length_one(xp.stack([scalar, *vector], axis=-1), 4)
    return xp.where(product[..., :1] < 0, -product, product)


@dataclasses.dataclass(frozen=True, repr=False)
class SpecialOrthogonal3(AbstractRotations, AbstractRodriguesGroup):
    """Rotations of space; the coordinates of the algebra are the angular velocity vector.

    `exp(x)` is the rotation by the vector `x` (axis times angle), `cayley(x)` that about `x` with
    tan(angle / 2) = |x| / 2.
    """

    coordinates: ClassVar[Coordinates] = SeparatedCoordinates(3, *_rotations.planes(3))
    basis: ClassVar[np.ndarray] = np.ascontiguousarray(coordinates.matrix(np.eye(3)))
    unit_size: ClassVar[int] = 4
    curvature: ClassVar[float] = 1.0

    def _squared_angle(self, x: Float[Array, "... 3"]) -> Float[Array, "..."]:
        return (x * x).sum(axis=-1)

    def log(self, g: Float[Array, "... 3 3"]) -> Float[Array, "... 3"]:
        """Return the rotation vector, of length at most pi; accurate near 0 and near pi."""
        g = self._matrix(g)
        xp = g.__array_namespace__()
        q = quaternion_from_matrix(g)
        square = (q[..., 1:] * q[..., 1:]).sum(axis=-1)
        small = square < _SMALL
        sine = xp.sqrt(xp.where(small, 1.0, square))
        series = 1 + square * (1 / 6 + square * (3 / 40 + square * (5 / 112)))
        scale = 2 * xp.where(small, series, xp.arctan2(sine, q[..., 0]) / sine)
        return scale[..., None] * q[..., 1:]

    def angle(self, x: Float[Array, "... 3"]) -> Float[Array, "..."]:
        """Return the angle through which `exp(x)` turns."""
        x = self._vector(x)
        return x.__array_namespace__().sqrt((x * x).sum(axis=-1))

    def random(self, rng: int | np.random.Generator) -> Float[np.ndarray, "3 3"]:
        """Draw a uniformly distributed rotation."""
        return matrix_from_quaternion(self._generator(rng).normal(size=4))

    def matrix_from_pose(self, pose: Float[Array, "... 4"]) -> Float[Array, "... 3 3"]:
        """Return the rotation matrix of a quaternion, scalar first."""
        return matrix_from_quaternion(self._with_direction(pose))

    def pose_from_matrix(self, g: Float[Array, "... 3 3"]) -> Float[Array, "... 4"]:
        """Return the unit quaternion, scalar first and non-negative."""
        return quaternion_from_matrix(self._matrix(g))

    def pose_product(self, pose: Float[Array, "... 4"], other: Float[Array, "... 4"]) -> Float[Array, "... 4"]:
        """Return Hamilton's product of two quaternions as a unit quaternion, its scalar non-negative."""
        return quaternion_product(self._with_direction(pose), self._with_direction(other))

    def pose_rate(self, pose: Float[Array, "... 4"], x: Float[Array, "... 3"]) -> Float[Array, "... 4"]:
        """Return half the Hamilton product of the quaternion with the angular velocity."""
        pose, x = self._pose(pose), self._vector(x)
        xp = x.__array_namespace__()
        (q0, q1, q2, q3), (a, b, c) = (tuple(v[..., i] for i in range(v.shape[-1])) for v in (pose, x))
        rows = (-q1 * a - q2 * b - q3 * c, q0 * a + q2 * c - q3 * b, q0 * b + q3 * a - q1 * c, q0 * c + q1 * b - q2 * a)
        return xp.stack(rows, axis=-1) / 2


@dataclasses.dataclass(frozen=True, repr=False)
class SpecialOrthogonalN(AbstractRotations, AbstractBodyGroup):
    r"""Rotations of n-dimensional space; coordinates are the coefficients of $e_i\wedge e_j$, i < j, lexicographic."""

    n: int

    def __post_init__(self) -> None:
        assign(self, dim=self.n * (self.n - 1) // 2, size=self.n, pose_size=self.n * self.n)

    @functools.cached_property
    def coordinates(self) -> SeparatedCoordinates:
        """The maps between coordinate vectors and skew-symmetric matrices."""
        return SeparatedCoordinates(self.n, *_rotations.planes(self.n))

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

    def random(self, rng: int | np.random.Generator) -> Float[np.ndarray, "n n"]:
        """Draw a uniformly distributed rotation."""
        return _rotations.random(self.n, self._generator(rng))

    def matrix_from_pose(self, pose: Float[Array, "... size"]) -> Float[Array, "... n n"]:
        """Return the rotation nearest to the matrix with these rows."""
        return _rotations.nearest(super().matrix_from_pose(pose))


def SO(n: int) -> AbstractMatrixGroup:
    r"""Return the rotation group $SO(n)$, $n \ge 2$.

    Algebra coordinates: for n = 3 the usual vector, $\mathrm{hat}(v)\,x = v \times x$; otherwise $x_{ij}$, pairs
    $i < j$ in lexicographic order, the coefficients of $e_i\wedge e_j = e_ie_j^T - e_je_i^T$.

    Raises:
        ValueError: `n` is not an integer of at least 2.

    Example:
        >>> SO(3).hat(np.array([0.0, 0.0, 1.0]))
        array([[ 0., -1.,  0.],
               [ 1.,  0.,  0.],
               [ 0.,  0.,  0.]])
        >>> SO(4).hat(np.arange(1.0, 7.0))
        array([[ 0.,  1.,  2.,  3.],
               [-1.,  0.,  4.,  5.],
               [-2., -4.,  0.,  6.],
               [-3., -5., -6.,  0.]])
    """
    n = dimension("SO(n=...)", n)
    return SpecialOrthogonal3() if n == 3 else SpecialOrthogonalN(n)
