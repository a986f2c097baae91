"""Runs of any step in compiled blocks: one size of table, one compilation."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import step_counts
from nonholo.base.limits import within_a_year, within_memory
from nonholo.base.progress import progress_bar
from nonholo.base.types import Array
from nonholo.lagrange_dalembert._precision import in_double

_ROWS = 1024  # saved states of one block
_LEAST = 1e-6  # seconds of a step, at least

State = tuple[Array, Array, Array]
"""Configuration, velocity of its step, velocity of the step before."""

Step = Callable[[Any, Array, State, Array], tuple[State, Array, Array]]
"""Maps a system, h, a state and an orientation to the next state, the impulses and the outcome."""


def checked_counts(steps: Any, save_every: Any, numbers: int) -> tuple[int, int]:
    """Return numbers of steps, refused where memory cannot hold this many numbers of each saved state, or in a year."""
    steps, every = step_counts(steps, save_every)
    within_a_year("simulate(steps=...)", _LEAST * steps, "Pass fewer steps, or a larger time_step.")
    within_memory("simulate(steps=...)", 8.0 * numbers * (1 + steps // every), "Raise save_every.")
    return steps, every


@functools.partial(jax.jit, static_argnums=(0, 1))
def _advance(step: Step, system: Any, h: Array, state: State, sign: Array, rows: Array, every: Array) -> tuple:
    """Run `rows` times `every` steps; return the states before each row, the first impulse of each row, and the end."""
    s = system.constraints

    def one(carry: tuple) -> tuple:
        done, current, impulse, _ = carry
        following, multipliers, code = step(system, h, current, sign)
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


def run(
    step: Step,
    system: Any,
    h: Any,
    start: tuple[State, Array, Array],
    steps: int,
    every: int,
    progress: bool,
) -> tuple[list[np.ndarray], Array, int]:
    """Return configurations, velocities and impulses of the saved states, the outcome and the number of good steps.

    The start is a state, the orientation to keep and the outcome so far.
    """
    state, sign, code = start
    done, blocks = 0, []
    with progress_bar("steps", progress) as report:
        while code == 0 and done < steps:
            left = steps - done
            rows, stride = (min(_ROWS, left // every), every) if left >= every else (1, left)
            counts = (np.int64(rows), np.int64(stride))
            taken, state, code, table = in_double(_advance, step, system, h, state, sign, *counts)
            begun = min(rows, int(taken) // stride + 1)
            blocks.append([column[:begun] for column in table])
            done += int(taken)
            report(done, steps)
    kept = 1 + done // every if blocks else 0
    last = [np.asarray(state[0])[None], np.asarray(state[1])[None], np.empty((0, system.constraints))]
    columns = [np.concatenate(column)[:kept] for column in zip(*blocks, last, strict=True)]
    return [*columns[:2], columns[2][: max(kept - 1, 0)]], code, done


def decoded(decode: Callable[..., Any], system: Any, h: Any, q: np.ndarray, v: np.ndarray) -> list[np.ndarray]:
    """Return what a compiled function makes of all saved states, in blocks of one size."""
    blocks = max(1, -(-len(q) // _ROWS))
    padded = [np.concatenate([x, np.zeros((blocks * _ROWS - len(x), *x.shape[1:]))]) for x in (q, v)]
    for x in padded:
        x[len(q) :] = x[len(q) - 1] if len(q) else 0.0
    parts = [in_double(decode, system, h, *(x[i * _ROWS : (i + 1) * _ROWS] for x in padded)) for i in range(blocks)]
    return [np.concatenate(column)[: len(q)] for column in zip(*parts, strict=True)]
