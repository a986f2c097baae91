r"""Potentials that are linear in the entries of the pose, $U = \mathrm{tr}(A^Tg)$: weights, fields, magnets."""

import abc
import dataclasses
from typing import Any, ClassVar

import numpy as np

from nonholo.base.checks import array, error
from nonholo.base.types import Array, Float
from nonholo.groups import AbstractMatrixGroup


class AbstractLinear(abc.ABC):
    r"""A potential $U(g) = \mathrm{tr}(A^Tg)$ with a constant matrix A, homogeneous on SE(n)."""

    @abc.abstractmethod
    def matrix_for(self, group: AbstractMatrixGroup) -> Float[Array, "N N"]:
        """Return A for matrices of the group."""

    @abc.abstractmethod
    def check(self, group: AbstractMatrixGroup) -> None:
        """Refuse a group of another size."""

    def energy(self, group: AbstractMatrixGroup, configuration: Float[Array, "... N N"]) -> Float[Array, "..."]:
        """Return U at configurations."""
        return (self.matrix_for(group) * configuration).sum(axis=(-2, -1))

    def covector(self, group: AbstractMatrixGroup, configuration: Float[Array, "... N N"]) -> Float[Array, "... dim"]:
        """Return -dU along the body directions at configurations."""
        return pulled(group, self.matrix_for(group), configuration)

    def mean_covector(
        self, group: AbstractMatrixGroup, g: Float[Array, "... N N"], W: Float[Array, "... N N"]
    ) -> Float[Array, "... dim"]:
        r"""Return -G of steps W from poses, $\langle G, x\rangle = \mathrm{tr}(A^Tg(I + Y)x)$: what U loses, exactly."""
        return pulled(group, self.matrix_for(group), leaning(g, W))


@dataclasses.dataclass(frozen=True, eq=False)
class Linear(AbstractLinear):
    r"""The potential $U(g) = \mathrm{tr}(A^Tg) = \sum_{ij}A_{ij}g_{ij}$: a magnet, a field, weights at several points.

    Args:
        matrix: A, (N, N), as large as the matrices of the group: (n + 1, n + 1) on SE(n), whose last column acts on the
            position. A force F at the body point x is $A = -F x^T$, with x = (..., 1) and F = (..., 0) on SE(n).

    Raises:
        ValueError: No square matrix, a value that is not finite.

    Example:
        A magnet along the third body axis in a field along the first axis of space:

        >>> magnet = nh.Linear([[0.0, 0.0, -1.5], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
        >>> needle = nh.Forced(nh.SuslovTop(np.diag([1.0, 1.2, 0.6])), magnet)
        >>> orbit = nh.simulate(nh.discretize(needle, 0.1), body_velocity=(0.2, 0.1, 0.0), steps=1000)
        >>> float(np.ptp(orbit.energy)) < 1e-13
        True
    """

    matrix: Array
    leaves: ClassVar[tuple[str, ...]] = ("matrix",)
    structure: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        rows = array("Linear(matrix=...)", self.matrix, (None, None), "Pass A, as large as the matrices of the group.")
        object.__setattr__(self, "matrix", rows)

    def check(self, group: AbstractMatrixGroup) -> None:
        """Refuse a group of another size."""
        if self.matrix.shape != (group.size, group.size):
            remedy = f"Pass a matrix {(group.size, group.size)}."
            got = f"shape {self.matrix.shape}"
            raise error("Forced(potential=Linear(...))", f"be as large as matrices of {group}", got, remedy)

    def matrix_for(self, group: AbstractMatrixGroup) -> Float[Array, "N N"]:
        """Return A."""
        del group
        return self.matrix


def pulled(group: AbstractMatrixGroup, A: Array, g: Float[Array, "... N N"]) -> Float[Array, "... dim"]:
    r"""Return the covectors $-\mathrm{tr}(A^Tg\,x)$ of body directions x at matrices g."""
    xp: Any = g.__array_namespace__()
    return -xp.einsum("...ab,...ac,dcb->...d", xp.asarray(A), g, xp.asarray(group.basis))


def leaning(g: Float[Array, "... N N"], W: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
    r"""Return $g(I + Y) = 2 g W(I + W)^{-1}$ with the Cayley matrix Y of displacements."""
    xp: Any = W.__array_namespace__()
    one = xp.eye(W.shape[-1])
    return g @ xp.linalg.solve(one + W, 2 * W)


def homogeneous(group: AbstractMatrixGroup, vector: Array, last: float) -> Array:
    """Return a vector as matrices of the group take it: on motions with one more number, 1 of points, 0 of forces."""
    if not group.is_affine:
        return vector
    rows = np.eye(len(vector) + 1)
    return vector @ rows[:-1] + last * rows[-1]


def check_point(where: str, group: AbstractMatrixGroup, point: Array) -> None:
    """Refuse a group whose matrices move points of another dimension."""
    n = group.size - group.is_affine
    if point.shape != (n,):
        remedy = f"Pass points and forces with {n} numbers each, or a function of the configuration."
        raise error(where, f"have points of {group}", f"{len(point)} numbers", remedy)
