r"""Quadratic equations by Taylor series: momenta and pose of a motion whose constraint is fixed in the body.

With velocities $w = Vr$ the state x = (r, pose, ...) obeys $x_m' = \sum_q C_{mq}\,w_{a(q)}\,z_{b(q)}$, where z is (w, 1,
x): Taylor coefficients of the products are Cauchy products. Order and step are those of Jorba and Zou, A software
package for the numerical integration of ODEs by means of high-order Taylor methods (2005): the last two terms of a step
are within the tolerance of the first. Steps do not depend on the times that are asked for, which are read from the
series. Rounding errors of the sum over steps are carried along (Kahan), and so are those of the time.
"""

import math
from typing import NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.base.types import Float
from nonholo.kernels._scalar import COMPILED

SERIES_LANES = 8
"""Products are so many at a time: pad their number to a multiple of it."""

_ATTEMPTS = 10_000  # steps between two looks at the keyboard
_SMALLEST_STEP = 1e-13  # of an interval between requested times; below it a solve is given up
_REPAIRS = 30  # of a step; one or two do
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
        closed: Whether each block moves itself, or is only driven by others, (blocks,).
    """

    velocities: np.ndarray
    left: np.ndarray
    right: np.ndarray
    targets: np.ndarray
    products: np.ndarray
    factors: np.ndarray
    blocks: np.ndarray
    closed: np.ndarray


class _Room(NamedTuple):
    """Coefficients of x (order + 1, size), both factors of all products, the right ones backward, and their sums."""

    series: np.ndarray
    left: np.ndarray
    right: np.ndarray
    sums: np.ndarray


def solve_series(
    f: Quadratic, start: Float[np.ndarray, "size"], times: Float[np.ndarray, "K"], tolerance: float
) -> Float[np.ndarray, "reached size"]:
    """Return the states at the times, which rise or fall, up to the first that cannot be reached."""
    order = max(8, math.ceil(1 - math.log(tolerance) / 2))
    rows = np.empty((len(times), len(start)))
    rows[0] = start
    state, place = np.stack((start, np.zeros_like(start))), np.array([times[0], 0.0])
    reached, going = 1, True
    while going and reached < len(times):
        reached, going = advance(f, times, order, tolerance, reached, state, place, rows)
    return rows[:reached]


@njit(nogil=True, **COMPILED)
def advance(
    f: Quadratic,
    times: np.ndarray,
    order: int,
    tolerance: float,
    reached: int,
    state: np.ndarray,
    place: np.ndarray,
    rows: np.ndarray,
) -> tuple[int, bool]:
    """Take some steps; return how many rows are filled and whether a step was possible.

    `state` holds x and what rounding took from it, `place` the time and what rounding took from that.
    """
    size, lanes = state.shape[1], len(f.left)
    series, left = np.empty((order + 1, size)), np.zeros((order + 1, lanes))
    room = _Room(series, left, np.zeros((order + 1, lanes)), np.empty(lanes))
    for _ in range(_ATTEMPTS):
        _expand(f, state[0], order, room)
        step = _step(f, series, tolerance, abs(times[-1] - place[0]))
        if not step > _SMALLEST_STEP * abs(times[reached] - times[reached - 1]):
            return reached, False
        step = math.copysign(step, times[-1] - times[0])
        while reached < len(times) and abs(times[reached] - place[0] - place[1]) <= abs(step):
            _evaluate(series, times[reached] - place[0] - place[1], state, rows[reached])
            if not math.isfinite(rows[reached].sum()):
                return reached, False
            reached += 1
        if reached == len(times):
            break
        _move(series, step, state)
        place[0], place[1] = _added(place[0], place[1], step)
    return reached, True


@njit(**COMPILED)
def _expand(f: Quadratic, start: np.ndarray, order: int, room: _Room) -> None:
    """Write the Taylor coefficients of the solution from a state."""
    series, left, right, sums = room
    k, size = len(f.velocities), len(start)
    w = np.empty(k)
    for m in range(size):
        series[0, m] = start[m]
    for j in range(order):
        for a in range(k):
            w[a] = 0.0
            for i in range(k):
                w[a] += f.velocities[a, i] * series[j, i]
        row = order - 1 - j
        for q in range(len(f.left)):
            left[j, q] = w[f.left[q]]
            b = f.right[q]
            right[row, q] = w[b] if b < k else series[j, b - k - 1] if b > k else (1.0 if j == 0 else 0.0)
        _multiply(left, right, j, row, sums)
        for m in range(size):
            series[j + 1, m] = 0.0
        for i in range(len(f.factors)):
            series[j + 1, f.targets[i]] += f.factors[i] * sums[f.products[i]]
        for m in range(size):
            series[j + 1, m] /= j + 1


@njit(**COMPILED)
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
            if f.closed[block] and not sizes[late, block] == 0:
                ratio = sizes[late, block] / sizes[0, block]
                share = ratio if not ratio <= share else share
        if not share == 0:
            step = min(step, _root(tolerance / share, late)) if math.isfinite(share) else np.nan
    for block in range(len(f.closed)):
        if not f.closed[block]:
            step = _repaired(sizes[:, block], tolerance, step)
    return step


@njit(**COMPILED)
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


@njit(**COMPILED)
def _repaired(sizes: np.ndarray, tolerance: float, step: float) -> float:
    """Return a step, shortened until the last terms of a driven block are within the tolerance of its largest one."""
    order = len(sizes) - 1
    for _ in range(_REPAIRS):
        power, largest, late = 1.0, 0.0, 0.0
        for j in range(order + 1):
            largest = max(largest, sizes[j] * power)
            late = max(late, sizes[j] * power) if j >= order - 1 else late
            power *= step
        if not late > tolerance * largest:
            break
        step *= _root(tolerance * largest / late, order)
    return step


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
    """Carry the state to the end of a step."""
    change = np.empty(series.shape[1])
    _evaluate(series, step, np.zeros_like(state), change)
    for m in range(len(change)):
        state[0, m], state[1, m] = _added(state[0, m], state[1, m], change[m])


@njit(**COMPILED)
def _added(total: float, lost: float, term: float) -> tuple[float, float]:
    """Return a sum and what rounding took from it."""
    term += lost
    after = total + term
    return after, term - (after - total)
