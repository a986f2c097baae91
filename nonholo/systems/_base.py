r"""The interface of a left-invariant nonholonomic system, and what follows from it.

The kinetic energy is $\tfrac12\langle\omega, \mathbb{I}\omega\rangle$, body velocities lie in a subspace
$\mathfrak{d}$. Time steps and solvers live elsewhere.
"""

import abc
import dataclasses

import numpy as np

from nonholo._checks import as_floats
from nonholo._types import Array, Float
from nonholo.groups import AbstractMatrixGroup


@dataclasses.dataclass(frozen=True)
class Equilibria:
    """The body velocities that stay constant: a linear space, and the half of it that attracts.

    Attributes:
        subspace: Rows span the equilibria, shape (m, dim).
        attracting: A body velocity whose positive multiples attract within their energy level and whose negative
            multiples repel; None when no equilibrium attracts.
    """

    subspace: Float[np.ndarray, "m dim"]
    attracting: Float[np.ndarray, "dim"] | None


class AbstractLLSystem(abc.ABC):
    """A left-invariant Lagrangian with a left-invariant constraint on a matrix group.

    A system states its group, mass tensor, constraint subspace and annihilator in the user's body frame. Kernels work
    in its canonical body frame: `canonical` is the same body seen from `frame`, that is g_canonical = g @ frame.
    """

    group: AbstractMatrixGroup

    @property
    @abc.abstractmethod
    def homogeneous_mass_tensor(self) -> Float[Array, "N N"]:
        """The mass tensor on which the group's matrices act."""

    @property
    @abc.abstractmethod
    def constraint_subspace(self) -> Float[np.ndarray, "k dim"]:
        """Rows span the admissible body velocities."""

    @property
    @abc.abstractmethod
    def annihilator(self) -> Float[np.ndarray, "s dim"]:
        """Rows span the covectors that vanish on admissible body velocities; multipliers refer to them."""

    @property
    @abc.abstractmethod
    def canonical(self) -> "AbstractLLSystem":
        """The same body in the canonical frame."""

    @property
    @abc.abstractmethod
    def frame(self) -> Float[np.ndarray, "N N"]:
        """The canonical body frame as seen from the user's: a group element that maps the constraint to itself."""

    @abc.abstractmethod
    def equilibria(self) -> Equilibria:
        """Return the constant body velocities and the attracting half."""

    @property
    @abc.abstractmethod
    def inertia_operator(self) -> Float[Array, "dim dim"]:
        """The symmetric matrix that takes body velocity to body momentum."""

    @property
    def constrained_inertia(self) -> Float[Array, "k k"]:
        r"""The inertia operator restricted to the constraint subspace, in its rows."""
        rows = self.constraint_subspace
        return rows @ self.inertia_operator @ rows.T

    @property
    def frame_map(self) -> Float[Array, "k k"]:
        """C with r_canonical = C r for momenta along the constraint subspace (and y = y_canonical C for charts)."""
        images = self.canonical.constraint_subspace @ self.group.adjoint(self.frame).T
        return images @ np.linalg.pinv(self.constraint_subspace)

    def restrict(self, momentum: Float[Array, "... dim"]) -> Float[Array, "... k"]:
        """Return the components of a momentum along the rows of the constraint subspace."""
        return as_floats(momentum) @ self.constraint_subspace.T

    def constrained_energy(self, momentum: Float[Array, "... dim"] | Float[Array, "... k"]) -> Float[Array, "..."]:
        r"""Return the reduced constrained energy $\tfrac12\,r\cdot(\mathbb{I}|_\mathfrak{d})^{-1}\,r$ of a momentum.

        Here $r = p|_\mathfrak{d}$ are its components along the constraint subspace.

        Args:
            momentum: A momentum, or its components along the rows of the constraint subspace.

        Example:
            >>> ChaplyginSleigh(mass=2.0, inertia=1.0, a=0.5).constrained_energy([0.0, 2.0, 0.0])
            np.float64(1.0)
        """
        momentum = as_floats(momentum)
        restricted = momentum if momentum.shape[-1] == self.constraint_subspace.shape[0] else self.restrict(momentum)
        return (restricted * self.restricted_velocity(restricted)).sum(axis=-1) / 2

    def restricted_velocity(self, restricted_momentum: Float[Array, "... k"]) -> Float[Array, "... k"]:
        """Return the velocity, in rows of the constraint subspace, that has these momenta along it."""
        restricted_momentum = as_floats(restricted_momentum)
        xp = restricted_momentum.__array_namespace__()
        return xp.linalg.solve(xp.asarray(self.constrained_inertia), restricted_momentum[..., None])[..., 0]
