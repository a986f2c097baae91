"""`step`: one step of the discrete map as a pure JAX function."""

from typing import NamedTuple

import equinox
import jax.numpy as jnp
import numpy as np

from nonholo import kernels
from nonholo._checks import array, choice, error
from nonholo._results import Outcome
from nonholo._types import Array, Float
from nonholo.discrete._definition import displaced, momentum_of, principal_displacement
from nonholo.discrete._discretization import Discretization, as_discretization
from nonholo.discrete._precision import in_double
from nonholo.discrete._root import principal_root
from nonholo.discrete._structured import ScalarStep, scalar_step
from nonholo.systems import AbstractLRSystem

_ON_LOCUS = 1e-6  # relative distance from the momentum locus that a computed momentum may have


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


def step(
    discrete: Discretization, momentum: Float[Array, "dim"] | Float[Array, "k"], branch: str = "principal"
) -> StepResult:
    r"""Take one step of the discrete map: from $P_k$ to $P_{k+1}$, with the displacement $W_{k+1}$ at the new momentum.

    $$ P_{k+1} = \mathrm{Ad}^*_{W_k} P_k + \sum_j \lambda_j a^j, \qquad P_k = P(W_k),\ P_{k+1} = P(W_{k+1}). $$

    A pure function: it works under `jax.jit`, `jax.vmap` and `jax.grad` (with respect to the momentum and to the
    numbers of the system) and never raises there. Eager calls run in 64 bits and return NumPy arrays; traced calls must
    be 64-bit, or stand inside `allow_float32`.

    Reference: [fedorov-zenkov-2004], equation (disc.momentum.eqn).

    Args:
        discrete: The discretised system.
        momentum: P_k on the momentum locus, or its components along the constraint subspace.
        branch: "principal".

    Returns:
        The new state and the outcome.

    Raises:
        ValueError: A wrong shape, a value that is not finite, an unknown branch, a right-invariant constraint (whose
            step depends on the configuration: use `simulate`).
        TypeError: Traced 32-bit input.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), time_step=0.1)
        >>> after = nh.step(sleigh, np.array([0.0, 1.0, 0.0]))
        >>> after.momentum, int(after.outcome)
        (array([0., 1., 0.]), 0)
    """
    as_discretization("step(discrete=...)", discrete)
    choice("step(branch=...)", branch, ("principal",))
    if isinstance(discrete.system, AbstractLRSystem):
        got = f"{type(discrete.system).__name__}, whose step depends on the configuration"
        raise error("step(discrete=...)", "have a left-invariant constraint", got, "Use simulate(..., steps=1).")
    k, dim = discrete.system.constraint_subspace.shape
    size = k if np.shape(momentum) == (k,) else dim
    where = "step(momentum=...)"
    value = array(where, momentum, (size,), f"Pass {dim} body momenta or the {k} along the constraint subspace.")
    return in_double(_step, discrete, scalar_step(discrete), value)


@equinox.filter_jit
def _step(discrete: Discretization, closed: ScalarStep | None, momentum: Array) -> StepResult:
    system = discrete.system
    subspace = jnp.asarray(system.constraint_subspace)
    full = momentum.shape[0] != subspace.shape[0]
    y, code = _principal(discrete, closed, subspace @ momentum if full else momentum)
    if full:
        code = jnp.where((code == 0) & _off_locus(discrete, y, momentum), int(Outcome.off_momentum_locus), code)
    nowhere = system.group.identity
    arriving = momentum_of(discrete, y, nowhere, "right")
    following, later = _principal(discrete, closed, subspace @ arriving)
    code = jnp.where(code == 0, later, code)
    after = momentum_of(discrete, following, nowhere, "left")
    multipliers = (after - arriving) @ jnp.linalg.pinv(jnp.asarray(system.annihilator))
    good = code == 0
    W = displaced(discrete, following)
    return StepResult(*(jnp.where(good, x, jnp.nan) for x in (after, W, multipliers)), outcome=code)


def _off_locus(discrete: Discretization, y: Array, momentum: Array) -> Array:
    missed = momentum_of(discrete, y, discrete.system.group.identity, "left") - momentum
    return jnp.sum(missed**2) > _ON_LOCUS**2 * jnp.sum(momentum**2)


def _principal(discrete: Discretization, closed: ScalarStep | None, restricted: Array) -> tuple[Array, Array]:
    if closed is None:
        return principal_displacement(discrete, restricted, discrete.system.group.identity)
    body, C = closed.body, jnp.asarray(discrete.system.frame_map)

    def residual(y: Array, m: Array) -> Array:
        return jnp.stack(kernels.residual(body, *m, *y))

    def certified(y: Array, m: Array) -> Array:
        return kernels.certified(body, *m, *y)

    return principal_root(residual, closed.scale * (C @ restricted), 2, certified)
