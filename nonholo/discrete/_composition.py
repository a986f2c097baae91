r"""Steps of order 4, 6 and 8: symmetric compositions of the step of order 2 (docs/theory/compositions.md).

A substep of length $\gamma h$ takes the restricted momentum r to what the step of order 2 with time step $\gamma h$,
of either sign, makes of it; its displacement is the principal one over r. Orbits keep the momentum and the chart of the
first substep of each step.
"""

import functools
from typing import Any

import numpy as np

from nonholo.base.checks import choice, error
from nonholo.base.types import Float, read_only
from nonholo.discrete._scheme import Scheme

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
    return read_only(np.concatenate([half, [1 - 2 * half.sum()], half[::-1]]))


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


def refuse_composition(where: str, discrete: Scheme, remedy: str) -> None:
    """Refuse a discretization of an order above 2."""
    if discrete.order > 2:
        got = f"order {discrete.order}, a composition of {len(weights(discrete.order))} steps"
        raise error(where, "have a discretization of order 2", got, remedy)
