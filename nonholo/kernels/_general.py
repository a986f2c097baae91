r"""The step for any left- or right-invariant constraint on SO(n) and SE(n), straight from its matrix equations.

The displacement is $W = (I - Y)^{-1}(I + Y)$, $Y = \sum_a y_a C_a$. Unknowns are its m Cayley coordinates, equations

$$ \mathrm{tr}(D_i W J (W - I)^T) = m_i \ (i \le k), \qquad \langle A_j, \tfrac12 (W - W^{-1})\rangle = 0, $$

with $D_i$ a basis of $\mathfrak{d}$ and momenta in units of displacements, $m = h r/\ell^2$. All lengths are in
units of a length $\ell$ of the body, so that translations and rotations are numbers of one size. Where
$\exp\mathfrak{d}$ solves the constraint, the $C_a$ are the $D_i$ and there is no second kind; otherwise the $C_a$
span the algebra. With `spatial` the constraint is right-invariant: the pose carries J to space, and m is constant.
"""

from typing import NamedTuple

import numba
import numpy as np

_STEPS = 12  # of Newton's method
_FIRST = 0.25  # first continuation step, in s
_SMALLEST = 1e-7  # continuation step, relative to s, below which the branch is given up
_LEAST = 1e-300  # and the absolute one: a momentum may be any number of times too large
_FAR = 1e4  # turning of a displacement beyond which the Cayley chart ends: an angle of 179 degrees
_LOST = 1e12  # that of an iteration that runs away


class GeneralBody(NamedTuple):
    """Matrices of a body and its constraint.

    Attributes:
        tensor: Mass tensor, (N, N).
        directions: D_i, (k, N, N).
        chart: C_a, (m, N, N).
        forbidden: A_j, (m - k, N, N); the pairing is the sum of products of entries.
        size: n, the size of the rotations.
        spatial: Whether the constraint is right-invariant.
        metric: Inverse of the constrained inertia, (k, k).
        radius: Squared radius of the ball in which a root is certainly principal, in the metric of the energy.
        level: Largest squared norm of scaled momenta for which it is.
        unit: The length l; poses are in the unit of the user's.
        stretch: Factors from the coordinates y of this kernel to those of the caller, (m,).
    """

    tensor: np.ndarray
    directions: np.ndarray
    chart: np.ndarray
    forbidden: np.ndarray
    size: int
    spatial: bool
    metric: np.ndarray
    radius: float
    level: float
    unit: float
    stretch: np.ndarray


@numba.njit(cache=True)
def _turning(p: GeneralBody, y: np.ndarray) -> float:
    """Return half the sum of the squared entries of the rotational part of Y: the sum of tan^2(angle / 2)."""
    Y = np.zeros((p.size, p.size))
    for a in range(len(y)):
        Y += y[a] * p.chart[a, : p.size, : p.size]
    return np.sum(Y * Y) / 2


@numba.njit(cache=True)
def displaced(p: GeneralBody, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return W - I and (I - Y)^{-1}; W - I = 2 (I - Y)^{-1} Y without cancellation."""
    Y = np.zeros_like(p.tensor)
    for a in range(len(y)):
        Y += y[a] * p.chart[a]
    G = np.linalg.inv(np.eye(len(Y)) - Y)
    return 2 * (G @ Y), G


@numba.njit(cache=True)
def inverse(p: GeneralBody, W: np.ndarray) -> np.ndarray:
    """Return the inverse of a rotation or a rigid motion."""
    n, V = p.size, W.T.copy()
    if len(W) > n:
        V[n, :n] = 0.0
        V[:n, n] = -(np.ascontiguousarray(V[:n, :n]) @ W[:n, n].copy())
    return V


@numba.njit(cache=True)
def _paired(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return the sums of products of entries, of each matrix of a stack with one matrix."""
    return np.array([np.sum(matrix * second) for matrix in first]) if len(first) else np.zeros(0)


@numba.njit(cache=True)
def equations(p: GeneralBody, J: np.ndarray, m: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the residual and its Jacobian at y."""
    X, G = displaced(p, y)
    eye = np.eye(len(J))
    W = X + eye
    V, WJ, JX = inverse(p, W), W @ J, J @ X.T
    k, unknowns = len(p.directions), len(p.chart)
    residual, slope = np.empty(unknowns), np.empty((unknowns, unknowns))
    residual[:k] = _paired(p.directions, (WJ @ X.T).T) - m
    residual[k:] = _paired(p.forbidden, (X - (V - eye)) / 2)
    right = W + eye
    for a in range(unknowns):
        dW = (G @ p.chart[a]) @ right
        slope[:k, a] = _paired(p.directions, (dW @ JX + WJ @ dW.T).T)
        if unknowns > k:
            slope[k:, a] = _paired(p.forbidden, (dW + V @ dW @ V) / 2)
    return residual, slope


@numba.njit(cache=True)
def increments(p: GeneralBody, J: np.ndarray, X: np.ndarray) -> np.ndarray:
    r"""Return the change of the scaled momenta in one step, $\mathrm{tr}([X, D_i] J X^T)$."""
    JX = J @ X.T
    return _paired(p.directions, (JX @ X - X @ JX).T)


@numba.njit(cache=True)
def newton(p: GeneralBody, J: np.ndarray, m: np.ndarray, y: np.ndarray) -> tuple[bool, np.ndarray, float]:
    """Correct a guess until the next correction would be below rounding; also the Jacobian determinant at the end."""
    det = 1.0
    for _ in range(_STEPS if len(y) else 0):
        if not _turning(p, y) < _LOST:  # I - Y may be singular to rounding beyond
            return False, y, det
        residual, slope = equations(p, J, m, y)
        det = np.linalg.det(slope)
        if not (np.isfinite(det) and det != 0):
            return False, y, det
        step = np.linalg.solve(slope, residual)
        y = y - step
        if np.sum(step * step) <= 1e-18 * (1 + np.sum(y * y)):
            return True, y, det
    return len(y) == 0, y, det


@numba.njit(cache=True)
def certified(p: GeneralBody, J: np.ndarray, m: np.ndarray, y: np.ndarray) -> bool:
    """Tell whether a root is certainly the principal one: it lies in the ball where there is only one."""
    if p.spatial or m @ (p.metric @ m) > p.level:
        return False
    X, _ = displaced(p, y)
    if np.sum(X[: p.size, : p.size] ** 2) >= 4.0:  # no longer surely below 90 degrees, where K determines W
        return False
    K = (X - (inverse(p, X + np.eye(len(J))) - np.eye(len(J)))) / 2
    return bool(np.sum((K @ J) * K) <= p.radius)


@numba.njit(cache=True)
def principal(p: GeneralBody, J: np.ndarray, m: np.ndarray) -> tuple[int, np.ndarray]:
    """Follow the root from momentum zero along s m, 0 <= s <= 1; return the outcome and y."""
    y = np.zeros(len(p.chart))
    if not np.all(np.isfinite(m)):
        return 5, y
    target = np.zeros(len(y))
    target[: len(m)] = m
    if len(y) == 0:
        return 0, y
    _, slope = equations(p, J, 0 * m, y)
    start = np.linalg.det(slope)
    tangent = np.linalg.solve(slope, target)
    s, size, now = 0.0, _FIRST, start
    while s < 1.0:
        size = min(size, 1.0 - s)
        ahead = 1.0 if size == 1.0 - s else s + size
        guess = y + size * tangent
        good, found, det = newton(p, J, ahead * m, guess)
        moved, off = found - y, found - guess
        close = np.sum(off * off) <= 0.01 * np.sum(moved * moved) or np.sum(moved * moved) < 1e-6
        if good and close and det * start > 0 and np.sum(moved * moved) <= 0.04 * (1 + np.sum(y * y)) ** 2:
            y, s, now, size = found, ahead, det, 2 * size
            _, slope = equations(p, J, s * m, y)
            if np.linalg.det(slope) * start <= 0:  # singular to rounding
                return _why_it_ended(p, y, 0.0, start), y
            tangent = np.linalg.solve(slope, target)
        elif size > max(_SMALLEST * s, _LEAST):
            size /= 4
        else:
            return _why_it_ended(p, y, now, start), y
    return 0, y


@numba.njit(cache=True)
def _why_it_ended(p: GeneralBody, y: np.ndarray, det: float, start: float) -> int:
    """Tell a fold (1) from the end of the chart (2) and from a failure to converge (3)."""
    if _turning(p, y) > _FAR:
        return 2
    return 1 if abs(det) < 1e-2 * abs(start) else 3


@numba.njit(cache=True)
def solve(p: GeneralBody, J: np.ndarray, m: np.ndarray, guess: np.ndarray) -> tuple[int, np.ndarray]:
    """Correct a guess and verify that it is the principal root, or follow it from momentum zero."""
    good, y, _ = newton(p, J, m, guess)
    if good and certified(p, J, m, y):
        return 0, y
    return principal(p, J, m)


@numba.njit(cache=True)
def tensor_at(p: GeneralBody, g: np.ndarray) -> np.ndarray:
    """Return the mass tensor that the equations see at a pose."""
    if not p.spatial:
        return p.tensor
    scaled = _in_units(p, g, 1 / p.unit)
    return (scaled @ p.tensor) @ scaled.T.copy()


@numba.njit(cache=True)
def _in_units(p: GeneralBody, g: np.ndarray, factor: float) -> np.ndarray:
    """Return a motion with its translation multiplied by a factor."""
    scaled = g.copy()
    if len(g) > p.size:
        scaled[: p.size, p.size] *= factor
    return scaled


@numba.njit(cache=True)
def moved(p: GeneralBody, g: np.ndarray, W: np.ndarray) -> np.ndarray:
    """Return the pose after one displacement, its rotation brought back to the group by one Newton-Schulz step."""
    V = _in_units(p, W, p.unit)
    n, after = p.size, (V @ g if p.spatial else g @ V)
    R = np.ascontiguousarray(after[:n, :n])
    after[:n, :n] = R @ (3 * np.eye(n) - R.T @ R) / 2
    return after


@numba.njit(cache=True, nogil=True)
def advance(
    p: GeneralBody,
    state: np.ndarray,
    steps: int,
    every: int,
    momenta: np.ndarray,
    charts: np.ndarray,
    poses: np.ndarray,
) -> tuple[int, int]:
    """Take up to `steps` steps, saving each `every`-th one; return how many were good and the outcome.

    The state holds momenta and their compensations (k each), the last three charts (m each) and the pose (N N). After
    a failure it is that of the last good step.
    """
    k, c, N = len(p.directions), len(p.chart), len(p.tensor)
    m, lost = state[:k].copy(), state[k : 2 * k].copy()
    charts_now = state[2 * k : 2 * k + 3 * c].copy().reshape(3, c)
    y, u, v = charts_now[0], charts_now[1], charts_now[2]
    g = state[2 * k + 3 * c :].copy().reshape(N, N)
    code, done = 0, 0
    while done < steps:
        X, _ = displaced(p, y)
        after = moved(p, g, X + np.eye(N))
        term = (np.zeros(k) if p.spatial else increments(p, p.tensor, X)) - lost
        total = m + term
        code, found = solve(p, tensor_at(p, after), total, 3 * (y - u) + v)
        if code != 0:
            break
        lost = (total - m) - term
        m, v, u, y, g = total, u, y, found, after
        done += 1
        if done % every == 0:
            row = done // every - 1
            momenta[row], charts[row], poses[row] = m, y * p.stretch, g.ravel()
    state[: 2 * k] = np.concatenate((m, lost))
    state[2 * k :] = np.concatenate((y, u, v, g.ravel()))
    return done, code


@numba.njit(cache=True, nogil=True)
def start(p: GeneralBody, m: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray]:
    """Return the outcome of the first root and the state of a run that begins with scaled momenta and a pose."""
    k, c, N = len(p.directions), len(p.chart), len(p.tensor)
    code, y = solve(p, tensor_at(p, pose.copy().reshape(N, N)), m, np.zeros(c))
    return code, np.concatenate((m, np.zeros(k), y, y, y, pose))


@numba.njit(cache=True, nogil=True)
def step_each(
    p: GeneralBody,
    momenta: np.ndarray,
    charts: np.ndarray,
    poses: np.ndarray,
    guesses: np.ndarray,
    principal_only: bool,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Take one step from each row; return momenta, charts and outcomes.

    The root is the principal one or else that value of the map which Newton's method reaches from the guess.
    """
    N = len(p.tensor)
    next_momenta, next_charts = np.empty_like(momenta), np.empty_like(charts)
    codes = np.zeros(len(momenta), dtype=np.int64)
    for row in range(len(momenta)):
        X, _ = displaced(p, charts[row] / p.stretch)
        J, m = p.tensor, momenta[row]
        if p.spatial:
            J = tensor_at(p, moved(p, poses[row].copy().reshape(N, N), X + np.eye(N)))
        else:
            m = m + increments(p, J, X)
        next_momenta[row] = m
        if principal_only:
            codes[row], y = solve(p, J, m, guesses[row] / p.stretch)
        else:
            good, y, _ = newton(p, J, m, guesses[row] / p.stretch)
            codes[row] = 0 if good else 3
        next_charts[row] = y * p.stretch
    return next_momenta, next_charts, codes
