"""The principal root of the general step: Newton's method, its certificate, and continuation where there is none."""

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import PIECES
from nonholo.kernels._small import assign, assign_rows, eliminate, multiply, paired
from nonholo.kernels.general._step import LOST, GeneralBody, Workspace, displaced, equations, skew_part

_STEPS = 12  # of Newton's method
_FIRST = 0.25  # first continuation step, in s
_SMALLEST = 1e-7  # continuation step, relative to s, below which the branch is given up
_BENT = 0.5  # most change of the Jacobian in one piece of the path: two roots for one momentum differ by -2
_APART = 1e300  # of Jacobians that cannot be compared
_ROUNDING = 1e-24  # squared, of a displacement
_LEAST = 1e-300  # and the absolute one: a momentum may be any number of times too large
_FAR = 1e4  # turning of a displacement beyond which the Cayley chart ends: an angle of 179 degrees


@njit()
def newton(p: GeneralBody, w: Workspace, m: np.ndarray, y: np.ndarray) -> tuple[bool, float]:
    """Correct a guess until the next correction would be below rounding; return the Jacobian determinant at the end."""
    det = 1.0
    for _ in range(_STEPS if len(y) else 0):
        if not displaced(p, w, y) < LOST:
            return False, det
        equations(p, w, m)
        correction = w.residual
        det = eliminate(w.slope, correction)
        if not (np.isfinite(det) and det != 0):
            return False, det
        step = size = 0.0
        for a in range(len(y)):
            y[a] -= correction[a, 0]
            step += correction[a, 0] ** 2
            size += y[a] ** 2
        if step <= 1e-18 * (1 + size):
            return True, det
    return len(y) == 0, det


@njit()
def certified(p: GeneralBody, w: Workspace, m: np.ndarray, y: np.ndarray) -> bool:
    """Tell whether a root is certainly the principal one: it lies in the ball where there is only one.

    The workspace holds its displacement afterwards.
    """
    displaced(p, w, y)
    if p.spatial or not _energy(p.metric, m) <= p.level:
        return False
    X, K, carried = w.X, w.scratch, w.V
    if _rotational(X, p.size) >= 4.0:  # no longer surely below 90 degrees, where K determines W
        return False
    skew_part(p, w)
    multiply(K, p.tensor, carried)
    return paired(carried, K) <= p.radius


@njit()
def _rotational(X: np.ndarray, n: int) -> float:
    """Return the sum of the squares of the first n rows and columns."""
    total = 0.0
    for i in range(n):
        for j in range(n):
            total += X[i, j] ** 2
    return total


@njit()
def _energy(metric: np.ndarray, m: np.ndarray) -> float:
    total = 0.0
    for i in range(len(m)):
        for j in range(len(m)):
            total += m[i] * metric[i, j] * m[j]
    return total


@njit()
def _tangent(
    p: GeneralBody, w: Workspace, m: np.ndarray, y: np.ndarray, s: float, slope: np.ndarray
) -> tuple[float, np.ndarray]:
    """Write the Jacobian at a root; return its determinant and the derivative of the root with respect to s."""
    displaced(p, w, y)
    equations(p, w, s * m)
    assign_rows(slope, w.slope)
    w.residual[:] = 0.0
    assign(w.residual[:, 0], m)
    det = eliminate(w.slope, w.residual)
    return det, w.residual[:, 0].copy()


@njit()
def _bend(before: np.ndarray, after: np.ndarray) -> float:
    """Return how far Jacobians are apart, by traces of E and E^2, E + I the quotient: the same in all coordinates.

    Were the equations quadratic, E would have an eigenvalue of -2 between two roots for the same momentum.
    """
    E, trace = after.copy(), 0.0
    det = eliminate(before.copy(), E)
    for a in range(len(E)):
        E[a, a] -= 1
        trace += E[a, a]
    square = abs(paired(E, E.T))
    return max(abs(trace), square) if np.isfinite(det) and det != 0 and np.isfinite(square) else _APART


@njit()
def principal(p: GeneralBody, w: Workspace, m: np.ndarray) -> tuple[int, np.ndarray]:
    """Follow the root from momentum zero along s m, 0 <= s <= 1; return the outcome and y."""
    y = np.zeros(len(p.stretch))
    if not np.all(np.isfinite(m)):
        return 5, y
    if len(y) == 0:
        return 0, y
    slope, slope_ahead = np.empty_like(w.slope), np.empty_like(w.slope)
    start, tangent = _tangent(p, w, m, y, 0.0, slope)
    s, size, now, peak = 0.0, _FIRST, start, abs(start)
    for _ in range(PIECES):
        size = min(size, 1.0 - s)
        ahead = 1.0 if size == 1.0 - s else s + size
        guess = y + size * tangent
        found = guess.copy()
        good, det = newton(p, w, ahead * m, found)
        if good and det * start > 0 and _close(y, guess, found):
            det, tangent_ahead = _tangent(p, w, m, found, ahead, slope_ahead)
            good = _bend(slope, slope_ahead) <= _BENT
        else:
            good, tangent_ahead = False, tangent
        if good:
            y, s, now, size, tangent = found, ahead, det, 2 * size, tangent_ahead
            assign_rows(slope, slope_ahead)
            if len(p.form) > 0:  # boosts scale the determinant
                peak = max(peak, abs(det))
            if not det * start > 0:  # singular to rounding
                return _why_it_ended(p, w, y, 0.0, peak), y
            if s == 1.0:
                return 0, y
        elif size > max(_SMALLEST * s, _LEAST):
            size /= 4
        else:
            return _why_it_ended(p, w, y, now, peak), y
    return 3, y


@njit()
def _close(y: np.ndarray, guess: np.ndarray, found: np.ndarray) -> bool:
    """Tell whether a root is where the tangent foretold, to a tenth of a move that is not long, or to rounding."""
    moved, off, size = np.sum((found - y) ** 2), np.sum((found - guess) ** 2), 1 + np.sum(y * y)
    return off <= 0.01 * moved + _ROUNDING * size and moved <= 0.04 * size * size


@njit()
def _why_it_ended(p: GeneralBody, w: Workspace, y: np.ndarray, det: float, peak: float) -> int:
    """Tell a fold (1) from the end of the chart or of all displacements (2) and from a failure to converge (3)."""
    if displaced(p, w, y) > _FAR or (len(p.form) > 0 and paired(w.X, w.X) > _FAR**2):
        return 2
    return 1 if abs(det) < 1e-2 * peak else 3


@njit()
def solve(p: GeneralBody, w: Workspace, m: np.ndarray, guess: np.ndarray) -> tuple[int, np.ndarray]:
    """Correct a guess and verify that it is the principal root, or follow it from momentum zero.

    The workspace holds its displacement afterwards.
    """
    y = guess.copy()
    good, _ = newton(p, w, m, y)
    if good and certified(p, w, m, y):
        return 0, y
    code, y = principal(p, w, m)
    displaced(p, w, y)
    return code, y
