"""The continuous motion in coordinates: accelerations and forces of constraint, and the orbit of a solve."""

import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import flow_times, flow_tolerances
from nonholo.base.types import Array
from nonholo.lagrange_dalembert import _start
from nonholo.lagrange_dalembert._equations import acceleration_matrix, energy, forms, solve_bordered
from nonholo.lagrange_dalembert._orbit import CoordinateOrbit
from nonholo.lagrange_dalembert._sweep import Motion, State, flowed
from nonholo.lagrange_dalembert._system import LagrangeDAlembert
from nonholo.systems import one_start


def flow(
    system: LagrangeDAlembert, configuration: Any, starts: dict[str, Any], times: Any, rtol: float, atol: float
) -> CoordinateOrbit:
    """Check a start, solve the equations and return the orbit."""
    time, errors = flow_times(times), flow_tolerances(rtol, atol)
    q = _start.point("flow", system, configuration)
    v = _velocity(system, q, starts)
    return flowed(CoordinateOrbit, Motion(_rate, _projected, _decode), system, (q, v), time, errors)


def _velocity(system: LagrangeDAlembert, q: np.ndarray, starts: dict[str, Any]) -> np.ndarray:
    if one_start("flow", **starts) == "momentum":
        return _start.velocity_of_momentum("flow", system, q, starts["momentum"])[1]
    return _start.velocity("flow", system, q, starts["body_velocity"])


def _bordered_solve(system: LagrangeDAlembert, q: Array, v: Array, force: Array, off: Array) -> tuple[Array, Array]:
    r"""Solve $M x - A^T\lambda$ = force, A x = off."""
    return solve_bordered(*acceleration_matrix(system, q, v), force, off)


def _projected(system: LagrangeDAlembert, state: State) -> State:
    """Return the state with the admissible velocity next to its own in the kinetic energy."""
    q, v = state
    return q, v - _bordered_solve(system, q, v, jnp.zeros_like(v), forms(system, q) @ v)[0]


def _rate(system: LagrangeDAlembert, state: State) -> State:
    return state[1], _acceleration(system, *state)[0]


def _acceleration(system: LagrangeDAlembert, q: Array, v: Array) -> tuple[Array, Array]:
    r"""Return the acceleration and the forces $\lambda$, from the equations and $\tfrac{d}{dt}(A v) = 0$."""
    along_q = jax.grad(system.lagrangian)(q, v)
    _, carried = jax.jvp(lambda x: jax.grad(system.lagrangian, argnums=1)(x, v), (q,), (v,))
    _, turned = jax.jvp(lambda x: forms(system, x) @ v, (q,), (v,))
    return _bordered_solve(system, q, v, along_q - carried, -turned)


@functools.partial(jax.jit, static_argnums=0)
def _decode(system: LagrangeDAlembert, q: Array, v: Array) -> tuple[Array, ...]:
    def one(q: Array, v: Array) -> tuple[Array, ...]:
        residual = jnp.max(jnp.abs(forms(system, q) @ v), initial=0.0)
        momentum = jax.grad(system.lagrangian, argnums=1)(q, v)
        return momentum, _acceleration(system, q, v)[1], energy(system, q, v), residual

    return jax.vmap(one)(q, v)
