"""Many motions by Taylor series, as many as there are lanes at a time.

A lane whose motion has reached its last time takes the next one. Each motion takes the steps that it would take alone,
with the same bits.
"""

import math

import numpy as np

from nonholo.base.compiled import njit
from nonholo.base.types import Bool, Float, Int
from nonholo.kernels._scalar import COMPILED
from nonholo.kernels._taylor import Quadratic, Room, make_room, move, order_for, prepare, read

_LANES = (0,) * 8
_LOOK = 64  # steps between two looks at whether to stop


def solve_members(
    f: Quadratic,
    numbers: tuple[Float[np.ndarray, "m k k"], Float[np.ndarray, "m Q"]],
    starts: Float[np.ndarray, "M size"],
    times: tuple[Float[np.ndarray, "K"], Float[np.ndarray, "M"]],
    tolerance: float,
    rows: Float[np.ndarray, "M K size"],
    stop: Bool[np.ndarray, "1"],
) -> Int[np.ndarray, "M"]:
    """Write the states of members at the times, up to the first that cannot be reached; return how many each has.

    Args:
        f: Equations of all members, with a constraint fixed in the body.
        numbers: Velocities and factors of each member, or with an axis of length 1 those of all.
        starts: First states.
        times: Requested times, which rise or fall, and the factor of each member to them.
        tolerance: Of a step.
        rows: Where the states go; the others are left as they are.
        stop: Ends the work when it becomes true.
    """
    reached, used = np.zeros(len(starts), dtype=np.int64), f.products.max(initial=-1) + 1
    spread = f._replace(left=f.left[:used], right=f.right[:used], velocities=np.tile(f.velocities, len(_LANES)))
    spread = spread._replace(factors=np.zeros(len(f.factors) * len(_LANES)))
    _advance_members(spread, *numbers, starts, *times, order_for(tolerance), tolerance, rows, reached, stop)
    return reached


@njit(nogil=True, **COMPILED)
def _advance_members(
    f: Quadratic,
    velocities: np.ndarray,
    factors: np.ndarray,
    starts: np.ndarray,
    times: np.ndarray,
    units: np.ndarray,
    order: int,
    tolerance: float,
    rows: np.ndarray,
    reached: np.ndarray,
    stop: np.ndarray,
) -> None:
    L, following = len(_LANES), 0
    room, state, ends = make_room(f, order, _LANES), np.zeros((2, (starts.shape[1] + 1) * L)), np.zeros(L)
    members, direction, looked = np.zeros(L, np.int64) - 1, math.copysign(1.0, times[-1] - times[0]), 0
    while following < len(starts) or members.max() >= 0:
        if looked % _LOOK == 0 and stop[0]:
            break
        looked += 1
        for lane in range(L):
            if members[lane] < 0 and following < len(starts):
                own = following if len(velocities) > 1 else 0
                span = times[0] * units[following], times[-1] * units[following]
                ends[lane] = _load(f, velocities[own], factors[own], starts[following], span, lane, state)
                rows[following, 0], reached[following], members[lane] = starts[following], 1, following
                following += 1
        prepare(f, state, order, tolerance, ends, room, _LANES)
        for lane in range(L):
            room.steps[lane] *= direction * _continue(room, state, times, units, lane, members, reached, rows)
        move(room.series, room.steps, state, _LANES)


@njit(inline="always", **COMPILED)
def _load(
    f: Quadratic,
    velocities: np.ndarray,
    factors: np.ndarray,
    start: np.ndarray,
    span: tuple[float, float],
    lane: int,
    state: np.ndarray,
) -> float:
    """Give a lane to a motion: its numbers, its first state and time; return its last time."""
    L, size = len(_LANES), len(start)
    for a in range(len(velocities)):
        for i in range(len(velocities)):
            f.velocities[a, i * L + lane] = velocities[a, i]
    for i in range(len(factors)):
        f.factors[i * L + lane] = factors[i]
    for m in range(size):
        state[0, m * L + lane], state[1, m * L + lane] = start[m], 0.0
    state[0, size * L + lane], state[1, size * L + lane] = span[0], 0.0
    return span[1]


@njit(inline="always", **COMPILED)
def _continue(
    room: Room,
    state: np.ndarray,
    times: np.ndarray,
    units: np.ndarray,
    lane: int,
    members: np.ndarray,
    reached: np.ndarray,
    rows: np.ndarray,
) -> bool:
    """Write what the motion in a lane reaches in this step; tell whether it takes the step, else free the lane."""
    at, going = members[lane], members[lane] >= 0 and reached[members[lane]] < len(times)
    if going:
        reached[at], going = read(room, state, times, units[at], reached[at], rows[at], lane, _LANES)
    if going and reached[at] < len(times):
        return True
    members[lane], room.steps[lane] = -1, 0.0
    return False
