"""Ordinary differential equations by DOP853, compiled: every requested time is stepped to.

The formulas of order 8 with their two estimates of the error are those of Dormand and Prince, the choice of steps that
of Hairer, Norsett and Wanner, Solving ordinary differential equations I, section II.10; scipy holds the coefficients.
Interpolated output would be much less accurate than the steps.
"""

import functools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba.extending import overload

from nonholo.base.compiled import njit
from nonholo.base.types import Float
from nonholo.kernels._scalar import COMPILED
from nonholo.kernels._small import assign

_ATTEMPTS = 10_000  # of steps between two looks at the keyboard
_SMALLEST_STEP = 1e-13  # of an interval; below it a solve is given up
_SAFETY, _SLOWEST, _FASTEST = 0.9, 0.2, 10.0  # of the change from one step to the next

RATES: dict[type, Callable[..., None]] = {}
"""Compiled function of a motion, time, state and the row it writes the rate to, by the type of the motion."""


class Tables(NamedTuple):
    """Coefficients: of the stages (13, 12), the last of which is the result; the nodes and both estimates (13,)."""

    stages: np.ndarray
    nodes: np.ndarray
    third: np.ndarray
    fifth: np.ndarray


@functools.cache
def tables() -> Tables:
    """Return the coefficients, which scipy holds; its integrators load slowly."""
    from scipy.integrate import DOP853

    return Tables(np.vstack([DOP853.A, DOP853.B]), np.append(DOP853.C, 1.0), DOP853.E3, DOP853.E5)


def solve(
    motion: Any, start: Float[np.ndarray, "size"], times: Float[np.ndarray, "K"], tolerances: tuple[float, float]
) -> Float[np.ndarray, "reached size"]:
    """Return the states at the times, which rise or fall, up to the first that the tolerances do not let be reached."""
    rows = np.empty((len(times), len(start)))
    rows[0] = start
    state, place = start.copy(), np.array([0.0, np.diff(times)[:1].sum()])
    reached, going = 1, True
    while going and reached < len(times):
        reached, going = advance(motion, tables(), times, tolerances, reached, state, place, rows)
    return rows[:reached]


def rate(motion: Any, time: float, state: np.ndarray, out: np.ndarray) -> None:
    """Write the rate of change of a state."""
    RATES[type(motion)](motion, time, state, out)


@overload(rate, jit_options=COMPILED, strict=False)
def _choose_rate(motion: Any, *_: Any) -> Any:
    function = RATES[motion.instance_class]
    return lambda motion, time, state, out: function(motion, time, state, out)


@njit(nogil=True, **COMPILED)
def advance(
    motion: Any,
    t: Tables,
    times: np.ndarray,
    tolerances: tuple[float, float],
    reached: int,
    state: np.ndarray,
    place: np.ndarray,
    rows: np.ndarray,
) -> tuple[int, bool]:
    """Try some steps; return how many rows are filled and whether the tolerances could be met.

    `place` holds the time since the last row, where `state` is, and the next step.
    """
    since, step = place[0], place[1]
    stages, trial = np.empty((13, len(state))), np.empty_like(state)
    first, rejected = 0, False
    for _ in range(_ATTEMPTS):
        span = times[reached] - times[reached - 1]
        last = not abs(step) < abs(span - since)
        taken = span - since if last else step
        _attempt(motion, t, times[reached - 1] + since, taken, state, first, stages, trial)
        factor, good = _verdict(_miss(t, taken, state, stages, trial, tolerances))
        first = 1
        if good:
            if rejected:
                factor = min(factor, 1.0)
            # a step cut short of the requested time may tell no more than that a longer one is allowed
            step = step if last and factor == _FASTEST and abs(step) > abs(_FASTEST * taken) else factor * taken
            since += taken
            assign(state, trial)
            assign(stages[0], stages[12])
        else:
            step = factor * taken
        rejected = not good
        if rejected and abs(step) < _SMALLEST_STEP * abs(span):
            return reached, False
        if good and last:
            assign(rows[reached], state)
            reached, since = reached + 1, 0.0
            if reached == len(times):
                break
    place[0], place[1] = since, step
    return reached, True


@njit(**COMPILED)
def _attempt(
    motion: Any,
    t: Tables,
    time: float,
    step: float,
    state: np.ndarray,
    first: int,
    stages: np.ndarray,
    trial: np.ndarray,
) -> None:
    """Write the rates of a step, from the first one that is not known, and the state after it to `trial`."""
    for stage in range(first, 13):
        _combine(t.stages[stage], stage, step, state, stages, trial)
        rate(motion, time + t.nodes[stage] * step, trial, stages[stage])


@njit(**COMPILED)
def _verdict(miss: float) -> tuple[float, bool]:
    """Return the factor of the next step and whether the error of this one is allowed."""
    if not math.isfinite(miss):
        return _SLOWEST, False
    factor = _FASTEST if miss == 0 else _SAFETY / math.sqrt(math.sqrt(math.sqrt(miss)))
    return min(max(factor, _SLOWEST), _FASTEST), miss < 1


@njit(**COMPILED)
def _combine(
    weights: np.ndarray, count: int, step: float, state: np.ndarray, stages: np.ndarray, trial: np.ndarray
) -> None:
    """Write the state advanced by a weighted sum of the first rates."""
    for i in range(len(state)):
        total = 0.0
        for stage in range(count):
            total += weights[stage] * stages[stage, i]
        trial[i] = state[i] + step * total


@njit(**COMPILED)
def _miss(
    t: Tables,
    step: float,
    state: np.ndarray,
    stages: np.ndarray,
    trial: np.ndarray,
    tolerances: tuple[float, float],
) -> float:
    """Return the estimated error of a step, one if it is as large as allowed."""
    relative, absolute = tolerances
    fifth, third = 0.0, 0.0
    for i in range(len(state)):
        five, three = 0.0, 0.0
        for stage in range(13):
            five += t.fifth[stage] * stages[stage, i]
            three += t.third[stage] * stages[stage, i]
        scale = absolute + relative * max(abs(state[i]), abs(trial[i]))
        five, three = five / scale, three / scale
        fifth += five * five
        third += three * three
    if fifth == 0:
        return 0.0 if third == 0 else 0.0 * third
    return abs(step) * fifth / math.sqrt((fifth + 0.01 * third) * len(state))
