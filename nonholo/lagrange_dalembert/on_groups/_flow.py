"""The continuous motion on a group: accelerations and forces of constraint, and the orbit of a solve."""

import functools
from typing import Any

import jax
import jax.numpy as jnp

from nonholo.base.checks import flow_times, flow_tolerances
from nonholo.base.types import Array
from nonholo.lagrange_dalembert._equations import solve_bordered
from nonholo.lagrange_dalembert._sweep import Motion, State, flowed
from nonholo.lagrange_dalembert.on_groups import _equations as equations
from nonholo.lagrange_dalembert.on_groups import _start as start
from nonholo.lagrange_dalembert.on_groups._orbit import GroupOrbit
from nonholo.lagrange_dalembert.on_groups._system import GroupLagrangeDAlembert
from nonholo.systems import one_start


def flow(
    system: GroupLagrangeDAlembert, configuration: Any, starts: dict[str, Any], times: Any, rtol: float, atol: float
) -> GroupOrbit:
    """Check a start, solve the equations and return the orbit."""
    time, errors, given = flow_times(times), flow_tolerances(rtol, atol), one_start("flow", **starts)
    g = start.pose("flow", system, configuration)
    of = start.of_momentum if given == "momentum" else start.of_velocity
    w, _ = of("flow", system, g, starts[given])
    return flowed(GroupOrbit, Motion(_rate, _projected, _decode), system, (g, w), time, errors)


def _bordered_solve(
    system: GroupLagrangeDAlembert, g: Array, w: Array, force: Array, off: Array
) -> tuple[Array, Array]:
    r"""Solve $M x - a^T\lambda$ = force, a x = off."""
    return solve_bordered(*equations.acceleration_matrix(system, g, w), force, off)


def _projected(system: GroupLagrangeDAlembert, state: State) -> State:
    """Return the state on the group, with the admissible velocity next to its own in the kinetic energy."""
    g, w = equations.normalized(system, state[0]), state[1]
    return g, w - _bordered_solve(system, g, w, jnp.zeros_like(w), equations.forms(system, g) @ w)[0]


def _acceleration(system: GroupLagrangeDAlembert, g: Array, w: Array) -> tuple[Array, Array]:
    r"""Return the rate of $\omega$ and the forces $\lambda$, from the equations and $\tfrac{d}{dt}(a(g)\omega) = 0$."""
    force = system.group.coad(w, equations.continuous_momentum(system, w))
    _, turned = jax.jvp(lambda x: equations.forms(system, x) @ w, (g,), (g @ system.group.hat(w),))
    return _bordered_solve(system, g, w, force, -turned)


def _rate(system: GroupLagrangeDAlembert, state: State) -> State:
    g, w = state
    return g @ system.group.hat(w), _acceleration(system, g, w)[0]


@functools.partial(jax.jit, static_argnums=0)
def _decode(system: GroupLagrangeDAlembert, g: Array, w: Array) -> tuple[Array, ...]:
    def one(g: Array, w: Array) -> tuple[Array, ...]:
        residual = jnp.max(jnp.abs(equations.forms(system, g) @ w), initial=0.0)
        momentum, energy = equations.continuous_momentum(system, w), equations.energy(system, w)
        return momentum, _acceleration(system, g, w)[1], energy, residual

    return jax.vmap(one)(g, w)
