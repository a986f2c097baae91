"""Flows by diffrax, for equations that are no smooth formulas. Imported on first use: diffrax loads slowly."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.numerics.time_sweep import good_rows, pad, sweep
from nonholo.base.progress import interruptibly
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert import _equations as equations
from nonholo.lagrange_dalembert._flow import State, acceleration, admissible_velocity
from nonholo.lagrange_dalembert._tangents import flow_slopes
from nonholo.lagrange_dalembert.functions import in_double, in_rows

_RTOL, _ATOL = 1e-12, 1e-13  # of the equations of variation


class Pieces(NamedTuple):
    """A solved motion: its states, from each of which it can be solved for a piece of time.

    Attributes:
        system: The system.
        times: Of the states.
        rows: Places and velocities.
        errors: Relative and absolute.
    """

    system: Any
    times: np.ndarray
    rows: list[np.ndarray]
    errors: tuple[float, float]

    def __call__(self, times: np.ndarray) -> list[np.ndarray]:
        """Return places and velocities at times; NaN where the solver fails."""
        forward = 1.0 if self.times[-1] >= self.times[0] else -1.0
        begin = np.maximum(np.searchsorted(forward * self.times, forward * times, "right") - 1, 0)
        columns = [np.full((len(times), *column.shape[1:]), np.nan) for column in self.rows]
        for i, (at, time) in enumerate(zip(begin, times, strict=True)):
            first = self.rows[0][at], self.rows[1][at]
            ends, _ = flow(self.system, first, np.array([self.times[at], time]), self.errors)
            for column, end in zip(columns, ends, strict=True):
                column[i : i + len(end) - 1] = end[1:]
        return columns

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last time."""
        return float(self.times[0]), float(self.times[-1])

    def looks(self) -> np.ndarray:
        """Return no times: events are evaluated at those of the states alone."""
        return self.times


def flow(system: Any, first: State, times: np.ndarray, errors: tuple[float, float]) -> tuple[list[np.ndarray], Pieces]:
    """Return places and velocities at the times, up to the first that cannot be reached, and the motion between."""
    rest, good = interruptibly(lambda: in_double(_sweep, system, first, pad(times), errors))
    rows = good_rows(first, rest, good, len(times))
    return rows, Pieces(system, times[: len(rows[0])], rows, errors)


def _sweep(system: Any, state: State, times: Array, errors: tuple[Array, Array]) -> tuple[State, Array]:

    def settle(current: State) -> State:
        """Return the admissible state next to one in the kinetic energy."""
        q, v = system.places.normalize(current[0]), current[1]
        if system.holonomic is not None:
            away = equations.holonomic_residual(system, q)
            back = equations.bordered_solution(system, q, v, jnp.zeros_like(v), away)[0]
            q = q - jnp.pad(back, (0, system.is_driven))
        return q, admissible_velocity(system, q, v)

    def rate(current: State) -> State:
        return system.places.rate(*current), acceleration(system, *current)[0]

    return sweep(lambda _, current: rate(settle(current)), settle, state, times, errors)


def columns(system: Any, rows: list[np.ndarray]) -> list[np.ndarray]:
    """Return momenta, forces of constraint, energies and residuals of places and velocities."""
    return [x[: len(rows[0])] for x in in_rows(_decode, system, *map(pad, rows))]


def _decode(system: Any, q: Array, v: Array) -> tuple[Array, ...]:
    residual = jnp.max(jnp.abs(equations.constraint(system, q, v)), initial=0.0)
    momentum, force = equations.momentum(system, q, v), acceleration(system, q, v)[1]
    return momentum, force, equations.energy(system, q, v), residual


def transitions(system: Any, x: np.ndarray, v: np.ndarray, time: Float[np.ndarray, "K"]) -> Float[np.ndarray, "L m m"]:
    """Return the derivatives of states by those before them, by the equations of variation; NaN where these fail."""
    count, spans = len(time) - 1, np.stack([time[:-1], time[1:]], axis=1)
    if not count:
        return np.empty((0, *2 * (2 * v.shape[1] + system.is_driven,)))
    x, v, spans = pad(x[:-1]), pad(v[:-1]), pad(spans)
    spans[count:] = time[-1]
    return in_double(_transitions, system, x, v, spans)[:count]


def _transitions(system: Any, xs: Array, vs: Array, spans: Array) -> Array:
    def one(state: tuple[Array, Array, Array]) -> Array:
        x, v, span = state
        way, speed = _sizes(system, *state)
        sizes, length = jnp.concatenate([way, speed]), way if x.ndim == 1 else 1.0

        def rate(_: Array, current: tuple[Array, ...]) -> tuple[Array, ...]:
            (x, v), D = (current[0] * length, current[1] * speed), current[2]
            slope = flow_slopes(system, x, v)[1] * (sizes / sizes[:, None])
            return system.places.rate(x, v) / length, acceleration(system, x, v)[0] / speed, slope @ D

        begin = x / length, v / speed, jnp.eye(len(sizes))
        rest, good = sweep(rate, lambda current: current, begin, span, (jnp.asarray(_RTOL), jnp.asarray(_ATOL)))
        return jnp.where(good[0], rest[2][0] * (sizes[:, None] / sizes), jnp.nan)

    return jax.lax.map(one, (xs, vs, spans))


def _sizes(system: Any, x: Array, v: Array, span: Array) -> tuple[Array, Array]:
    """Return units of places and of velocities, from their masses and the time in which they are passed."""
    unit, time = equations.acceleration_matrix(system, x, v)[1].velocity, jnp.abs(span[1] - span[0])
    time = jnp.where(time == 0, 1.0, time)
    numbers = x[: len(v)] if x.ndim == 1 else jnp.zeros(len(v))
    extent = jnp.clip(jnp.max(jnp.abs(numbers / unit)), jnp.min(1 / unit), jnp.max(1 / unit))
    speed = unit * (jnp.max(jnp.abs(v / unit)) + extent / time)
    return jnp.append(speed * time, jnp.full(int(system.is_driven), time)), speed
