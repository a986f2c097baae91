"""Body velocities that stay constant: of tops and sleighs by their normal form, of others by the reduced equations."""

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np

from nonholo.base.checks import array, error
from nonholo.base.types import Float
from nonholo.systems._normal_form import NormalForm
from nonholo.systems._quadratic_field import QuadraticField, quadratic_field

if TYPE_CHECKING:
    from nonholo.systems._base import AbstractLLSystem


@dataclasses.dataclass(frozen=True)
class Equilibria:
    """The body velocities that stay constant: a linear space, and the half of it that attracts.

    Those of a system that is neither a top nor a sleigh may be several linear spaces, such as the axes of a free body.

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
    return _of_field(system, quadratic_field(system)) if form is None else _of_form(system, form)


def _of_form(system: "AbstractLLSystem", form: NormalForm) -> Equilibria:
    rows = system.form_map @ system.constraint_subspace
    if form.is_sleigh and form.arm != 0:
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
        remedy = "Equilibria of more are zeros of quadratic equations that this version does not solve."
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
