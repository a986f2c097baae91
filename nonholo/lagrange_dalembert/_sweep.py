"""A continuous motion: diffrax's Dopri8, one solve from each requested time to the next.

Interpolated output would be much less accurate than the steps, so every requested time is stepped to. Each interval is
mapped to [0, 1]: time units and the direction of time do not matter. Imported on first use, since diffrax loads slowly.
"""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import diffrax
import jax
import numpy as np

from nonholo._checks import array, error, number, positive
from nonholo._types import Array
from nonholo.lagrange_dalembert._precision import in_double

_LEAST_RTOL = 1e-14
_SMALLEST_STEP = 1e-13  # of an interval; below it a solve is given up

State = tuple[Array, Array]
"""Configuration and velocity."""


class Motion(NamedTuple):
    """What a solve needs: the rate of change of a state, and its projection to the constraint."""

    system: Any
    rate: Callable[[Any, State], State]
    projected: Callable[[Any, State], State]


def times_of(value: Any) -> np.ndarray:
    """Return checked times of a flow."""
    where, remedy = "flow(times=...)", "Sort the times; the start is at the first."
    times = array(where, value, (None,), "Pass a sequence of times.")
    if times.size == 0:
        raise error(where, "hold at least one time", "none", "Pass the time of the start first.")
    gaps = np.diff(times)
    forward = gaps * np.sign(gaps[:1])
    if gaps.size and not forward.min() > 0:
        at = int(np.argmin(forward))
        raise error(where, "be strictly increasing or decreasing", f"{times[at + 1]} after {times[at]}", remedy)
    return times


def tolerances(rtol: Any, atol: Any) -> tuple[float, float]:
    """Return checked tolerances of a flow."""
    relative = float(number("flow(rtol=...)", rtol))
    if relative < _LEAST_RTOL:
        raise error("flow(rtol=...)", "be at least 1e-14", f"{relative:g}", "Rounding errors are as large as that.")
    return relative, float(positive("flow(atol=...)", atol, "Pass a positive absolute error."))


def padded(rows: np.ndarray) -> np.ndarray:
    """Repeat the last row until their number is one more than a power of two, so that few sizes are compiled."""
    missing = (1 << max(len(rows) - 2, 0).bit_length()) + 1 - len(rows)
    return np.concatenate([rows, np.broadcast_to(rows[-1:], (missing, *rows.shape[1:]))])


def swept(motion: Motion, first: State, time: np.ndarray, errors: tuple[float, float]) -> list[np.ndarray]:
    """Return configurations and velocities at the times, as far as the solver comes."""
    rest, good = in_double(_sweep, motion, first, padded(time), errors)
    reached = len(time) if np.all(good) else 1 + int(np.argmin(good))
    return [np.concatenate([x[None], more])[: len(time)][:reached] for x, more in zip(first, rest, strict=True)]


@functools.partial(jax.jit, static_argnums=0)
def _sweep(motion: Motion, state: State, times: Array, errors: tuple[Array, Array]) -> tuple[State, Array]:
    """Carry the state from each time to the next; return all states but the first, and which solves succeeded."""
    system = motion.system

    def scaled(fraction: Array, current: State, length: Array) -> State:
        del fraction
        return jax.tree.map(lambda x: length * x, motion.rate(system, motion.projected(system, current)))

    def advance(current: State, length: Array) -> tuple[State, tuple[State, Array]]:
        solution = diffrax.diffeqsolve(
            diffrax.ODETerm(scaled),
            diffrax.Dopri8(),
            t0=0.0,
            t1=1.0,
            dt0=1.0,
            y0=current,
            args=length,
            stepsize_controller=diffrax.PIDController(*errors, dtmin=_SMALLEST_STEP, force_dtmin=False),
            adjoint=diffrax.ForwardMode(),
            max_steps=None,
            throw=False,
        )
        following = motion.projected(system, jax.tree.map(lambda rows: rows[-1], solution.ys))
        return following, (following, solution.result == diffrax.RESULTS.successful)

    return jax.lax.scan(advance, state, times[1:] - times[:-1])[1]
