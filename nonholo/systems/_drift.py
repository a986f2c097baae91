r"""The quadratic terms of the reduced equations: what drives the momentum along a direction of the algebra.

On an LL system $\dot p_x = \langle\mathbb{I}\omega, [\omega, x]\rangle$ for the momentum along $x \in \mathfrak{d}$.
Where this form vanishes a momentum is conserved; where it vanishes for every x velocities are constant.
"""

import numpy as np

from nonholo._checks import error
from nonholo._types import Float
from nonholo.systems._base import AbstractLLSystem, Equilibria

_ROUNDING = 1e-12  # of the largest term before it cancels


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


def constant_velocities(system: AbstractLLSystem, owner: str) -> Equilibria:
    """Return every admissible velocity as an equilibrium if all of them stay constant; refuse otherwise."""
    rows, inertia = system.constraint_subspace, np.asarray(system.inertia_operator)
    brackets = system.group.bracket(rows[:, None, :], rows[None, :, :])
    form = gyroscopic_form(inertia, brackets, rows)
    scale = np.max(np.abs(rows @ inertia) @ np.abs(rows).T, initial=0.0) * np.max(np.abs(rows), initial=0.0)
    if np.max(np.abs(form), initial=0.0) > _ROUNDING * scale:
        requirement = "have equilibria that form a linear space"
        got = f"a drift of {np.abs(form).max():.3g} along the constraint subspace"
        remedy = "Those of a general system solve quadratic equations, and are not computed by this version."
        raise error(f"{owner}.equilibria()", requirement, got, remedy)
    return Equilibria(rows, None)
