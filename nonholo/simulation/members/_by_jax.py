"""The loop over members by JAX: the same scalar functions as the compiled one, mapped over whole arrays and scanned.

It takes certain steps alone. A member with a root that is not certain to be the principal one is left to the compiled
loop, from its start. Processors take the members in chunks that stay in their caches, accelerators all at once.
"""

import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo import kernels
from nonholo.discrete.definition import in_double

Starts = tuple[np.ndarray, np.ndarray]  # scaled momenta and poses
State = tuple[jax.Array, ...]  # momenta, compensations, three charts (2, n) each, pose (4, n), who is certain (n,)


def chunk() -> int | None:
    """Return how many members to run at once; None for all."""
    return 4096 if jax.default_backend() == "cpu" else None


def advance_by_jax(
    body: kernels.Body, axes: kernels.MemberAxes, starts: Starts, steps: int, every: int, rows: kernels.MemberRows
) -> np.ndarray:
    """Take steps as `kernels.advance_members` does, with fields of the body that are arrays; tell who was uncertain."""
    save_count = steps // every if every else 1
    each = every or steps
    run = functools.partial(_run, how=(save_count, rows.poses.shape[1] > 0, axes[1:]))
    numbers = (x.T for x in (axes.numbers, *starts))
    first, history, certain = in_double(run, body, *numbers, (each, steps - save_count * each))
    for target, start, later in zip(rows[:3], first, history, strict=True):
        if every and target.shape[1]:
            target[:, 0] = start.T
        if target.shape[1]:
            target[:, 1 if every else 0 :] = np.moveaxis(later, (0, 2), (1, 0))
    rows.counts[:] = steps
    return ~certain


@functools.partial(jax.jit, static_argnames=("how",))
def _run(
    body: kernels.Body, axes: jax.Array, m: jax.Array, q: jax.Array, paces: tuple[Any, Any], *, how: tuple[Any, ...]
) -> tuple[State, State, jax.Array]:
    """Return the first states, the saved ones, and which members were certain all the time."""
    (save_count, with_poses, turns), (each, rest) = how, paces
    y, certain = _root(body, m, jnp.zeros_like(m))
    state = (m, jnp.zeros_like(m), y, y, y, q, certain)
    step = functools.partial(_step, body, with_poses)

    def row_of(state: State) -> State:
        numbers = jnp.stack(kernels.canonical((*state[0], *state[2], *state[5]), tuple(axes), *turns))
        return numbers[:2], numbers[2:4], numbers[4:]

    def stretch(state: State, _: None) -> tuple[State, State]:
        state = jax.lax.fori_loop(0, each, step, state)
        return state, row_of(state)

    start = row_of(state)
    state, history = jax.lax.scan(stretch, state, None, length=save_count)
    state = jax.lax.fori_loop(0, rest, step, state)
    return start, history, state[-1]


def _step(body: kernels.Body, with_poses: bool, _: jax.Array, state: State) -> State:
    m, k, y, u, v, q, certain = state
    n, error = _add(m, k, jnp.stack(kernels.increment(body, *m, *y)))
    w, sure = _root(body, n, 3 * (y - u) + v)
    if with_poses:
        q = jnp.stack(kernels.move(body, *y, *q))
    certain = certain & sure
    rest = (jnp.where(certain, x, 0.0) for x in (n, error, w, y, u))  # a lost member costs no further corrections
    return *rest, q, certain


def _add(total: jax.Array, error: jax.Array, term: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Add as the compiled loop does, each momentum measured by the other one."""
    term = term - error
    result = total + term
    small = jnp.abs(result) < kernels.SETTLED * jnp.abs(total[::-1])
    is_zero = small & ((jnp.abs(result) < jnp.abs(total)) | (total == 0))
    return jnp.where(is_zero, 0.0, result), jnp.where(is_zero, 0.0, (result - total) - term)


def _root(body: kernels.Body, m: jax.Array, guess: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Correct guesses until all have converged or it takes too long; return which are certain."""

    def correct(carry: tuple[jax.Array, jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array, jax.Array]:
        count, y, further = carry
        d = jnp.stack(kernels.correction(body, *m, *y))
        y = jnp.where(further, y + d, y)
        return count + 1, y, further & ~kernels.converged(*d, *y)

    begin = jnp.asarray(0), guess, jnp.ones(m.shape[1], dtype=bool)
    _, y, further = jax.lax.while_loop(lambda c: (c[0] < kernels.CORRECTIONS) & c[2].any(), correct, begin)
    return y, ~further & kernels.is_certain(body, *m, *y)
