r"""`discretize`: the choice of the discrete Lagrangian and the variety, checked; and whether the two fit.

Momenta of displacements and back, checked: `discrete_legendre`, and the free top by a matrix equation. One step of
Moser and Veselov is the solution of a Riccati equation.
"""

from collections.abc import Callable
from typing import Any, overload

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.checks import array, choice, error, function, scale, shape_of, symmetric
from nonholo.base.types import Array, Float
from nonholo.discrete._discretization import Discretization, as_discretization
from nonholo.discrete._scheme import (
    WEIGHTS,
    Constraint,
    Difference,
    at_identity,
    checked_constraint,
    definition,
    legendre,
)
from nonholo.groups import SO
from nonholo.systems import AbstractCoordinateSystem, AbstractSystem, DiscretizationT, as_system, refuse_in_coordinates


@overload
def discretize(
    system: AbstractSystem,
    time_step: Array,
    difference: Difference | None = None,
    constraint: Constraint | Callable[[Array], Array] | None = None,
    order: int = 2,
) -> Discretization: ...
@overload
def discretize(system: AbstractCoordinateSystem[DiscretizationT, Any], time_step: Array) -> DiscretizationT: ...
def discretize(
    system: AbstractSystem | AbstractCoordinateSystem,
    time_step: Array,
    difference: Difference | None = None,
    constraint: Constraint | Callable[[Array], Array] | None = None,
    order: int = 2,
) -> Any:
    r"""Discretize a system: choose the discrete Lagrangian and the variety that displacements lie on.

    $$ l_d(W) = h\, l\bigl((W - I)/h\bigr) \ \text{(matrix)}, \qquad l_d(W) = h\, l(\log W/h)\ \text{(logarithmic)}, $$

    with $h$ the time step and, for matrices, $l(X) = \tfrac12\mathrm{tr}(X\,\mathbb{J}\,X^*)$. With "matrix" and "skew"
    the step of a left-invariant system conserves the reduced constrained energy exactly, for every constraint
    subspace; with any other choice it does not (see `Discretization.conserves_energy`).

    Reference: [fedorov-zenkov-2004], section 3; docs/theory/energy-theorem.md.

    A `LagrangeDAlembert` has its own rule, and takes no other argument than the time step.

    Args:
        system: The system.
        time_step: h > 0.
        difference: "matrix", "logarithmic" or a callable $L_d(W)$ of a JAX matrix that includes the factor h. By
            default "matrix" where it is defined, for a mass tensor, and "logarithmic" elsewhere.
        constraint: "skew", (W - W^-1)/2 in d on the irreducible analytic component through the identity;
            "exponential", exp d; "naive", W - I projected to the algebra, in d; or functions f_j(W) of a JAX matrix,
            zero on the variety. By default "skew" where it is defined, on SO(n), SE(n) and groups with a form, and
            "exponential" elsewhere.
        order: 2, or 4, 6, 8: a symmetric composition of 5, 9, 15 steps of order 2 with time steps of either sign. It
            needs difference "matrix" or "logarithmic" and constraint "skew" or "exponential".
            docs/theory/compositions.md explains momenta and displacements of its orbits.

    Returns:
        The discretization; of a system in coordinates a `nonholo.lagrange_dalembert.CoordinateDiscretization`.

    Raises:
        ValueError: A time step that is not positive and real, an unknown choice, a difference or a constraint that is
            not defined for the system, functions that do not fit d at the identity,
            an order that is not available.

    Example:
        >>> discretize(ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), time_step=0.1).difference
        'matrix'
    """
    if isinstance(system, AbstractCoordinateSystem):
        others = {"difference": (difference, None), "constraint": (constraint, None), "order": (order, 2)}
        refuse_in_coordinates("discretize", **others)
        return system.discrete_map(time_step)
    as_system("discretize(system=...)", system)
    step = scale("discretize(time_step=...)", time_step, "Pass a positive real time step.")
    lagrangian, variety = _difference(system, difference), _constraint(system, constraint)
    where = "discretize(order=...)"
    order = choice(where, order, (2, *WEIGHTS))
    if order > 2 and callable(lagrangian):
        got = "a callable L_d(W), which has one time step built in"
        raise error(where, "be 2", f"{order} with {got}", "Pass difference='matrix' or 'logarithmic'.")
    if order > 2 and variety not in ("skew", "exponential"):
        got = f"{order} with a constraint that may not hold for W^-1 where it holds for W"
        raise error(where, "be 2", got, "Pass constraint='skew' or 'exponential'.")
    discrete = Discretization(system, step, lagrangian, variety, order)
    if discrete.forces is not None:
        _ = discrete.route  # refused here where there is none
    return discrete


def _difference(system: AbstractSystem, difference: Difference | None) -> Difference:
    where, is_defined = "discretize(difference=...)", system.is_wide or system.homogeneous_mass_tensor is not None
    if difference is None:
        return "matrix" if is_defined else "logarithmic"
    if callable(difference):
        words = "a real scalar function", "Write L_d(W) with jax.numpy, returning one number.", "Avoid 0/0 there."
        return at_identity(where, (difference,), system.group, words)[0][0]
    choice(where, difference, ("matrix", "logarithmic"), "Or pass a callable L_d(W).")
    if difference == "matrix" and not is_defined:
        got = "a kinetic energy given by an inertia operator, which does not extend to W - I outside the algebra"
        remedy = "Pass 'logarithmic', or build the system of a mass tensor, on SO(n), SE(n) or MatrixGroup(form=...)."
        raise error(where, "be defined for the system", got, remedy)
    return difference


def _constraint(system: AbstractSystem, constraint: object) -> Constraint:
    is_defined = system.group.has_skew_part
    if constraint is None:
        return "skew" if is_defined else "exponential"
    where = "discretize(constraint=...)"
    kind = checked_constraint(where, system, constraint)
    if kind == "skew" and not is_defined:
        got = f"{system.group}, where (W - W^-1)/2 need not lie in the algebra"
        remedy = "Pass 'exponential' or, if the group preserves a form G, build it as MatrixGroup(basis, form=G)."
        raise error(where, "be defined on the group", got, remedy)
    return kind


_SAMPLES = 16


def consistency_defect(discrete: Discretization, discretization_map: Callable[[Array], Array] | None = None) -> float:
    r"""Return the distance of a displacement variety from consistency with a discretization map; zero if consistent.

    A discrete Lagrangian that comes from a continuous one by a map $\Psi$ from displacements to velocities,
    $l_d(W) = h\,l(\Psi(W))$, has the consistent variety $\{W : \langle a^j, \Psi(W)\rangle = 0\}$. The result is the
    largest $|\langle a^j, \Psi(W)\rangle|$ at displacements W drawn from the variety, with rows $a^j$ and
    velocities of length one. Consistency does not conserve energy, nor does its absence spoil it: "matrix" is
    consistent with "naive" and conserves with "skew".

    Reference: [fedorov-zenkov-2004], section 2, the remark on discretization mappings.

    Args:
        discrete: The discretized system.
        discretization_map: W -> coordinates of the velocity, for one JAX matrix, up to a factor. By default that of the
            difference: the projection of W - I to the algebra for "matrix", log W for "logarithmic".

    Raises:
        ValueError: No map for a difference that is a callable, or one with a wrong result.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1, constraint="naive")
        >>> consistency_defect(sleigh) < 1e-14
        True
        >>> consistency_defect(nh.discretize(sleigh.system, 0.1)) > 0.01
        True
    """
    as_discretization("consistency_defect(discrete=...)", discrete)
    of_jax = definition("consistency_defect(...)")
    group, annihilator = discrete.system.group, np.asarray(discrete.system.annihilator)
    where = "consistency_defect(discretization_map=...)"
    own = {"matrix": lambda W: group.vee(W - group.identity), "logarithmic": group.log}
    if discretization_map is not None:
        function(where, discretization_map, "W")
        velocities = of_jax.map_each(discretization_map, of_jax.sample_displacements(discrete, _SAMPLES))
    elif callable(discrete.difference):
        got = "none, with a callable difference"
        raise error(where, "be given", got, "Pass the map W -> velocity that the difference was made with.")
    else:
        velocities = own[discrete.difference](of_jax.sample_displacements(discrete, _SAMPLES))
    if velocities.shape != (_SAMPLES, group.dim) or not np.all(np.isfinite(velocities)):
        got = f"shape {velocities.shape[1:]}" if velocities.shape[1:] != (group.dim,) else "a value that is not finite"
        raise error(where, f"return {group.dim} finite coordinates", got, "Use `vee` on a matrix of the algebra.")
    unit, rows = (x / np.linalg.norm(x, axis=1, keepdims=True) for x in (velocities, annihilator))
    return float(np.abs(unit @ rows.T).max(initial=0.0))


def discrete_legendre(
    discrete: Discretization, displacement: Float[Array, "... N N"], side: str = "left"
) -> Float[Array, "... dim"]:
    r"""Return the discrete body momentum of a displacement, in physical units.

    $$ \langle P(W), x\rangle = \tfrac{d}{d\varepsilon} l_d(e^{\varepsilon x} W)\big|_0 \ \text{(left)}, \qquad
       \langle P^+(W), x\rangle = \tfrac{d}{d\varepsilon} l_d(W e^{\varepsilon x})\big|_0 \ \text{(right)}, $$

    and $P^+(W) = \mathrm{Ad}^*_W P(W)$: the momentum that arrives at the next state before the constraint force.

    Reference: [fedorov-zenkov-2004], equation (disc.mom.dfn), whose second form has the wrong sign.

    Args:
        discrete: The discretized system.
        displacement: W, an element of the group; a leading axis of many is allowed.
        side: "left" or "right".

    Raises:
        ValueError: A wrong shape, a value that is not finite, an unknown side.

    Example:
        >>> sleigh = discretize(ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.0), time_step=0.5)
        >>> discrete_legendre(sleigh, SE(2).exp(np.array([0.0, 0.5, 0.0])))
        array([0., 1., 0.])
    """
    group = as_discretization("discrete_legendre(discrete=...)", discrete).system.group
    where, shape = "discrete_legendre(displacement=...)", group.identity.shape
    leading = (None,) * (len(shape_of(displacement)) - 2)
    W = array(where, displacement, leading + shape, f"Pass an element of {group} as a matrix.")
    return legendre(discrete, W - group.identity, choice("discrete_legendre(side=...)", side, ("left", "right")))


def moser_veselov_displacement(mass_tensor: Any, momentum: Any, time_step: Array) -> Float[np.ndarray, "n n"]:
    r"""Return the displacement of the free top on SO(n) with a given momentum, on the branch of small steps.

    $$ M = WJ - JW^T, \qquad W = (\tfrac12M + S)J^{-1}, \qquad S^2 + \tfrac12(SM - MS) = \tfrac14M^2 + J^2, $$

    with $M = h\hat P$ and the symmetric positive definite solution S of the Riccati equation, which is J for M = 0.
    An independent way to the first displacement of `simulate(discretize(RigidBody(mass_tensor), h), momentum=...)`.

    Reference: [moser-veselov-1991]; [cardoso-leite-2003] for the Riccati equation.

    Args:
        mass_tensor: J, positive definite (n, n).
        momentum: P, coordinates of so(n)*.
        time_step: h.

    Raises:
        ValueError: A wrong shape, a mass tensor that is not positive definite, a momentum beyond the branch.

    Example:
        >>> W = moser_veselov_displacement(np.diag([1.0, 2.0, 3.0]), [0.3, 0.4, 0.2], time_step=0.1)
        >>> top = nh.discretize(nh.RigidBody(np.diag([1.0, 2.0, 3.0])), time_step=0.1)
        >>> nh.discrete_legendre(top, W).round(12)
        array([0.3, 0.4, 0.2])
    """
    owner = "moser_veselov_displacement"
    where, remedy = f"{owner}(mass_tensor=...)", "Pass the mass tensor J."
    n = max((2, *shape_of(mass_tensor)[-1:]))
    J = symmetric(where, array(where, mass_tensor, (n, n), remedy), remedy)
    if np.linalg.eigvalsh(J)[0] <= 0:
        got = f"an eigenvalue {np.linalg.eigvalsh(J)[0]:.3g}"
        raise error(where, "be positive definite", got, "Flat bodies have no Riccati equation: use `simulate`.")
    group = SO(len(J))
    P = array(f"{owner}(momentum=...)", momentum, (group.dim,), f"Pass {group.dim} coordinates of so(n)*.")
    h = scale(f"{owner}(time_step=...)", time_step, "Pass a positive time step.")
    unit = np.exp2(np.floor(np.log2(np.abs(J).max())))  # of mass: exact
    J, M = J / unit, h * group.hat(P / unit)
    try:
        S = scipy.linalg.solve_continuous_are(-M / 2, np.eye(n), M @ M / 4 + J @ J, np.eye(n))
    except (np.linalg.LinAlgError, ValueError) as failure:  # what is not finite is a ValueError
        demand = "lie on the branch of small steps"
        raise error(f"{owner}(momentum=...)", demand, f"{failure}", "Take smaller steps.") from None
    return np.linalg.solve(J, (M / 2 + S).T).T
