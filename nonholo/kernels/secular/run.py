"""Runs of the secular step: compensated momenta, rows of the pose, one step from each of many states.

The state of a run is one array, so that it can stop after any step and continue with the same bits: momenta (k) and
their compensations (k), the last three pairs of unknowns (6), the certain radius, the rows of the pose.
"""

import math

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._driver import floor_of
from nonholo.kernels._scalar import COMPILED, Rows, scalar
from nonholo.kernels._small import assign
from nonholo.kernels.secular._root import certain_radius, level_of, principal
from nonholo.kernels.secular._step import SecularBody, coordinate, newton, room_for_sums, term


@njit(nogil=True, **COMPILED)
def coordinates(p: SecularBody, m: np.ndarray, nu: float, tau: float, y: np.ndarray) -> None:
    """Write y."""
    for i in range(len(p.b)):
        y[i], _, _ = coordinate(p.b[i], p.c[i], m[i], nu, tau)


@scalar
def _is_principal(good: bool, size: float, tau: float, lever: float, certain: float) -> bool:
    """Return whether a corrected guess is certainly the principal root; `size` is the sum of b y y."""
    return good and tau < 1 and 4 * (size + lever * tau) <= certain * (1 + tau) ** 2


@njit(nogil=True, **COMPILED)
def solve(
    p: SecularBody, m: np.ndarray, certain: float, nu: float, tau: float, room: np.ndarray
) -> tuple[int, float, float]:
    """Correct a guess and verify that it is the principal root, or restart from momentum zero."""
    m0 = m[-1] if p.slides else 0.0
    good, nu, tau, size = newton(p, m, m0, 1.0, nu, max(tau, 0.0), False, room)
    if _is_principal(good, size, tau, p.mass * p.arm * p.arm, certain):
        return 0, nu, tau
    return principal(p, m, m0, room)


@njit(**COMPILED)
def _kahan_sum(total: float, carry: float, change: float, floor: float) -> tuple[float, float]:
    """Add by Kahan's summation; a sum that has decayed below `floor` is put on the equilibrium."""
    change = change - carry
    result = total + change
    if abs(result) < floor and abs(result) < abs(total):
        return 0.0, 0.0
    return result, (result - total) - change


@njit(nogil=True, **COMPILED)
def push(p: SecularBody, m: np.ndarray, carry: np.ndarray, nu: float, tau: float, floor: float) -> None:
    """Replace the momenta, and their compensations, by those after one step."""
    lever = p.mass * p.arm * p.arm
    for i in range(len(p.b)):
        k = np.uint64(i)  # a signed index would be tested for counting from the end
        y, _, _ = coordinate(p.b[k], p.c[k], m[k], nu, tau)
        m[k], carry[k] = _kahan_sum(m[k], carry[k], term(p.c[k], y, nu, tau, lever), floor)
    for i in range(len(p.b), len(m)):
        m[i], carry[i] = _kahan_sum(m[i], carry[i], 2 * p.mass * p.arm * tau / (1 + tau), floor)


@njit(nogil=True, **COMPILED)
def slide(p: SecularBody, m0: float, nu: float, tau: float, y: np.ndarray) -> float:
    """Return the last Cayley coordinate of a sleigh, half its slide over the cosine of half its turn.

    Beyond a right angle (1 + tau) q is taken from nu: near angle pi q is the difference of nearly equal numbers.
    """
    across, along = 0.0, 0.0
    for i in range(len(y)):
        across += p.offset[i] * y[i]
        along += p.c[i] * y[i]
    if tau > 1 and p.arm != 0:
        return (nu - along) / (p.arm * p.mass) - p.arm - across
    return (m0 * (1 + tau) + p.mass * p.arm * tau) / p.mass - across


@njit(nogil=True, **COMPILED)
def unknowns_of(p: SecularBody, m0: float, chart: np.ndarray) -> tuple[float, float]:
    """Return nu and tau of a displacement, by the inverse of `slide`."""
    across, along, tau = 0.0, 0.0, 0.0
    for i in range(len(p.b)):
        across += p.offset[i] * chart[i]
        along += p.c[i] * chart[i]
        tau += chart[i] * chart[i]
    if tau > 1 and p.arm != 0:
        return along + p.arm * p.mass * (chart[len(p.b)] + across + p.arm), tau
    return along + (1 + tau) * (p.arm * m0 + p.mass * p.arm * p.arm), tau


@njit(nogil=True, **COMPILED)
def move(p: SecularBody, m0: float, nu: float, tau: float, y: np.ndarray, pose: np.ndarray) -> None:
    """Advance the rows of a pose by the displacement, a reflection of each; keep their length."""
    k, first = len(y), 1 if p.slides else 0
    axis, width = 0 if p.slides else k, k + 1 + first
    z0 = 1 / math.sqrt(1 + tau)
    sign = -z0 if p.slides else z0
    length = 2 * slide(p, m0, nu, tau, y) * z0 if p.slides else 0.0
    for begin in range(0, len(pose), 4 * width):  # four sums at once: each term waits for the one before
        last = len(pose) - width
        places = (begin, min(begin + width, last), min(begin + 2 * width, last), min(begin + 3 * width, last))
        along, square = _reflect(pose, places, first, axis, z0, sign, y)
        for i in range(min(4, (len(pose) - begin) // width)):
            row = pose[places[i] : places[i] + width]
            row[axis] = 2 * z0 * along[i] - row[axis]
            length_squared = square[i] + row[axis] ** 2
            if length_squared > 0.5:
                for j in range(k + 1):
                    row[j] *= (3 - length_squared) / 2
            if p.slides:
                row[k + 1] += length * along[i]


@njit(forceinline=True, **COMPILED)
def _reflect(
    pose: np.ndarray, places: tuple[int, int, int, int], first: int, axis: int, z0: float, sign: float, y: np.ndarray
) -> tuple[tuple[float, float, float, float], tuple[float, float, float, float]]:
    """Reflect the turning entries of four rows in (z0, sign z0 y), but for the one on the axis.

    Return the parts of the rows along it, and the sums of squares. A row that comes twice is reflected once.
    """
    a, b, c, d = places
    along0, along1, along2, along3 = z0 * pose[a + axis], z0 * pose[b + axis], z0 * pose[c + axis], z0 * pose[d + axis]
    square0 = square1 = square2 = square3 = 0.0
    for i in range(len(y)):
        x, j = sign * y[i], first + i  # a signed index would be tested for counting from the end
        along0 += x * pose[np.uint64(a + j)]
        along1 += x * pose[np.uint64(b + j)]
        along2 += x * pose[np.uint64(c + j)]
        along3 += x * pose[np.uint64(d + j)]
    for i in range(len(y)):
        j = first + i
        at0, at1, at2, at3 = np.uint64(a + j), np.uint64(b + j), np.uint64(c + j), np.uint64(d + j)
        value0 = pose[at0] - 2 * along0 * sign * y[i]
        value1 = pose[at1] - 2 * along1 * sign * y[i]
        value2 = pose[at2] - 2 * along2 * sign * y[i]
        value3 = pose[at3] - 2 * along3 * sign * y[i]
        pose[at0], pose[at1], pose[at2], pose[at3] = value0, value1, value2, value3
        square0 += value0 * value0
        square1 += value1 * value1
        square2 += value2 * value2
        square3 += value3 * value3
    return (along0, along1, along2, along3), (square0, square1, square2, square3)


@njit(nogil=True, **COMPILED)
def start(p: SecularBody, m: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray]:
    """Return the outcome of the first root and the state of a run that begins with momenta and rows of a pose."""
    k = len(p.b)
    m0 = m[-1] if p.slides else 0.0
    certain = certain_radius(p, level_of(p, m[:k], m0))
    code, nu, tau = solve(p, m, certain, p.mass * p.arm * p.arm, 0.0, room_for_sums())
    state = np.zeros(2 * len(m) + 7 + len(pose))
    assign(state, m)
    assign(state[2 * len(m) :], np.array((nu, tau, nu, tau, nu, tau, certain)))
    assign(state[2 * len(m) + 7 :], pose)
    return code, state


@njit(nogil=True, **COMPILED)
def chart_of(p: SecularBody, m: np.ndarray, nu: float, tau: float, chart: np.ndarray) -> None:
    """Write the chart coordinates of the displacement."""
    k = len(p.b)
    coordinates(p, m, nu, tau, chart[:k])
    if p.slides:
        chart[k] = slide(p, m[k], nu, tau, chart[:k])


def chart_in(p: SecularBody, state: np.ndarray) -> np.ndarray:
    """Return the chart coordinates of the displacement in a state."""
    size = len(p.b) + p.slides
    chart = np.empty(size)
    chart_of(p, state[:size], state[2 * size], state[2 * size + 1], chart)
    return chart


@njit(nogil=True, **COMPILED)
def advance(p: SecularBody, state: np.ndarray, steps: int, every: int, rows: Rows) -> tuple[int, int]:
    """Take up to `steps` steps, saving each `every`-th one; return how many were good and the outcome.

    After a failure the state is that of the last good step.
    """
    first = state.copy()
    count, code = _take(p, state, steps, every, rows)
    if code != 0:  # the state before the last push is gone: what led to it is done again
        assign(state, first)
        _take(p, state, count, every, rows)
    return count, code


@njit(nogil=True, **COMPILED)
def _take(p: SecularBody, s: np.ndarray, steps: int, every: int, rows: Rows) -> tuple[int, int]:
    """Take steps; where a root is missing the state is good for nothing."""
    momenta, charts, poses = rows
    k, size = len(p.b), len(p.b) + (1 if p.slides else 0)
    m, carry, pose, room = s[:size], s[size : 2 * size], s[2 * size + 7 :], room_for_sums()
    nu, tau, nu1, tau1, nu2, tau2, certain = s[2 * size : 2 * size + 7]
    y, floor, lever = np.zeros(k if len(pose) else 0), floor_of(m), p.mass * p.arm * p.arm
    code, count = 0, 0
    while count < steps:
        if len(pose):
            coordinates(p, m, nu, tau, y)
            move(p, m[-1], nu, tau, y, pose)
        push(p, m, carry, nu, tau, floor)
        m0, guess = m[-1] if p.slides else 0.0, max(3 * (tau - tau1) + tau2, 0.0)
        good, nu3, tau3, square = newton(p, m, m0, 1.0, 3 * (nu - nu1) + nu2, guess, False, room)
        if not _is_principal(good, square, tau3, lever, certain):
            code, nu3, tau3 = principal(p, m, m0, room)
            if code != 0:
                break
        nu2, tau2, nu1, tau1, nu, tau = nu1, tau1, nu, tau, nu3, tau3
        count += 1
        if count % every == 0:
            row = count // every - 1
            assign(momenta[row], m)
            chart_of(p, m, nu, tau, charts[row])
            assign(poses[row], pose)
    assign(s[2 * size :], np.array((nu, tau, nu1, tau1, nu2, tau2)))
    return count, code


@njit(nogil=True, **COMPILED)
def step_each(
    p: SecularBody, momenta: np.ndarray, charts: np.ndarray, guesses: np.ndarray, principal_only: bool
) -> Rows:
    """Take one step from each row; return momenta, charts and outcomes.

    The root is the principal one or else that value of the map which Newton's method reaches from the guess.
    """
    k = len(p.b)
    room = room_for_sums()
    next_momenta, next_charts = np.empty_like(momenta), np.empty_like(charts)
    codes = np.zeros(len(momenta), dtype=np.int64)
    for row in range(len(momenta)):
        before, m = momenta[row], next_momenta[row]
        nu, tau = unknowns_of(p, before[k] if p.slides else 0.0, charts[row])
        assign(m, before)
        push(p, m, np.zeros_like(m), nu, tau, 0.0)
        m0 = m[k] if p.slides else 0.0
        nu, tau = unknowns_of(p, m0, guesses[row])
        if principal_only:
            certain = certain_radius(p, level_of(p, m[:k], m0))
            codes[row], nu, tau = solve(p, m, certain, nu, tau, room)
        else:
            good, nu, tau, _ = newton(p, m, m0, 1.0, nu, tau, True, room)
            codes[row] = 0 if good else 3
        chart_of(p, m, nu, tau, next_charts[row])
    return next_momenta, next_charts, codes
