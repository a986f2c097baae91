"""The order and the length of a step [jorba-zou-2005], without a library's logarithm.

The last two terms of a step are within the tolerance of the first, block by block; where something outside drives a
block, of its largest one. The size of a block is the sum of what its components have.
"""

import math

import numpy as np

from nonholo.kernels._scalar import scalar
from nonholo.kernels.lanes import load, spread, store
from nonholo.kernels.taylor._expansion import Quadratic, Room

_STRETCH = 0.8  # of the logarithm of the tolerance
_REPAIRS = 50  # of a step; one or two do
_ENOUGH, _FAR = 0.99, 2.0**-32  # of the step that the last terms allow (roots have two digits), or that overflows
_BEND = 0.34  # of the logarithm between powers of two: log2(1 + t) is near t + _BEND t (1 - t)
_SMALLEST, _SCALE, _RAISED = 2.0**-1022, 2.0**54, 54  # normal number; what makes others normal; its exponent
_FRACTION, _UNIT = (1 << 52) - 1, 1023  # the bits of a number that follow its exponent; the exponent of one


def order_for(tolerance: float) -> int:
    """Return the order of the series.

    Half of the logarithm takes the fewest products [jorba-zou-2005]; but a processor waits for one order after another
    at every order, so that longer steps of a higher order take less time.
    """
    return max(8, math.floor(1 - _STRETCH * math.log(tolerance)))


@scalar
def write_steps(
    f: Quadratic, state: np.ndarray, ends: np.ndarray, tolerance: float, room: Room, lanes: tuple[int, ...]
) -> None:
    """Write the lengths of the steps, not much longer than is left; NaN where the series is not finite."""
    L, is_closed, sizes = len(lanes), f.is_closed, room.sizes
    _measure(f, room, lanes)
    for lane in range(L):
        left = ends[lane] - state[0, len(f.blocks) * L + lane]
        step, power = _limit(is_closed, sizes, tolerance, 2 * abs(left), lane, L), 0.0
        for block in range(len(is_closed)):
            if not is_closed[block]:
                step, power = _repair(sizes, block * L + lane, tolerance, step, power)
        room.steps[0, lane] = step


@scalar
def _limit(is_closed: np.ndarray, sizes: np.ndarray, tolerance: float, step: float, lane: int, L: int) -> float:
    """Return a step, shortened until the last terms of all closed blocks are small enough; NaN if nothing helps."""
    order = len(sizes) - 1
    for late in range(order - 1, order + 1):
        share = _late_share(is_closed, sizes, late, lane, L)
        if share > 0:
            step = min(step, root(tolerance / share, late))
        elif share != 0:
            return np.nan
    return step


@scalar
def _measure(f: Quadratic, room: Room, lanes: tuple[int, ...]) -> None:
    """Write the sizes of each block's coefficients: of all orders where it is driven, else of those that are needed."""
    sizes, series, blocks, is_closed = room.sizes, room.series, f.blocks, f.is_closed
    before, order = len(f.velocities), len(series) - 1
    for block in range(len(is_closed)):
        store(sizes, 0, block, lanes, spread(0.0, lanes))
        for j in range(order - 1 if is_closed[block] else 1, order + 1):
            store(sizes, j, block, lanes, spread(0.0, lanes))
    for m in range(len(blocks)):
        block = blocks[m]
        _add_size(sizes, 0, block, series, before + m, lanes)
        for j in range(order - 1 if is_closed[block] else 1, order + 1):
            _add_size(sizes, j, block, series, before + m, lanes)


@scalar
def _add_size(sizes: np.ndarray, j: int, block: int, series: np.ndarray, at: int, lanes: tuple[int, ...]) -> None:
    """Add the size of a component's coefficient to that of its block."""
    store(sizes, j, block, lanes, load(sizes, j, block, lanes) + abs(load(series, j, at, lanes)))


@scalar
def _late_share(is_closed: np.ndarray, sizes: np.ndarray, late: int, lane: int, L: int) -> float:
    """Return the largest ratio of a late coefficient to the first one of its closed block; NaN if one is not finite."""
    share = 0.0
    for block in range(len(is_closed)):
        at = block * L + lane
        if is_closed[block] and sizes[late, at] != 0:
            ratio = sizes[late, at] / sizes[0, at]
            share = ratio if ratio > share else share
            if not math.isfinite(ratio):
                return np.nan
    return share


@scalar
def _repair(sizes: np.ndarray, at: int, tolerance: float, step: float, high: float) -> tuple[float, float]:
    """Return a step, shortened until the last terms of a driven block are within the tolerance of its largest one.

    The largest term is often an early one. `high` is the power of the step in the last but one, or 0, and comes back.
    """
    order = len(sizes) - 1
    for _ in range(_REPAIRS):
        high = _power(step, order - 1) if high == 0 else high
        late = max(max(0.0, sizes[order - 1, at] * high), sizes[order, at] * (high * step))
        power, largest = 1.0, 0.0
        for j in range(order + 1):
            largest = max(largest, sizes[j, at] * power)
            if late <= tolerance * largest:
                return step, high
            power *= step
        step *= _ENOUGH * root(tolerance * largest / late, order) if math.isfinite(late) else _FAR
        high = 0.0
    return np.nan, 0.0


@scalar
def _power(step: float, exponent: int) -> float:
    """Return a power, by one product after another."""
    power = 1.0
    for _ in range(exponent):
        power *= step
    return power


@scalar
def root(x: float, degree: int) -> float:
    """Return the root of a positive number to two digits, from its bits; of zero a number that is small."""
    exponent = 0
    if x < _SMALLEST:
        x, exponent = max(x * _SCALE, _SMALLEST), _RAISED
    if not math.isfinite(x):
        return math.inf
    bits = np.float64(x).view(np.int64)
    part = np.int64((bits & _FRACTION) | (_UNIT << 52)).view(np.float64) - 1
    power = ((bits >> 52) - _UNIT - exponent + part + _BEND * part * (1 - part)) / degree
    whole = int(power + _UNIT)  # rounds toward zero, so from a positive number
    part = power + _UNIT - whole
    return np.int64(whole << 52).view(np.float64) * (1 + part - _BEND * part * (1 - part))
