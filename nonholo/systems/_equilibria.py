r"""Body velocities that stay constant: of tops and sleighs by their normal form, of others by the reduced equations.

The reduced equations of a left-invariant system, as a quadratic vector field, and where it vanishes.

In rows $d_1, \dots, d_k$ of the constraint subspace, with $\omega = \sum x_ad_a$,

$$ \dot r_m = \sum_b x_b\,\Omega_{bm}(x), \qquad \Omega_{bm}(x) = \langle\mathbb{I}\omega, [d_b, d_m]\rangle
   = -\Omega_{mb}(x). $$

A skew matrix of order 2 is one number, $\Omega_{12} = \ell(x)$; one of order 3 is a vector, $\Omega_{23} = (Mx)_1$ and
so on, with which $\dot r = (Mx)\times x$. So equilibria of two directions are the line $\ell(x) = 0$, those of three
the real eigenspaces of M. Theory: docs/theory/groups-and-systems.md.
"""

import dataclasses
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from nonholo.base.checks import array, error
from nonholo.base.numerics import real_eigenspaces
from nonholo.base.results import result
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
    rows = system.constraint_subspace
    units = np.sqrt(np.einsum("ad,de,ae->a", np.abs(rows), np.abs(inertia), np.abs(rows)))  # rows may mix lengths
    values, axes = np.linalg.eigh(np.asarray(system.constrained_inertia) / units / units[:, None])
    axes[:, -1:] *= np.sign(np.linalg.det(axes))  # oriented as the rows of the system
    rows, signs = (axes / np.sqrt(np.abs(values))).T @ (rows / units[:, None]), np.sign(values)

    tensor = np.einsum("ad,bmd->abm", rows @ inertia, group.bracket(rows[:, None, :], rows[None, :, :]))
    momenta = np.abs(group.coordinates.dual_matrix(np.abs(rows) @ np.abs(inertia)))
    velocities = np.abs(group.hat(rows))
    products = velocities[:, None] @ velocities[None, :]
    terms = np.einsum("aij,bmij->abm", momenta, products + products.swapaxes(0, 1))
    return QuadraticField(rows, signs, tensor, _ROUNDING * float(terms.max(initial=0.0)))


@result
class Equilibria:
    """The body velocities that stay constant: a linear space, and the half of it that attracts.

    Equilibria of a system that is neither a top nor a sleigh may be several linear spaces, such as the axes of a free
    body.

    Attributes:
        subspace: Rows span the equilibria, shape (m, dim).
        attracting: A body velocity whose positive multiples attract within their energy level and whose negative
            multiples repel; None when no equilibrium attracts.
        others: The other linear spaces of equilibria, each with the half of it that attracts; attracting ones first.
    """

    subspace: Float[np.ndarray, "m dim"]
    attracting: Float[np.ndarray, "dim"] | None
    others: tuple["Equilibria", ...] = ()


def equilibria_of(system: "AbstractLLSystem") -> Equilibria:
    """Return the constant body velocities of a system, and the attracting half."""
    form = system.normal_form
    if form is None:
        return _of_field(system, quadratic_field(system))
    rows = system.form_map @ system.constraint_subspace
    if form.arm != 0:  # 0 of tops
        return Equilibria(rows[-1:], np.copysign(1.0, form.arm) * rows[-1])
    if not form.is_coupled:
        return Equilibria(system.constraint_subspace, None)
    line = form.coupling @ rows[: len(form.coupling)]
    if not form.is_sleigh:
        return Equilibria(line[None, :], -line)
    turn = (form.offset @ form.coupling) * rows[-1] - line  # u = 0: the center of mass does not advance
    return Equilibria(np.stack([turn, rows[-1]]), turn)


def _of_field(system: "AbstractLLSystem", field: QuadraticField) -> Equilibria:
    zeros = field.zeros()
    if zeros is None:
        got = f"{system.rank}, in which velocities change"
        remedy = "Look for one near a velocity: nh.equilibria(system, body_velocity=...)."
        where = f"{type(system).__name__}.equilibria()"
        raise error(where, "have a constraint with at most three admissible directions", got, remedy)
    if len(zeros[0]) == system.rank:
        return Equilibria(system.constraint_subspace, None)
    first, *others = sorted((_space(field, rows) for rows in zeros), key=lambda space: space.attracting is None)
    return dataclasses.replace(first, others=tuple(others))


def _space(field: QuadraticField, zeros: Float[np.ndarray, "m k"]) -> Equilibria:
    """Return one linear space of equilibria; what does not attract is signed by its largest entry."""
    attracting = field.attracting(zeros)
    rows = zeros @ field.rows
    signs = np.sign(np.take_along_axis(rows, np.abs(rows).argmax(axis=1, keepdims=True), axis=1))
    return Equilibria(signs * rows + 0.0, None if attracting is None else attracting @ field.rows)


def transverse_rates(system: "AbstractLLSystem", velocity: Any, subspace: Any) -> np.ndarray:
    """Return the eigenvalues of the linearized reduced equations across a linear space of equilibria."""
    where, dim = f"{type(system).__name__}.transverse_rates", system.group.dim
    x = array(f"{where}(velocity=...)", velocity, (dim,), "Pass an equilibrium.")
    rows = array(f"{where}(subspace=...)", subspace, (None, dim), "Pass rows that span equilibria.")
    field, inertia = quadratic_field(system), np.asarray(system.inertia_operator)
    return field.rates(field.coordinates(x, inertia), field.coordinates(rows, inertia))


def gyroscopic_form(
    inertia: Float[np.ndarray, "dim dim"], brackets: Float[np.ndarray, "k m dim"], rows: Float[np.ndarray, "k dim"]
) -> Float[np.ndarray, "k k m"]:
    r"""Return the forms $\langle\mathbb{I}\omega, [\omega, x_m]\rangle$ as symmetric matrices in the rows of $\omega$.

    Args:
        inertia: $\mathbb{I}$.
        brackets: $[d_b, x_m]$ for the rows $d_b$ and any directions $x_m$.
        rows: $d_a$.
    """
    form = np.einsum("ad,bmd->abm", rows @ inertia, brackets)
    return (form + form.transpose(1, 0, 2)) / 2
