r"""The step for any left- or right-invariant constraint on SO(n) and SE(n), straight from its matrix equations.

The displacement is $W = I + X = (I - Y)^{-1}(I + Y)$, $Y = \sum_a y_a C_a$. Unknowns are its m Cayley coordinates,
equations

$$ \mathrm{tr}(D_i W J X^T) = \mathrm{tr}(D_i J X^T) = m_i \ (i \le k), \qquad
   \langle A_j, \tfrac12 (W - W^{-1})\rangle = 0, $$

where $\mathrm{tr}(D X J X^T) = 0$ since $XJX^T$ is symmetric and has no homogeneous part. The derivatives of X are
$2GC_aG$, $G = (I - Y)^{-1}$. Here $D_i$ is a basis of $\mathfrak{d}$, momenta are in units of displacements,
$m = h r/\ell^2$, and all lengths in units of a length $\ell$ of the body, so that translations and rotations are
numbers of one size. Where $\exp\mathfrak{d}$ solves the constraint, the $C_a$ are the $D_i$ and there is no second
kind; otherwise the $C_a$ span the algebra. With `spatial` the constraint is right-invariant: the pose carries J to
space, and m is constant.
"""

from typing import NamedTuple

import numba
import numpy as np

from nonholo.kernels._small import eliminate, multiply, paired, sandwich, transpose

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
        places: Index a, row and column of the entries of C_a that are not zero, (E, 3).
        entries: Their values, (E,).
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
    places: np.ndarray
    entries: np.ndarray
    forbidden: np.ndarray
    size: int
    spatial: bool
    metric: np.ndarray
    radius: float
    level: float
    unit: float
    stretch: np.ndarray


class Workspace(NamedTuple):
    """Matrices that the functions below write to, made once for a run.

    Attributes:
        G: (I - Y)^{-1}.
        X: W - I.
        V: The inverse of W, or scratch.
        H: (I + Y)^{-1}, or scratch.
        scratch: One more.
        half: Another.
        Q: D_i J, (k, N, N), with the mass tensor that the equations see.
        slope: The Jacobian, (m, m).
        residual: The residual, then the correction, (m, 1).
    """

    G: np.ndarray
    X: np.ndarray
    V: np.ndarray
    H: np.ndarray
    scratch: np.ndarray
    half: np.ndarray
    Q: np.ndarray
    slope: np.ndarray
    residual: np.ndarray


@numba.njit(cache=True)
def workspace(p: GeneralBody) -> Workspace:
    """Return a workspace for a body, with the mass tensor of the body."""
    N, m = len(p.tensor), len(p.stretch)
    many = np.zeros((6, N, N))
    w = Workspace(
        many[0],
        many[1],
        many[2],
        many[3],
        many[4],
        many[5],
        np.zeros_like(p.directions),
        np.zeros((m, m)),
        np.zeros((m, 1)),
    )
    see_tensor(p, w, p.tensor)
    return w


@numba.njit(cache=True)
def see_tensor(p: GeneralBody, w: Workspace, J: np.ndarray) -> None:
    """Let the equations see a mass tensor."""
    for i in range(len(p.directions)):
        multiply(p.directions[i], J, w.Q[i])


@numba.njit(cache=True)
def displaced(p: GeneralBody, w: Workspace, y: np.ndarray) -> float:
    """Compute X = 2 (I - Y)^{-1} Y and G = I + X / 2; return how far it turns, the sum of tan^2(angle / 2).

    Beyond `_LOST`, where I - Y may be singular to rounding, they are not computed.
    """
    return _displaced(p.places, p.entries, p.size, y, w.X, w.G, w.scratch)


@numba.njit(cache=True)
def _displaced(
    places: np.ndarray, entries: np.ndarray, n: int, y: np.ndarray, X: np.ndarray, G: np.ndarray, scratch: np.ndarray
) -> float:
    X[:] = 0.0
    for e in range(len(entries)):
        X[places[e, 1], places[e, 2]] += 2 * y[places[e, 0]] * entries[e]
    turning = 0.0
    for i in range(len(X)):
        for j in range(len(X)):
            if i < n and j < n:
                turning += X[i, j] ** 2 / 8
            scratch[i, j] = -X[i, j] / 2
        scratch[i, i] += 1.0
    if not (turning < _LOST):
        return turning
    eliminate(scratch, X)
    for i in range(len(X)):
        for j in range(len(X)):
            G[i, j] = X[i, j] / 2
        G[i, i] += 1.0
    return turning


@numba.njit(cache=True)
def _invert(X: np.ndarray, n: int, V: np.ndarray) -> None:
    """Write the inverse of the rotation or rigid motion I + X."""
    transpose(X, V)
    for i in range(len(X)):
        V[i, i] += 1.0
    if n < len(X):
        for i in range(n):
            V[n, i] = 0.0
            V[i, n] = -X[i, n]
            for j in range(n):
                V[i, n] -= X[j, i] * X[j, n]


@numba.njit(cache=True)
def _skew_part(p: GeneralBody, w: Workspace) -> None:
    """Write K = (W - W^{-1})/2 to the scratch matrix, and W^{-1} to V."""
    X, V, K = w.X, w.V, w.scratch
    _invert(X, p.size, V)
    for i in range(len(X)):
        for j in range(len(X)):
            K[i, j] = (X[i, j] - V[i, j]) / 2
        K[i, i] += 0.5


@numba.njit(cache=True)
def _pair_with_chart(S: np.ndarray, factor: float, places: np.ndarray, entries: np.ndarray, row: np.ndarray) -> None:
    """Add the pairings of a matrix with each C_a, times a factor, to a row."""
    for e in range(len(entries)):
        row[places[e, 0]] += factor * S[places[e, 1], places[e, 2]] * entries[e]


@numba.njit(cache=True)
def equations(p: GeneralBody, w: Workspace, m: np.ndarray) -> None:
    """Compute the residual and its Jacobian at the displacement in the workspace.

    The pairing of Q with G C_a G is that of G^T Q G^T with C_a.
    """
    k, unknowns, places, entries = len(p.directions), len(p.stretch), p.places, p.entries
    G, X, Q, half, scratch, slope, residual = w.G, w.X, w.Q, w.half, w.scratch, w.slope, w.residual
    slope[:] = 0.0
    if unknowns > k:
        H, A = w.H, p.forbidden
        _skew_part(p, w)
        for j in range(k, unknowns):
            residual[j, 0] = paired(A[j - k], scratch)
        multiply(G, w.V, H)
        for j in range(k, unknowns):
            sandwich(G, A[j - k], half, scratch)
            _pair_with_chart(scratch, 1.0, places, entries, slope[j])
            sandwich(H, A[j - k], half, scratch)
            _pair_with_chart(scratch, 1.0, places, entries, slope[j])
    for i in range(k):
        residual[i, 0] = paired(Q[i], X) - m[i]
        sandwich(G, Q[i], half, scratch)
        _pair_with_chart(scratch, 2.0, places, entries, slope[i])


@numba.njit(cache=True)
def increments(w: Workspace, term: np.ndarray) -> None:
    r"""Compute the change of the scaled momenta in one step, $\mathrm{tr}(X D_i J X^T) = \langle Q_i, X^TX\rangle$."""
    X, transposed, square, Q = w.X, w.V, w.scratch, w.Q
    transpose(X, transposed)
    multiply(transposed, X, square)
    for i in range(len(Q)):
        term[i] = paired(Q[i], square)


@numba.njit(cache=True)
def newton(p: GeneralBody, w: Workspace, m: np.ndarray, y: np.ndarray) -> tuple[bool, float]:
    """Correct a guess until the next correction would be below rounding; return the Jacobian determinant at the end."""
    det = 1.0
    for _ in range(_STEPS if len(y) else 0):
        if not displaced(p, w, y) < _LOST:
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


@numba.njit(cache=True)
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
    _skew_part(p, w)
    multiply(K, p.tensor, carried)
    return paired(carried, K) <= p.radius


@numba.njit(cache=True)
def _rotational(X: np.ndarray, n: int) -> float:
    """Return the sum of the squares of the first n rows and columns."""
    total = 0.0
    for i in range(n):
        for j in range(n):
            total += X[i, j] ** 2
    return total


@numba.njit(cache=True)
def _energy(metric: np.ndarray, m: np.ndarray) -> float:
    total = 0.0
    for i in range(len(m)):
        for j in range(len(m)):
            total += m[i] * metric[i, j] * m[j]
    return total


@numba.njit(cache=True)
def _tangent(p: GeneralBody, w: Workspace, m: np.ndarray, y: np.ndarray, s: float) -> tuple[float, np.ndarray]:
    """Return the determinant of the Jacobian at a root and the derivative of the root with respect to s."""
    displaced(p, w, y)
    equations(p, w, s * m)
    w.residual[:] = 0.0
    w.residual[: len(m), 0] = m
    det = eliminate(w.slope, w.residual)
    return det, w.residual[:, 0].copy()


@numba.njit(cache=True)
def principal(p: GeneralBody, w: Workspace, m: np.ndarray) -> tuple[int, np.ndarray]:
    """Follow the root from momentum zero along s m, 0 <= s <= 1; return the outcome and y."""
    y = np.zeros(len(p.stretch))
    if not np.all(np.isfinite(m)):
        return 5, y
    if len(y) == 0:
        return 0, y
    start, tangent = _tangent(p, w, m, y, 0.0)
    s, size, now = 0.0, _FIRST, start
    while s < 1.0:
        size = min(size, 1.0 - s)
        ahead = 1.0 if size == 1.0 - s else s + size
        guess = y + size * tangent
        found = guess.copy()
        good, det = newton(p, w, ahead * m, found)
        moved, off = found - y, found - guess
        close = np.sum(off * off) <= 0.01 * np.sum(moved * moved) or np.sum(moved * moved) < 1e-6
        if good and close and det * start > 0 and np.sum(moved * moved) <= 0.04 * (1 + np.sum(y * y)) ** 2:
            y, s, now, size = found, ahead, det, 2 * size
            det, tangent = _tangent(p, w, m, y, s)
            if not det * start > 0:  # singular to rounding
                return _why_it_ended(p, w, y, 0.0, start), y
        elif size > max(_SMALLEST * s, _LEAST):
            size /= 4
        else:
            return _why_it_ended(p, w, y, now, start), y
    return 0, y


@numba.njit(cache=True)
def _why_it_ended(p: GeneralBody, w: Workspace, y: np.ndarray, det: float, start: float) -> int:
    """Tell a fold (1) from the end of the chart (2) and from a failure to converge (3)."""
    if displaced(p, w, y) > _FAR:
        return 2
    return 1 if abs(det) < 1e-2 * abs(start) else 3


@numba.njit(cache=True)
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


@numba.njit(cache=True)
def see_pose(p: GeneralBody, w: Workspace, g: np.ndarray) -> None:
    """Let the equations of a right-invariant constraint see the mass tensor that a pose carries to space."""
    if p.spatial:
        scaled = _in_units(p, g, 1 / p.unit)
        see_tensor(p, w, (scaled @ p.tensor) @ scaled.T.copy())


@numba.njit(cache=True)
def _in_units(p: GeneralBody, g: np.ndarray, factor: float) -> np.ndarray:
    """Return a motion with its translation multiplied by a factor."""
    scaled = g.copy()
    if len(g) > p.size:
        scaled[: p.size, p.size] *= factor
    return scaled


@numba.njit(cache=True)
def move(p: GeneralBody, w: Workspace, g: np.ndarray) -> None:
    """Advance a pose by the displacement; bring its rotation back to the group by one Newton-Schulz step."""
    n, N, X, W, moved = p.size, len(g), w.X, w.V, w.H
    for i in range(N):
        for j in range(N):
            W[i, j] = X[i, j]
        W[i, i] += 1.0
    for i in range(n, N):
        for j in range(n):
            W[j, i] *= p.unit
    if p.spatial:
        multiply(W, g, moved)
    else:
        multiply(g, W, moved)
    _rectify(moved, n, w.scratch, g)


@numba.njit(cache=True)
def _rectify(moved: np.ndarray, n: int, scratch: np.ndarray, g: np.ndarray) -> None:
    """Write a pose with its rotation R replaced by R (3 I - R^T R) / 2."""
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += moved[k, i] * moved[k, j]
            scratch[i, j] = -0.5 * total
        scratch[i, i] += 1.5
    g[:] = moved
    for i in range(n):
        for j in range(n):
            g[i, j] = 0.0
            for k in range(n):
                g[i, j] += moved[i, k] * scratch[k, j]


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
    k, c, N, w = len(p.directions), len(p.stretch), len(p.tensor), workspace(p)
    m, lost = state[:k].copy(), state[k : 2 * k].copy()
    charts_now = state[2 * k : 2 * k + 3 * c].copy().reshape(3, c)
    y, u, v = charts_now[0], charts_now[1], charts_now[2]
    g = state[2 * k + 3 * c :].copy().reshape(N, N)
    term, code, done = np.zeros(k), 0, 0
    displaced(p, w, y)
    while done < steps:
        if not p.spatial:
            increments(w, term)
        change = term - lost
        total = m + change
        after = g.copy()
        move(p, w, after)
        see_pose(p, w, after)
        code, found = solve(p, w, total, 3 * (y - u) + v)
        if code != 0:
            break
        lost = (total - m) - change
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
    w, N = workspace(p), len(p.tensor)
    see_pose(p, w, pose.copy().reshape(N, N))
    code, y = solve(p, w, m, np.zeros(len(p.stretch)))
    return code, np.concatenate((m, np.zeros(len(p.directions)), y, y, y, pose))


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
    w, N, term = workspace(p), len(p.tensor), np.zeros(len(p.directions))
    next_momenta, next_charts = np.empty_like(momenta), np.empty_like(charts)
    codes = np.zeros(len(momenta), dtype=np.int64)
    for row in range(len(momenta)):
        displaced(p, w, charts[row] / p.stretch)
        if p.spatial:
            g = poses[row].copy().reshape(N, N)
            move(p, w, g)
            see_pose(p, w, g)
        else:
            increments(w, term)
        next_momenta[row] = momenta[row] + term
        y = guesses[row] / p.stretch
        if principal_only:
            codes[row], y = solve(p, w, next_momenta[row], y)
        else:
            good, _ = newton(p, w, next_momenta[row], y)
            codes[row] = 0 if good else 3
        next_charts[row] = y * p.stretch
    return next_momenta, next_charts, codes
