r"""The parts of the equations of a step, all of a discretization that they and the routes see; momenta; compositions.

The discrete Legendre transformation is $W \mapsto P(W)$, with $\mathrm{Ad}^*_W P(W)$ on the right. For the matrix
difference both are closed forms in $X = W - I$, free of cancellation, for the logarithmic one in log W; for every other
discrete Lagrangian they are derivatives taken by JAX.

Steps of order 4, 6 and 8 are symmetric compositions of the step of order 2 (docs/theory/compositions.md). A substep of
length $\gamma h$ takes the restricted momentum r to what the step of order 2 with time step $\gamma h$, of either sign,
makes of it; its displacement is the principal one over r. Orbits keep the momentum and the chart of the first substep
of each step.
"""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from nonholo.base.checks import choice, error
from nonholo.base.numerics import applied
from nonholo.base.types import Array, Float, Inexact, read_only
from nonholo.discrete._variety import Constraint, Variety, definition, variety_of
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import System

Difference = str | Callable[[Array], Array]


@dataclasses.dataclass(frozen=True, eq=False)
class Scheme:
    """A system, a time step, a discrete Lagrangian and a displacement variety.

    A class, not a protocol: to try whether an object obeys one would ask it for its variety, whose matrices
    fill the memory for wide bodies.

    Attributes:
        system: The system.
        time_step: The time step h.
        difference: The discrete Lagrangian: "matrix", "logarithmic" or a callable.
        constraint: The name of the variety, or its functions.
        order: 2, or that of a composition.
    """

    system: System
    time_step: Array
    difference: Difference = "matrix"
    constraint: Constraint = "skew"
    order: int = 2
    leaves: ClassVar[tuple[str, ...]] = ("system", "time_step")
    structure: ClassVar[tuple[str, ...]] = ("difference", "constraint", "order")

    @functools.cached_property
    def variety(self) -> Variety:
        """The displacement variety in the canonical frame."""
        return variety_of(self.system, self.constraint)

    def part(self, share: Array) -> Any:
        """Return the step of order 2 whose length is a share of that of a step."""
        return dataclasses.replace(self, time_step=share * self.time_step, order=2)

    @functools.cached_property
    def first_part(self) -> Any:
        """The first step of order 2 of a composition; the scheme itself, if it is one."""
        return self if self.order == 2 else self.part(float(weights(self.order)[0]))


def legendre(discrete: Scheme, increment: Inexact[Array, "... N N"], side: str) -> Inexact[Array, "... dim"]:
    """Return the momenta of displacements given as W - I."""
    group = discrete.system.group
    if discrete.difference == "matrix":
        tensor = discrete.system.homogeneous_mass_tensor
        return matrix_legendre(group, tensor, increment, side) / discrete.time_step
    if isinstance(discrete.difference, str):
        return logarithmic_legendre(discrete, increment + group.identity, side)
    by_derivative = definition("discretize(difference=...)").momenta_by_derivative
    return by_derivative(discrete.difference, group, increment + group.identity, side)


def logarithmic_legendre(discrete: Scheme, W: Float[Array, "... N N"], side: str) -> Float[Array, "... dim"]:
    r"""Return $(\mathrm{dexp}^{-1}_{\pm X})^*\,\mathbb{I}\,X/h$, $X = \log W$: plus on the left, minus on the right."""
    group = discrete.system.group
    x = group.log(W)
    xp = x.__array_namespace__()
    transport = group.dexp_inverse(x if side == "left" else -x)
    p = applied(xp.asarray(discrete.system.inertia_operator), x) / discrete.time_step
    return (p[..., None, :] @ transport)[..., 0, :]


def matrix_legendre(
    group: AbstractMatrixGroup, tensor: Inexact[Array, "N N"], X: Inexact[Array, "... N N"], side: str
) -> Inexact[Array, "... dim"]:
    r"""Return $\mathrm{tr}(E_i W\mathbb{J}X^*)$ (left) or $\mathrm{tr}(W E_i\mathbb{J}X^*)$ (right), $W = I + X$."""
    xp = X.__array_namespace__()
    arm = xp.asarray(tensor, dtype=X.dtype) @ group.form_adjoint(X)
    product = arm + X @ arm if side == "left" else arm + arm @ X
    return group.coordinates.dual_vector(xp.swapaxes(product, -1, -2))


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
    order = choice(where, order, (2, *WEIGHTS))
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
