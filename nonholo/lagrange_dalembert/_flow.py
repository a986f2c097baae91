r"""The continuous motion: accelerations, forces of constraint, the solve, its orbit, the work that changes the energy.

Equations that are smooth formulas are solved by Taylor series, any other by diffrax.

Along a motion $\dot E = f\cdot v + \lambda\cdot b - \partial L/\partial t$: the power of the force, that of moving
constraints $A v = b$ (of driven joints what their motors give), and what a Lagrangian of the time adds.
"""

import dataclasses
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error, flow_times, flow_tolerances, is_traced, number, trailing
from nonholo.base.results import Outcome, conclude_flow
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert import _equations as equations
from nonholo.lagrange_dalembert import compiled
from nonholo.lagrange_dalembert._discretization import checked_state
from nonholo.lagrange_dalembert._orbit import ORBITS
from nonholo.lagrange_dalembert.functions import configurations, in_blocks, in_double, place, places, room
from nonholo.orbit import times_within
from nonholo.systems.forces import refuse_table

_PROJECTIONS, _NEAR = 50, 1e-14  # corrections of a place, at most, and what the last one may be beside it
_REMEDY = "Pass the configuration, row by row, then the velocity."


def acceleration(system: Any, q: Array, v: Array, extra: Any = 0.0) -> tuple[Array, Array]:
    r"""Return the rate of v and the forces $\lambda$, from the equations and $\tfrac{d}{dt}(A v - b) = 0$.

    Args:
        system: The system.
        q: Where it is.
        v: Its velocity.
        extra: A force beside those of the system: of a table the row that acts.
    """
    _, constraint_rate = jax.jvp(lambda x: equations.constraint(system, x, v), (q,), (system.places.rate(q, v),))
    return equations.bordered_solution(system, q, v, equations.force(system, q, v) + extra, -constraint_rate)


def admissible_velocity(system: Any, q: Array, v: Array) -> Array:
    """Return the admissible velocity next to one in the kinetic energy."""
    return v - equations.bordered_solution(system, q, v, jnp.zeros_like(v), equations.constraint(system, q, v))[0]


def nearest_place(system: Any, x: Array) -> Array:
    r"""Return the admissible place y next to x in the kinetic energy at x; NaN where none is reached.

    $M(y - x) = D\Phi(y)^T\lambda$, $\Phi(y) = 0$, by Newton's method from x.
    """
    n, first = system.dimension, system.velocity_constraints
    M = equations.mass_matrix(system, x, jnp.zeros(n))

    def residual(z: Array) -> Array:
        y = x.at[:n].add(z[:n])
        across = z[n:] @ equations.forms(system, y)[first:]
        return jnp.concatenate([M @ z[:n] - across, equations.place_residual(system, y)])

    def correct(carry: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        count, z, _ = carry
        step = jnp.linalg.solve(jax.jacfwd(residual)(z), -residual(z))
        after = z + step
        return count + 1, after, jnp.linalg.norm(step[:n]) / (jnp.linalg.norm(x) + jnp.linalg.norm(after[:n]))

    start = jnp.asarray(0), jnp.zeros(n + system.constraints - first), jnp.asarray(jnp.inf)
    _, z, size = jax.lax.while_loop(lambda c: (c[0] < _PROJECTIONS) & (c[2] > _NEAR), correct, start)
    return jnp.where(size <= _NEAR, x.at[:n].add(z[:n]), jnp.nan)


def vector_field(system: Any) -> Callable[[Array, Float[Array, "size"]], Float[Array, "size"]]:
    """Return the equations of motion as a function (time, state) -> derivative; `nonholo.vector_field` says of what."""
    refuse_table("vector_field(system=...)", system.table)
    size = int(np.prod(system.shapes[0]) + np.prod(system.shapes[1]))

    def derivative(time: Array, state: Float[Array, "size"]) -> Float[Array, "size"]:
        now = number("vector_field(...)(time=...)", time)
        rows = trailing("vector_field(...)(state=...)", state, (size,), _REMEDY, real=True)
        if is_traced(now) or is_traced(rows):
            return _derivative(system.bound(*system.parameters.values()), now, rows)
        return in_double(_derivative, system, now, rows)

    return derivative


def _derivative(system: Any, time: Array, state: Float[Array, "... size"]) -> Float[Array, "... size"]:
    pose, _ = system.shapes

    def one(row: Array) -> Array:
        q, v = jnp.split(row, [int(np.prod(pose))])
        x = place(system, q.reshape(pose), time)
        return jnp.concatenate([jnp.ravel(system.places.rate(x, v))[: len(q)], acceleration(system, x, v)[0]])

    return one(state) if state.ndim == 1 else jax.lax.map(one, state.reshape(-1, state.shape[-1])).reshape(state.shape)


State = tuple[Array, Array]
"""Configuration and velocity."""

_FINE, _COARSE = 1e-14, 1e-10  # relative errors of a step, by series and by diffrax


def flow(system: Any, *, rtol: float | None, atol: float, **start: Any) -> Any:
    """Check the arguments, solve the equations and return the orbit."""
    time, first = _opening(system, **start)
    return conclude_flow(solve(system, first, time, rtol, atol), time, _checked_errors(rtol, atol))


def _opening(system: Any, *, configuration: Any, times: Any, project: bool, **starts: Any) -> tuple[np.ndarray, State]:
    """Return the checked times of a flow and its first place and velocity."""
    refuse_table("flow(system=...)", system.table)
    time = flow_times(times)
    return time, checked_state(system, configuration, starts, time[0], project=project)


class Flights(NamedTuple):
    """The flows from states of a motion.

    Attributes:
        system: The system.
        errors: Relative and absolute errors of a step.
    """

    system: Any
    errors: tuple[float | None, float]

    def fly(self, there: Any, elapsed: np.ndarray) -> tuple[Any, Outcome, str]:
        """Return the flow from a state at the requested times since then, the outcome and its message."""
        orbit = self.solve(there, there.time[0] + np.union1d(0.0, elapsed))
        looks = orbit.solution.looks()
        return orbit.at(np.union1d(orbit.time, looks[looks < orbit.time[-1]])), orbit.outcome, ""

    def solve(self, there: Any, time: np.ndarray) -> Any:
        """Return the flow from a state at times, as far as it gets."""
        return solve(self.system, there.as_start().numbers[1:], time, *self.errors)

    def joined(self, begins: list[Any], until: float) -> dict[str, Any]:
        """Return the motion from several states, each up to the next one."""
        nodes = np.array([*(each.time[0] for each in begins), until])
        times = map(np.unique, np.stack([nodes[:-1], nodes[1:]], axis=1))
        flows = (self.successful(self.solve(each, time), time) for each, time in zip(begins, times, strict=True))
        return {"solution": Broken(nodes, tuple(flow.solution for flow in flows))}

    def successful(self, orbit: Any, time: np.ndarray) -> Any:
        """Return a flow, or raise if it ended early."""
        return conclude_flow(orbit, time, _checked_errors(*self.errors))


class Broken(NamedTuple):
    """A motion that begins again at times.

    Attributes:
        nodes: These times, and the last one.
        solutions: The motions from them.
    """

    nodes: np.ndarray
    solutions: tuple[Any, ...]

    def __call__(self, times: np.ndarray) -> list[np.ndarray]:
        """Return places and velocities at increasing times."""
        owner = np.clip(np.searchsorted(self.nodes, times, "right") - 1, 0, len(self.solutions) - 1)
        parts = [self.solutions[k](times[owner == k]) for k in np.unique(owner)]
        return [np.concatenate(column) for column in zip(*parts, strict=True)]

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last time."""
        return float(self.nodes[0]), float(self.nodes[-1])


def flights(system: Any, *, rtol: float | None, atol: float, **start: Any) -> tuple[Flights, np.ndarray, Any]:
    """Check the arguments; return the flows of a system, the times and the first state."""
    (time, (x, v)), _ = _opening(system, **start), _checked_errors(rtol, atol)
    first = _orbit(system, time[:1], [x[None], v[None]], Outcome.successful, None)
    return Flights(system, (rtol, atol)), time, first


def _checked_errors(rtol: float | None, atol: float) -> tuple[float, float]:
    return flow_tolerances(_COARSE if rtol is None else rtol, atol)


def solve(system: Any, first: State, time: Float[np.ndarray, "K"], rtol: float | None, atol: float = 1e-12) -> Any:
    """Return the orbit from a checked place and velocity, as far as it gets."""
    errors = _checked_errors(rtol, atol)
    motion = compiled.flow(system, first, time, _FINE if rtol is None else errors[0])
    rows, solution = motion or room("_integration").flow(system, first, time, errors)
    count = len(rows[0])
    outcome = Outcome.successful if count == len(time) else Outcome.not_converged
    return _orbit(system, time[:count], rows, outcome, solution).on_group()


def at(orbit: Any, times: Any) -> Any:
    """Return the states of a flow at any of its times."""
    time, order = times_within(orbit.span, times)
    rows = [column[np.argsort(order)] for column in orbit.solution(time[order])]
    return _orbit(orbit.system, time, rows, orbit.outcome, orbit.solution)


def push(orbit: Any, normal: Float[np.ndarray, "n"], change: float) -> Any:
    r"""Return one state after the impulse along a covector, that of a gap, which changes the rate of the gap.

    The velocity w of its momentum becomes w + j u, the momentum p + j n: $M u - A^T\lambda = n$, A u = 0.
    """
    p, x, _ = orbit.as_start().numbers
    w, u = in_double(answer, orbit.system, x, p, normal)
    impulse = change / (normal @ u)
    p, v = orbit.after_impulse(orbit.momentum, impulse * normal), orbit.after_impulse(w, impulse * u)[None]
    if orbit.is_discrete:
        return dataclasses.replace(orbit, momentum=p, body_velocity=v)
    after = _orbit(orbit.system, orbit.time, [x[None], v], orbit.outcome, orbit.solution)
    return dataclasses.replace(after, step=orbit.step)


def answer(system: Any, x: Array, p: Array, normal: Array) -> tuple[Array, Array]:
    """Return the velocity of a momentum, and how velocities change with an impulse along a covector."""
    w = equations.inverse_legendre(system, x, p)
    return w, equations.bordered_solution(system, x, w, normal, jnp.zeros(system.constraints))[0]


def _orbit(system: Any, time: np.ndarray, rows: list[np.ndarray], outcome: Outcome, solution: Any) -> Any:
    columns = compiled.flow_rows(system, *rows) or room("_integration").columns(system, rows)
    place = configurations(system, rows[0])
    return ORBITS[system.orbits](time, place, None, rows[1], *columns, outcome, system, solution=solution)


def works(orbit: Any) -> Float[np.ndarray, "K 2"]:
    """Return the work on a driven system since the first state, and minus that of friction, by the trapezoidal rule."""
    system, time, h = orbit.system, orbit.time, np.diff(orbit.time)
    x, p = places(system, orbit.configuration, time), orbit.momentum
    if orbit.lacks_forces:
        got = f"steps {orbit.step[:3].tolist()} ... with a force for each step"
        raise error("Orbit.work", "contain every step", got, "Run with save_every=1.")
    rows = np.zeros_like(p) if system.table is None else system.table.acting(orbit.step)
    before = _powers(system, x, p, rows)
    after = before if system.table is None else _powers(system, x, p, np.roll(rows, 1, axis=0))
    gains = np.cumsum(h[:, None] * (before[:-1] + after[1:]) / 2, axis=0)
    return np.concatenate([np.zeros((min(1, len(time)), 2)), gains])


def _powers(system: Any, *columns: Float[np.ndarray, "K n"]) -> Float[np.ndarray, "K 2"]:
    """Return the power on each state and what friction takes: of places, momenta and rows of a table."""
    power, v = in_blocks(_power, system, *columns)
    C = getattr(system.applied, "friction", np.zeros((v.shape[1],) * 2))
    return np.stack([power, (v @ C * v).sum(axis=1)], axis=1)


def _power(system: Any, x: Array, p: Array, row: Array) -> tuple[Array, Array]:
    v = equations.inverse_legendre(system, x, p)
    force = row + equations.applied(system, x, v)
    rates = equations.forms(system, x) @ v - equations.constraint(system, x, v)
    time_slope = jnp.sum(jax.grad(equations.lagrangian, argnums=1)(system, x, v)[-1])
    return force @ v + acceleration(system, x, v, row)[1] @ rates - time_slope, v
