r"""Compositions of the step: one long step made of substeps $\gamma_i h$ of either sign (docs/theory/compositions.md).

Momenta are in units of the displacement of the long step, $m = h\,r/2$ or whatever its body has; a substep sees
$\gamma_i m$ and changes m by the increment over $\gamma_i$. A state counts as good when the whole step that starts
there was taken, so the state of a run holds the present state and the one after it. It is one array: momenta (k),
pose, then momenta (k), compensations (k) and pose after the step, then the last three roots of each substep.
"""

from typing import Any, NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._driver import _compensated, _solve
from nonholo.kernels._interface import Body, increment, move
from nonholo.kernels._scalar import COMPILED
from nonholo.kernels._small import assign
from nonholo.kernels._substeps import at_rest, charted, chosen, prepared, pushed, solved
from nonholo.kernels.general import GeneralBody
from nonholo.kernels.secular import SecularBody

_SETTLED = 1e-150  # of the largest momentum; squares below it underflow


class ComposedBody(NamedTuple):
    r"""A body and the weights of the substeps.

    Attributes:
        body: The body of the step that is composed.
        weights: The fractions $\gamma_i$ of the time step, (S,).
    """

    body: Body | SecularBody | GeneralBody
    weights: np.ndarray


@njit(**COMPILED)
def _swept(
    p: Any,
    w: Any,
    weights: np.ndarray,
    m: np.ndarray,
    lost: np.ndarray,
    pose: np.ndarray,
    roots: np.ndarray,
    room: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> int:
    """Take all substeps from momenta and pose, in place; `roots` (S, 3, u) are extrapolated to guesses."""
    scaled, change, guess = room
    settled = 0.0
    for x in m:
        settled = max(settled, _SETTLED * abs(x))
    for i in range(len(weights)):
        weight, past = weights[i], roots[i]
        for j in range(len(guess)):
            guess[j] = 3 * (past[0, j] - past[1, j]) + past[2, j]
            past[2, j], past[1, j] = past[1, j], past[0, j]
        for j in range(len(m)):
            scaled[j] = weight * m[j]
        code = solved(p, w, i, scaled, guess, pose, past[0])
        if code != 0:
            return code
        pushed(p, w, scaled, past[0], change, pose)
        for j in range(len(m)):
            m[j], lost[j] = _compensated(m[j], lost[j], change[j] / weight, settled)
    return 0


@njit(**COMPILED)
def _two_swept(
    p: Body,
    w: np.ndarray,
    weights: np.ndarray,
    m: np.ndarray,
    lost: np.ndarray,
    pose: np.ndarray,
    roots: np.ndarray,
    room: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> int:
    """Take all substeps as `_swept` does, with numbers in place of arrays: several times as fast."""
    m1, m2, l1, l2, q0, q1, q2, q3 = m[0], m[1], lost[0], lost[1], pose[0], pose[1], pose[2], pose[3]
    settled = _SETTLED * max(abs(m1), abs(m2))
    for i in range(len(weights)):
        weight, s1, s2 = weights[i], weights[i] * m1, weights[i] * m2
        y1, y2, u1, u2 = roots[i, 0, 0], roots[i, 0, 1], roots[i, 1, 0], roots[i, 1, 1]
        code, w1, w2 = _solve(p, s1, s2, 3 * (y1 - u1) + roots[i, 2, 0], 3 * (y2 - u2) + roots[i, 2, 1])
        if code != 0:
            return code
        roots[i, 0, 0], roots[i, 0, 1], roots[i, 1, 0], roots[i, 1, 1] = w1, w2, y1, y2
        roots[i, 2, 0], roots[i, 2, 1] = u1, u2
        d1, d2 = increment(p, s1, s2, w1, w2)
        m1, l1 = _compensated(m1, l1, d1 / weight, settled)
        m2, l2 = _compensated(m2, l2, d2 / weight, settled)
        q0, q1, q2, q3 = move(p, w1, w2, q0, q1, q2, q3)
    m[0], m[1], lost[0], lost[1] = m1, m2, l1, l2
    pose[0], pose[1], pose[2], pose[3] = q0, q1, q2, q3
    return 0


_sweep = chosen(_swept, _swept, _two_swept)


@njit(**COMPILED)
def _room(momenta: int, unknowns: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the arrays that a sweep writes to: momenta and their changes in a substep, and a guess."""
    return np.empty(momenta), np.empty(momenta), np.empty(unknowns)


@njit(nogil=True, **COMPILED)
def _advance(
    p: Any,
    weights: np.ndarray,
    state: np.ndarray,
    steps: int,
    every: int,
    momenta: np.ndarray,
    charts: np.ndarray,
    poses: np.ndarray,
) -> tuple[int, int]:
    k, size, stages = momenta.shape[1], poses.shape[1], len(weights)
    now, g, ahead, after = state[:k], state[k : k + size], state[k + size : 3 * k + size], state[3 * k + size :]
    m, lost, pose = ahead[:k].copy(), ahead[k:].copy(), after[:size].copy()
    roots = after[size:].copy().reshape(stages, 3, -1)
    w, room, code, done = prepared(p, m, weights), _room(k, roots.shape[2]), 0, 0
    before, at = m.copy(), pose.copy()
    while done < steps:
        assign(before, m)
        assign(at, pose)
        code = _sweep(p, w, weights, m, lost, pose, roots, room)
        if code != 0:
            break
        assign(now, before)
        assign(g, at)
        done += 1
        if done % every == 0:
            row = done // every - 1
            assign(momenta[row], now)
            assign(poses[row], g)
            assign(room[0], weights[0] * now)
            charted(p, room[0], roots[0, 0], charts[row])
    assign(ahead, m)
    assign(ahead[k:], lost)
    assign(after, pose)
    assign(after[size:], roots.ravel())
    return done, code


@njit(nogil=True, **COMPILED)
def _each(
    p: Any, weights: np.ndarray, momenta: np.ndarray, poses: np.ndarray, rest: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Take one step from each row; return momenta, poses and outcomes, and compensations and roots of the last row."""
    after, moved, codes = momenta.copy(), poses.copy(), np.zeros(len(momenta), dtype=np.int64)
    room, roots = _room(momenta.shape[1], len(rest)), np.empty((len(weights), 3, len(rest)))
    lost = np.zeros(momenta.shape[1])
    for row in range(len(momenta)):
        lost[:] = 0.0
        for i in range(len(weights)):
            for j in range(3):
                assign(roots[i, j], rest)
        w = prepared(p, momenta[row], weights)
        codes[row] = _sweep(p, w, weights, after[row], lost, moved[row], roots, room)
    return after, moved, codes, lost, roots


def start(composed: ComposedBody, momentum: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray]:
    """Return the outcome of the first step and the state of a run that begins with scaled momenta and a pose."""
    p, weights = composed
    after, moved, codes, lost, roots = _each(p, weights, np.array([momentum]), np.array([pose]), at_rest(p))
    roots[:, 1:] = roots[:, :1]
    return int(codes[0]), np.concatenate((momentum, pose, after[0], lost, moved[0], roots.ravel()))


def advance(
    composed: ComposedBody,
    state: np.ndarray,
    steps: int,
    every: int,
    rows: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> tuple[int, int]:
    """Take up to `steps` steps, saving each `every`-th one; return how many were good and the outcome.

    The chart of a row is that of its first substep. After a failure momenta and pose of the present state are those of
    the last good step.
    """
    return _advance(*composed, state, steps, every, *rows)


def first_chart(composed: ComposedBody, state: np.ndarray, momenta: int, coordinates: int) -> np.ndarray:
    """Return the chart coordinates of the first substep from the present state, given their numbers."""
    p, weights = composed
    unknowns = len(at_rest(p))
    chart = np.empty(coordinates)
    first = len(state) - 3 * unknowns * len(weights)
    charted(p, weights[0] * state[:momenta], state[first : first + unknowns], chart)
    return chart


def whole_steps(
    composed: ComposedBody, momenta: np.ndarray, poses: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Take one whole step from each row of momenta and poses; return both after it, and the outcomes."""
    p, weights = composed
    return _each(p, weights, np.array(momenta, order="C"), np.array(poses, order="C"), at_rest(p))[:3]
