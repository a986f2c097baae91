"""Ordinary differential equations: diffrax's Dopri8, one solve from each requested time to the next.

Interpolated output would be much less accurate than the steps, so every requested time is stepped to. Each interval is
mapped to [0, 1]: time units and the direction of time do not matter. Imported on first use, since diffrax loads slowly.
"""

from collections.abc import Callable
from typing import Any

import diffrax
import jax
import numpy as np

from nonholo.base.types import Array

_FEWEST = 64  # intervals of a compiled solve; those of no length cost next to nothing
_SMALLEST_STEP = 1e-13  # of an interval; below it a solve is given up

State = tuple[Array, ...]


def pad(rows: np.ndarray) -> np.ndarray:
    """Repeat the last row until there are 65, 129, 257... rows: few sizes are compiled, and one for most flows."""
    missing = (1 << max(len(rows) - 2, _FEWEST - 1).bit_length()) + 1 - len(rows)
    return np.concatenate([rows, np.broadcast_to(rows[-1:], (missing, *rows.shape[1:]))])


def sweep(
    rate: Callable[[Array, State], State],
    settle: Callable[[State], State],
    state: State,
    times: Array,
    tolerances: tuple[Array, Array],
) -> tuple[State, Array]:
    """Carry a state from each time to the next; return all states but the first, and which solves succeeded.

    `rate` takes time and state; `settle` takes the state at the end of an interval to the one that continues.
    """

    def scaled_rate(fraction: Array, current: State, span: tuple[Array, Array]) -> State:
        time, length = span
        return jax.tree.map(lambda x: length * x, rate(time + length * fraction, current))

    def advance(current: State, span: tuple[Array, Array]) -> tuple[State, tuple[State, Array]]:
        solution = diffrax.diffeqsolve(
            diffrax.ODETerm(scaled_rate),
            diffrax.Dopri8(),
            t0=0.0,
            t1=1.0,
            dt0=1.0,
            y0=current,
            args=span,
            stepsize_controller=diffrax.PIDController(*tolerances, dtmin=_SMALLEST_STEP, force_dtmin=False),
            adjoint=diffrax.ForwardMode(),
            max_steps=None,
            throw=False,
        )
        following = settle(jax.tree.map(lambda rows: rows[-1], solution.ys))
        return following, (following, solution.result == diffrax.RESULTS.successful)

    return jax.lax.scan(advance, state, (times[:-1], times[1:] - times[:-1]))[1]


def good_rows(first: State, rest: Any, good: Any, count: int) -> list[np.ndarray]:
    """Return the rows of the first `count` states, up to the first solve that failed."""
    is_failure = ~np.asarray(good)
    count = 1 + int(np.argmax(is_failure)) if is_failure.any() else count
    return [np.concatenate([x[None], np.asarray(more)])[:count] for x, more in zip(first, rest, strict=True)]
