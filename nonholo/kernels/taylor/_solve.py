"""One motion by Taylor series, or many, as many as there are lanes at a time.

Steps do not depend on the times that are asked for, which are read from the series. What rounding takes from state and
time is carried along (Kahan). A lane whose motion has reached its last time takes the next one; each motion takes the
steps that it would take alone, with the same bits.
"""

import math
from typing import Any

import numpy as np

from nonholo.base.compiled import njit
from nonholo.base.progress import tell
from nonholo.base.types import Bool, Float, Int
from nonholo.kernels._scalar import COMPILED, scalar
from nonholo.kernels._small import assign, assign_rows
from nonholo.kernels.lanes import EIGHT, ONE, load, spread, store
from nonholo.kernels.taylor._expansion import (
    Quadratic,
    Room,
    expand,
    expansion_of,
    kept_room,
    make_room,
    sparse_products,
)
from nonholo.kernels.taylor._steps import order_for, write_steps

_FIRST, _STEPS = 64, 2048  # between two looks at the keyboard: at first, and at most
_NUMBERS = 1 << 24  # in the nodes of a solve, 128 MiB
_SMALLEST_STEP = 1e-13  # of an interval between requested times; below it a solve is given up


def solve_series(
    f: Quadratic,
    start: Float[np.ndarray, "size"],
    times: Float[np.ndarray, "K"],
    tolerance: float,
    most: float = math.inf,
    expansion: int = 0,
) -> tuple[Float[np.ndarray, "reached size"], Float[np.ndarray, "steps 2 state"]]:
    """Return the states at the times, which rise or fall, up to the first that cannot be reached, and the nodes.

    Nodes are the beginnings of steps: the state and its time, above what rounding took from them. When they fill much
    memory every second one is left out. The solve ends early if at the rate of the steps so far it needs more than
    `most` of them. The coefficients are written by the code at an address: by default that of the structure.
    """
    rows = np.empty((len(times), len(start)))
    rows[0] = start
    state = np.zeros((2, len(start) + 1))
    state[0, :-1], state[0, -1] = start[f.order], times[0]
    longest = max(16, min(_STEPS, _NUMBERS // (8 * state.size)))
    block, nodes = min(_FIRST, longest), []
    count, going, stride, total, node_count = 1, True, 1, 0, 0
    room, expansion = kept_room(f, order_for(tolerance)), expansion or expansion_of(f, ONE)
    while going and count < len(times):
        starts, block = np.empty((block, *state.shape)), min(8 * block, longest)
        count, steps, going = advance(f, times, tolerance, count, state, rows, starts, room, expansion)
        nodes.append(starts[-total % stride : steps : stride].copy())
        total, node_count = total + steps, node_count + len(nodes[-1])
        if node_count * state.size > max(_NUMBERS, 2 * state.size):
            nodes, stride = [np.concatenate(nodes)[::2].copy()], 2 * stride
            node_count = len(nodes[0])
        come = max(abs(state[0, -1] - times[0]), abs(times[count - 1] - times[0]))
        tell(come, abs(times[-1] - times[0]))
        if total * abs(times[-1] - times[0]) / most > come:
            break
    return rows[:count], np.concatenate(nodes) if len(nodes) > 1 else nodes[0] if nodes else state[None]


def revisit_series(
    f: Quadratic,
    nodes: Float[np.ndarray, "steps 2 state"],
    times: Float[np.ndarray, "K"],
    end: float,
    tolerance: float,
    expansion: int = 0,
) -> Float[np.ndarray, "K size"]:
    """Return the states at times in the order of the nodes, the bits as if they had been requested with `end`."""
    rows, room = np.empty((len(times), len(f.blocks))), kept_room(f, order_for(tolerance))
    expansion = expansion or expansion_of(f, ONE)
    revisit(f, nodes, times, np.array([end]), tolerance, nodes[0].copy(), rows, room, expansion)
    return rows


@njit(nogil=True, _nrt=False, **COMPILED)
def advance(
    f: Quadratic,
    times: np.ndarray,
    tolerance: float,
    count: int,
    state: np.ndarray,
    rows: np.ndarray,
    nodes: np.ndarray,
    room: Room,
    expansion: int,
) -> tuple[int, int, bool]:
    """Take a step from each node, which is written; return how many rows and nodes are filled and whether one failed.

    `state` holds x and time, and what rounding took from them.
    """
    going, at = True, 0
    while at < len(nodes) and going and count < len(times):
        assign_rows(nodes[at], state)
        at += 1
        expand(f, expansion, state, room, ONE)
        write_steps(f, state, times[-1:], tolerance, room, ONE)
        count, going = read(f, room, state, times, 1.0, count, rows, 0, ONE)
        if going and count < len(times):
            room.steps[0, 0] = math.copysign(room.steps[0, 0], times[-1] - times[0])
            move(f, room, state, ONE)
    return count, at, going


@njit(nogil=True, _nrt=False, **COMPILED)
def revisit(
    f: Quadratic,
    nodes: np.ndarray,
    times: np.ndarray,
    ends: np.ndarray,
    tolerance: float,
    state: np.ndarray,
    rows: np.ndarray,
    room: Room,
    expansion: int,
) -> None:
    """Write the states at times in the order of the nodes."""
    at, direction = -1, math.copysign(1.0, ends[0] - nodes[0, 0, -1])
    for i in range(len(times)):
        after = max(at, 0)
        while after + 1 < len(nodes) and direction * since(nodes[after + 1], times[i], 0, ONE) > 0:
            after += 1
        if after != at:
            at = after
            assign_rows(state, nodes[at])
            expand(f, expansion, state, room, ONE)
            write_steps(f, state, ends, tolerance, room, ONE)
        while abs(since(state, times[i], 0, ONE)) > room.steps[0, 0]:  # nodes between were left out
            room.steps[0, 0] *= direction
            move(f, room, state, ONE)
            expand(f, expansion, state, room, ONE)
            write_steps(f, state, ends, tolerance, room, ONE)
        evaluate(f, room, since(state, times[i], 0, ONE), state, rows[i], 0, ONE)


@scalar
def since(state: np.ndarray, time: float, lane: int, lanes: tuple[int, ...]) -> float:
    """Return how long after the state of a lane a time is."""
    at = state.shape[1] - len(lanes) + lane
    return time - state[0, at] - state[1, at]


@scalar
def read(
    f: Quadratic,
    room: Room,
    state: np.ndarray,
    times: np.ndarray,
    unit: Any,
    count: Any,
    rows: np.ndarray,
    lane: int,
    lanes: tuple[int, ...],
) -> tuple[int, bool]:
    """Write the rows whose times lie within the step of a lane; return how many are filled, and whether all went well.

    Times are in other units than the state's: `unit` is the factor to them.
    """
    step = room.steps[0, lane]
    going = step > _SMALLEST_STEP * unit * abs(times[count] - times[count - 1])
    while going and count < len(times) and abs(since(state, times[count] * unit, lane, lanes)) <= step:
        evaluate(f, room, since(state, times[count] * unit, lane, lanes), state, rows[count], lane, lanes)
        going = _is_finite(rows[count])
        count += going
    return count, going


@scalar
def _is_finite(row: np.ndarray) -> bool:
    total = 0.0
    for x in row:
        total += x
    return math.isfinite(total)


@scalar
def evaluate(
    f: Quadratic, room: Room, time: float, state: np.ndarray, out: np.ndarray, lane: int, lanes: tuple[int, ...]
) -> None:
    """Write the state of a lane some time after the beginning of its step."""
    L, before, series, change = len(lanes), len(f.velocities), room.series, room.change
    order = len(series) - 1
    if L == 1:
        _sum(series, before // len(EIGHT), spread(time, EIGHT), change)
    else:
        for m in range(before, before + len(out)):
            total = series[order, m * L + lane]
            for j in range(order - 1, 0, -1):
                total = total * time + series[j, m * L + lane]
            change[0, m * L + lane] = total * time
    for m in range(len(out)):
        out[f.order[m]] = state[0, m * L + lane] + (change[0, (before + m) * L + lane] + state[1, m * L + lane])


@scalar
def move(f: Quadratic, room: Room, state: np.ndarray, lanes: tuple[int, ...]) -> None:
    """Carry states and times of all lanes to the ends of their steps."""
    size, before, change, step = len(f.blocks), len(f.velocities), room.change, load(room.steps, 0, 0, lanes)
    _sum(room.series, before // len(EIGHT) if len(lanes) == 1 else before, spread(step, EIGHT), change)
    for m in range(size):
        _add(state, m, load(change, 0, before + m, lanes), lanes)
    _add(state, size, step, lanes)


@scalar
def _sum(series: np.ndarray, first: int, time: Any, change: np.ndarray) -> None:
    """Write what the terms of the series beyond the first add up to, eight of them side by side."""
    order = len(series) - 1
    for m in range(first, series.shape[1] // len(EIGHT)):
        total = load(series, order, m, EIGHT)
        for j in range(order - 1, 0, -1):
            total = total * time + load(series, j, m, EIGHT)
        store(change, 0, m, EIGHT, total * time)


@scalar
def _add(state: np.ndarray, m: int, term: Any, lanes: tuple[int, ...]) -> None:
    """Add a term to a number, and keep what rounding took from it."""
    before = load(state, 0, m, lanes)
    term = term + load(state, 1, m, lanes)
    after = before + term
    store(state, 0, m, lanes, after)
    store(state, 1, m, lanes, term - (after - before))


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
    counts, L = np.zeros(len(starts), dtype=np.int64), len(EIGHT)
    wide, size = f._replace(velocities=np.tile(f.velocities, L), factors=np.tile(f.factors, L)), starts.shape[1]
    wide = wide._replace(**one_by_one(f.rows, f.sources))
    room, state, ends = make_room(wide, order_for(tolerance), EIGHT), np.zeros((2, (size + 1) * L)), np.zeros(L)
    members, expansion = np.full(L, -1), expansion_of(wide, EIGHT)
    _advance_members(
        wide, *numbers, starts, *times, tolerance, rows, counts, stop, (state, ends, members), room, expansion
    )
    return counts


def one_by_one(rows: Int[np.ndarray, "2 R"], sources: Int[np.ndarray, "Q"]) -> dict[str, Int[np.ndarray, "..."]]:
    """Return the products one by one, not eight at a time."""
    L, products = len(EIGHT), sources < len(EIGHT) * rows.shape[1]
    velocity, eight = rows[:, sources[products] // L]
    ones, places = sparse_products(velocity, eight * L + sources[products] % L, 1)
    of_ones = sources - L * rows.shape[1] + ones.shape[1]
    of_ones[products] = places
    return {"rows": ones, "sources": of_ones}


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
    counts: np.ndarray,
    stop: np.ndarray,
    lanes: tuple[np.ndarray, np.ndarray, np.ndarray],
    room: Room,
    expansion: int,
) -> None:
    state, ends, members = lanes
    L, following, busy, looks = len(EIGHT), 0, True, 0
    direction = math.copysign(1.0, times[-1] - times[0])
    while busy:
        if looks % _LOOK == 0 and stop[0]:
            break
        looks += 1
        for lane in range(L):
            if members[lane] < 0 and following < len(starts):
                own = following if len(velocities) > 1 else 0
                span = times[0] * units[following], times[-1] * units[following]
                ends[lane] = _load(f, velocities[own], factors[own], starts[following], span, lane, state)
                assign(rows[following, 0], starts[following])
                counts[following], members[lane] = 1, following
                following += 1
        expand(f, expansion, state, room, EIGHT)
        write_steps(f, state, ends, tolerance, room, EIGHT)
        busy = following < len(starts)
        for lane in range(L):
            room.steps[0, lane] *= direction * _continue(f, room, state, times, units, lane, members, counts, rows)
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
    counts: np.ndarray,
    rows: np.ndarray,
) -> bool:
    """Write what the motion in a lane reaches in this step; tell whether it takes the step, else free the lane."""
    at, going = members[lane], members[lane] >= 0 and counts[members[lane]] < len(times)
    if going:
        counts[at], going = read(f, room, state, times, units[at], counts[at], rows[at], lane, EIGHT)
    if going and counts[at] < len(times):
        return True
    members[lane], room.steps[0, lane] = -1, 0.0
    return False
