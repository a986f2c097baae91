r"""Momenta of tops and sleighs by Taylor series, in O(n) operations a coefficient and without poses.

In principal axes and units of energy, $x_a = \pi_a/\sqrt{d_a}$, the equations of the normal form are
$$ x' = s\,\rho x - q\gamma, \qquad s = \gamma\cdot x, \qquad q = x\cdot\rho x, $$
with $\rho_a = 1/d_a$, $\gamma_a = c_a/\sqrt{d_a}$; the slide of a sleigh is one more component, with $\rho = 0$ and
$\gamma = -\sqrt m\,a_1$. So a coefficient is made of products of scalar series with x, and of sums. The energy
$|x|^2/2$ is constant because $x\cdot x' = sq - qs$.

Steps are compensated as those of `_solve`, errors measured in the sum of all components. The order is lower: it is
numbers to be passed through that take time, and half of the logarithm takes the fewest products [jorba-zou-2005].
"""

import math
from typing import NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.base.progress import tell
from nonholo.base.types import Float
from nonholo.kernels._scalar import COMPILED, scalar
from nonholo.kernels._small import assign
from nonholo.kernels.lanes import ONE
from nonholo.kernels.taylor._solve import since
from nonholo.kernels.taylor._steps import root

_PART = 128  # components whose coefficients are made together, and sums that run side by side
_NUMBERS = 1 << 24  # in the nodes of a solve, 128 MiB
_OWN = 32  # numbers that an array takes besides its own
_LOOK = 256  # steps between two reports
_SMALLEST_STEP = 1e-13  # of what is left to the next requested time; below it a solve is given up


class Arrowhead(NamedTuple):
    r"""Equations as the module states them.

    Attributes:
        rates: $\rho$, (size,).
        coupling: $\gamma$, (size,).
    """

    rates: np.ndarray
    coupling: np.ndarray


class _Work(NamedTuple):
    """The equations, the last time and the tolerance of a solve, and room for one step.

    Room: coefficients of x; of s and q; of a part of x, and what is summed for the next ones of s and q; what is added
    to a state.
    """

    rates: np.ndarray
    coupling: np.ndarray
    end: float
    tolerance: float
    series: np.ndarray
    scalars: np.ndarray
    part: np.ndarray
    sums: np.ndarray
    change: np.ndarray


def solve_arrowhead(
    f: Arrowhead, node: Float[np.ndarray, "2 state"], times: Float[np.ndarray, "K"], end: float, tolerance: float
) -> tuple[Float[np.ndarray, "reached size"], list[Float[np.ndarray, "2 state"]]]:
    """Return the states at the times up to the first that cannot be reached, and nodes, the first one in.

    When nodes fill much memory every second one is left out.

    Args:
        f: The equations.
        node: A beginning of a step: x and time, and what rounding took from them.
        times: In the order of the solve, none before the node.
        end: The last time of the solve, which bounds the steps.
        tolerance: Of a step.
    """
    size, steps, stride = len(f.rates), 0, 1
    p = room_for_steps(f, end, tolerance, terms_for(tolerance))
    state, nodes, rows, count, going = node.copy(), [node], np.empty((len(times), size)), 0, True
    while going and count < len(times):
        count, going = take_step(p, state, times, count, rows)
        steps += 1
        if steps % _LOOK == 0:
            tell(abs(state[0, -1] - node[0, -1]), abs(end - node[0, -1]))
        if going and count < len(times) and steps % stride == 0:
            nodes.append(state.copy())
        if len(nodes) * (state.size + _OWN) > max(_NUMBERS, 4 * state.size):
            nodes, stride = nodes[::2], 2 * stride
    return rows[:count], nodes


def terms_for(tolerance: float) -> int:
    """Return the number of terms of a series."""
    return max(8, math.ceil(1 - math.log(tolerance) / 2)) + 1


@scalar
def room_for_steps(f: Arrowhead, end: float, tolerance: float, terms: int) -> _Work:
    """Return room for steps with this many terms of the series."""
    size, part = len(f.rates), min(_PART, len(f.rates))
    series, sums = (np.empty((terms, size)), np.empty((2, terms))), (np.empty(part), np.empty((2, part)))
    return _Work(f.rates, f.coupling, end, tolerance, series[0], series[1], sums[0], sums[1], np.empty(size + 1))


@njit(nogil=True, **COMPILED)
def take_step(p: _Work, state: np.ndarray, times: np.ndarray, count: int, rows: np.ndarray) -> tuple[int, bool]:
    """Write the rows whose times lie within a step, and take it; return how many are written, and if all went well."""
    left = p.end - state[0, -1]
    _expand(p, state[0, : len(p.rates)])
    step = _step(p, 2 * abs(left))
    going = step >= _SMALLEST_STEP * abs(since(state, times[count], 0, ONE))
    while going and count < len(times) and abs(since(state, times[count], 0, ONE)) <= step:
        _sum(p.series, since(state, times[count], 0, ONE), p.change)
        for m in range(rows.shape[1]):
            rows[count, m] = state[0, m] + (p.change[m] + state[1, m])
        count += 1
    _sum(p.series, math.copysign(step, left), p.change)
    for m in range(len(p.change)):
        before, term = state[0, m], p.change[m] + state[1, m]
        state[0, m] = before + term
        state[1, m] = term - (state[0, m] - before)
    return count, going


@njit(**COMPILED)
def _expand(p: _Work, start: np.ndarray) -> None:
    """Write the Taylor coefficients of the solution from a state, part by part: one passage through them an order."""
    size, width = len(start), len(p.part)
    assign(p.series[0], start)
    for j in range(len(p.series)):
        for a in range(width):
            p.sums[0, a] = p.sums[1, a] = 0.0
        for begin in range(0, size, width):
            end = min(begin + width, size)
            if j > 0:
                _write_part(p, j, begin, end)
            _add_part(p, j, begin, end)
        p.scalars[0, j], p.scalars[1, j] = p.sums[0].sum(), p.sums[1].sum()


@njit(inline="always", **COMPILED)
def _write_part(p: _Work, order: int, begin: int, end: int) -> None:
    """Write a part of a coefficient: of s rho x - q gamma, divided by its order."""
    total, level, out = p.part, p.scalars[1, order - 1], p.series[order, begin:end]
    rates, coupling = p.rates[begin:end], p.coupling[begin:end]
    for a in range(len(out)):
        total[a] = 0.0
    for i in range(order):
        pull, x = p.scalars[0, order - 1 - i], p.series[i, begin:end]
        for a in range(len(out)):
            total[a] += pull * x[a]
    for a in range(len(out)):
        out[a] = (total[a] * rates[a] - level * coupling[a]) / order


@njit(inline="always", **COMPILED)
def _add_part(p: _Work, order: int, begin: int, end: int) -> None:
    """Add the terms of a part of the components to the sums for a coefficient of s and of q."""
    total, x, middle = p.part, p.series[order, begin:end], p.series[order // 2, begin:end]
    rates, coupling = p.rates[begin:end], p.coupling[begin:end]
    for a in range(len(x)):
        total[a] = middle[a] * middle[a] / 2 if order % 2 == 0 else 0.0
    for i in range((order + 1) // 2):
        left, right = p.series[i, begin:end], p.series[order - i, begin:end]
        for a in range(len(x)):
            total[a] += left[a] * right[a]
    for a in range(len(x)):
        p.sums[0, a] += coupling[a] * x[a]
        p.sums[1, a] += 2 * rates[a] * total[a]


@njit(**COMPILED)
def _step(p: _Work, step: float) -> float:
    """Return a step, or one for which the last two terms are within the tolerance of the first; or NaN."""
    order = len(p.series) - 1
    for late in range(order - 1, order + 1):
        last = _norm(p.series[late])
        if last != 0:
            share = p.tolerance * _norm(p.series[0]) / last
            step = min(step, root(share, late)) if math.isfinite(last) else math.nan
    return step


@njit(**COMPILED)
def _norm(x: np.ndarray) -> float:
    total = 0.0
    for m in range(len(x)):
        total += abs(x[m])
    return total


@njit(**COMPILED)
def _sum(series: np.ndarray, time: float, change: np.ndarray) -> None:
    """Write what the terms of the series beyond the first add up to some time after the state, and the time."""
    order, size = len(series) - 1, series.shape[1]
    for m in range(size):
        change[m] = series[order, m]
    for j in range(order - 1, 0, -1):
        for m in range(size):
            change[m] = change[m] * time + series[j, m]
    for m in range(size):
        change[m] *= time
    change[size] = time
