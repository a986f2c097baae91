"""The run: one step, compiled blocks of steps, the decoding, and what is said when a step fails."""

from collections.abc import Callable
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import step_counts
from nonholo.base.limits import within_a_year, within_memory
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome, finished
from nonholo.base.types import Array
from nonholo.lagrange_dalembert._newton import orientation, solve
from nonholo.lagrange_dalembert._precision import in_double
from nonholo.lagrange_dalembert._room import equations_of

_ROWS = 1024  # saved states of one block: one size of table, one compilation
_LEAST = 1e-6  # seconds of a step, at least

OrbitT = TypeVar("OrbitT")
State = tuple[Array, Array, Array]
"""Configuration, velocity of its step, velocity of the step before."""

Start = tuple[State, Array, Array]
"""The first state, the orientation to keep and the outcome so far."""


def checked_counts(steps: Any, save_every: Any, numbers: int) -> tuple[int, int]:
    """Return numbers of steps, refused where memory cannot hold this many numbers of each saved state, or in a year."""
    steps, every = step_counts(steps, save_every)
    within_a_year("simulate(steps=...)", _LEAST * steps, "Pass fewer steps, or a larger time_step.")
    within_memory("simulate(steps=...)", 8.0 * numbers * (1 + steps // every), "Raise save_every.")
    return steps, every


def simulated(
    kind: Callable[..., OrbitT],
    system: Any,
    h: Any,
    start: Start,
    steps: int,
    every: int,
    throw: bool,
    progress: bool,
) -> OrbitT:
    """Run the map from a checked start and return its orbit of a kind."""
    (q, v, impulses), code, done = _run(system, h, start, steps, every, progress)
    *displaced, momentum, energy, residual = _decoded(system, h, q, v)
    displacement, time = displaced[0] if displaced else h * v, h * (every * np.arange(len(q)))
    orbit = kind(time, q, displacement, v, momentum, impulses, energy, residual, Outcome(int(code)), system, float(h))
    return finished(orbit, h, done, steps, throw)


def set_out(system: Any, h: Array, q: Array, v: Array, p: Array) -> Start:
    """Return the start with a momentum, by the root next to the velocity v."""
    sign, _ = orientation(system, q, v, h)
    first, _, code = solve(system, h, q, p, v, v, sign)
    return (q, first, first), sign, code


def _step(system: Any, h: Array, state: State, sign: Array) -> tuple[State, Array, Array]:
    """Return the next state, the impulses and the outcome."""
    q, v, before = state
    equations = equations_of(system)
    _, arriving = equations.momenta(system, q, v, h)
    ahead = equations.ahead(system, q, v, h)
    following, multipliers, code = solve(system, h, ahead, arriving, v, 2 * v - before, sign)
    return (ahead, following, v), multipliers, code


def _advance(system: Any, h: Array, state: State, sign: Array, rows: Array, every: Array) -> tuple:
    """Run `rows` times `every` steps; return the states before each row, the first impulse of each row, and the end."""
    s = system.constraints

    def one(carry: tuple) -> tuple:
        done, current, impulse, _ = carry
        following, multipliers, code = _step(system, h, current, sign)
        kept = jax.tree.map(lambda new, old: jnp.where(code == 0, new, old), following, current)
        return done + (code == 0), kept, jnp.where(done == 0, multipliers, impulse), code

    def row(carry: tuple) -> tuple:
        i, taken, current, _, (configurations, velocities, impulses) = carry
        start = (jnp.asarray(0), current, jnp.zeros(s), jnp.asarray(0))
        done, end, impulse, code = jax.lax.while_loop(lambda c: (c[0] < every) & (c[3] == 0), one, start)
        table = (
            configurations.at[i].set(current[0]),
            velocities.at[i].set(current[1]),
            impulses.at[i].set(impulse),
        )
        return i + 1, taken + done, end, code, table

    tables = tuple(jnp.zeros((_ROWS, *shape)) for shape in (state[0].shape, state[1].shape, (s,)))
    start = (jnp.asarray(0), jnp.asarray(0), state, jnp.asarray(0), tables)
    return jax.lax.while_loop(lambda c: (c[0] < rows) & (c[3] == 0), row, start)[1:]


def _run(
    system: Any, h: Any, start: Start, steps: int, every: int, progress: bool
) -> tuple[list[np.ndarray], Array, int]:
    """Return configurations, velocities and impulses of the saved states, the outcome and the number of good steps."""
    state, sign, code = start
    done, blocks = 0, []
    with progress_bar("steps", progress) as report:
        while code == 0 and done < steps:
            left = steps - done
            rows, stride = (min(_ROWS, left // every), every) if left >= every else (1, left)
            counts = (np.int64(rows), np.int64(stride))
            taken, state, code, table = in_double(_advance, system, h, state, sign, *counts)
            begun = min(rows, int(taken) // stride + 1)
            blocks.append([column[:begun] for column in table])
            done += int(taken)
            report(done, steps)
    kept = 1 + done // every if blocks else 0
    last = [np.asarray(state[0])[None], np.asarray(state[1])[None], np.empty((0, system.constraints))]
    columns = [np.concatenate(column)[:kept] for column in zip(*blocks, last, strict=True)]
    return [*columns[:2], columns[2][: max(kept - 1, 0)]], code, done


def _decoded(system: Any, h: Any, q: np.ndarray, v: np.ndarray) -> list[np.ndarray]:
    """Return displacements, momenta, energies and residuals of all saved states, decoded in blocks of one size."""
    blocks = max(1, -(-len(q) // _ROWS))
    padded = [np.concatenate([x, np.zeros((blocks * _ROWS - len(x), *x.shape[1:]))]) for x in (q, v)]
    for x in padded:
        x[len(q) :] = x[len(q) - 1] if len(q) else 0.0
    parts = [in_double(_decode, system, h, *(x[i * _ROWS : (i + 1) * _ROWS] for x in padded)) for i in range(blocks)]
    return [np.concatenate(column)[: len(q)] for column in zip(*parts, strict=True)]


def _decode(system: Any, h: Array, q: Array, v: Array) -> tuple[Array, ...]:
    equations = equations_of(system)

    def one(q: Array, v: Array) -> tuple[Array, ...]:
        residual = jnp.max(jnp.abs(equations.discrete_constraints(system, q, v, h)), initial=0.0)
        momentum, energy = equations.momenta(system, q, v, h)[0], equations.discrete_energy(system, q, v, h)
        return *equations.displaced(system, v, h), momentum, energy, residual

    return jax.vmap(one)(q, v)
