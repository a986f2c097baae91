r"""Steps to the nearest value, where that is clear: one real root of the equations of a body followed along a segment.

The equations are those of `nonholo.discrete`, on the sphere over the displacement variety and in units of the body,

$$ z_0 B_1z + (z\cdot z)c - (c\cdot z)z + \tfrac\alpha2 uz = r, \qquad uz_0 - 2\alpha z\cdot z = p,
   \qquad z_0^2 + z\cdot z = 1. $$

An unclear step (a root near a fold, a lost path) is left to them: `advance` ends before that step.
"""

from typing import NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._small import assign, eliminate


class NearestBody(NamedTuple):
    """A body in its own units, and how a root of its equations is followed.

    Attributes:
        stiffness: Diagonal of B_1.
        coupling: c.
        arm: alpha, zero of a top.
        slides: Whether there are u and p, those of a sleigh.
        longest: A predicted move per continuation step.
        close: Part of the predicted move that the corrector may add.
        small: A corrector's move that is accepted where the predicted one is smaller.
        corrections: How many of Newton's method.
    converged: A correction after which the next one is below rounding.
        shortest: Continuation step below which the root is given up.
        clear: Regularity that is certainly no fold.
    """

    stiffness: np.ndarray
    coupling: np.ndarray
    arm: float
    slides: bool
    longest: float
    close: float
    small: float
    corrections: int
    converged: float
    shortest: float
    clear: float


@njit()
def _sums(p: NearestBody, x: np.ndarray) -> tuple[float, float, float]:
    """Return the coupling along a point, the square of its length, and its slide."""
    along = square = 0.0
    for i in range(len(p.coupling)):
        along += p.coupling[i] * x[1 + i]
        square += x[1 + i] * x[1 + i]
    return along, square, x[len(p.coupling) + 1] if p.slides else 0.0


@njit()
def residual(p: NearestBody, goal: np.ndarray, x: np.ndarray, out: np.ndarray) -> None:
    """Write the equations, whose right-hand sides are the goal."""
    k = len(p.stiffness)
    along, square, u = _sums(p, x)
    for i in range(k):
        force = x[0] * p.stiffness[i] * x[1 + i] + square * p.coupling[i] - along * x[1 + i]
        out[i, 0] = force + p.arm / 2 * u * x[1 + i] - goal[i]
    if p.slides:
        out[k, 0] = u * x[0] - 2 * p.arm * square - goal[k]
    out[len(x) - 1, 0] = x[0] * x[0] + square - 1


@njit()
def slope(p: NearestBody, x: np.ndarray, J: np.ndarray) -> None:
    """Write the derivative of the equations."""
    k, m = len(p.stiffness), len(x)
    along, _, u = _sums(p, x)
    J[:] = 0.0
    for i in range(k):
        J[i, 0] = p.stiffness[i] * x[1 + i]
        for j in range(k):
            J[i, 1 + j] = 2 * p.coupling[i] * x[1 + j] - x[1 + i] * p.coupling[j]
        J[i, 1 + i] += x[0] * p.stiffness[i] - along + p.arm / 2 * u
        J[m - 1, 1 + i] = 2 * x[1 + i]
    J[m - 1, 0] = 2 * x[0]
    if p.slides:
        J[k, 0], J[k, m - 1] = u, x[0]
        for i in range(k):
            J[i, m - 1] = p.arm / 2 * x[1 + i]
            J[k, 1 + i] = -4 * p.arm * x[1 + i]


@njit()
def kick(p: NearestBody, goal: np.ndarray, x: np.ndarray, out: np.ndarray) -> None:
    """Write the goal of the step after a point."""
    k = len(p.stiffness)
    along, square, u = _sums(p, x)
    for i in range(k):
        out[i] = goal[i] + 2 * (along * x[1 + i] - square * p.coupling[i]) - p.arm * u * x[1 + i]
    if p.slides:
        out[k] = goal[k] + 4 * p.arm * square


@njit()
def _length(move: np.ndarray, at: np.ndarray) -> float:
    """Return the size of a move, of components relative to themselves where they are large."""
    total = 0.0
    for i in range(len(at)):
        part = move[i] / max(1.0, abs(at[i]))
        total += part * part
    return np.sqrt(total)


@njit()
def _is_clear(p: NearestBody, J: np.ndarray, det: float) -> bool:
    """Return whether the least singular value of the derivative along the sphere is certainly large.

    It is at least the determinant over the product of the others, each of which is at most the Frobenius norm.
    """
    if not (np.isfinite(det) and det != 0):
        return False
    k, m = len(p.stiffness), len(J)
    square = last = 0.0
    least = abs(det)
    for i in range(m - 1):
        unit = abs(p.stiffness[i]) if i < k else 1.0
        least /= unit
        for j in range(m):
            square += (J[i, j] / unit) ** 2
    for j in range(m):
        last += J[m - 1, j] ** 2
    least /= np.sqrt(last)
    for _ in range(m - 2):
        least /= np.sqrt(square)
    return least > p.clear


@njit()
def _correct(p: NearestBody, goal: np.ndarray, guess: np.ndarray, prediction: float, x: np.ndarray) -> bool:
    """Write the root next to a guess; false if it is further away than the prediction allows."""
    m = len(guess)
    J, correction = np.empty((m, m)), np.empty((m, 1))
    most = max(p.close * prediction, min(p.small, prediction))
    assign(x, guess)
    for _ in range(p.corrections):
        slope(p, x, J)
        residual(p, goal, x, correction)
        det = eliminate(J, correction)
        if not (np.isfinite(det) and det != 0):
            return False
        x -= correction[:, 0]
        if not _length(x - guess, guess) <= most + p.converged:
            return False
        if _length(correction[:, 0], x) <= p.converged:
            return True
    return False


@njit()
def _tangent(p: NearestBody, x: np.ndarray, direction: np.ndarray, out: np.ndarray, J: np.ndarray) -> float:
    """Write how a root moves with its goal; return the determinant of the derivative, which is left in J."""
    slope(p, x, J)
    for i in range(len(direction)):
        out[i, 0] = direction[i]
    out[len(direction) :, 0] = 0.0
    return eliminate(J.copy(), out)


@njit()
def _keeps(det: float, positive: bool) -> bool:
    """Return whether a determinant keeps its sign."""
    return det != 0 and np.isfinite(det) and (det > 0) == positive


@njit()
def follow(p: NearestBody, start: np.ndarray, end: np.ndarray, x: np.ndarray) -> bool:
    """Follow a root from one goal to another; false, with the point as it was, if the path is not clear."""
    m, here = len(x), x.copy()
    J, tangent, there = np.empty((m, m)), np.empty((m, 1)), np.empty(m)
    direction = end - start
    det = _tangent(p, here, direction, tangent, J)
    if not _is_clear(p, J, det):
        return False
    positive, s, size = det > 0, 0.0, 1.0
    while s < 1.0:
        pace = _length(tangent[:, 0], here)
        size = min(size, 1.0 - s, p.longest / pace if pace > 0 else 1.0)
        ahead = 1.0 if size == 1.0 - s else s + size
        goal = end if ahead == 1.0 else start + ahead * direction
        clear = _correct(p, goal, here + size * tangent[:, 0], size * pace, there)
        if clear:
            clear = _keeps(_tangent(p, there, direction, tangent, J), positive)
        if clear:
            assign(here, there)
            s, size = ahead, 2 * size
        elif size > p.shortest:
            size /= 4
            _tangent(p, here, direction, tangent, J)
        else:
            return False
    assign(x, here)
    return True


@njit()
def advance(p: NearestBody, goal: np.ndarray, x: np.ndarray, goals: np.ndarray, points: np.ndarray) -> int:
    """Take as many steps as there are rows for goals and points; return how many were clear."""
    for step in range(len(points)):
        now, here = (goal, x) if step == 0 else (goals[step - 1], points[step - 1])
        kick(p, now, here, goals[step])
        assign(points[step], here)
        if not follow(p, now, goals[step], points[step]):
            return step
    return len(points)
