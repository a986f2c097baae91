"""The additive group of vectors as matrices: wheel angles, positions of internal masses."""

import dataclasses
import functools

import numpy as np

from nonholo.base.checks import assign, count
from nonholo.base.numerics import identity_like
from nonholo.base.types import Array, Float
from nonholo.groups._base import AbstractMatrixGroup, SeparatedCoordinates


@dataclasses.dataclass(frozen=True, repr=False)
class Translations(AbstractMatrixGroup):
    r"""The vectors of $\mathbb R^m$ as matrices $\begin{pmatrix} I & x \\ 0 & 1\end{pmatrix}$; the pose is $x$.

    Args:
        m: Number of components.

    Raises:
        ValueError: `m` is not a positive integer.

    Example:
        >>> Translations(2).exp(np.array([3.0, 4.0]))
        array([[1., 0., 3.],
               [0., 1., 4.],
               [0., 0., 1.]])
    """

    m: int

    def __post_init__(self) -> None:
        m = count("Translations(m=...)", self.m, "Pass the number of components.")
        assign(self, m=m, dim=m, size=m + 1, pose_size=m)

    def __repr__(self) -> str:
        return f"Translations({self.m})"

    @functools.cached_property
    def coordinates(self) -> SeparatedCoordinates:
        """The maps between vectors and the last columns of matrices."""
        axes = np.arange(self.m)[:, None]
        return SeparatedCoordinates(self.size, axes, np.full_like(axes, self.m), np.ones((self.m, 1)))

    @functools.cached_property
    def basis(self) -> np.ndarray:
        """The basis of the algebra, shape (m, m + 1, m + 1)."""
        return self.hat(np.eye(self.m))

    def exp_increment(self, x: Float[Array, "... m"]) -> Float[Array, "... N N"]:
        """Return `hat(x)`, whose square is zero."""
        return self.hat(x)

    def log(self, g: Float[Array, "... N N"]) -> Float[Array, "... m"]:
        """Return the vector."""
        return self.vee(g)

    cayley_increment = exp_increment

    def dexp_inverse(self, x: Float[Array, "... m"]) -> Float[Array, "... m m"]:
        """Return the identity matrix: the group is commutative."""
        x = self._vector(x)
        xp = x.__array_namespace__()
        return xp.broadcast_to(xp.eye(self.m, dtype=x.dtype), (*x.shape, self.m))

    def inverse(self, g: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
        """Return the opposite translation."""
        g = self._matrix(g)
        return 2 * identity_like(g) - g

    def residual(self, g: Float[Array, "... N N"]) -> Float[Array, "..."]:
        """Return the largest error of an entry that every translation shares."""
        g = self._matrix(g)
        xp = g.__array_namespace__()
        return xp.max(abs(g - identity_like(g) - self.hat(self.vee(g))), axis=(-2, -1))

    def angle(self, x: Float[Array, "... m"]) -> Float[Array, "..."]:
        """Return zero: nothing turns."""
        x = self._vector(x)
        return x.__array_namespace__().zeros_like(x[..., 0])

    def matrix_from_pose(self, pose: Float[Array, "... m"]) -> Float[Array, "... N N"]:
        """Return the matrix of a vector."""
        return self.exp(pose)

    def pose_from_matrix(self, g: Float[Array, "... N N"]) -> Float[Array, "... m"]:
        """Return the vector."""
        return self.vee(self._matrix(g))

    def normalize_pose(self, pose: Float[Array, "... m"]) -> Float[Array, "... m"]:
        """Return the vector as it is."""
        return self._pose(pose)

    def pose_rate(self, pose: Float[Array, "... m"], x: Float[Array, "... m"]) -> Float[Array, "... m"]:
        """Return the velocity."""
        x, pose = self._vector(x), self._pose(pose)
        return x.__array_namespace__().broadcast_to(x, np.broadcast_shapes(x.shape, pose.shape))
