r"""Coordinates of a Lie algebra of matrices and of its dual, given by a basis $E_1, \dots, E_{dim}$.

A covector p is paired with a matrix X of the algebra as $\langle p, X\rangle = \mathrm{tr}\,P^TX$, where the matrix
$P = \sum p_i D_i$ is built from the dual basis: $\mathrm{tr}\,D_i^TE_j = \delta_{ij}$, $D_i$ in the span of the basis.
"""

import abc

import numpy as np

from nonholo.base.numerics import applied
from nonholo.base.types import Array, Float, Inexact, Int


class AbstractCoordinates(abc.ABC):
    """The four linear maps between coordinate vectors and matrices."""

    @abc.abstractmethod
    def matrix(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        r"""Return $\sum x_i E_i$."""

    @abc.abstractmethod
    def vector(self, X: Inexact[Array, "... N N"]) -> Inexact[Array, "... dim"]:
        r"""Return $x_i = \mathrm{tr}\,D_i^TX$, the coordinates of the orthogonal projection of X on the algebra."""

    @abc.abstractmethod
    def dual_matrix(self, p: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        r"""Return $\sum p_i D_i$."""

    @abc.abstractmethod
    def dual_vector(self, P: Inexact[Array, "... N N"]) -> Inexact[Array, "... dim"]:
        r"""Return $p_i = \mathrm{tr}\,E_i^TP$."""


class SeparatedCoordinates(AbstractCoordinates):
    """A basis of which no two matrices share an entry: every map picks entries, and no (dim, N, N) array is needed.

    Args:
        size: N.
        rows: Row of each entry of each matrix, shape (dim, entries).
        columns: Its column.
        values: Its value; zero for a place that stands for nothing.
    """

    def __init__(
        self,
        size: int,
        rows: Int[np.ndarray, "dim entries"],
        columns: Int[np.ndarray, "dim entries"],
        values: Float[np.ndarray, "dim entries"],
    ) -> None:
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


class DenseCoordinates(AbstractCoordinates):
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
        r"""Return $x_i = \mathrm{tr}\,D_i^TX$."""
        return _pair(X, self._dual)

    def dual_matrix(self, p: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        r"""Return $\sum p_i D_i$."""
        return _combine(p, self._dual)

    def dual_vector(self, P: Inexact[Array, "... N N"]) -> Inexact[Array, "... dim"]:
        r"""Return $p_i = \mathrm{tr}\,E_i^TP$."""
        return _pair(P, self._basis)


def coordinates_of(basis: Float[np.ndarray, "dim N N"]) -> AbstractCoordinates:
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
