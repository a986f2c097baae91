r"""Quadratic equations by Taylor series: momenta and poses of continuous motions.

With velocities w the state x obeys $x_m' = \sum_q C_{mq}\,w_{a(q)}\,z_{b(q)}$, where z is (w, 1, x). If the constraint
is fixed in the body, x begins with momenta r, and w = V r. If it is fixed in space, x begins with the inertia tensor
$\mathbb{J}_g = g\mathbb{J}g^T$, and $B(\mathbb{J}_g)\,w = r$ with a linear map B and constant r: a division of
series. Taylor coefficients of products are Cauchy products.

Order and step are those of [jorba-zou-2005]: the last two terms of a step are within the tolerance of the first. Steps
do not depend on the times that are asked for, which are read from the series. What rounding takes from state and time
is carried along (Kahan).

Several motions can be expanded side by side, in lanes: number m of a lane stands at m L + lane. How many there are
tells the length of a tuple, which the compiler knows; with one lane the loops over lanes vanish.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numba.extending import overload

from nonholo.base.compiled import njit
from nonholo.base.types import Float
from nonholo.kernels._scalar import COMPILED
from nonholo.kernels._small import assign_rows, eliminate, multiply, transpose

SERIES_LANES = 8
"""The number of products is padded to a multiple of it."""

_STEPS = 2048  # between two looks at the keyboard
_NUMBERS = 1 << 24  # in the nodes of a solve, 128 MiB
_SMALLEST_STEP = 1e-13  # of an interval between requested times; below it a solve is given up
_REPAIRS = 50  # of a step; one or two do
_ENOUGH, _FAR = 0.99, 2.0**-32  # of the step that the last terms allow (roots have three digits), or that overflows
_BITS = 20  # of the exponent of a root
ONE = (0,)
"""A single lane."""


class Quadratic(NamedTuple):
    """Equations as the module states them, with products padded to full lanes by such as nobody reads.

    Attributes:
        velocities: V, (k, k L).
        left: a, the velocity in each product, (P,).
        right: b, the place in z of the other factor, (P,).
        targets: Rows m of the coefficients C that are not zero, (Q,).
        products: Their columns q, (Q,).
        factors: Their values, (Q L,).
        blocks: The block of each component of x, whose errors are measured together, (size,).
        closed: Whether nothing outside moves a block, (blocks,).
        forms: The coefficients of B, (k, k, N N), or none, (0,), if the constraint is fixed in the body.
        tensor: J, (N, N).
        momentum: r, (k,), of a constraint fixed in space.
    """

    velocities: np.ndarray
    left: np.ndarray
    right: np.ndarray
    targets: np.ndarray
    products: np.ndarray
    factors: np.ndarray
    blocks: np.ndarray
    closed: np.ndarray
    forms: np.ndarray
    tensor: np.ndarray
    momentum: np.ndarray


class Room(NamedTuple):
    """Coefficients of x, w and B, of z at one order, of both factors of products (the right ones backward); sums.

    Also the largest coefficients of each block, and for each lane a number and the length of the step.
    """

    series: np.ndarray
    velocities: np.ndarray
    inertia: np.ndarray
    places: np.ndarray
    left: np.ndarray
    right: np.ndarray
    sums: np.ndarray
    sizes: np.ndarray
    ratios: np.ndarray
    steps: np.ndarray


def solve_series(
    f: Quadratic, start: Float[np.ndarray, "size"], times: Float[np.ndarray, "K"], tolerance: float
) -> tuple[Float[np.ndarray, "reached size"], Float[np.ndarray, "steps 2 state"]]:
    """Return the states at the times, which rise or fall, up to the first that cannot be reached, and the nodes.

    Nodes are the beginnings of steps: the state and its time, above what rounding took from them. When they fill much
    memory every second one is left out.
    """
    rows = np.empty((len(times), len(start)))
    rows[0] = start
    state = np.zeros((2, len(start) + 1))
    state[0] = *start, times[0]
    block = max(16, min(_STEPS, _NUMBERS // (8 * state.size)))
    nodes: list[np.ndarray] = []
    reached, going, stride = 1, True, 1
    while going and reached < len(times):
        room = np.empty((block, *state.shape))
        reached, steps, going = advance(f, times, order_for(tolerance), tolerance, reached, state, rows, room)
        nodes.append(room[:steps:stride].copy())
        if len(nodes) * block * state.size > stride * _NUMBERS:
            nodes, stride = [part[::2].copy() for part in nodes], 2 * stride
    return rows[:reached], np.concatenate(nodes) if nodes else state[None]


def order_for(tolerance: float) -> int:
    """Return the order of the series."""
    return max(8, math.ceil(1 - math.log(tolerance) / 2))


@njit(nogil=True, **COMPILED)
def advance(
    f: Quadratic,
    times: np.ndarray,
    order: int,
    tolerance: float,
    reached: int,
    state: np.ndarray,
    rows: np.ndarray,
    nodes: np.ndarray,
) -> tuple[int, int, bool]:
    """Take a step from each node, which is written; return how many rows and nodes are filled and whether one failed.

    `state` holds x and time, and what rounding took from them.
    """
    room, going, at = make_room(f, order, ONE), True, 0
    while at < len(nodes) and going and reached < len(times):
        assign_rows(nodes[at], state)
        at += 1
        prepare(f, state, order, tolerance, times[-1:], room, ONE)
        reached, going = read(room, state, times, 1.0, reached, rows, 0, ONE)
        if going and reached < len(times):
            room.steps[0] = math.copysign(room.steps[0], times[-1] - times[0])
            move(room.series, room.steps, state, ONE)
    return reached, at, going


@njit(nogil=True, **COMPILED)
def revisit_series(
    f: Quadratic, nodes: np.ndarray, times: np.ndarray, end: float, order: int, tolerance: float, rows: np.ndarray
) -> None:
    """Write the states at times in the order of the nodes, the bits as if they had been requested with `end`."""
    room, at, state = make_room(f, order, ONE), -1, nodes[0].copy()
    direction = math.copysign(1.0, end - nodes[0, 0, -1])
    ends = np.array([end])
    for i in range(len(times)):
        after = max(at, 0)
        while after + 1 < len(nodes) and direction * since(nodes[after + 1], times[i], 0, ONE) > 0:
            after += 1
        if after != at:
            at = after
            assign_rows(state, nodes[at])
            prepare(f, state, order, tolerance, ends, room, ONE)
        while abs(since(state, times[i], 0, ONE)) > room.steps[0]:  # nodes between were left out
            room.steps[0] *= direction
            move(room.series, room.steps, state, ONE)
            prepare(f, state, order, tolerance, ends, room, ONE)
        evaluate(room.series, since(state, times[i], 0, ONE), state, rows[i], 0, ONE)


@njit(inline="always", **COMPILED)
def since(state: np.ndarray, time: float, lane: int, lanes: tuple[int, ...]) -> float:
    """Return how long after the state of a lane a time is."""
    at = state.shape[1] - len(lanes) + lane
    return time - state[0, at] - state[1, at]


@njit(inline="always", **COMPILED)
def read(
    room: Room,
    state: np.ndarray,
    times: np.ndarray,
    unit: float,
    reached: int,
    rows: np.ndarray,
    lane: int,
    lanes: tuple[int, ...],
) -> tuple[int, bool]:
    """Write the rows whose times lie within the step of a lane; return how many are filled, and whether all went well.

    Times are in other units than the state's: `unit` is the factor to them.
    """
    step = room.steps[lane]
    going = step > _SMALLEST_STEP * unit * abs(times[reached] - times[reached - 1])
    while going and reached < len(times) and abs(since(state, times[reached] * unit, lane, lanes)) <= step:
        evaluate(room.series, since(state, times[reached] * unit, lane, lanes), state, rows[reached], lane, lanes)
        going = math.isfinite(rows[reached].sum())
        reached += going
    return reached, going


@njit(inline="always", **COMPILED)
def make_room(f: Quadratic, order: int, lanes: tuple[int, ...]) -> Room:
    """Return room for the series of some lanes."""
    L = len(lanes)
    k, size, products = len(f.velocities), len(f.blocks) * L, len(f.left) * L
    factors = np.empty((order, products)), np.empty((order, products)), np.empty(products)
    inertia, places = np.empty((order, len(f.forms), len(f.forms))), np.empty((k + 1) * L + size)
    sizes = np.empty((order + 1, len(f.closed) * L))
    return Room(
        np.empty((order + 1, size)),
        np.empty((order, k * L)),
        inertia,
        places,
        *factors,
        sizes,
        np.empty(L),
        np.empty(L),
    )


@njit(inline="always", **COMPILED)
def prepare(
    f: Quadratic,
    state: np.ndarray,
    order: int,
    tolerance: float,
    ends: np.ndarray,
    room: Room,
    lanes: tuple[int, ...],
) -> None:
    """Write the series from the states of all lanes, and the lengths of their steps, NaN where there is none."""
    if len(lanes) == 1 and len(f.forms) > 0:
        _see_tensor(f.tensor, state)
    _expand(f, state[0], order, room, lanes)
    _write_steps(f, state, ends, tolerance, room, lanes)


@njit(inline="always", **COMPILED)
def _see_tensor(tensor: np.ndarray, state: np.ndarray) -> None:
    """Write the inertia tensor in space, which its own equations carry through one step, from the pose behind it."""
    N = len(tensor)
    g = state[0, N * N : 2 * N * N].copy().reshape(N, N)
    half, across, seen = np.empty((N, N)), np.empty((N, N)), np.empty((N, N))
    multiply(g, tensor, half)
    transpose(g, across)
    multiply(half, across, seen)
    for i in range(N * N):
        state[0, i], state[1, i] = seen[i // N, i % N], 0.0


@njit(**COMPILED)
def _expand(f: Quadratic, start: np.ndarray, order: int, room: Room, lanes: tuple[int, ...]) -> None:
    """Write the Taylor coefficients of the solution from a state."""
    series, size = room.series, room.series.shape[1]
    for m in range(size):
        series[0, m] = start[m]
    for j in range(order):
        _write_velocities(f, j, room, lanes)
        _gather(f, j, order - 1 - j, room, lanes)
        _multiply(room.left, room.right, j, order - 1 - j, room.sums)
        _collect(f, j, room, lanes)
        for m in range(size):
            series[j + 1, m] /= j + 1


def _write_velocities(f: Any, order: Any, room: Any, lanes: Any) -> Any:
    """Write a coefficient of w: with numba one of the two that follow, by the axes of the forms."""
    (_divide if f.forms.ndim == 3 else _apply)(f, order, room, lanes)


@overload(_write_velocities, jit_options=COMPILED)
def _choose(f: Any, order: Any, room: Any, lanes: Any) -> Any:
    """Choose when a kernel is compiled: one that has both is five times slower."""
    return _divide if f.types[f.fields.index("forms")].ndim == 3 else _apply


def _apply(f: Any, order: Any, room: Any, lanes: Any) -> Any:
    """Write the coefficient of w = V r."""
    w, L, k = room.velocities, len(lanes), len(f.velocities)
    for a in range(k * L):
        w[order, a] = 0.0
    for a in range(k):
        for i in range(k):
            for lane in range(L):
                w[order, a * L + lane] += f.velocities[a, i * L + lane] * room.series[order, i * L + lane]


def _divide(f: Any, order: Any, room: Any, lanes: Any) -> Any:
    """Write the coefficient of w in B w = r: B_0 w_j = r_j - B_1 w_(j-1) - ... - B_j w_0."""
    k, inertia, w = len(f.momentum), room.inertia, np.zeros((len(f.momentum), 1))
    for a in range(k):
        for b in range(k):
            inertia[order, a, b] = 0.0
            for e in range(f.forms.shape[2]):
                inertia[order, a, b] += f.forms[a, b, e] * room.series[order, e]
        w[a, 0] = f.momentum[a] if order == 0 else 0.0
        for i in range(1, order + 1):
            for b in range(k):
                w[a, 0] -= inertia[i, a, b] * room.velocities[order - i, b]
    eliminate(inertia[0].copy(), w)
    for a in range(k):
        room.velocities[order, a] = w[a, 0]


@njit(inline="always", **COMPILED)
def _collect(f: Quadratic, order: int, room: Room, lanes: tuple[int, ...]) -> None:
    """Write the coefficients of the rates: the products with their factors."""
    rates, L = room.series, len(lanes)
    for m in range(rates.shape[1]):
        rates[order + 1, m] = 0.0
    for i in range(len(f.targets)):
        target, product = f.targets[i] * L, f.products[i] * L
        for lane in range(L):
            rates[order + 1, target + lane] += f.factors[i * L + lane] * room.sums[product + lane]


@njit(inline="always", **COMPILED)
def _gather(f: Quadratic, order: int, row: int, room: Room, lanes: tuple[int, ...]) -> None:
    """Write the factors of the products of an order."""
    z, L, k = room.places, len(lanes), len(f.velocities) * len(lanes)
    for a in range(k):
        z[a] = room.velocities[order, a]
    for lane in range(L):
        z[k + lane] = 1.0 if order == 0 else 0.0
    for m in range(room.series.shape[1]):
        z[k + L + m] = room.series[order, m]
    for q in range(len(f.left)):
        left, right = f.left[q] * L, f.right[q] * L
        for lane in range(L):
            room.left[order, q * L + lane] = z[left + lane]
            room.right[row, q * L + lane] = z[right + lane]


@njit(inline="always", **COMPILED)
def _multiply(left: np.ndarray, right: np.ndarray, order: int, row: int, sums: np.ndarray) -> None:
    """Write coefficients of the products: the sums over i from 0 to an order of left[i] right[row + i]."""
    for q in range(len(sums)):
        sums[q] = left[0, q] * right[row, q]
    for i in range(1, order, 2):
        for q in range(len(sums)):
            sums[q] += left[i, q] * right[row + i, q] + left[i + 1, q] * right[row + i + 1, q]
    if order % 2 == 1:
        for q in range(len(sums)):
            sums[q] += left[order, q] * right[row + order, q]


@njit(**COMPILED)
def _write_steps(
    f: Quadratic, state: np.ndarray, ends: np.ndarray, tolerance: float, room: Room, lanes: tuple[int, ...]
) -> None:
    """Write the lengths of the steps, not much longer than is left; NaN where the series is not finite."""
    L, order, steps, roots = len(lanes), len(room.series) - 1, room.steps, room.ratios
    _measure(f, room, lanes)
    for lane in range(L):
        steps[lane] = 2 * abs(ends[lane] - state[0, state.shape[1] - L + lane])
    for late in range(order - 1, order + 1):
        _compare(f, late, room, lanes)
        for lane in range(L):
            steps[lane] = steps[lane] if math.isfinite(roots[lane]) else np.nan
            roots[lane] = tolerance / roots[lane] if roots[lane] != 0 else math.inf
        _take_roots(roots, late, lanes)
        for lane in range(L):
            steps[lane] = min(steps[lane], roots[lane])
    for block in range(len(f.closed)):
        if not f.closed[block]:
            for lane in range(L):
                steps[lane] = _repaired(room.sizes[:, block * L + lane], tolerance, steps[lane])


@njit(inline="always", **COMPILED)
def _compare(f: Quadratic, late: int, room: Room, lanes: tuple[int, ...]) -> None:
    """Write for each lane the largest ratio of a late coefficient to the first one of its block."""
    L, sizes, ratios = len(lanes), room.sizes, room.ratios
    for lane in range(L):
        ratios[lane] = 0.0
    for block in range(len(f.closed)):
        if f.closed[block]:
            for lane in range(L):
                last, first = sizes[late, block * L + lane], sizes[0, block * L + lane]
                ratio = last / first if last != 0 else 0.0
                ratios[lane] = ratios[lane] if ratio <= ratios[lane] else ratio


@njit(inline="always", **COMPILED)
def _measure(f: Quadratic, room: Room, lanes: tuple[int, ...]) -> None:
    """Write the largest coefficient in each block: of all orders where it is driven, else of those that are needed."""
    L, series, sizes = len(lanes), room.series, room.sizes
    order = len(series) - 1
    for j in range(order + 1):
        for i in range(sizes.shape[1]):
            sizes[j, i] = 0.0
    for m in range(len(f.blocks)):
        block = f.blocks[m]
        for j in range(order + 1):
            if j == 0 or j >= order - 1 or not f.closed[block]:
                for lane in range(L):
                    sizes[j, block * L + lane] = max(sizes[j, block * L + lane], abs(series[j, m * L + lane]))


@njit(inline="always", **COMPILED)
def _repaired(sizes: np.ndarray, tolerance: float, step: float) -> float:
    """Return a step, shortened until the last terms of a driven block are within the tolerance of its largest one."""
    order = len(sizes) - 1
    ratio = np.empty(1)
    for _ in range(_REPAIRS):
        power, largest, late = 1.0, 0.0, 0.0
        for j in range(order + 1):
            largest = max(largest, sizes[j] * power)
            late = max(late, sizes[j] * power) if j >= order - 1 else late
            power *= step
        if late <= tolerance * largest:
            return step
        ratio[0] = tolerance * largest / late
        _take_roots(ratio, order, ONE)
        step *= _ENOUGH * ratio[0] if math.isfinite(late) else _FAR
    return np.nan


@njit(inline="always", **COMPILED)
def _take_roots(x: np.ndarray, degree: int, lanes: tuple[int, ...]) -> None:
    """Write roots of positive numbers to three digits, by square roots: x^(1/d), 1/d written in bits."""
    share, roots = 1.0 / degree, np.empty(len(lanes))
    for lane in range(len(lanes)):
        roots[lane] = 1.0
    for _ in range(_BITS):
        share *= 2
        for lane in range(len(lanes)):
            x[lane] = math.sqrt(x[lane])
        if share >= 1:
            share -= 1
            for lane in range(len(lanes)):
                roots[lane] *= x[lane]
    for lane in range(len(lanes)):
        x[lane] = roots[lane]


@njit(inline="always", **COMPILED)
def evaluate(
    series: np.ndarray, time: float, state: np.ndarray, out: np.ndarray, lane: int, lanes: tuple[int, ...]
) -> None:
    """Write the state of a lane some time after the beginning of its step."""
    L, order = len(lanes), len(series) - 1
    for m in range(len(out)):
        out[m] = series[order, m * L + lane]
    for j in range(order - 1, 0, -1):
        for m in range(len(out)):
            out[m] = out[m] * time + series[j, m * L + lane]
    for m in range(len(out)):
        out[m] = state[0, m * L + lane] + (out[m] * time + state[1, m * L + lane])


@njit(inline="always", **COMPILED)
def move(series: np.ndarray, steps: np.ndarray, state: np.ndarray, lanes: tuple[int, ...]) -> None:
    """Carry states and times of all lanes to the ends of their steps."""
    L, size, order = len(lanes), series.shape[1], len(series) - 1
    change = np.empty(size + L)
    for m in range(0, size, L):
        for lane in range(L):
            change[m + lane] = series[order, m + lane]
        for j in range(order - 1, 0, -1):
            for lane in range(L):
                change[m + lane] = change[m + lane] * steps[lane] + series[j, m + lane]
        for lane in range(L):
            change[m + lane] *= steps[lane]
    for lane in range(L):
        change[size + lane] = steps[lane]
    for m in range(size + L):
        state[0, m], state[1, m] = _added(state[0, m], state[1, m], change[m])


@njit(**COMPILED)
def _added(total: float, lost: float, term: float) -> tuple[float, float]:
    """Return a sum and what rounding took from it."""
    term += lost
    after = total + term
    return after, term - (after - total)
