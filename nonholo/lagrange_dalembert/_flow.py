r"""The continuous motion: the solve, the orbit of it, and the work that changes the energy.

Imported on first use: diffrax loads slowly.

Along a motion $\dot E = f\cdot v + \lambda\cdot b - \partial L/\partial t$: the power of the force, that of moving
constraints $A v = b$ (of driven joints what their motors give), and what a Lagrangian of the time adds.
"""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error, flow_times, flow_tolerances
from nonholo.base.numerics.time_sweep import padded, reached, sweep
from nonholo.base.progress import interruptibly
from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert import _equations
from nonholo.lagrange_dalembert._accelerations import acceleration, bordered_solution, refuse_table
from nonholo.lagrange_dalembert._discretization import checked_state
from nonholo.lagrange_dalembert._motion import ORBITS
from nonholo.lagrange_dalembert._room import configurations, equations_of, in_double, places
from nonholo.lagrange_dalembert._tangents import flow_slopes

State = tuple[Array, Array]
"""Configuration and velocity."""

_RTOL, _ATOL = 1e-12, 1e-13  # of the equations of variation
_ROWS = 1024  # states whose powers are computed at once: one size, one compilation


def flow(
    system: Any,
    configuration: Any,
    starts: dict[str, Any],
    times: Any,
    rtol: float,
    atol: float,
) -> Any:
    """Check the arguments, solve the equations and return the orbit."""
    refuse_table("flow", system)
    time, errors = flow_times(times), flow_tolerances(rtol, atol)
    first = checked_state(system, configuration, starts, time[0])
    rest, good = interruptibly(lambda: in_double(_sweep, system, first, padded(time), errors))
    rows = reached(first, rest, good, len(time))
    count = len(rows[0])
    outcome = Outcome.successful if count == len(time) else Outcome.not_converged
    orbit = _orbit(system, time[:count], rows, outcome)
    if outcome != Outcome.successful:
        rtol, atol = errors
        where = f"Flow from time {time[count - 1]:g} to {time[count]:g} (rtol {rtol:g}, atol {atol:g})"
        raise OutcomeError(outcome, where, orbit)
    return orbit


def flowed(system: Any, states: Any, times: np.ndarray, rtol: float, atol: float) -> Any:
    """Return states of a flow carried on, each to a later time of its own."""
    x, spans = places(system, states.configuration, states.time), np.stack([states.time, times], axis=1)
    ends = [
        in_double(_sweep, system, tuple(first), padded(span), flow_tolerances(rtol, atol))
        for *first, span in zip(x, states.body_velocity, spans, strict=True)
    ]
    rows = [np.stack([np.where(good[0], rest[which][0], np.nan) for rest, good in ends]) for which in (0, 1)]
    return _orbit(system, times, rows, Outcome.successful)


def _orbit(system: Any, time: np.ndarray, rows: list[np.ndarray], outcome: Outcome) -> Any:
    columns = (x[: len(time)] for x in in_double(_decode, system, *map(padded, rows)))
    return ORBITS[system.orbits](time, configurations(system, rows[0]), None, rows[1], *columns, outcome, system)


def _sweep(system: Any, state: State, times: Array, errors: tuple[Array, Array]) -> tuple[State, Array]:
    equations = equations_of(system)

    def settled(current: State) -> State:
        """Return the state with the admissible velocity next to its own in the kinetic energy."""
        q, v = equations.normalized(system, current[0]), current[1]
        return q, v - bordered_solution(system, q, v, jnp.zeros_like(v), equations.constraint(system, q, v))[0]

    def rate(current: State) -> State:
        return equations.rate(system, *current), acceleration(system, *current)[0]

    return sweep(lambda _, current: rate(settled(current)), settled, state, times, errors)


def transitions(system: Any, x: np.ndarray, v: np.ndarray, time: Float[np.ndarray, "K"]) -> Float[np.ndarray, "L m m"]:
    """Return the derivatives of states by those before them, by the equations of variation; NaN where these fail."""
    count, spans = len(time) - 1, np.stack([time[:-1], time[1:]], axis=1)
    if not count:
        return np.empty((0, *2 * (2 * v.shape[1] + system.is_driven,)))
    x, v, spans = padded(x[:-1]), padded(v[:-1]), padded(spans)
    spans[count:] = time[-1]
    return in_double(_transitions, system, x, v, spans)[:count]


def _transitions(system: Any, xs: Array, vs: Array, spans: Array) -> Array:
    def rate(_: Array, current: tuple[Array, ...]) -> tuple[Array, ...]:
        x, v, D = current
        return equations_of(system).rate(system, x, v), acceleration(system, x, v)[0], flow_slopes(system, x, v)[1] @ D

    def one(state: tuple[Array, Array, Array]) -> Array:
        x, v, span = state
        begin = x, v, jnp.eye(2 * len(v) + system.is_driven)
        rest, good = sweep(rate, lambda current: current, begin, span, (jnp.asarray(_RTOL), jnp.asarray(_ATOL)))
        return jnp.where(good[0], rest[2][0], jnp.nan)

    return jax.lax.map(one, (xs, vs, spans))


def _decode(system: Any, q: Array, v: Array) -> tuple[Array, ...]:
    """Return momenta, forces of constraint, energies and residuals of many states."""
    equations = equations_of(system)

    def one(q: Array, v: Array) -> tuple[Array, ...]:
        residual = jnp.max(jnp.abs(equations.constraint(system, q, v)), initial=0.0)
        momentum, force = equations.momentum(system, q, v), acceleration(system, q, v)[1]
        return momentum, force, equations.energy(system, q, v), residual

    return jax.vmap(one)(q, v)


def work(orbit: Any) -> Float[np.ndarray, "K"]:
    """Return the work on a driven system along an orbit since its first state, by the trapezoidal rule."""
    system, time, h = orbit.system, orbit.time, np.diff(orbit.time)
    x, p = places(system, orbit.configuration, time), orbit.momentum
    if system.table is not None:
        if orbit.lacks_forces:
            got = f"steps {orbit.step[:3].tolist()} ... with a force for each step"
            raise error("Orbit.work", "know every step", got, "Run with save_every=1.")
        rows = system.table.acting(orbit.step)
        before, after = _powers(system, x, p, rows), _powers(system, x, p, np.roll(rows, 1, axis=0))
    else:
        before = after = _powers(system, x, p, np.zeros_like(p))
    return np.concatenate([np.zeros(min(1, len(time))), np.cumsum(h * (before[:-1] + after[1:]) / 2)])


def _powers(system: Any, *columns: Float[np.ndarray, "K n"]) -> Float[np.ndarray, "K"]:
    """Return the power on each state: of places, momenta and rows of a table."""
    missing = -len(columns[0]) % _ROWS
    padded = [np.concatenate([rows, np.repeat(rows[-1:], missing, axis=0)]) for rows in columns]
    blocks = zip(*(rows.reshape(-1, _ROWS, rows.shape[1]) for rows in padded), strict=True)
    return np.concatenate([np.empty(0), *(in_double(_power, system, *block) for block in blocks)])[: len(columns[0])]


def _power(system: Any, x: Array, p: Array, row: Array) -> Array:
    def one(x: Array, p: Array, row: Array) -> Array:
        v = _equations.inverse_legendre(system, x, p)
        force = row + _equations.applied(system, x, v)
        moved = _equations.forms(system, x) @ v - _equations.constraint(system, x, v)
        changed = jax.grad(_equations.lagrangian, argnums=1)(system, x, v)[-1]
        return force @ v + acceleration(system, x, v, row)[1] @ moved - changed

    return jax.vmap(one)(x, p, jnp.asarray(row))
