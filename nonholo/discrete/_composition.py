r"""Steps of order 4, 6 and 8: symmetric compositions of the step of order 2 (docs/theory/compositions.md).

A substep of length $\gamma h$ takes the restricted momentum r to what the step of order 2 with time step $\gamma h$,
of either sign, makes of it; its displacement is the principal one over r. Orbits keep the momentum and the chart of the
first substep of each step.
"""

import dataclasses
import functools
from typing import TYPE_CHECKING, Any

import numpy as np

from nonholo import kernels
from nonholo._checks import choice, error
from nonholo._results import Outcome
from nonholo._types import Float
from nonholo.discrete._structured import Structured, decoded, decoded_poses, encoded, encoded_poses, structured
from nonholo.orbit import Orbit
from nonholo.systems import AbstractLRSystem

if TYPE_CHECKING:
    from nonholo.discrete._discretization import Discretization

WEIGHTS = {
    4: ("0.414490771794375737142354062860761495711775", "0.414490771794375737142354062860761495711775"),
    6: (
        "0.39216144400731413927925056",
        "0.332599136789359438599748634257274355737334",
        "-0.706246172557639359809964819634910351039340",
        "0.0822135962935508002314904488531569176963106",
    ),
    8: (
        "0.741670364350612953448227801783806315603537",
        "-0.409100825800031593997300095893563417309918",
        "0.190754710296238379953876256450371662735461",
        "-0.573862471116082266656387726635535742159509",
        "0.299064181303655923844463540688602988225823",
        "0.334624918245298183784957979882182288633692",
        "0.315293092396766596632056663811002430994081",
    ),
}
r"""First half of the $\gamma_i$ by order; the second is its mirror image and the middle one makes their sum 1."""


@functools.cache
def weights(order: int) -> Float[np.ndarray, "S"]:
    r"""Return the fractions $\gamma_i$ of the time step, one for order 2.

    Example:
        >>> weights(4).round(3).tolist()
        [0.414, 0.414, -0.658, 0.414, 0.414]
    """
    half = np.array([float(text) for text in WEIGHTS.get(order, ())])
    found = np.concatenate([half, [1 - 2 * half.sum()], half[::-1]])
    found.flags.writeable = False
    return found


def checked_order(order: Any, difference: object, constraint: object) -> int:
    """Refuse an order that is not offered, or not for this difference and constraint."""
    where = "discretize(order=...)"
    choice(where, order, (2, *WEIGHTS))
    if order == 2:
        return order
    if callable(difference):
        got = "a callable L_d(W), which has one time step built in"
        raise error(where, "be 2", f"{order} with {got}", "Pass difference='matrix' or 'logarithmic'.")
    if constraint not in ("skew", "exponential"):
        got = f"{order} with a constraint that may not hold for W^-1 where it holds for W"
        raise error(where, "be 2", got, "Pass constraint='skew' or 'exponential'.")
    return order


def refuse_composition(where: str, discrete: "Discretization", remedy: str) -> None:
    """Refuse a discretisation of an order above 2."""
    if discrete.order > 2:
        got = f"order {discrete.order}, a composition of {len(weights(discrete.order))} steps"
        raise error(where, "have a discretisation of order 2", got, remedy)


def first_substep(discrete: "Discretization") -> "Discretization":
    """Return the discretisation of order 2 of the first substep; that of order 2 itself."""
    if discrete.order == 2:
        return discrete
    return dataclasses.replace(discrete, time_step=weights(discrete.order)[0] * discrete.time_step, order=2)


def compiled_step(discrete: "Discretization") -> Structured | None:
    """Return the compiled step of a discretisation of any order, or None if only its definition can be run."""
    closed = structured(discrete)
    if closed is None or discrete.order == 2:
        return closed
    return closed._replace(body=_composed(closed, discrete))


def _composed(closed: Structured, discrete: "Discretization") -> kernels.ComposedBody:
    return kernels.ComposedBody(closed.body, weights(discrete.order).copy())


def whole_displacements(discrete: "Discretization", states: Orbit) -> Float[np.ndarray, "K N N"]:
    """Return the displacements of whole steps from states, in the user's frame; spatial ones of LR systems."""
    group, moves = discrete.system.group, isinstance(discrete.system, AbstractLRSystem)
    g = states.configuration if moves else np.broadcast_to(group.identity, (len(states), group.size, group.size))
    after = whole_steps(discrete, states.reduced_momentum, g)[1]
    return after @ group.inverse(g) if moves else after


def whole_steps(
    discrete: "Discretization", momenta: Float[np.ndarray, "K k"], g: Float[np.ndarray, "K N N"]
) -> tuple[Float[np.ndarray, "K k"], Float[np.ndarray, "K N N"], np.ndarray]:
    """Take one step from each row of canonical momenta and poses; return both after it, and the outcomes.

    Rows that cannot go on are NaN.
    """
    closed, group, frame = structured(discrete), discrete.system.group, discrete.system.frame
    if closed is None:
        from nonholo.discrete._composition_definition import whole_steps_by_definition

        return whole_steps_by_definition(discrete, momenta, g)
    poses = encoded_poses(closed, group, group.pose_from_matrix(g @ frame))
    after, moved, codes = kernels.whole_steps(_composed(closed, discrete), encoded(closed, momenta), poses)
    after, moved = (np.where((codes == Outcome.successful)[:, None], rows, np.nan) for rows in (after, moved))
    ahead = group.matrix_from_pose(decoded_poses(closed, group, moved)) @ group.inverse(frame)
    return decoded(closed, after), ahead, codes


def composed_reversal_defects(discrete: "Discretization", states: Orbit) -> Float[np.ndarray, "K"]:
    """Return, for each state, how far one step forward and one back (from the opposite momentum) miss it, relatively.

    Infinite where the step back cannot be taken, NaN where the step forward cannot.
    """
    r, group = states.reduced_momentum, discrete.system.group
    moves = isinstance(discrete.system, AbstractLRSystem)
    g = states.configuration if moves else np.broadcast_to(group.identity, (len(r), group.size, group.size))
    after, there, ahead = whole_steps(discrete, r, g)
    good = ahead == Outcome.successful
    back, _, behind = whole_steps(discrete, -after[good], there[good])
    missed = np.full(len(r), np.nan)
    far = np.abs(back + r[good]).max(axis=1, initial=0.0) / np.abs(r[good]).max(axis=1, initial=0.0)
    missed[good] = np.where(behind == Outcome.successful, far, np.inf)
    return missed
