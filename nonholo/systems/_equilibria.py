"""Body velocities that stay constant: of tops and sleighs by their normal form, of other systems where all do."""

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from nonholo.base.checks import error
from nonholo.base.types import Float
from nonholo.systems._drift import gyroscopic_form
from nonholo.systems._normal_form import NormalForm

if TYPE_CHECKING:
    from nonholo.systems._base import AbstractLLSystem

_ROUNDING = 1e-12  # of the largest term before it cancels


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


def equilibria_of(system: "AbstractLLSystem") -> Equilibria:
    """Return the constant body velocities of a system, and the attracting half."""
    form = system.normal_form
    return _all_constant(system) if form is None else _of_form(system, form)


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


def _all_constant(system: "AbstractLLSystem") -> Equilibria:
    """Return every admissible velocity as an equilibrium if all of them stay constant; refuse otherwise."""
    rows, inertia = system.constraint_subspace, np.asarray(system.inertia_operator)
    brackets = system.group.bracket(rows[:, None, :], rows[None, :, :])
    form = gyroscopic_form(inertia, brackets, rows)
    scale = np.max(np.abs(rows @ inertia) @ np.abs(rows).T, initial=0.0) * np.max(np.abs(rows), initial=0.0)
    if np.max(np.abs(form), initial=0.0) > _ROUNDING * scale:
        requirement = "have equilibria that form a linear space"
        got = f"a drift of {np.abs(form).max():.3g} along the constraint subspace"
        remedy = "Those of a general system solve quadratic equations, and are not computed by this version."
        raise error(f"{type(system).__name__}.equilibria()", requirement, got, remedy)
    return Equilibria(rows, None)
