"""One motion by Taylor series, or many, as many as there are lanes at a time.

Steps do not depend on the times that are asked for, which are read from the series. What rounding takes from state and
time is carried along (Kahan). A lane whose motion has reached its last time takes the next one; each motion takes the
steps that it would take alone, with the same bits.
"""

import math
from typing import Any, TypeAlias

import numpy as np

from nonholo.base.compiled import njit
from nonholo.base.progress import tell
from nonholo.base.types import Bool, Float, Int
from nonholo.kernels._scalar import COMPILED, scalar
from nonholo.kernels._small import assign_rows
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

Columns: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray]
"""A row for each state in three parts: places, headings, and what moves them."""

_FIRST, _STEPS = 64, 2048  # between two looks at the keyboard: at first, and at most
_NUMBERS = 1 << 24  # in the nodes of a solve, 128 MiB
_SMALLEST_STEP = 1e-13  # of an interval between requested times; below it a solve is given up


def solve_series(
    f: Quadratic,
    parts: Columns,
    times: Float[np.ndarray, "K"],
    tolerance: float,
    most: float = math.inf,
    expansion: int = 0,
) -> tuple[Columns, Float[np.ndarray, "steps 2 state"]]:
    """Return the states at the times, which rise or fall, up to the first that cannot be reached, and the nodes.

    States come in the three parts of the first one. Nodes are the beginnings of steps: the state and its time, above
    what rounding took from them. When they fill much memory every second one is left out. The solve ends early if at
    the rate of the steps so far it needs more than `most` of them. The coefficients are written by the code at an
    address: by default that of the structure.
    """
    columns = _columns(len(times), *map(len, parts))
    for column, part in zip(columns, parts, strict=True):
        column[0] = part
    state = np.zeros((2, len(f.order) + 1))
    state[0, :-1], state[0, -1] = np.concatenate(parts)[f.order], times[0]
    longest = max(16, min(_STEPS, _NUMBERS // (8 * state.size)))
    block, nodes = min(_FIRST, longest), []
    count, going, stride, total, node_count = 1, True, 1, 0, 0
    begin, span = float(times[0]), float(abs(times[-1] - times[0]))
    room, expansion = kept_room(f, order_for(tolerance)), expansion or expansion_of(f, ONE)
    while going and count < len(times):
        starts, block = np.empty((block, *state.shape)), min(8 * block, longest)
        count, steps, going = advance(f, times, tolerance, count, state, columns, starts, room, expansion)
        nodes.append(starts[-total % stride : steps : stride].copy())
        total, node_count = total + steps, node_count + len(nodes[-1])
        if node_count * state.size > max(_NUMBERS, 2 * state.size):
            nodes, stride = [np.concatenate(nodes)[::2].copy()], 2 * stride
            node_count = len(nodes[0])
        come = max(abs(float(state[0, -1]) - begin), abs(float(times[count - 1]) - begin))
        tell(come, span)
        if total * span / most > come:
            break
    nodes = np.concatenate(nodes) if len(nodes) > 1 else nodes[0] if nodes else state[None]
    return (columns[0][:count], columns[1][:count], columns[2][:count]), nodes


def _columns(count: int, place: int, heading: int, head: int) -> Columns:
    """Return room for states in three parts, side by side: of one large array few pages are touched first."""
    room, first, second = np.empty(count * (place + heading + head)), count * place, count * (place + heading)
    parts = room[:first].reshape(count, place), room[first:second].reshape(count, heading)
    return *parts, room[second:].reshape(count, head)


def revisit_series(
    f: Quadratic,
    nodes: Float[np.ndarray, "steps 2 state"],
    widths: tuple[int, int, int],
    times: Float[np.ndarray, "K"],
    end: float,
    tolerance: float,
    expansion: int = 0,
) -> Columns:
    """Return the states at times in the order of the nodes, the bits as if they had been requested with `end`."""
    columns, room = _columns(len(times), *widths), kept_room(f, order_for(tolerance))
    expansion = expansion or expansion_of(f, ONE)
    revisit(f, nodes, times, np.array([end]), tolerance, nodes[0].copy(), columns, room, expansion)
    return columns


@njit(nogil=True, _nrt=False, **COMPILED)
def advance(
    f: Quadratic,
    times: np.ndarray,
    tolerance: float,
    count: int,
    state: np.ndarray,
    columns: Columns,
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
        going = room.steps[0, 0] > _SMALLEST_STEP * abs(times[count] - times[count - 1])
        if going:
            count, going = read(f, room, state, times, 1.0, count, 0, columns, 0, 0, ONE)
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
    columns: Columns,
    room: Room,
    expansion: int,
) -> None:
    """Write the states at times in the order of the nodes."""
    at, count, direction = -1, 0, math.copysign(1.0, ends[0] - nodes[0, 0, -1])
    while count < len(times):
        after = max(at, 0)
        while after + 1 < len(nodes) and direction * since(nodes[after + 1], times[count], 0, ONE) > 0:
            after += 1
        if after != at:
            at = after
            assign_rows(state, nodes[at])
            expand(f, expansion, state, room, ONE)
            write_steps(f, state, ends, tolerance, room, ONE)
        while abs(since(state, times[count], 0, ONE)) > room.steps[0, 0]:  # nodes between were left out
            room.steps[0, 0] *= direction
            move(f, room, state, ONE)
            expand(f, expansion, state, room, ONE)
            write_steps(f, state, ends, tolerance, room, ONE)
        count, going = read(f, room, state, times, 1.0, count, 1, columns, 0, 0, ONE)
        count += not going


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
    least: int,
    columns: Columns,
    first: Any,
    lane: int,
    lanes: tuple[int, ...],
) -> tuple[int, bool]:
    """Write the rows, from `first` on, of times within the step of a lane, and at least some more than are there.

    Times are in other units than the state's: `unit` is the factor to them. Return how many rows are good, up to one
    that is not finite, and whether all are.
    """
    end, going = count + least, True
    while end < len(times) and abs(since(state, times[end] * unit, lane, lanes)) <= room.steps[0, lane]:
        end += 1
    while going and count < end:
        rows, good = min(room.ahead.shape[1], end - count), 0
        for k in range(rows):
            room.ahead[0, k] = since(state, times[count + k] * unit, lane, lanes)
        _write_rows(f, room, state, columns, first + count, rows, lane, lanes)
        while good < rows and math.isfinite(room.ahead[0, good]):
            good += 1
        count, going = count + good, good == rows
    return count, going


@scalar
def _write_rows(
    f: Quadratic,
    room: Room,
    state: np.ndarray,
    columns: Columns,
    row: Any,
    rows: int,
    lane: int,
    lanes: tuple[int, ...],
) -> None:
    """Write states of a lane at the times ahead, in place of which the sums of their numbers come."""
    L, series, ahead, order = len(lanes), room.series, room.ahead, len(room.series) - 1
    time, later, total, sum_later = (
        load(ahead, 0, 0, EIGHT),
        load(ahead, 0, 1, EIGHT),
        spread(0.0, EIGHT),
        spread(0.0, EIGHT),
    )
    for m in range(len(f.blocks)):
        source, own, at = (len(f.velocities) + m) * L + lane, m * L + lane, f.order[m]
        x, rest, change = (
            spread(state[0, own], EIGHT),
            spread(state[1, own], EIGHT),
            spread(series[order, source], EIGHT),
        )
        other = change
        for j in range(order - 1, 0, -1):
            term = spread(series[j, source], EIGHT)
            change, other = change * time + term, other * later + term
        change, other = x + (change * time + rest), x + (other * later + rest)
        store(ahead, 1, 0, EIGHT, change)
        store(ahead, 1, 1, EIGHT, other)
        total, sum_later = total + change, sum_later + other
        for k in range(rows):
            _put(columns, row + k, at, ahead[1, k])
    store(ahead, 0, 0, EIGHT, total)
    store(ahead, 0, 1, EIGHT, sum_later)


@scalar
def _put(columns: Columns, row: Any, at: int, value: float) -> None:
    """Write a number of a state into the part that has it."""
    place, heading, head = columns
    first, second = place.shape[1], place.shape[1] + heading.shape[1]
    if at < first:
        place[row, at] = value
    elif at < second:
        heading[row, at - first] = value
    else:
        head[row, at - second] = value


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
    parts: Columns,
    times: tuple[Float[np.ndarray, "K"], Float[np.ndarray, "M"]],
    tolerance: float,
    stop: Bool[np.ndarray, "1"],
) -> tuple[list[Float[np.ndarray, "M K size"]], Int[np.ndarray, "M"]]:
    """Return the states of members at the times in three parts, NaN where there are none, and how many each has.

    Args:
        f: Equations of all members, with a constraint fixed in the body.
        numbers: Velocities and factors of each member, or with an axis of length 1 those of all.
        parts: First states, (M, size) of each part.
        times: Requested times, which rise or fall, and the factor of each member to them.
        tolerance: Of a step.
        stop: Ends the work when it becomes true.
    """
    starts, L = np.hstack(parts), len(EIGHT)
    count, states, size = len(starts), len(times[0]), starts.shape[1]
    columns = [np.full((count, states, part.shape[1]), np.nan) for part in parts]
    for column, part in zip(columns, parts, strict=True):
        column[:, 0] = part
    rows = tuple([column.reshape(count * states, column.shape[2]) for column in columns])
    wide = f._replace(velocities=np.tile(f.velocities, L), factors=np.tile(f.factors, L))
    wide = wide._replace(**one_by_one(f.rows, f.sources))
    room, state, ends = make_room(wide, order_for(tolerance), EIGHT), np.zeros((2, (size + 1) * L)), np.zeros(L)
    counts, lanes = np.zeros(count, dtype=np.int64), (state, ends, np.full(L, -1))
    expansion = expansion_of(wide, EIGHT)
    _advance_members(wide, *numbers, starts, *times, tolerance, rows, counts, stop, lanes, room, expansion)
    return columns, counts


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
    columns: Columns,
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
                counts[following], members[lane] = 1, following
                following += 1
        expand(f, expansion, state, room, EIGHT)
        write_steps(f, state, ends, tolerance, room, EIGHT)
        busy = following < len(starts)
        for lane in range(L):
            room.steps[0, lane] *= direction * _continue(f, room, state, times, units, lane, members, counts, columns)
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
    columns: Columns,
) -> bool:
    """Write what the motion in a lane reaches in this step; tell whether it takes the step, else free the lane."""
    at, going = members[lane], members[lane] >= 0 and counts[members[lane]] < len(times)
    if going:
        count, unit = counts[at], units[at]
        going = room.steps[0, lane] > _SMALLEST_STEP * unit * abs(times[count] - times[count - 1])
        if going:
            counts[at], going = read(f, room, state, times, unit, count, 0, columns, at * len(times), lane, EIGHT)
    if going and counts[at] < len(times):
        return True
    members[lane], room.steps[0, lane] = -1, 0.0
    return False
