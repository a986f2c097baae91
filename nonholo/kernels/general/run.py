"""The principal root of the general step: Newton's method, its certificate, and continuation where there is none.

Runs of it: the pose, the loop over steps, and one step from each of many states.
"""

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import BORROWING, COMPILED, INLINED, PIECES, Rows
from nonholo.kernels._small import assign, assign_rows, eliminate, multiply, pair, transpose
from nonholo.kernels.general._rows import decompose, solve_rows
from nonholo.kernels.general._step import (
    LOST,
    GeneralBody,
    Workspace,
    displace,
    increments,
    jacobian,
    residual,
    see_tensor,
    skew_part,
    workspace,
)

_STEPS = 12  # of Newton's method
_FIRST = 0.25  # first continuation step, in s
_SMALLEST = 1e-7  # continuation step, relative to s, below which the branch is given up
_BENT = 0.5  # most change of the Jacobian in one piece of the path: two roots for one momentum differ by -2
_APART = 1e300  # of Jacobians that cannot be compared
_NEAR = 1e-4  # times _FALL: most of a correction after which its Jacobian serves again, squared
_FALL = 1e-4  # least fall of a correction with the same Jacobian, squared
_ROUNDING = 1e-24  # squared, of a displacement
_LEAST = 1e-300  # and the absolute one: a momentum may be any number of times too large
_FAR = 1e4  # turning of a displacement beyond which the Cayley chart ends: an angle of 179 degrees


@njit(**BORROWING)
def newton(p: GeneralBody, w: Workspace, s: float, m: np.ndarray, y: np.ndarray) -> tuple[bool, float]:
    """Correct a guess of the root over s m until the next correction would be below rounding.

    A Jacobian serves as long as corrections with it are small and fall fast: what is left then is below the product of
    the first and the last one. Return whether the root was reached, and the last determinant.
    """
    det, first, last = 1.0, 0.0, 0.0
    for _ in range(_STEPS if len(y) else 0):
        if not displace(p, w, y) < LOST:
            return False, det
        residual(p, w, s, m)
        if first == 0.0:
            last = _NEAR
            jacobian(p, w)
            det = decompose(w.slope, w.order, w.inverses, w.others)
            if not (np.isfinite(det) and det != 0):
                return False, det
        solve_rows(w.slope, w.order, w.inverses, w.sums, w.correction)
        step = size = 0.0
        for a in range(len(y)):
            y[a] -= w.correction[a]
            step += w.correction[a] ** 2
            size += y[a] ** 2
        share = step / (1 + size)
        first = max(first, share)
        if share * first <= 1e-36:
            return True, det
        if not share <= _FALL * last:
            first = 0.0
        last = share
    return len(y) == 0, det


@njit(**INLINED)
def is_certain(p: GeneralBody, w: Workspace, m: np.ndarray, y: np.ndarray) -> bool:
    """Return whether a root is certainly the principal one: it lies in the ball where there is only one.

    The workspace holds its displacement afterwards.
    """
    displace(p, w, y)
    if not _certifiable(p, m):
        return False
    X, K, product = w.X, w.scratch, w.V
    if _rotational(X, p.size) >= 4.0:  # no longer surely below 90 degrees, where K determines W
        return False
    skew_part(p, w)
    multiply(K, p.tensor, product)
    return pair(product, K) <= p.radius


@njit(inline="always", **BORROWING)
def _rotational(X: np.ndarray, n: int) -> float:
    """Return the sum of the squares of the first n rows and columns."""
    total = 0.0
    for i in range(n):
        for j in range(n):
            total += X[i, j] ** 2
    return total


@njit(inline="always", **BORROWING)
def _certifiable(p: GeneralBody, m: np.ndarray) -> bool:
    """Return whether the momenta are so small that there is a ball."""
    energy = 0.0
    for i in range(len(m)):
        for j in range(len(m)):
            energy += m[i] * p.metric[i, j] * m[j]
    return energy <= p.level and not p.spatial


@njit(**BORROWING)
def _tangent(
    p: GeneralBody, w: Workspace, s: float, m: np.ndarray, y: np.ndarray, slope: np.ndarray, tangent: np.ndarray
) -> float:
    """Write the Jacobian at a root and the derivative of the root with respect to s; return the determinant."""
    displace(p, w, y)
    residual(p, w, s, m)
    jacobian(p, w)
    assign_rows(slope, w.slope)
    w.sums[:] = 0.0
    assign(w.sums[0], m)
    det = decompose(w.slope, w.order, w.inverses, w.others)
    solve_rows(w.slope, w.order, w.inverses, w.sums, tangent)
    return det


@njit(inline="always", **BORROWING)
def _bend(w: Workspace) -> float:
    """Return the distance of two Jacobians, by traces of E and E^2, E + I the quotient: the same in all coordinates.

    Were the equations quadratic, E would have an eigenvalue of -2 between two roots for the same momentum.
    """
    E, trace, square = w.slopes[2], 0.0, 0.0
    assign_rows(w.slope, w.slopes[0])
    assign_rows(E, w.slopes[1])
    det = eliminate(w.slope, E)
    for a in range(len(E)):
        E[a, a] -= 1
        trace += E[a, a]
    for a in range(len(E)):
        for b in range(len(E)):
            square += E[a, b] * E[b, a]
    bent = max(abs(trace), abs(square))
    return bent if np.isfinite(det) and det != 0 and np.isfinite(square) else _APART


@njit(**BORROWING)
def principal(p: GeneralBody, w: Workspace, m: np.ndarray, y: np.ndarray) -> int:
    """Follow the root from momentum zero along s m, 0 <= s <= 1, to y; return the outcome."""
    y[:] = 0.0
    if not finite(m):
        return 5
    if len(y) == 0:
        return 0
    start = _tangent(p, w, 0.0, m, y, w.slopes[0], w.charts[2])
    s, size, now, peak = 0.0, _FIRST, start, abs(start)
    for _ in range(PIECES):
        size = min(size, 1.0 - s)
        ahead = 1.0 if size == 1.0 - s else s + size
        good, det = _piece(p, w, size, ahead, m, y, start)
        if good:
            s, now, size = ahead, det, 2 * size
            assign(y, w.charts[1])
            assign(w.charts[2], w.charts[3])
            assign_rows(w.slopes[0], w.slopes[1])
            if len(p.form) > 0:  # boosts scale the determinant
                peak = max(peak, abs(det))
            if not det * start > 0:  # singular to rounding
                return _why_it_ended(p, w, y, 0.0, peak)
            if s == 1.0:
                return 0
        elif size > max(_SMALLEST * s, _LEAST):
            size /= 4
        else:
            return _why_it_ended(p, w, y, now, peak)
    return 3


@njit(inline="always", **BORROWING)
def _piece(
    p: GeneralBody, w: Workspace, size: float, ahead: float, m: np.ndarray, y: np.ndarray, start: float
) -> tuple[bool, float]:
    """Write the root over ahead m, its Jacobian and its tangent to the workspace; return whether it is the next one."""
    guess, root = w.charts[0], w.charts[1]
    for a in range(len(y)):
        guess[a] = y[a] + size * w.charts[2, a]
    assign(root, guess)
    good, det = newton(p, w, ahead, m, root)
    if not (good and det * start > 0 and _close(y, guess, root)):
        return False, det
    det = _tangent(p, w, ahead, m, root, w.slopes[1], w.charts[3])
    return _bend(w) <= _BENT, det


@njit(inline="always", **BORROWING)
def finite(A: np.ndarray) -> bool:
    """Return whether all numbers of an array are finite."""
    result = True
    for x in A.flat:
        result = result and np.isfinite(x)
    return result


@njit(inline="always", **BORROWING)
def _close(y: np.ndarray, guess: np.ndarray, root: np.ndarray) -> bool:
    """Return whether a root is where the tangent foretold, to a tenth of a move that is not long, or to rounding."""
    shift = off = square = 0.0
    for a in range(len(y)):
        shift += (root[a] - y[a]) ** 2
        off += (root[a] - guess[a]) ** 2
        square += y[a] * y[a]
    size = 1 + square
    return off <= 0.01 * shift + _ROUNDING * size and shift <= 0.04 * size * size


@njit(**BORROWING)
def _why_it_ended(p: GeneralBody, w: Workspace, y: np.ndarray, det: float, peak: float) -> int:
    """Tell a fold (1) from the end of the chart or of all displacements (2) and from a failure to converge (3)."""
    if displace(p, w, y) > _FAR or (len(p.form) > 0 and pair(w.X, w.X) > _FAR**2):
        return 2
    return 1 if abs(det) < 1e-2 * peak else 3


@njit(**INLINED)
def solve(p: GeneralBody, w: Workspace, m: np.ndarray, y: np.ndarray) -> int:
    """Correct a guess y and verify that it is the principal root, or follow that from momentum zero to y.

    The workspace holds its displacement afterwards.
    """
    if _certifiable(p, m):
        good, _ = newton(p, w, 1.0, m, y)
        if good and is_certain(p, w, m, y):
            return 0
    code = principal(p, w, m, y)
    displace(p, w, y)
    return code


@njit(**INLINED)
def see_pose(p: GeneralBody, w: Workspace, g: np.ndarray) -> None:
    """Let the equations of a right-invariant constraint see the mass tensor that a pose carries to space."""
    if p.spatial:
        pose, n, N = w.G, p.size, len(g)
        assign_rows(pose, g)
        for i in range(n):
            for j in range(n, N):
                pose[i, j] *= 1 / p.unit
        multiply(pose, p.tensor, w.half)
        transpose(pose, w.scratch)
        multiply(w.half, w.scratch, w.H)
        see_tensor(p, w, w.H)


@njit(**INLINED)
def move(p: GeneralBody, w: Workspace, g: np.ndarray) -> None:
    """Advance a pose by the displacement; bring its rotation back to the group by one Newton-Schulz step.

    Not with a form: where poses grow, the residual of the group is known to no more digits than the pose.
    """
    n, N, X, W, product = p.size, len(g), w.X, w.V, w.H
    for i in range(N):
        for j in range(N):
            W[i, j] = X[i, j]
        W[i, i] += 1.0
    for i in range(n, N):
        for j in range(n):
            W[j, i] *= p.unit
    if p.spatial:
        multiply(W, g, product)
    else:
        multiply(g, W, product)
    if len(p.form) > 0:
        assign_rows(g, product)
    else:
        _rectify(product, n, w.scratch, g)


@njit(**INLINED)
def is_infinite(p: GeneralBody, g: np.ndarray) -> bool:
    """Return whether a pose of a group with a form, which may grow without bound, is no longer finite."""
    return len(p.form) > 0 and not finite(g)


@njit(**INLINED)
def _rectify(pose: np.ndarray, n: int, scratch: np.ndarray, g: np.ndarray) -> None:
    """Write a pose with its rotation R replaced by R (3 I - R^T R) / 2."""
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += pose[k, i] * pose[k, j]
            scratch[i, j] = -0.5 * total
        scratch[i, i] += 1.5
    assign_rows(g, pose)
    for i in range(n):
        for j in range(n):
            g[i, j] = 0.0
            for k in range(n):
                g[i, j] += pose[i, k] * scratch[k, j]


@njit(nogil=True, **COMPILED)
def advance(p: GeneralBody, state: np.ndarray, steps: int, every: int, rows: Rows) -> tuple[int, int]:
    """Take up to `steps` steps, saving each `every`-th one; return how many were good and the outcome.

    The state holds momenta and their compensations (k each), the last three charts (m each) and the pose (N N). After
    a failure it is that of the last good step.
    """
    momenta, charts, poses = rows
    k, c, N, w = len(p.directions), len(p.stretch), len(p.tensor), workspace(p)
    m, carry, g = state[:k], state[k : 2 * k], state[2 * k + 3 * c :].reshape(N, N)
    past, y = state[2 * k : 2 * k + 3 * c].reshape(3, c), np.empty(c)
    term, total, after, code, count = np.zeros(k), np.empty(k), np.empty((N, N)), 0, 0
    displace(p, w, past[0])
    while count < steps:
        if not p.spatial:
            increments(p, w, term)
        for i in range(k):
            total[i] = m[i] + (term[i] - carry[i])
        assign_rows(after, g)
        move(p, w, after)
        see_pose(p, w, after)
        for a in range(c):
            y[a] = 3 * (past[0, a] - past[1, a]) + past[2, a]
        code = 5 if is_infinite(p, after) else solve(p, w, total, y)
        if code != 0:
            break
        for i in range(k):
            carry[i] = (total[i] - m[i]) - (term[i] - carry[i])
            m[i] = total[i]
        for a in range(c):
            past[2, a], past[1, a], past[0, a] = past[1, a], past[0, a], y[a]
        assign_rows(g, after)
        count += 1
        if count % every == 0:
            row = count // every - 1
            assign(momenta[row], m)
            assign(charts[row], y * p.stretch)
            assign(poses[row], g.ravel())
    return count, code


@njit(nogil=True, **COMPILED)
def start(p: GeneralBody, m: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray]:
    """Return the outcome of the first root and the state of a run that begins with scaled momenta and a pose."""
    w, N = workspace(p), len(p.tensor)
    see_pose(p, w, pose.copy().reshape(N, N))
    y = np.zeros(len(p.stretch))
    code = solve(p, w, m, y)
    return code, np.concatenate((m, np.zeros(len(p.directions)), y, y, y, pose))


@njit(nogil=True, **COMPILED)
def step_each(p: GeneralBody, states: Rows, guesses: np.ndarray, principal_only: bool) -> Rows:
    """Take one step from each row; return momenta, charts and outcomes.

    The root is the principal one or else that value of the map which Newton's method reaches from the guess.
    """
    momenta, charts, poses = states
    w, N, term = workspace(p), len(p.tensor), np.zeros(len(p.directions))
    next_momenta, next_charts = np.empty_like(momenta), np.empty_like(charts)
    codes = np.zeros(len(momenta), dtype=np.int64)
    for row in range(len(momenta)):
        displace(p, w, charts[row] / p.stretch)
        if p.spatial:
            g = poses[row].copy().reshape(N, N)
            move(p, w, g)
            see_pose(p, w, g)
        else:
            increments(p, w, term)
        assign(next_momenta[row], momenta[row] + term)
        y = guesses[row] / p.stretch
        if principal_only:
            codes[row] = solve(p, w, next_momenta[row], y)
        else:
            good, _ = newton(p, w, 1.0, next_momenta[row], y)
            codes[row] = 0 if good else 3
        assign(next_charts[row], y * p.stretch)
    return next_momenta, next_charts, codes
