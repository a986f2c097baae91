"""Samples of a group, made from its basis alone, so that no function under test takes part in them."""

import functools

import numpy as np
import scipy.linalg

from nonholo.base.types import Float
from nonholo.groups import AbstractMatrixGroup

_COUNT = 4


class GroupSamples:
    """Random coordinates, matrices and elements of a group.

    Args:
        group: The group.
        rng: Where the numbers come from.
    """

    def __init__(self, group: AbstractMatrixGroup, rng: np.random.Generator) -> None:
        self.group = group
        self._directions = rng.normal(size=(2, _COUNT, group.dim))
        self.p = rng.normal(size=(_COUNT, group.dim))
        self._many = rng.normal(size=(16 * _COUNT, group.dim))
        self._rng = rng

    def vectors(self, size: float, which: int = 0) -> Float[np.ndarray, "4 dim"]:
        """Return coordinates whose matrices have the given norm."""
        x = self._directions[which]
        return size * x / np.linalg.norm(self.matrix(x), 2, axis=(1, 2))[:, None]

    @functools.cached_property
    def x(self) -> Float[np.ndarray, "4 dim"]:
        """Coordinates of matrices of norm one."""
        return self.vectors(1.0)

    @functools.cached_property
    def y(self) -> Float[np.ndarray, "4 dim"]:
        """Others."""
        return self.vectors(1.0, which=1)

    @functools.cached_property
    def g(self) -> Float[np.ndarray, "4 N N"]:
        """Elements, the exponentials of x."""
        return self.element(self.x)

    @functools.cached_property
    def turning(self) -> tuple[Float[np.ndarray, "4 dim"], Float[np.ndarray, "4"]]:
        """Coordinates, among many of norm one those that turn most, and the angles through which they turn."""
        x = self._many / np.linalg.norm(self.matrix(self._many), 2, axis=(1, 2))[:, None]
        turn = np.abs(np.linalg.eigvals(self.matrix(x)).imag).max(axis=-1)
        most = np.argsort(turn)[-_COUNT:]
        return x[most], turn[most]

    @functools.cached_property
    def elements(self) -> Float[np.ndarray, "4 N N"]:
        """Elements that the group draws."""
        return np.stack([self.group.random(self._rng) for _ in range(_COUNT)])

    def matrix(self, x: Float[np.ndarray, "... dim"]) -> Float[np.ndarray, "... N N"]:
        """Return the sum over the basis."""
        return np.tensordot(x, self.group.basis, axes=1)

    def coordinates(self, X: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "... dim"]:
        """Return the coefficients of the nearest matrix in the span of the basis."""
        columns = self.group.basis.reshape(self.group.dim, -1).T
        flat = X.reshape(-1, columns.shape[0])
        return np.linalg.lstsq(columns, flat.T, rcond=None)[0].T.reshape(*X.shape[:-2], -1)

    def element(self, x: Float[np.ndarray, "... dim"]) -> Float[np.ndarray, "... N N"]:
        """Return the exponential by SciPy."""
        return scipy.linalg.expm(self.matrix(x))

    def conjugate(self, g: np.ndarray, x: np.ndarray) -> Float[np.ndarray, "... dim"]:
        """Return the coordinates of g X g^-1."""
        return self.coordinates(g @ self.matrix(x) @ np.linalg.inv(g))

    def commutator(self, x: np.ndarray, y: np.ndarray) -> Float[np.ndarray, "... N N"]:
        """Return the commutator of matrices."""
        X, Y = self.matrix(x), self.matrix(y)
        return X @ Y - Y @ X
