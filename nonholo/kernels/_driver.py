"""The compiled loop over steps: warm start, correction, certificate, restart from zero, compensated momentum.

The state is one array, so that a run can stop after any step and continue with the same bits:
momentum (2), its compensation (2), the last three Cayley coordinates (6), pose (4).
"""

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import COMPILED, Body, Rows, correction, increment, is_certain, move, principal, scalar
from nonholo.kernels._small import assign

STATE_SIZE = 14
CHART = slice(4, 6)  # where the coordinates of the displacement stand in a state
SETTLED = 1e-150  # of one momentum to the other; squares below it underflow
CORRECTIONS = 8  # of a guess, before the root is followed from momentum zero


@njit(nogil=True, **COMPILED)
def start(p: Body, momentum: np.ndarray, pose: np.ndarray, state: np.ndarray) -> int:
    """Fill the state of a run that begins with scaled momenta and a pose; return the outcome of the first root."""
    code, y1, y2 = _solve(p, momentum[0], momentum[1], 0.0, 0.0)
    assign(state, momentum)
    state[2:4] = 0.0
    for i in (4, 6, 8):
        state[i], state[i + 1] = y1, y2
    assign(state[10:], pose)
    return code


def first_state(p: Body, momentum: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray]:
    """Return the outcome of the first root, and the state of a run that begins with scaled momenta and a pose."""
    state = np.zeros(STATE_SIZE)
    return start(p, momentum, pose, state), state


def chart_in(_p: Body, state: np.ndarray) -> np.ndarray:
    """Return the coordinates of the displacement in a state."""
    return state[CHART]


@njit(nogil=True, **COMPILED)
def advance(p: Body, state: np.ndarray, steps: int, every: int, rows: Rows) -> tuple[int, int]:
    """Take up to `steps` steps, saving each `every`-th one; return how many were good and the outcome.

    After a failure the state is that of the last good step.
    """
    momenta, charts, poses = rows
    m1, m2, k1, k2, y1, y2, u1, u2, v1, v2, q0, q1, q2, q3 = _unpack(state)
    code, count = 0, 0
    while count < steps:
        d1, d2 = increment(p, m1, m2, y1, y2)
        n1, l1 = kahan_sum(m1, k1, d1, SETTLED * abs(m2))
        n2, l2 = kahan_sum(m2, k2, d2, SETTLED * abs(m1))
        code, w1, w2 = _solve(p, n1, n2, 3 * (y1 - u1) + v1, 3 * (y2 - u2) + v2)
        if code != 0:
            break
        q0, q1, q2, q3 = move(p, y1, y2, q0, q1, q2, q3)
        m1, m2, k1, k2 = n1, n2, l1, l2
        v1, v2, u1, u2, y1, y2 = u1, u2, y1, y2, w1, w2
        count += 1
        if count % every == 0:
            row = count // every - 1
            momenta[row, 0], momenta[row, 1] = m1, m2
            charts[row, 0], charts[row, 1] = y1, y2
            poses[row, 0], poses[row, 1], poses[row, 2], poses[row, 3] = q0, q1, q2, q3
    state[0], state[1], state[2], state[3] = m1, m2, k1, k2
    state[4], state[5], state[6], state[7], state[8], state[9] = y1, y2, u1, u2, v1, v2
    state[10], state[11], state[12], state[13] = q0, q1, q2, q3
    return count, code


@njit(inline="always", **COMPILED)
def _unpack(s: np.ndarray):  # noqa: ANN202
    return s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8], s[9], s[10], s[11], s[12], s[13]


@njit(**COMPILED)
def kahan_sum(total: float, carry: float, term: float, floor: float) -> tuple[float, float]:
    """Add by Kahan's summation; return the sum and the rounding it lost.

    A sum that has decayed below `floor` is put on the equilibrium: what is left would soon be denormal, and slow.
    """
    term = term - carry
    result = total + term
    if abs(result) < floor and (abs(result) < abs(total) or total == 0):
        return 0.0, 0.0
    return result, (result - total) - term


@njit(**COMPILED)
def _solve(p: Body, m1: float, m2: float, y1: float, y2: float) -> tuple[int, float, float]:
    """Correct a guess and verify that it is the principal root, or restart from momentum zero."""
    good, y1, y2 = _newton(p, m1, m2, y1, y2)
    if good and is_certain(p, m1, m2, y1, y2):
        return 0, y1, y2
    return principal(p, m1, m2)


@njit(**COMPILED)
def _newton(p: Body, m1: float, m2: float, y1: float, y2: float) -> tuple[bool, float, float]:
    """Correct a guess until the next correction would be below rounding."""
    for _ in range(CORRECTIONS):
        d1, d2 = correction(p, m1, m2, y1, y2)
        y1 += d1
        y2 += d2
        if converged(d1, d2, y1, y2):
            return True, y1, y2
    return False, y1, y2


@scalar
def floor_of(m: np.ndarray) -> float:
    """Return below what momenta count as zero."""
    largest = 0.0
    for i in range(len(m)):
        largest = max(largest, abs(m[i]))
    return SETTLED * largest


@scalar
def converged(d1: float, d2: float, y1: float, y2: float) -> bool:
    """Return whether a correction that led to y was so small that the next one would be below rounding."""
    return d1 * d1 + d2 * d2 <= 1e-18 * (1 + y1 * y1 + y2 * y2)


@njit(nogil=True, **COMPILED)
def step_each(p: Body, momenta: np.ndarray, charts: np.ndarray, guesses: np.ndarray, principal_only: bool) -> Rows:
    """Take one step from each row; return momenta, charts and outcomes.

    The root is the principal one or else that value of the map which Newton's method reaches from the guess.
    """
    next_momenta, next_charts = np.empty_like(momenta), np.empty_like(charts)
    codes = np.zeros(len(momenta), dtype=np.int64)
    for k in range(len(momenta)):
        y1, y2 = charts[k]
        d1, d2 = increment(p, momenta[k, 0], momenta[k, 1], y1, y2)
        m1, m2 = momenta[k, 0] + d1, momenta[k, 1] + d2
        if principal_only:
            codes[k], w1, w2 = _solve(p, m1, m2, guesses[k, 0], guesses[k, 1])
        else:
            good, w1, w2 = _newton(p, m1, m2, guesses[k, 0], guesses[k, 1])
            codes[k] = 0 if good else 3
        next_momenta[k, 0], next_momenta[k, 1] = m1, m2
        next_charts[k, 0], next_charts[k, 1] = w1, w2
    return next_momenta, next_charts, codes
