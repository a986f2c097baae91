"""`step`: one step of the discrete map as a pure JAX function."""

from typing import Any, NamedTuple

import equinox
import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import array, error, is_traced, shape_of, shown
from nonholo.base.results import Outcome
from nonholo.base.types import Array, Float
from nonholo.discrete import branching, definition
from nonholo.discrete._discretization import Discretization, as_discretization
from nonholo.discrete._scheme import legendre
from nonholo.discrete.routes import ScalarRoute, ScalarStep
from nonholo.systems import refuse_fixed_in_space


class StepResult(NamedTuple):
    """The state after a step.

    Attributes:
        momentum: P_{k+1}, shape (dim,).
        displacement: W_{k+1}, whose momentum is P_{k+1}.
        multipliers: The impulses between P_k and P_{k+1}, shape (s,).
        outcome: An `Outcome` as an integer array; where it is not `successful` the other fields are NaN.
    """

    momentum: Float[Array, "dim"]
    displacement: Float[Array, "N N"]
    multipliers: Float[Array, "s"]
    outcome: Array


def step(discrete: Discretization, momentum: Any, branch: branching.BranchRule = "principal") -> StepResult:
    r"""Take one step of the discrete map: from $P_k$ to $P_{k+1}$, with the displacement $W_{k+1}$ at the new momentum.

    $$ P_{k+1} = \mathrm{Ad}^*_{W_k} P_k + \sum_j \lambda_j a^j, \qquad P_k = P(W_k),\ P_{k+1} = P(W_{k+1}). $$

    A pure function: it works under `jax.jit`, `jax.vmap` and `jax.grad` (with respect to the momentum and to the
    numbers of the system) and never raises there. Eager calls run in 64 bits and return NumPy arrays; traced calls must
    be 64-bit, or stand inside `allow_float32`.

    Reference: [fedorov-zenkov-2004], equation (disc.momentum.eqn).

    Args:
        discrete: The discretized system.
        momentum: P_k on the momentum locus, or its components along the constraint subspace.
        branch: As in `simulate`. With "principal" and "nearest" a step can be traced; "nearest" then starts at the
            principal displacement of the momentum, as it always does for components along the subspace.

    Returns:
        The new state and the outcome.

    Raises:
        ValueError: A wrong shape, a value that is not finite, an unknown branch or one that the system does not
            have, a right-invariant constraint (whose step depends on the configuration: use `simulate`); with another
            branch than "principal" a full momentum off the locus.
        TypeError: Traced 32-bit input.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), time_step=0.1)
        >>> after = nh.step(sleigh, np.array([0.0, 1.0, 0.0]))
        >>> after.momentum, int(after.outcome)
        (array([0., 1., 0.]), 0)
    """
    as_discretization("step(discrete=...)", discrete)
    got = f"{type(discrete.system).__name__}, whose step depends on the configuration"
    refuse_fixed_in_space("step(discrete=...)", discrete.system, "Use simulate(..., steps=1).", got)
    k, dim = discrete.system.constraint_subspace.shape
    size = k if shape_of(momentum) == (k,) else dim
    where = "step(momentum=...)"
    value = array(where, momentum, (size,), f"Pass {dim} body momenta or the {k} along the constraint subspace.")
    in_jax = any(is_traced(x) for x in jax.tree.leaves((discrete, value)))
    rule = branching.checked_rule("step", discrete, branch)
    if in_jax and not (rule.is_principal or rule.is_nearest):
        got = f"{shown(branch)} under a JAX transformation"
        raise error("step(branch=...)", "be 'principal' or 'nearest'", got, "Take this step outside of it.")
    if rule.is_principal or in_jax or not branching.has_frame(discrete):
        route = discrete.route
        scalar_step = jax.tree.map(definition.traceable, route.step) if isinstance(route, ScalarRoute) else None
        return definition.in_double(_step, discrete, scalar_step, not rule.is_principal, value)
    return _step_by_rule(discrete, rule, value)


def _step_by_rule(discrete: Discretization, rule: branching.AbstractBranchRule, momentum: np.ndarray) -> StepResult:
    """Take a step in NumPy, from a state that need not be on the principal branch."""
    system = discrete.system
    frame = branching.frame_of("step(discrete=...)", discrete)
    full = momentum if momentum.shape != (len(system.constraint_subspace),) else None
    canonical = system.to_canonical(momentum if full is None else system.restrict(full))
    code, place = branching.first_place("step", frame, rule, canonical, full)
    after, W = np.full(system.group.dim, np.nan), np.full_like(system.group.identity, np.nan)
    multipliers = np.full(len(system.annihilator), np.nan)
    if place is not None:
        code, following = branching.next_place(frame, rule, place)
        if code == 0:
            now, W = (branching.displacement_at(frame, x.point) for x in (place, following))
            after = legendre(discrete, W - system.group.identity, "left")
            arriving = legendre(discrete, now - system.group.identity, "right")
            multipliers = (after - arriving) @ np.linalg.pinv(system.annihilator)
    return StepResult(after, W, multipliers, np.asarray(int(code)))


@equinox.filter_jit
def _step(discrete: Discretization, scalar_step: ScalarStep | None, nearest: bool, momentum: Array) -> StepResult:
    system = discrete.system
    subspace = jnp.asarray(system.constraint_subspace)
    full, nowhere = momentum.shape[0] != subspace.shape[0], system.group.identity
    y, code = definition.principal_of(discrete, scalar_step, subspace @ momentum if full else momentum, nowhere)
    if full:
        gap = definition.momentum_of(discrete, y, nowhere, "left") - momentum
        is_off = jnp.sum(gap**2) > definition.ON_LOCUS**2 * jnp.sum(momentum**2)
        code = jnp.where((code == 0) & is_off, int(Outcome.off_momentum_locus), code)
    arriving = definition.momentum_of(discrete, y, nowhere, "right")
    if nearest:
        following, later = definition.nearest_displacement(discrete, y, subspace @ arriving)
    else:
        following, later = definition.principal_of(discrete, scalar_step, subspace @ arriving, nowhere)
    code = jnp.where(code == 0, later, code)
    after = definition.momentum_of(discrete, following, nowhere, "left")
    multipliers = (after - arriving) @ jnp.linalg.pinv(jnp.asarray(system.annihilator))
    good = code == 0
    W = definition.displacement_of(discrete, following)
    return StepResult(*(jnp.where(good, x, jnp.nan) for x in (after, W, multipliers)), outcome=code)
