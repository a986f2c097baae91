"""Many motions by Taylor series, as many as there are lanes at a time.

A lane whose motion has reached its last time takes the next one. Each motion takes the steps that it would take alone,
with the same bits.
"""

import math

import numpy as np

from nonholo.base.compiled import njit
from nonholo.base.types import Bool, Float, Int
from nonholo.kernels._scalar import COMPILED, scalar
from nonholo.kernels._small import assign
from nonholo.kernels.lanes import EIGHT
from nonholo.kernels.taylor._expansion import Quadratic, Room, expand, expansion_of, make_room, sparse_products
from nonholo.kernels.taylor._solve import move, read
from nonholo.kernels.taylor._steps import order_for, write_steps

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
    reached, L = np.zeros(len(starts), dtype=np.int64), len(EIGHT)
    wide, size = f._replace(velocities=np.tile(f.velocities, L), factors=np.tile(f.factors, L)), starts.shape[1]
    wide = wide._replace(**one_by_one(f.rows, f.found))
    room, state, ends = make_room(wide, order_for(tolerance), EIGHT), np.zeros((2, (size + 1) * L)), np.zeros(L)
    members, expansion = np.full(L, -1), expansion_of(wide, EIGHT)
    _advance_members(
        wide, *numbers, starts, *times, tolerance, rows, reached, stop, (state, ends, members), room, expansion
    )
    return reached


def one_by_one(rows: Int[np.ndarray, "2 R"], found: Int[np.ndarray, "Q"]) -> dict[str, Int[np.ndarray, "..."]]:
    """Return the products one by one, not eight at a time."""
    L, products = len(EIGHT), found < len(EIGHT) * rows.shape[1]
    velocity, eight = rows[:, found[products] // L]
    ones, places = sparse_products(velocity, eight * L + found[products] % L, 1)
    of_ones = found - L * rows.shape[1] + ones.shape[1]
    of_ones[products] = places
    return {"rows": ones, "found": of_ones}


@njit(nogil=True, _nrt=False, **COMPILED)
def _advance_members(
    f: Quadratic,
    velocities: np.ndarray,
    factors: np.ndarray,
    starts: np.ndarray,
    times: np.ndarray,
    units: np.ndarray,
    tolerance: float,
    rows: np.ndarray,
    reached: np.ndarray,
    stop: np.ndarray,
    lanes: tuple[np.ndarray, np.ndarray, np.ndarray],
    room: Room,
    expansion: int,
) -> None:
    state, ends, members = lanes
    L, following, busy, looked = len(EIGHT), 0, True, 0
    direction = math.copysign(1.0, times[-1] - times[0])
    while busy:
        if looked % _LOOK == 0 and stop[0]:
            break
        looked += 1
        for lane in range(L):
            if members[lane] < 0 and following < len(starts):
                own = following if len(velocities) > 1 else 0
                span = times[0] * units[following], times[-1] * units[following]
                ends[lane] = _load(f, velocities[own], factors[own], starts[following], span, lane, state)
                assign(rows[following, 0], starts[following])
                reached[following], members[lane] = 1, following
                following += 1
        expand(f, expansion, state, room, EIGHT)
        write_steps(f, state, ends, tolerance, room, EIGHT)
        busy = following < len(starts)
        for lane in range(L):
            room.steps[0, lane] *= direction * _continue(f, room, state, times, units, lane, members, reached, rows)
            busy |= members[lane] >= 0
        move(f, room, state, EIGHT)


@scalar
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
    L, size = len(EIGHT), len(start)
    for a in range(len(velocities)):
        for i in range(len(velocities)):
            f.velocities[a, i * L + lane] = velocities[a, i]
    for i in range(len(factors)):
        f.factors[0, i * L + lane] = factors[i]
    for m in range(size):
        state[0, m * L + lane], state[1, m * L + lane] = start[f.order[m]], 0.0
    state[0, size * L + lane], state[1, size * L + lane] = span[0], 0.0
    return span[1]


@scalar
def _continue(
    f: Quadratic,
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
        reached[at], going = read(f, room, state, times, units[at], reached[at], rows[at], lane, EIGHT)
    if going and reached[at] < len(times):
        return True
    members[lane], room.steps[0, lane] = -1, 0.0
    return False
