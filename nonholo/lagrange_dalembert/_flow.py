r"""The continuous motion: the solve, the orbit of it, and the work that changes the energy.

Equations that are smooth formulas are solved by Taylor series, any other by diffrax.

Along a motion $\dot E = f\cdot v + \lambda\cdot b - \partial L/\partial t$: the power of the force, that of moving
constraints $A v = b$ (of driven joints what their motors give), and what a Lagrangian of the time adds.
"""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error, flow_times, flow_tolerances
from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert import _equations, compiled
from nonholo.lagrange_dalembert._accelerations import acceleration, refuse_table
from nonholo.lagrange_dalembert._discretization import checked_state
from nonholo.lagrange_dalembert._motion import ORBITS
from nonholo.lagrange_dalembert._room import configurations, in_double, places, room
from nonholo.orbit import times_within

State = tuple[Array, Array]
"""Configuration and velocity."""

_FINE, _COARSE = 1e-14, 1e-10  # relative errors of a step, by series and by diffrax
_ROWS = 1024  # states whose powers are computed at once: one size, one compilation


def flow(
    system: Any,
    configuration: Any,
    starts: dict[str, Any],
    times: Any,
    rtol: float | None,
    atol: float,
    *,
    project: bool,
) -> Any:
    """Check the arguments, solve the equations and return the orbit."""
    refuse_table("flow", system)
    time, errors = flow_times(times), flow_tolerances(_COARSE if rtol is None else rtol, atol)
    first = checked_state(system, configuration, starts, time[0], project=project)
    solved = compiled.flow(system, first, time, _FINE if rtol is None else errors[0])
    rows, solution = solved or room("_integration").flow(system, first, time, errors)
    count = len(rows[0])
    outcome = Outcome.successful if count == len(time) else Outcome.not_converged
    orbit = _orbit(system, time[:count], rows, outcome, solution)
    if outcome != Outcome.successful:
        where = f"Flow from time {time[count - 1]:g} to {time[count]:g} (rtol {errors[0]:g}, atol {errors[1]:g})"
        raise OutcomeError(outcome, where, orbit)
    return orbit


def at(orbit: Any, times: Any) -> Any:
    """Return the states of a flow at any of its times."""
    time, order = times_within(orbit.span, times)
    rows = [column[np.argsort(order)] for column in orbit.solution(time[order])]
    return _orbit(orbit.system, time, rows, orbit.outcome, orbit.solution)


def _orbit(system: Any, time: np.ndarray, rows: list[np.ndarray], outcome: Outcome, solution: Any) -> Any:
    columns = compiled.flow_rows(system, *rows)
    if columns is None:
        columns = room("_integration").columns(system, rows)
    place = configurations(system, rows[0])
    return ORBITS[system.orbits](time, place, None, rows[1], *columns, outcome, system, solution=solution)


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
