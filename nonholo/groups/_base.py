r"""The interface of a matrix group, with everything that follows from a basis of its algebra.

Elements are matrices, elements of the algebra and its dual coordinate vectors, the pairing is the plain dot product.
All functions broadcast over leading axes.
"""

import abc
import functools
from typing import Any, TypeAlias

import numpy as np

from nonholo.base.checks import generator, trailing, within_memory
from nonholo.base.memo import Keeper
from nonholo.base.numerics import applied, identity_like, integrated_exponential, inverse_of
from nonholo.base.types import Array, Float, Inexact, Int

Places = Int[np.ndarray, "dim entries"]


class SeparatedCoordinates:
    """A basis of which no two matrices share an entry: every map picks entries, and no (dim, N, N) array is needed.

    Args:
        size: N.
        rows: Row of each entry of each matrix, shape (dim, entries).
        columns: Its column.
        values: Its value; zero for a place that stands for nothing.
    """

    def __init__(self, size: int, rows: Places, columns: Places, values: Float[np.ndarray, "dim entries"]) -> None:
        is_nonzero = values != 0
        self._rows, self._columns = rows.astype(np.int32), columns.astype(np.int32)  # JAX takes these in 32 bits too
        self._values = values
        self._owner = np.zeros((size, size), dtype=np.int32)
        self._owner[rows[is_nonzero], columns[is_nonzero]] = np.nonzero(is_nonzero)[0]
        self._weight = np.zeros((size, size))
        self._weight[rows[is_nonzero], columns[is_nonzero]] = values[is_nonzero]
        self._squares = np.sum(values * values, axis=1)

    def matrix(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        r"""Return $\sum x_i E_i$."""
        weight = x.__array_namespace__().asarray(self._weight, dtype=x.dtype)
        return x[..., self._owner] * weight + 0.0  # no negative zeros

    def vector(self, X: Inexact[Array, "... N N"]) -> Inexact[Array, "... dim"]:
        r"""Return $x_i = \mathrm{tr}\,E_i^TX/|E_i|^2$."""
        return self.dual_vector(X) / X.__array_namespace__().asarray(self._squares, dtype=X.dtype)

    def dual_matrix(self, p: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        r"""Return $\sum p_i E_i/|E_i|^2$."""
        return self.matrix(p / p.__array_namespace__().asarray(self._squares, dtype=p.dtype))

    def dual_vector(self, P: Inexact[Array, "... N N"]) -> Inexact[Array, "... dim"]:
        r"""Return $p_i = \mathrm{tr}\,E_i^TP$."""
        xp = P.__array_namespace__()
        return xp.sum(P[..., self._rows, self._columns] * xp.asarray(self._values, dtype=P.dtype), axis=-1)


class DenseCoordinates:
    """Any basis, orthogonal or not.

    Args:
        basis: The matrices, linearly independent.
    """

    def __init__(self, basis: Float[np.ndarray, "dim N N"]) -> None:
        lengths = np.linalg.norm(basis, axis=(1, 2), keepdims=True)
        flat = (basis / lengths).reshape(len(basis), -1)
        self._basis, self._dual = basis, np.linalg.pinv(flat).T.reshape(basis.shape) / lengths

    def matrix(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        r"""Return $\sum x_i E_i$."""
        return _combine(x, self._basis)

    def vector(self, X: Inexact[Array, "... N N"]) -> Inexact[Array, "... dim"]:
        r"""Return $x_i = \mathrm{tr}\,D_i^TX$, the coordinates of the orthogonal projection of X on the algebra."""
        return _pair(X, self._dual)

    def dual_matrix(self, p: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        r"""Return $\sum p_i D_i$."""
        return _combine(p, self._dual)

    def dual_vector(self, P: Inexact[Array, "... N N"]) -> Inexact[Array, "... dim"]:
        r"""Return $p_i = \mathrm{tr}\,E_i^TP$."""
        return _pair(P, self._basis)


Coordinates: TypeAlias = SeparatedCoordinates | DenseCoordinates
"""The four linear maps between coordinate vectors and matrices."""


def coordinates_of(basis: Float[np.ndarray, "dim N N"]) -> Coordinates:
    """Return the coordinates of a basis: by picking entries, if no two matrices share one."""
    is_nonzero = basis != 0
    if np.any(is_nonzero.sum(axis=0) > 1):
        return DenseCoordinates(basis)
    entries = int(is_nonzero.sum(axis=(1, 2)).max())
    flat = np.argsort(~is_nonzero.reshape(len(basis), -1), axis=1, kind="stable")[:, :entries]
    rows, columns = np.unravel_index(flat, basis.shape[1:])
    values = np.take_along_axis(basis.reshape(len(basis), -1), flat, axis=1)
    return SeparatedCoordinates(basis.shape[1], rows, columns, values)


def _combine(x: Array, matrices: np.ndarray) -> Array:
    flat = x.__array_namespace__().asarray(matrices.reshape(len(matrices), -1), dtype=x.dtype)
    return applied(flat.T, x).reshape(*x.shape[:-1], *matrices.shape[1:])


def _pair(X: Array, matrices: np.ndarray) -> Array:
    flat = X.__array_namespace__().asarray(matrices.reshape(len(matrices), -1), dtype=X.dtype)
    return applied(flat, X.reshape(*X.shape[:-2], flat.shape[1]))


_WIDE = 1000  # from this size on it is asked whether a matrix fits into memory
_LEFT = 1e-9  # residual of a pose, that of starts of moderate size


class AbstractMatrixGroup(Keeper, abc.ABC):
    """A group of (N, N) matrices with a chosen basis of its Lie algebra.

    A new group states the attributes and the abstract methods; the rest is shared.
    """

    dim: int
    """Dimension of the group."""
    size: int
    """N, the number of rows of a matrix."""
    basis: np.ndarray
    """The basis of the algebra, shape (dim, N, N)."""
    pose_size: int
    """Numbers in a compact pose."""
    is_rigid: bool = False
    """Whether the group moves the points of a body, SO(n) or SE(n)."""
    curvature: float | None = None
    """Of the surface whose motions it has: 1 of the sphere, SO(3); 0 of the plane, SE(2); None of other groups."""
    has_drift: bool = False
    """Whether poses that grow leave the group by rounding, and its `residual` is relative to their size."""
    form: np.ndarray | None = None
    """G of a quadratic group, whose inverse is G^-1 W^T G; None for SO(n), where it is the identity, and all others."""

    @functools.cached_property
    def coordinates(self) -> Coordinates:
        """The maps between coordinate vectors and matrices that the basis defines."""
        return coordinates_of(self.basis)

    @abc.abstractmethod
    def exp_increment(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return `exp(x)` minus the identity, without cancellation."""

    @abc.abstractmethod
    def log(self, g: Float[Array, "... N N"]) -> Float[Array, "... dim"]:
        """Return the shortest `x` with `exp(x) = g`; at angle pi one of several."""

    @abc.abstractmethod
    def cayley_increment(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return `cayley(x)` minus the identity, without cancellation."""

    def dexp_inverse(self, x: Float[Array, "... dim"]) -> Float[Array, "... dim dim"]:
        r"""Return the matrix of $\mathrm{dexp}_x^{-1} = \sum_k B_k\,\mathrm{ad}_x^k/k!$, for angles below $2\pi$.

        It is the inverse of $\mathrm{dexp}_x = \sum_k \mathrm{ad}_x^k/(k+1)! = \varphi_1(\mathrm{ad}_x)$, defined by
        $\frac{d}{dt}e^{X(t)} = \mathrm{hat}(\mathrm{dexp}_x\dot x)\,e^{X}$.
        """
        return inverse_of(integrated_exponential(self.ad(x)))

    @abc.abstractmethod
    def inverse(self, g: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
        """Return the inverse of `g`, using its structure."""

    @abc.abstractmethod
    def residual(self, g: Float[Array, "... N N"]) -> Float[Array, "..."]:
        """Return the distance of matrices from the group: zero on it, up to rounding."""

    def leading_elements(self, g: Float[Array, "... K N N"]) -> Int[Array, "..."]:
        """Return how many of the first poses of a motion precede one that has left the group by rounding."""
        with np.errstate(invalid="ignore"):  # a member of an ensemble has NaN after its end
            is_on = self.residual(g) <= _LEFT
        return np.logical_and.accumulate(is_on, axis=-1).sum(axis=-1)

    @abc.abstractmethod
    def angle(self, x: Float[Array, "... dim"]) -> Float[Array, "..."]:
        """Return the angle through which `exp(x)` turns: the largest imaginary part of an eigenvalue of `hat(x)`."""

    def random(self, rng: int | np.random.Generator) -> Float[np.ndarray, "N N"]:
        """Draw an element: rotations uniformly, translations from the standard normal distribution."""
        return self.exp(self._generator(rng).normal(size=self.dim))

    def matrix_from_pose(self, pose: Float[Array, "... size"]) -> Float[Array, "... N N"]:
        """Return the matrix of a compact pose: by default the one with these rows."""
        pose = self._pose(pose)
        return pose.reshape(*pose.shape[:-1], self.size, self.size)

    def pose_from_matrix(self, g: Float[Array, "... N N"]) -> Float[Array, "... size"]:
        """Return the compact pose of a matrix: by default its entries row by row."""
        g = self._matrix(g)
        return g.reshape(*g.shape[:-2], self.pose_size)

    def normalize_pose(self, pose: Float[Array, "... size"]) -> Float[Array, "... size"]:
        """Return the compact pose of the group that is nearest to one in which rounding errors have gathered."""
        return self.pose_from_matrix(self.matrix_from_pose(pose))

    def pose_product(self, pose: Float[Array, "... size"], other: Float[Array, "... size"]) -> Float[Array, "... size"]:
        """Return the compact pose of the product g k of the elements with two compact poses."""
        return self.pose_from_matrix(self.matrix_from_pose(pose) @ self.matrix_from_pose(other))

    def pose_rate(self, pose: Float[Array, "... size"], x: Float[Array, "... dim"]) -> Float[Array, "... size"]:
        """Return the rate of change of a compact pose that moves with the body velocity `x`: by default g hat(x)."""
        pose, x = self._pose(pose), self._vector(x)
        rows = pose.reshape(*pose.shape[:-1], self.size, self.size)
        return self.pose_from_matrix(rows @ self.hat(x))

    @property
    def has_skew_part(self) -> bool:
        """Whether (W - W^-1)/2 lies in the algebra, and a mass tensor gives the kinetic energy: SO(n), SE(n), forms."""
        return self.is_rigid or self.form is not None

    @property
    def is_affine(self) -> bool:
        """Whether matrices move points of one dimension less, with homogeneous coordinates: SE(n)."""
        return self.is_rigid and not np.any(self.basis[:, -1])

    @property
    def point_size(self) -> int:
        """The number of coordinates of the points that matrices move."""
        return self.size - self.is_affine

    @property
    def identity(self) -> Float[np.ndarray, "N N"]:
        """The identity matrix."""
        if self.size > _WIDE:
            within_memory(f"{self!r}.identity", 8.0 * self.size**2, "Use what needs no matrices.")
        return np.eye(self.size)

    def exp(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return the matrix exponential of `hat(x)`: where the body velocity `x` leads in unit time."""
        return _from_identity(self.exp_increment(x))

    def cayley(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        r"""Return $(I - X/2)^{-1}(I + X/2)$, $X$ = `hat(x)`; it agrees with `exp` to second order."""
        return _from_identity(self.cayley_increment(x))

    def retract(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return the displacement with chart coordinates `x`: `cayley` where W has a skew part, else `exp`."""
        return _from_identity(self.retract_increment(x))

    def retract_increment(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return `retract(x)` minus the identity, without cancellation."""
        return self.cayley_increment(x) if self.has_skew_part else self.exp_increment(x)

    def hat(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return the matrix of the algebra with coordinates `x`."""
        return self.coordinates.matrix(self._vector(x))

    def vee(self, X: Inexact[Array, "... N N"]) -> Inexact[Array, "... dim"]:
        """Return the coordinates of a matrix of the algebra (of its orthogonal projection, if it lies outside)."""
        return self.coordinates.vector(self._matrix(X, real=False))

    def form_adjoint(self, X: Inexact[Array, "... N N"]) -> Inexact[Array, "... N N"]:
        r"""Return $X^* = G^{-1}X^TG$, the adjoint of a matrix in the form of the group; $X^T$ where there is none."""
        X = self._matrix(X, real=False)
        if self.form is None:
            return X.mT
        xp = X.__array_namespace__()
        G, inverse = (xp.asarray(each, dtype=X.dtype) for each in (self.form, np.linalg.inv(self.form)))
        return inverse @ X.mT @ G

    def adjoint(self, g: Float[Array, "... N N"]) -> Float[Array, "... dim dim"]:
        r"""Return the matrix of $\mathrm{Ad}_g$: column i holds the coordinates of $g\,e_i\,g^{-1}$."""
        g = self._matrix(g)
        xp = g.__array_namespace__()
        images = g[..., None, :, :] @ xp.asarray(self.basis, dtype=g.dtype) @ self.inverse(g)[..., None, :, :]
        return self.vee(images).mT

    def coadjoint(self, g: Float[Array, "... N N"], p: Float[Array, "... dim"]) -> Float[Array, "... dim"]:
        r"""Return the plain transpose: $\langle\mathrm{Ad}^*_g p, x\rangle = \langle p, \mathrm{Ad}_g x\rangle$.

        For the matrix $P$ of the covector it is $g^TPg^{-T}$, on SO(n) $g^TPg$.
        """
        g, p = self._matrix(g), self._vector(p)
        return self.coordinates.dual_vector(g.mT @ self.coordinates.dual_matrix(p) @ self.inverse(g).mT)

    def bracket(self, x: Float[Array, "... dim"], y: Float[Array, "... dim"]) -> Float[Array, "... dim"]:
        """Return the Lie bracket, in coordinates, of the matrix commutator."""
        X, Y = self.hat(x), self.hat(y)
        return self.vee(X @ Y - Y @ X)

    def ad(self, x: Float[Array, "... dim"]) -> Float[Array, "... dim dim"]:
        r"""Return the matrix of $\mathrm{ad}_x$: column i holds the coordinates of $[x, e_i]$."""
        x = self._vector(x)
        return self.bracket(x[..., None, :], x.__array_namespace__().eye(self.dim, dtype=x.dtype)).mT

    def coad(self, x: Float[Array, "... dim"], p: Float[Array, "... dim"]) -> Float[Array, "... dim"]:
        r"""Return the plain transpose: $\langle\mathrm{ad}^*_x p, y\rangle = \langle p, [x, y]\rangle$.

        For the matrix $P$ of the covector it is $[X^T, P]$, on so(n) $[P, X]$.
        """
        X, P = self.hat(x), self.coordinates.dual_matrix(self._vector(p))
        return self.coordinates.dual_vector(X.mT @ P - P @ X.mT)

    def _vector(self, x: Array) -> Array:
        remedy = "Use `vee` to turn a matrix into coordinates."
        return trailing(lambda: f"{self!r} (coordinates)", x, (self.dim,), remedy, real=True)

    def _pose(self, pose: Array) -> Array:
        remedy = "Use `pose_from_matrix` to turn a matrix into a pose."
        return trailing(lambda: f"{self!r} (pose)", pose, (self.pose_size,), remedy, real=True)

    def _generator(self, rng: Any) -> np.random.Generator:
        return generator(f"{self!r}.random(rng=...)", rng)

    def _matrix(self, g: Array, real: bool = True) -> Array:
        shape, remedy = (self.size, self.size), "Use `hat`, `exp` or `cayley` to make a matrix."
        return trailing(lambda: f"{self!r} (element)", g, shape, remedy, real=real)


def _from_identity(increment: Array) -> Array:
    return identity_like(increment) + increment
