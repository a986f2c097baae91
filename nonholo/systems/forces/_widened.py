"""A system without some rows of its constraint, in the frame of the one with all of them."""

import dataclasses
import functools
from typing import ClassVar

import numpy as np

from nonholo.base.memo import system_memo
from nonholo.base.types import Array, Float
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems._base import AbstractLLSystem, AbstractSystem


@dataclasses.dataclass(frozen=True, eq=False)
class Widened(AbstractLLSystem):
    r"""A body whose velocity may leave $\mathfrak{d}$ along vectors V with $AV^T = I$ that are orthogonal to it.

    They are orthogonal in the kinetic energy. So momenta along $\mathfrak{d}$ are those of the system inside, and
    $\pi = Mv$ with the slip velocity v and $M = V\mathbb{I}V^T$ are the others.

    Attributes:
        system: The system with its whole constraint.
        rows: A, (s, dim), what may not vanish.
        remaining: The rows of its annihilator that never yield.
    """

    system: AbstractSystem
    rows: Float[np.ndarray, "s dim"]
    remaining: Float[np.ndarray, "j dim"]
    leaves: ClassVar[tuple[str, ...]] = ("system",)
    structure: ClassVar[tuple[str, ...]] = ("rows", "remaining")

    @property
    def group(self) -> AbstractMatrixGroup:  # type: ignore[override]
        """The group."""
        return self.system.group

    @property
    def homogeneous_mass_tensor(self) -> Float[Array, "... N N"] | None:
        """That of the system inside."""
        return self.system.homogeneous_mass_tensor

    @system_memo
    def inertia_operator(self) -> Float[Array, "dim dim"]:
        """That of the system inside."""
        return self.system.inertia_operator

    @system_memo
    def annihilator(self) -> Float[np.ndarray, "j dim"]:
        """The rows that never yield."""
        return self.remaining

    @system_memo
    def duals(self) -> Float[np.ndarray, "s dim"]:
        """V, the velocities of unit slips."""
        system, s = self.system, len(self.rows)
        S = np.asarray(system.constraint_subspace)
        equations = np.concatenate([S @ np.asarray(system.inertia_operator), self.remaining, self.rows])
        return np.linalg.solve(equations, np.eye(len(equations))[:, -s:]).T

    @system_memo
    def slip_inertia(self) -> Float[np.ndarray, "s s"]:
        """M, by which momenta of slips are their velocities."""
        inertia = self.duals @ np.asarray(self.inertia_operator) @ self.duals.T
        return (inertia + inertia.T) / 2

    @system_memo
    def constraint_subspace(self) -> Float[np.ndarray, "k dim"]:
        """The rows of the system inside, and V."""
        return np.concatenate([self.system.constraint_subspace, self.duals])

    @system_memo
    def inertia_along(self) -> Float[np.ndarray, "k k"]:
        """That of the system inside beside M: nothing couples them, not even a rounding error."""
        return beside(np.asarray(self.system.constrained_inertia), self.slip_inertia)

    @functools.cached_property
    def canonical(self) -> "Widened":  # type: ignore[override]
        """The same body in the canonical frame of the system inside."""
        if self.system.canonical is self.system:
            return self
        seen = self.group.adjoint(self.frame)
        return Widened(self.system.canonical, self.rows @ seen, self.remaining @ seen)

    @system_memo
    def frame(self) -> Float[Array, "N N"]:
        """That of the system inside."""
        return self.system.frame

    @system_memo
    def frame_map(self) -> Float[Array, "k k"]:
        """That of the system inside; the slip is the same in every frame."""
        return beside(np.asarray(self.system.frame_map), np.eye(len(self.rows)))


def beside(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return the block diagonal matrix of two."""
    k, s = len(first), len(second)
    return np.block([[first, np.zeros((k, s))], [np.zeros((s, k)), second]])
