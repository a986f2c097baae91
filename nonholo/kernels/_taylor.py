r"""Quadratic equations by Taylor series: momenta and poses of continuous motions.

With velocities w the state x obeys $x_m' = \sum_q C_{mq}\,w_{a(q)}\,z_{b(q)}$, where z is (w, 1, x). If the constraint
is fixed in the body, x begins with momenta r, and w = V r. If it is fixed in space, x begins with the inertia tensor
$\mathbb{J}_g = g\mathbb{J}g^T$, and $B(\mathbb{J}_g)\,w = r$ with a linear map B and constant r: a division of
series. Taylor coefficients of products are Cauchy products.

Order and step are those of [jorba-zou-2005]: the last two terms of a step are within the tolerance of the first. Steps
do not depend on the times that are asked for, which are read from the series. What rounding takes from state and time
is carried along (Kahan).
"""

import math
from typing import NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.base.types import Float
from nonholo.kernels._scalar import COMPILED
from nonholo.kernels._small import eliminate, multiply, transpose

SERIES_LANES = 8
"""The number of products is padded to a multiple of it."""

_STEPS = 2048  # between two looks at the keyboard
_NUMBERS = 1 << 24  # in the nodes of a solve, 128 MiB
_SMALLEST_STEP = 1e-13  # of an interval between requested times; below it a solve is given up
_REPAIRS = 50  # of a step; one or two do
_ENOUGH, _FAR = 0.99, 2.0**-32  # of the step that the last terms allow (roots have three digits), or that overflows
_BITS = 20  # of the exponent of a root


class Quadratic(NamedTuple):
    """Equations as the module states them, with products padded to full lanes by such as nobody reads.

    Attributes:
        velocities: V, (k, k).
        left: a, the velocity in each product, (P,).
        right: b, the place in z of the other factor, (P,).
        targets: Rows m of the coefficients C that are not zero, (Q,).
        products: Their columns q, (Q,).
        factors: Their values, (Q,).
        blocks: The block of each component of x, whose errors are measured together, (size,).
        closed: Whether nothing outside moves a block, (blocks,).
        forms: The coefficients of B, (k, k, N N), or (0, 0, 0) if the constraint is fixed in the body.
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


class _Room(NamedTuple):
    """Coefficients of x, w and B, of z at one order, of both factors of products (the right ones backward); sums."""

    series: np.ndarray
    velocities: np.ndarray
    inertia: np.ndarray
    places: np.ndarray
    left: np.ndarray
    right: np.ndarray
    sums: np.ndarray


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
    room, going, at = _room(f, order), True, 0
    while at < len(nodes) and going and reached < len(times):
        nodes[at] = state
        at += 1
        step = _prepare(f, state, order, tolerance, times[-1], room)
        going = step > _SMALLEST_STEP * abs(times[reached] - times[reached - 1])
        while going and reached < len(times) and abs(_since(state, times[reached])) <= step:
            _evaluate(room.series, _since(state, times[reached]), state, rows[reached])
            going = math.isfinite(rows[reached].sum())
            reached += going
        if going and reached < len(times):
            _move(room.series, math.copysign(step, times[-1] - times[0]), state)
    return reached, at, going


@njit(nogil=True, **COMPILED)
def revisit_series(
    f: Quadratic, nodes: np.ndarray, times: np.ndarray, end: float, order: int, tolerance: float, rows: np.ndarray
) -> None:
    """Write the states at times in the order of the nodes, the bits as if they had been requested with `end`."""
    room, at, step, state = _room(f, order), -1, 0.0, nodes[0].copy()
    direction = math.copysign(1.0, end - nodes[0, 0, -1])
    for i in range(len(times)):
        after = max(at, 0)
        while after + 1 < len(nodes) and direction * _since(nodes[after + 1], times[i]) > 0:
            after += 1
        if after != at:
            at = after
            state[:] = nodes[at]
            step = _prepare(f, state, order, tolerance, end, room)
        while abs(_since(state, times[i])) > step:  # nodes between were left out
            _move(room.series, direction * step, state)
            step = _prepare(f, state, order, tolerance, end, room)
        _evaluate(room.series, _since(state, times[i]), state, rows[i])


@njit(inline="always", **COMPILED)
def _since(state: np.ndarray, time: float) -> float:
    return time - state[0, -1] - state[1, -1]


@njit(inline="always", **COMPILED)
def _room(f: Quadratic, order: int) -> _Room:
    k, size, lanes = len(f.velocities), len(f.blocks), len(f.left)
    factors = np.empty((order, lanes)), np.empty((order, lanes)), np.empty(lanes)
    inertia = np.empty((order, len(f.forms), len(f.forms)))
    return _Room(np.empty((order + 1, size)), np.empty((order, k)), inertia, np.empty(k + 1 + size), *factors)


@njit(inline="always", **COMPILED)
def _prepare(f: Quadratic, state: np.ndarray, order: int, tolerance: float, end: float, room: _Room) -> float:
    """Write the series from a state, and return the length of the step."""
    if len(f.forms) > 0:
        _see_tensor(f.tensor, state)
    _expand(f, state[0], order, room)
    return _step(f, room.series, tolerance, abs(end - state[0, -1]))


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
def _expand(f: Quadratic, start: np.ndarray, order: int, room: _Room) -> None:
    """Write the Taylor coefficients of the solution from a state."""
    series = room.series
    size = series.shape[1]
    for m in range(size):
        series[0, m] = start[m]
    for j in range(order):
        if len(f.forms) > 0:
            _divide(f, j, room)
        else:
            for a in range(len(f.velocities)):
                room.velocities[j, a] = 0.0
                for i in range(len(f.velocities)):
                    room.velocities[j, a] += f.velocities[a, i] * series[j, i]
        _gather(f, j, order - 1 - j, room)
        _multiply(room.left, room.right, j, order - 1 - j, room.sums)
        for m in range(size):
            series[j + 1, m] = 0.0
        for i in range(len(f.factors)):
            series[j + 1, f.targets[i]] += f.factors[i] * room.sums[f.products[i]]
        for m in range(size):
            series[j + 1, m] /= j + 1


@njit(inline="always", **COMPILED)
def _divide(f: Quadratic, order: int, room: _Room) -> None:
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
def _gather(f: Quadratic, order: int, row: int, room: _Room) -> None:
    """Write the factors of the products of an order."""
    z, k = room.places, len(f.velocities)
    for a in range(k):
        z[a] = room.velocities[order, a]
    z[k] = 1.0 if order == 0 else 0.0
    for m in range(room.series.shape[1]):
        z[k + 1 + m] = room.series[order, m]
    for q in range(len(f.left)):
        room.left[order, q] = z[f.left[q]]
        room.right[row, q] = z[f.right[q]]


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
def _step(f: Quadratic, series: np.ndarray, tolerance: float, longest: float) -> float:
    """Return the length of a step, not much longer than is left; NaN where the series is not finite."""
    order, step = len(series) - 1, 2 * longest
    sizes = _sizes(f, series)
    for late in range(order - 1, order + 1):
        share = 0.0
        for block in range(len(f.closed)):
            if f.closed[block] and sizes[late, block] != 0:
                ratio = sizes[late, block] / sizes[0, block]
                share = share if ratio <= share else ratio
        if share != 0:
            step = min(step, _root(tolerance / share, late)) if math.isfinite(share) else np.nan
    for block in range(len(f.closed)):
        if not f.closed[block]:
            step = _repaired(sizes[:, block], tolerance, step)
    return step


@njit(inline="always", **COMPILED)
def _sizes(f: Quadratic, series: np.ndarray) -> np.ndarray:
    """Return the largest coefficient in each block: of all orders where it is driven, else of those that are needed."""
    order = len(series) - 1
    sizes = np.zeros((order + 1, len(f.closed)))
    for m in range(series.shape[1]):
        block = f.blocks[m]
        for j in range(order + 1):
            if j == 0 or j >= order - 1 or not f.closed[block]:
                sizes[j, block] = max(sizes[j, block], abs(series[j, m]))
    return sizes


@njit(inline="always", **COMPILED)
def _repaired(sizes: np.ndarray, tolerance: float, step: float) -> float:
    """Return a step, shortened until the last terms of a driven block are within the tolerance of its largest one."""
    order = len(sizes) - 1
    for _ in range(_REPAIRS):
        power, largest, late = 1.0, 0.0, 0.0
        for j in range(order + 1):
            largest = max(largest, sizes[j] * power)
            late = max(late, sizes[j] * power) if j >= order - 1 else late
            power *= step
        if late <= tolerance * largest:
            return step
        step *= _ENOUGH * _root(tolerance * largest / late, order) if math.isfinite(late) else _FAR
    return np.nan


@njit(**COMPILED)
def _root(x: float, degree: int) -> float:
    """Return the root of a positive number to three digits, by square roots: x^(1/d), 1/d written in bits."""
    share, root = 1.0 / degree, 1.0
    for _ in range(_BITS):
        x, share = math.sqrt(x), 2 * share
        if share >= 1:
            root, share = root * x, share - 1
    return root


@njit(**COMPILED)
def _evaluate(series: np.ndarray, time: float, state: np.ndarray, out: np.ndarray) -> None:
    """Write the state some time after the beginning of a step."""
    order = len(series) - 1
    for m in range(len(out)):
        out[m] = series[order, m]
    for j in range(order - 1, 0, -1):
        for m in range(len(out)):
            out[m] = out[m] * time + series[j, m]
    for m in range(len(out)):
        out[m] = state[0, m] + (out[m] * time + state[1, m])


@njit(**COMPILED)
def _move(series: np.ndarray, step: float, state: np.ndarray) -> None:
    """Carry state and time to the end of a step."""
    change = np.empty(state.shape[1])
    change[-1] = step
    _evaluate(series, step, np.zeros_like(state), change[:-1])
    for m in range(len(change)):
        state[0, m], state[1, m] = _added(state[0, m], state[1, m], change[m])


@njit(**COMPILED)
def _added(total: float, lost: float, term: float) -> tuple[float, float]:
    """Return a sum and what rounding took from it."""
    term += lost
    after = total + term
    return after, term - (after - total)
