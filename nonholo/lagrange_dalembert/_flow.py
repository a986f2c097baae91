"""The continuous motion in coordinates: accelerations and forces of constraint, and the orbit of a solve."""

import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo._results import Outcome, OutcomeError
from nonholo._types import Array
from nonholo.lagrange_dalembert import _start
from nonholo.lagrange_dalembert._equations import acceleration_matrix, energy, forms
from nonholo.lagrange_dalembert._orbit import CoordinateOrbit
from nonholo.lagrange_dalembert._precision import in_double
from nonholo.lagrange_dalembert._sweep import Motion, State, padded, swept, times_of, tolerances
from nonholo.lagrange_dalembert._system import LagrangeDAlembert


def flow(
    system: LagrangeDAlembert, configuration: Any, starts: dict[str, Any], times: Any, rtol: float, atol: float
) -> CoordinateOrbit:
    """Check a start, solve the equations and return the orbit."""
    time, errors = times_of(times), tolerances(rtol, atol)
    q = _start.point("flow", system, configuration)
    v = _velocity(system, q, starts)
    rows = swept(Motion(system, _rate, _projected), (q, v), time, errors)
    reached = len(rows[0])
    momentum, forces, energies, residual = (x[:reached] for x in in_double(_decode, system, *map(padded, rows)))
    outcome = Outcome.successful if reached == len(time) else Outcome.not_converged
    orbit = CoordinateOrbit(time[:reached], rows[0], None, rows[1], momentum, forces, energies, residual, outcome)
    if outcome != Outcome.successful:
        where = f"Flow from time {time[reached - 1]:g} to {time[reached]:g} (rtol {rtol:g}, atol {atol:g})"
        raise OutcomeError(outcome, where, orbit)
    return orbit


def _velocity(system: LagrangeDAlembert, q: np.ndarray, starts: dict[str, Any]) -> np.ndarray:
    if _start.chosen("flow", starts) == "momentum":
        return _start.velocity_of_momentum("flow", system, q, starts["momentum"])[1]
    return _start.velocity("flow", system, q, starts["body_velocity"])


def _bordered_solve(system: LagrangeDAlembert, q: Array, v: Array, force: Array, off: Array) -> tuple[Array, Array]:
    r"""Solve $M x - A^T\lambda$ = force, A x = off."""
    n = q.shape[0]
    matrix, units = acceleration_matrix(system, q, v)
    solution = jnp.linalg.solve(matrix, jnp.concatenate([force * units.velocity, off / units.constraints]))
    return solution[:n] * units.velocity, solution[n:] / units.forms


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
