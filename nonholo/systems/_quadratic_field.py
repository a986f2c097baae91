r"""The reduced equations of a left-invariant system, as a quadratic vector field, and where it vanishes.

In rows $d_1, \dots, d_k$ of the constraint subspace, with $\omega = \sum x_ad_a$,

$$ \dot r_m = \sum_b x_b\,\Omega_{bm}(x), \qquad \Omega_{bm}(x) = \langle\mathbb{I}\omega, [d_b, d_m]\rangle
   = -\Omega_{mb}(x). $$

A skew matrix of order 2 is one number, $\Omega_{12} = \ell(x)$; one of order 3 is a vector, $\Omega_{23} = (Mx)_1$ and
so on, with which $\dot r = (Mx)\times x$. So equilibria of two directions are the line $\ell(x) = 0$, those of three
the real eigenspaces of M. Theory: docs/theory/groups-and-systems.md.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nonholo.base.numerics import real_eigenspaces
from nonholo.base.types import Float

if TYPE_CHECKING:
    from nonholo.systems._base import AbstractLLSystem

_ROUNDING = 1e-12  # of the terms of a sum


class QuadraticField(NamedTuple):
    r"""The reduced equations $s_m\dot x_m = \sum x_ax_b\Omega_{abm}$ in rows that are orthonormal for the energy.

    Attributes:
        rows: Along the constraint subspace; there the inertia is the diagonal matrix of the signs.
        signs: s, 1 where the kinetic energy is positive; -1 occurs on groups with a form.
        tensor: $\Omega_{abm}$.
        rounding: Entries of the tensor below it are zero.
    """

    rows: Float[np.ndarray, "k dim"]
    signs: Float[np.ndarray, "k"]
    tensor: Float[np.ndarray, "k k k"]
    rounding: float

    def zeros(self) -> tuple[Float[np.ndarray, "_ k"], ...] | None:
        """Return orthonormal rows of each linear space on which the field vanishes.

        Together they are all of its zeros; None where it has four directions and more and does not vanish everywhere.
        """
        k = len(self.rows)
        if np.abs(self.tensor + self.tensor.transpose(1, 0, 2)).max(initial=0.0) <= self.rounding:
            return (np.eye(k),)
        if k == 2:
            first, second = self.tensor[:, 0, 1]
            return (np.array([[-second, first]]) / np.hypot(first, second),)
        if k == 3:
            matrix = np.stack([self.tensor[:, 1, 2], self.tensor[:, 2, 0], self.tensor[:, 0, 1]])
            return real_eigenspaces(matrix, self.rounding)
        return None

    def rates(self, x: Float[np.ndarray, "k"], zeros: Float[np.ndarray, "m k"]) -> np.ndarray:
        """Return the eigenvalues of the linearized field at a zero, across the linear space of zeros it lies in.

        Real if all are: newer NumPy returns complex ones always.
        """
        linear = self.signs[:, None] * np.einsum("abm,b->ma", self.tensor + self.tensor.transpose(1, 0, 2), x)
        across = np.linalg.svd(zeros)[2][np.linalg.matrix_rank(zeros) :]
        values = np.sort(np.linalg.eigvals(across @ linear @ across.T))
        return values if np.imag(values).any() else np.real(values)

    def attracting(self, zeros: Float[np.ndarray, "m k"]) -> Float[np.ndarray, "k"] | None:
        """Return the point of a linear space of zeros, of unit length, where the field contracts most; None if none.

        The sum of the rates is a linear function of the point.
        """
        contraction = -np.array([np.real(self.rates(x, zeros).sum()) for x in zeros])
        if not np.linalg.norm(contraction) > self.rounding:
            return None
        x = contraction @ zeros / np.linalg.norm(contraction)
        return x if np.all(np.real(self.rates(x, zeros)) < -self.rounding) else None

    def coordinates(self, velocity: Float[np.ndarray, "... dim"], inertia: np.ndarray) -> Float[np.ndarray, "... k"]:
        """Return the coordinates of admissible velocities in the rows."""
        return velocity @ inertia @ self.rows.T * self.signs


def quadratic_field(system: "AbstractLLSystem") -> QuadraticField:
    """Return the reduced equations of a system."""
    inertia, group = np.asarray(system.inertia_operator), system.group
    rows, signs = _orthonormal(system, inertia)
    tensor = np.einsum("ad,bmd->abm", rows @ inertia, group.bracket(rows[:, None, :], rows[None, :, :]))
    momenta = np.abs(group.coordinates.dual_matrix(np.abs(rows) @ np.abs(inertia)))
    velocities = np.abs(group.hat(rows))
    products = velocities[:, None] @ velocities[None, :]
    terms = np.einsum("aij,bmij->abm", momenta, products + products.swapaxes(0, 1))
    return QuadraticField(rows, signs, tensor, _ROUNDING * float(terms.max(initial=0.0)))


def _orthonormal(system: "AbstractLLSystem", inertia: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return rows that are orthonormal for the energy, oriented as the system's, and the signs of their energy."""
    rows = system.constraint_subspace
    units = np.sqrt(np.einsum("ad,de,ae->a", np.abs(rows), np.abs(inertia), np.abs(rows)))  # rows may mix lengths
    values, axes = np.linalg.eigh(np.asarray(system.constrained_inertia) / units / units[:, None])
    axes[:, -1:] *= np.sign(np.linalg.det(axes))
    return (axes / np.sqrt(np.abs(values))).T @ (rows / units[:, None]), np.sign(values)
