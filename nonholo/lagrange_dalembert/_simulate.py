"""The run: its start, one step, the decoding, and what is said when a step fails."""

import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.results import Outcome, finished
from nonholo.base.types import Array
from nonholo.lagrange_dalembert import _start
from nonholo.lagrange_dalembert._blocks import State, checked_counts, decoded, run
from nonholo.lagrange_dalembert._equations import discrete_constraints, discrete_energy, momenta
from nonholo.lagrange_dalembert._newton import orientation, solve
from nonholo.lagrange_dalembert._orbit import CoordinateOrbit
from nonholo.lagrange_dalembert._precision import in_double
from nonholo.lagrange_dalembert._system import LagrangeDAlembert
from nonholo.systems import one_start


def simulate(
    system: LagrangeDAlembert,
    h: float,
    configuration: Any,
    starts: dict[str, Any],
    steps: int,
    save_every: int,
    throw: bool,
    progress: bool,
) -> CoordinateOrbit:
    """Check a start, run the map and return its orbit."""
    steps, every = checked_counts(steps, save_every, 4 * system.dimension)
    q = _start.point("simulate", system, configuration)
    _start.consistent(system, q, np.float64(h))
    start = _first(system, np.float64(h), q, starts)
    rows, code, done = run(_step, system, np.float64(h), start, steps, every, progress)
    return finished(_orbit(system, np.float64(h), rows, Outcome(int(code)), every), h, done, steps, throw)


def _first(system: LagrangeDAlembert, h: Any, q: np.ndarray, starts: dict[str, Any]) -> tuple[State, Array, Array]:
    given = one_start("simulate", **starts)
    if given == "displacement":
        v = _start.velocity_of_displacement(system, q, starts["displacement"], h)
        return in_double(_set_out_at, system, h, q, v)
    if given == "momentum":
        p, v = _start.velocity_of_momentum("simulate", system, q, starts["momentum"])
        return in_double(_set_out, system, h, q, v, p)
    v = _start.velocity("simulate", system, q, starts["body_velocity"])
    return in_double(_set_out_with, system, h, q, v)


def _set_out_of(system: LagrangeDAlembert, h: Array, q: Array, v: Array, p: Array) -> tuple[State, Array, Array]:
    sign, _ = orientation(system, q, v, h)
    first, _, code = solve(system, h, q, p, v, v, sign)
    return (q, first, first), sign, code


def _set_out_with_of(system: LagrangeDAlembert, h: Array, q: Array, v: Array) -> tuple[State, Array, Array]:
    return _set_out_of(system, h, q, v, jax.grad(system.lagrangian, argnums=1)(q, v))


def _set_out_at_of(system: LagrangeDAlembert, h: Array, q: Array, v: Array) -> tuple[State, Array, Array]:
    return _set_out_of(system, h, q, v, momenta(system, q, v, h)[0])


_set_out = jax.jit(_set_out_of, static_argnums=0)
_set_out_with = jax.jit(_set_out_with_of, static_argnums=0)
_set_out_at = jax.jit(_set_out_at_of, static_argnums=0)


def _step(system: LagrangeDAlembert, h: Array, state: State, sign: Array) -> tuple[State, Array, Array]:
    q, v, before = state
    _, arriving = momenta(system, q, v, h)
    following, multipliers, code = solve(system, h, q + h * v, arriving, v, 2 * v - before, sign)
    return (q + h * v, following, v), multipliers, code


def _orbit(system: LagrangeDAlembert, h: Any, rows: list[np.ndarray], outcome: Outcome, every: int) -> CoordinateOrbit:
    q, v, impulses = rows
    momentum, energy, residual = decoded(_decode, system, h, q, v)
    time = h * (every * np.arange(len(q)))
    return CoordinateOrbit(time, q, h * v, v, momentum, impulses, energy, residual, outcome)


@functools.partial(jax.jit, static_argnums=0)
def _decode(system: LagrangeDAlembert, h: Array, q: Array, v: Array) -> tuple[Array, Array, Array]:
    def one(q: Array, v: Array) -> tuple[Array, Array, Array]:
        residual = jnp.max(jnp.abs(discrete_constraints(system, q, v, h)), initial=0.0)
        return momenta(system, q, v, h)[0], discrete_energy(system, q, v, h), residual

    return jax.vmap(one)(q, v)
