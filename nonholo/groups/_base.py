r"""The interface of a matrix group, with everything that follows from a basis of its algebra.

Elements are matrices, elements of the algebra and its dual coordinate vectors, the pairing is the plain dot product.
All functions broadcast over leading axes.
"""

import abc

import numpy as np

from nonholo._checks import trailing
from nonholo._types import Array, Float


class AbstractMatrixGroup(abc.ABC):
    """A group of (N, N) matrices with a chosen basis of its Lie algebra.

    A new group states `basis`, `exp`, `log`, `inverse`, `random` and its compact pose; the rest is shared.
    """

    basis: np.ndarray
    """The basis of the algebra, shape (dim, N, N); orthogonal in the Frobenius product."""
    pose_size: int
    """Numbers in a compact pose."""

    @abc.abstractmethod
    def exp(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return the matrix exponential of `hat(x)`."""

    @abc.abstractmethod
    def log(self, g: Float[Array, "... N N"]) -> Float[Array, "... dim"]:
        """Return the shortest `x` with `exp(x) = g`; at angle pi one of the two."""

    @abc.abstractmethod
    def cayley(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        r"""Return $(I - X/2)^{-1}(I + X/2)$, $X$ = `hat(x)`; it agrees with `exp` to second order."""

    @abc.abstractmethod
    def cayley_increment(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return `cayley(x)` minus the identity, without cancellation."""

    @abc.abstractmethod
    def inverse(self, g: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
        """Return the inverse of `g`, using its structure."""

    @abc.abstractmethod
    def rotation(self, g: Float[Array, "... N N"]) -> Float[Array, "... n n"]:
        """Return the orthogonal part of `g`."""

    @abc.abstractmethod
    def angle(self, x: Float[Array, "... dim"]) -> Float[Array, "..."]:
        """Return the angle through which `exp(x)` turns."""

    @abc.abstractmethod
    def random(self, rng: np.random.Generator) -> Float[np.ndarray, "N N"]:
        """Draw an element: rotations uniformly, translations from the standard normal distribution."""

    @abc.abstractmethod
    def matrix_from_pose(self, pose: Float[Array, "... size"]) -> Float[Array, "... N N"]:
        """Return the matrix of a compact pose."""

    @abc.abstractmethod
    def pose_from_matrix(self, g: Float[Array, "... N N"]) -> Float[Array, "... size"]:
        """Return the compact pose of a matrix."""

    @abc.abstractmethod
    def normalize_pose(self, pose: Float[Array, "... size"]) -> Float[Array, "... size"]:
        """Return the compact pose of the group that is nearest to one in which errors have gathered."""

    @abc.abstractmethod
    def pose_rate(self, pose: Float[Array, "... size"], x: Float[Array, "... dim"]) -> Float[Array, "... size"]:
        """Return the rate of change of a compact pose that moves with the body velocity `x`."""

    @property
    def dim(self) -> int:
        """Dimension of the group."""
        return self.basis.shape[0]

    @property
    def identity(self) -> Float[np.ndarray, "N N"]:
        """The identity matrix."""
        return np.eye(self.basis.shape[1])

    def hat(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return the matrix of the algebra with coordinates `x`."""
        x = self._vector(x)
        xp = x.__array_namespace__()
        return xp.tensordot(x, xp.asarray(self.basis, dtype=x.dtype), axes=1)

    def vee(self, X: Float[Array, "... N N"]) -> Float[Array, "... dim"]:
        """Return the coordinates of a matrix of the algebra (of its orthogonal projection, if it lies outside)."""
        X = self._matrix(X)
        xp = X.__array_namespace__()
        return xp.tensordot(X, xp.asarray(_dual_basis(self), dtype=X.dtype), axes=((-2, -1), (1, 2)))

    def adjoint(self, g: Float[Array, "... N N"]) -> Float[Array, "... dim dim"]:
        r"""Return the matrix of $\mathrm{Ad}_g$: column i holds the coordinates of $g\,e_i\,g^{-1}$."""
        g = self._matrix(g)
        xp = g.__array_namespace__()
        images = g[..., None, :, :] @ xp.asarray(self.basis, dtype=g.dtype) @ self.inverse(g)[..., None, :, :]
        return xp.swapaxes(self.vee(images), -1, -2)

    def coadjoint(self, g: Float[Array, "... N N"], p: Float[Array, "... dim"]) -> Float[Array, "... dim"]:
        r"""Return the plain transpose: $\langle\mathrm{Ad}^*_g p, x\rangle = \langle p, \mathrm{Ad}_g x\rangle$."""
        p = self._vector(p)
        return (p[..., None, :] @ self.adjoint(g))[..., 0, :]

    def bracket(self, x: Float[Array, "... dim"], y: Float[Array, "... dim"]) -> Float[Array, "... dim"]:
        """Return the Lie bracket, in coordinates, of the matrix commutator."""
        X, Y = self.hat(x), self.hat(y)
        return self.vee(X @ Y - Y @ X)

    def coad(self, x: Float[Array, "... dim"], p: Float[Array, "... dim"]) -> Float[Array, "... dim"]:
        r"""Return the plain transpose: $\langle\mathrm{ad}^*_x p, y\rangle = \langle p, [x, y]\rangle$."""
        x, p = self._vector(x), self._vector(p)
        xp = x.__array_namespace__()
        brackets = self.bracket(x[..., None, :], xp.eye(self.dim, dtype=x.dtype))
        return (brackets @ p[..., :, None])[..., 0]

    def _vector(self, x: Array) -> Array:
        where = f"{self!r} (coordinates)"
        return trailing(where, x, (self.dim,), "Use `vee` to turn a matrix into coordinates.")

    def _matrix(self, g: Array) -> Array:
        where = f"{self!r} (element)"
        return trailing(where, g, self.identity.shape, "Use `hat`, `exp` or `cayley` to make a matrix.")


def _dual_basis(group: AbstractMatrixGroup) -> np.ndarray:
    squares = np.sum(group.basis * group.basis, axis=(1, 2))
    return group.basis / squares[:, None, None]
