"""Runs of the general step: the pose, the loop over steps, and one step from each of many states."""

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import COMPILED, INLINED
from nonholo.kernels._small import assign, assign_rows, multiply, transpose
from nonholo.kernels.general._step import GeneralBody, Workspace, displaced, increments, see_tensor, workspace
from nonholo.kernels.general.root import finite, newton, solve


@njit(**INLINED)
def see_pose(p: GeneralBody, w: Workspace, g: np.ndarray) -> None:
    """Let the equations of a right-invariant constraint see the mass tensor that a pose carries to space."""
    if p.spatial:
        scaled, n, N = w.G, p.size, len(g)
        assign_rows(scaled, g)
        for i in range(n):
            for j in range(n, N):
                scaled[i, j] *= 1 / p.unit
        multiply(scaled, p.tensor, w.half)
        transpose(scaled, w.scratch)
        multiply(w.half, w.scratch, w.H)
        see_tensor(p, w, w.H)


@njit(**INLINED)
def move(p: GeneralBody, w: Workspace, g: np.ndarray) -> None:
    """Advance a pose by the displacement; bring its rotation back to the group by one Newton-Schulz step.

    Not with a form: where poses grow, the residual of the group is known to no more digits than the pose.
    """
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
    if len(p.form) > 0:
        assign_rows(g, moved)
    else:
        _rectify(moved, n, w.scratch, g)


@njit(**INLINED)
def overflowed(p: GeneralBody, g: np.ndarray) -> bool:
    """Tell whether a pose of a group with a form, which may grow without bound, is no longer finite."""
    return len(p.form) > 0 and not finite(g)


@njit(**INLINED)
def _rectify(moved: np.ndarray, n: int, scratch: np.ndarray, g: np.ndarray) -> None:
    """Write a pose with its rotation R replaced by R (3 I - R^T R) / 2."""
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += moved[k, i] * moved[k, j]
            scratch[i, j] = -0.5 * total
        scratch[i, i] += 1.5
    assign_rows(g, moved)
    for i in range(n):
        for j in range(n):
            g[i, j] = 0.0
            for k in range(n):
                g[i, j] += moved[i, k] * scratch[k, j]


@njit(nogil=True, **COMPILED)
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
    m, lost, g = state[:k], state[k : 2 * k], state[2 * k + 3 * c :].reshape(N, N)
    past, found = state[2 * k : 2 * k + 3 * c].reshape(3, c), np.empty(c)
    term, total, after, code, done = np.zeros(k), np.empty(k), np.empty((N, N)), 0, 0
    displaced(p, w, past[0])
    while done < steps:
        if not p.spatial:
            increments(p, w, term)
        for i in range(k):
            total[i] = m[i] + (term[i] - lost[i])
        assign_rows(after, g)
        move(p, w, after)
        see_pose(p, w, after)
        for a in range(c):
            found[a] = 3 * (past[0, a] - past[1, a]) + past[2, a]
        code = 5 if overflowed(p, after) else solve(p, w, total, found)
        if code != 0:
            break
        for i in range(k):
            lost[i] = (total[i] - m[i]) - (term[i] - lost[i])
            m[i] = total[i]
        for a in range(c):
            past[2, a], past[1, a], past[0, a] = past[1, a], past[0, a], found[a]
        assign_rows(g, after)
        done += 1
        if done % every == 0:
            row = done // every - 1
            assign(momenta[row], m)
            assign(charts[row], found * p.stretch)
            assign(poses[row], g.ravel())
    return done, code


@njit(nogil=True, **COMPILED)
def start(p: GeneralBody, m: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray]:
    """Return the outcome of the first root and the state of a run that begins with scaled momenta and a pose."""
    w, N = workspace(p), len(p.tensor)
    see_pose(p, w, pose.copy().reshape(N, N))
    y = np.zeros(len(p.stretch))
    code = solve(p, w, m, y)
    return code, np.concatenate((m, np.zeros(len(p.directions)), y, y, y, pose))


@njit(nogil=True, **COMPILED)
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
