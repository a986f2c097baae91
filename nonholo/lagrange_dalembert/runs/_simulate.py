"""The run: one step, compiled blocks of steps, the decoding, and what is said when a step fails."""

import functools
from collections.abc import Callable, Iterator
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import count, error, step_counts
from nonholo.base.limits import within_a_year, within_memory
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome, finished
from nonholo.base.types import Array
from nonholo.lagrange_dalembert import compiled
from nonholo.lagrange_dalembert._motion import ORBITS
from nonholo.lagrange_dalembert._newton import orientation, solve
from nonholo.lagrange_dalembert._precision import in_double
from nonholo.lagrange_dalembert._room import configurations, equations_of

_ROWS = 1024  # saved states of one block: one size of table, one compilation
LEAST = 1e-6  # seconds of a step, at least

State = tuple[Array, Array, Array]
"""Configuration, velocity of its step, velocity of the step before."""

Start = tuple[State, Array, Array]
"""The first state, the orientation to keep and the outcome so far."""


def checked_counts(steps: Any, save_every: Any, numbers: int) -> tuple[int, int]:
    """Return numbers of steps, refused where memory cannot hold this many numbers of each saved state, or in a year."""
    steps, every = step_counts(steps, save_every)
    within_a_year("simulate(steps=...)", LEAST * steps, "Pass fewer steps, or a larger time_step.")
    within_memory("simulate(steps=...)", 8.0 * numbers * (1 + steps // every), "Raise save_every.")
    return steps, every


def simulated(
    system: Any,
    h: Any,
    start: Start,
    steps: int,
    every: int,
    throw: bool,
    progress: bool,
) -> Any:
    """Run the map from a checked start and return its orbit."""
    with progress_bar("steps", progress) as report:
        ((columns, _, code, done),) = blocks(system, h, start, steps, every, steps + 2, report)
    return finished(orbit_of(system, h, columns, 0, every, code), h, done, steps, throw)


def iterated(
    system: Any,
    h: Any,
    start: Start,
    steps: int,
    every: int,
    rows: int,
    throw: bool,
    progress: bool,
) -> Iterator[Any]:
    """Run the map from a checked start and give its orbit in blocks of this many states."""
    first = 0
    with progress_bar("steps", progress) as report:
        for columns, _, code, done in blocks(system, h, start, steps, every, rows, report):
            orbit = orbit_of(system, h, columns, first, every, code)
            first += len(columns[0])
            if len(columns[0]) or not throw:
                yield orbit
            finished(orbit, h, done, steps, throw)


def checked_block(block_steps: Any, every: int, numbers: int) -> int:
    """Return the states of a block, refused where memory cannot hold this many numbers of each."""
    where = "iterate(block_steps=...)"
    steps = _ROWS * every if block_steps is None else count(where, block_steps, "Pass the number of steps of a block.")
    if steps % every:
        raise error(where, f"be a multiple of save_every = {every}", str(steps), "Choose one.")
    within_memory(where, 8.0 * numbers * (steps // every), "Pass fewer.")
    return steps // every


def orbit_of(system: Any, h: Any, columns: list[np.ndarray], first: int, every: int, code: Any) -> Any:
    """Return states that were reached, of which the first has a number, as an orbit."""
    q, v, impulses = columns
    *displaced, momentum, energy, residual = _decoded(system, h, q, v)
    displacement, step = displaced[0] if displaced else h * v, every * np.arange(first, first + len(q))
    arrays = h * step, configurations(system, q), displacement, v, momentum, impulses, energy, residual
    return ORBITS[system.orbits](*arrays, Outcome(int(code)), system, float(h), every, step=step)


def first_state(system: Any, h: Any, q: Any, v: Any, p: Any) -> Start:
    """Return the start of `set_out`, computed."""
    return compiled.set_out(functools.partial(in_double, set_out, system, h), system, h, q, v, p)


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


def blocks(
    system: Any, h: Any, start: Start, steps: int, every: int, most: int, report: Callable[[int, int], object]
) -> Iterator[tuple[list[np.ndarray], State, Array, int]]:
    """Give configurations, velocities and impulses of `most` saved states at a time, and how the run stands after them.

    That is its state, the outcome and the good steps. The last block ends with the last state, whose impulse is not
    known.
    """
    state, sign, code = start
    started, done, given, tables = int(code == 0), 0, 0, []
    by_jax = functools.partial(in_double, _advance, system, h)
    while code == 0 and done < steps:
        left, open_rows = steps - done, most - sum(len(table[0]) for table in tables)
        rows, stride = (min(_ROWS, open_rows, left // every), every) if left >= every else (1, left)
        counts = (np.int64(rows), np.int64(stride))
        taken, state, code, table = compiled.advance(by_jax, system, h, state, sign, *counts)
        begun = min(rows, int(taken) // stride + 1)
        tables.append([column[:begun] for column in table])
        done += int(taken)
        report(done, steps)
        if code == 0 and begun == open_rows and done % every == 0:
            yield _joined(tables), state, code, done
            given, tables = given + most, []
    kept = started * (1 + done // every - given)
    last = [np.asarray(state[0])[None], np.asarray(state[1])[None], np.empty((0, system.constraints))]
    q, v, impulses = _joined([*tables, last])
    yield [q[:kept], v[:kept], impulses[: max(kept - 1, 0)]], state, code, done


def _joined(tables: list[list[np.ndarray]]) -> list[np.ndarray]:
    return [np.concatenate(column) for column in zip(*tables, strict=True)]


def _decoded(system: Any, h: Any, q: np.ndarray, v: np.ndarray) -> list[np.ndarray]:
    """Return displacements, momenta, energies and residuals of all saved states, by JAX in blocks of one size."""
    columns = compiled.decoded(_decode, system, h, q, v)
    if columns is not None:
        return columns
    blocks = max(1, -(-len(q) // _ROWS))
    padded = [np.concatenate([x, np.zeros((blocks * _ROWS - len(x), *x.shape[1:]))]) for x in (q, v)]
    for x in padded:
        x[len(q) :] = x[len(q) - 1] if len(q) else 0.0
    parts = [
        in_double(_decode_all, system, h, *(x[i * _ROWS : (i + 1) * _ROWS] for x in padded)) for i in range(blocks)
    ]
    return [np.concatenate(column)[: len(q)] for column in zip(*parts, strict=True)]


def _decode_all(system: Any, h: Array, q: Array, v: Array) -> tuple[Array, ...]:
    return jax.vmap(functools.partial(_decode, system, h))(q, v)


def _decode(system: Any, h: Array, q: Array, v: Array, *node: Array) -> tuple[Array, ...]:
    equations = equations_of(system)
    residual = jnp.max(jnp.abs(equations.discrete_constraints(system, q, v, h)), initial=0.0)
    momentum, energy = equations.momenta(system, q, v, h)[0], equations.discrete_energy(system, q, v, h, *node)
    return *equations.displaced(system, v, h), momentum, energy, residual
