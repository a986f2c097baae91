"""`discretize`: the choice of the discrete Lagrangian and the variety, checked."""

from collections.abc import Callable
from typing import Any, overload

import numpy as np

from nonholo.base.checks import choice, error, needs, scale
from nonholo.base.types import Array
from nonholo.discrete._composition import checked_order
from nonholo.discrete._discretization import Discretization
from nonholo.discrete._scheme import Difference
from nonholo.discrete._variety import Constraint, checked_constraint
from nonholo.systems import (
    AbstractCoordinateSystem,
    AbstractSystem,
    DiscretizationT,
    System,
    as_system,
    refuse_in_coordinates,
)


@overload
def discretize(
    system: System,
    time_step: Array,
    difference: Difference | None = None,
    constraint: Constraint | Callable[[Array], Array] | None = None,
    order: int = 2,
) -> Discretization: ...
@overload
def discretize(system: AbstractCoordinateSystem[DiscretizationT, Any], time_step: Array) -> DiscretizationT: ...
def discretize(
    system: System | AbstractCoordinateSystem,
    time_step: Array,
    difference: Difference | None = None,
    constraint: Constraint | Callable[[Array], Array] | None = None,
    order: int = 2,
) -> Any:
    r"""Discretize a system: choose the discrete Lagrangian and the variety that displacements lie on.

    $$ l_d(W) = h\, l\bigl((W - I)/h\bigr) \ \text{(matrix)}, \qquad l_d(W) = h\, l(\log W/h)\ \text{(logarithmic)}, $$

    with $h$ the time step and, for matrices, $l(X) = \tfrac12\mathrm{tr}(X\,\mathbb{J}\,X^*)$. With "matrix" and "skew"
    the step of a left-invariant system conserves the reduced constrained energy exactly, whatever the constraint
    subspace; with any other choice it does not (`Discretization.conserves_energy` tells).

    Reference: [fedorov-zenkov-2004], section 3; docs/theory/energy-theorem.md.

    A `LagrangeDAlembert` has its own rule, and takes no other argument than the time step.

    Args:
        system: What moves.
        time_step: h > 0.
        difference: "matrix", "logarithmic" or a callable $L_d(W)$ of a JAX matrix that includes the factor h. By
            default "matrix" where it is defined, for a mass tensor, and "logarithmic" elsewhere.
        constraint: "skew", (W - W^-1)/2 in d on the irreducible analytic component through the identity;
            "exponential", exp d; "naive", W - I projected to the algebra, in d; or functions f_j(W) of a JAX matrix,
            zero on the variety. By default "skew" where it is defined, on SO(n), SE(n) and groups with a form, and
            "exponential" elsewhere.
        order: 2, or 4, 6, 8: a symmetric composition of 5, 9, 15 steps of order 2 with time steps of either sign. It
            needs difference "matrix" or "logarithmic" and constraint "skew" or "exponential". See
            docs/theory/compositions.md for what momenta and displacements of its orbits are.

    Returns:
        The discretization; of a system in coordinates a `nonholo.lagrange_dalembert.CoordinateDiscretization`.

    Raises:
        ValueError: A time step that is not positive and real, an unknown choice, a difference or a constraint that is
            not defined for the system, functions that do not fit d at the identity,
            an order that cannot be had.

    Example:
        >>> discretize(ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), time_step=0.1).difference
        'matrix'
    """
    if isinstance(system, AbstractCoordinateSystem):
        refuse_in_coordinates(
            "discretize", difference=(difference, None), constraint=(constraint, None), order=(order, 2)
        )
        return system.discretize(time_step)
    as_system("discretize(system=...)", system)
    step = scale("discretize(time_step=...)", time_step, "Pass a positive real time step.")
    chosen = _difference(system, difference)
    variety = _constraint(system, constraint)
    made = Discretization(system, step, chosen, variety, checked_order(order, chosen, variety))
    if made.forces is not None:
        _ = made.route  # refused here where there is none
    return made


def _difference(system: AbstractSystem, difference: Difference | None) -> Difference:
    where, defined = "discretize(difference=...)", system.is_wide or system.homogeneous_mass_tensor is not None
    if difference is None:
        return "matrix" if defined else "logarithmic"
    if callable(difference):
        return _scalar(where, system, difference)
    choice(where, difference, ("matrix", "logarithmic"), "Or pass a callable L_d(W).")
    if difference == "matrix" and not defined:
        got = "a kinetic energy given by an inertia operator, which says nothing of W - I outside the algebra"
        remedy = "Pass 'logarithmic', or build the system of a mass tensor, on SO(n), SE(n) or MatrixGroup(form=...)."
        raise error(where, "be defined for the system", got, remedy)
    return difference


def _scalar(where: str, system: AbstractSystem, difference: Callable[[Array], Array]) -> Callable[[Array], Array]:
    """Refuse a discrete Lagrangian that is not a finite number with finite derivatives at the identity."""
    with needs("jax", where):
        from nonholo.discrete.definition import value_and_slope

    try:
        value, slope = value_and_slope(difference, system.group)
    except Exception as failure:
        got = f"{type(failure).__name__}: {f'{failure}'.splitlines()[0]}"
        remedy = "Write L_d(W) with jax.numpy, returning one number."
        raise error(where, "be a real scalar function of a JAX matrix", got, remedy) from failure
    if not (np.isfinite(value) and np.all(np.isfinite(slope))):
        raise error(where, "be differentiable at the identity", f"value {value}, slope {slope}", "Avoid 0/0 there.")
    return difference


def _constraint(system: AbstractSystem, constraint: object) -> Constraint:
    defined = system.group.has_skew_part
    if constraint is None:
        return "skew" if defined else "exponential"
    where = "discretize(constraint=...)"
    checked = checked_constraint(where, system, constraint)
    if checked == "skew" and not defined:
        got = f"{system.group}, where (W - W^-1)/2 need not lie in the algebra"
        remedy = "Pass 'exponential' or, if the group preserves a form G, build it as MatrixGroup(basis, form=G)."
        raise error(where, "be defined on the group", got, remedy)
    return checked
