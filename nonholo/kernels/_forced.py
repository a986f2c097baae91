r"""Runs with forces: half an impulse at each end of a step, and the step of the body between them.

A node k has the momenta m. A step begins at $s = K_k(m)$ with the root over s, and ends, after the increment and the
move, with $K_k$ once more at the pose of the next node (docs/theory/forces.md). The half impulse is

$$ K_k(m) = A\,m + P\,\phi(g) + r_k, $$

where $\phi$ are the entries of the pose, of a quaternion the products of two of them: a force that is fixed in space
is linear in the rotation. A run's state is one array: momenta of the next node, their compensations, its pose, the last
three roots, the number of its step, and the chart at which it began.
"""

from typing import Any, NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._driver import SETTLED, _compensated, _solve, _unpack
from nonholo.kernels._interface import Body, increment, move
from nonholo.kernels._scalar import COMPILED, scalar
from nonholo.kernels._small import assign
from nonholo.kernels._substeps import at_rest, charted, prepared, pushed, solved
from nonholo.kernels.general import GeneralBody
from nonholo.kernels.secular import SecularBody


class Kick(NamedTuple):
    """Half an impulse, in the units and axes of a kernel.

    Attributes:
        keep: A, what is left of the momenta, (k, k); (0, 0) where all is.
        pull: P, (k, size) for poses that are matrices, (k, 2) for cosine and sine, (k, 10) for a quaternion, its
            squares before its products 01, 02, 03, 12, 13, 23; (k, 0) without a force that is fixed in space.
        rows: r, (steps, 2, k), at the beginning and at the end of each step; none acts after the last one.
    """

    keep: np.ndarray
    pull: np.ndarray
    rows: np.ndarray


class ForcedBody(NamedTuple):
    """A body of an order-2 step and its half impulse."""

    body: Any
    kick: Kick


@njit(**COMPILED)
def kicked(kick: Kick, row: int, half: int, m: np.ndarray, pose: np.ndarray, out: np.ndarray) -> None:
    """Write the momenta after half an impulse of a step, at its beginning (0) or end (1); poses are matrices."""
    for i in range(len(m)):
        total, force = m[i], 0.0
        if len(kick.keep) > 0:
            total = 0.0
            for j in range(len(m)):
                total += kick.keep[i, j] * m[j]
        for j in range(kick.pull.shape[1]):
            force += kick.pull[i, j] * pose[j]
        if row < len(kick.rows):
            force += kick.rows[row, half, i]
        out[i] = total + force


@scalar
def pulled(width: int, P: Any, q0: float, q1: float, q2: float, q3: float) -> tuple[float, float]:
    """Return what a force that is fixed in space adds to two momenta at a compact pose."""
    if width == 10:
        a, b, c, d, e, f = q0 * q1, q0 * q2, q0 * q3, q1 * q2, q1 * q3, q2 * q3
        w, x, y, z = q0 * q0, q1 * q1, q2 * q2, q3 * q3
        first = (P[0] * w + P[1] * x) + (P[2] * y + P[3] * z)
        second = (P[10] * w + P[11] * x) + (P[12] * y + P[13] * z)
        first += (P[4] * a + P[5] * b) + (P[6] * c + P[7] * d) + (P[8] * e + P[9] * f)
        second += (P[14] * a + P[15] * b) + (P[16] * c + P[17] * d) + (P[18] * e + P[19] * f)
        return first, second
    return (P[0] * q0 + P[1] * q1, P[10] * q0 + P[11] * q1) if width > 0 else (0.0, 0.0)


@njit(**COMPILED)
def _numbers(kick: Kick):  # noqa: ANN202
    """Return the rows of P and A as numbers: arrays would be counted at every step of a loop."""
    p, a, width = np.zeros(20), np.zeros(4), kick.pull.shape[1]
    for j in range(width):
        p[j], p[10 + j] = kick.pull[0, j], kick.pull[1, j]
    for j in range(2 * len(kick.keep)):
        a[j] = kick.keep[j // 2, j % 2]
    first = (p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], p[9])
    second = (p[10], p[11], p[12], p[13], p[14], p[15], p[16], p[17], p[18], p[19])
    return width, first + second, a[0], a[1], a[2], a[3]


@njit(nogil=True, **COMPILED)
def _advance_two(
    p: Body,
    kick: Kick,
    state: np.ndarray,
    steps: int,
    every: int,
    momenta: np.ndarray,
    charts: np.ndarray,
    poses: np.ndarray,
) -> tuple[int, int]:
    """Advance a top in space or a sleigh in the plane, with numbers in place of arrays."""
    m1, m2, l1, l2, q0, q1, q2, q3, y1, y2, u1, u2, v1, v2 = _unpack(state)
    rubs, table, last = len(kick.keep) > 0, kick.rows, len(kick.rows)
    width, P, a, b, c, d = _numbers(kick)
    row, code, done = int(state[14]), 0, 0
    f1, f2 = pulled(width, P, q0, q1, q2, q3)
    while done < steps:
        s1, s2 = (a * m1 + b * m2, c * m1 + d * m2) if rubs else (m1, m2)
        r1, r2 = (table[row, 0, 0], table[row, 0, 1]) if row < last else (0.0, 0.0)
        s1, s2 = s1 + (f1 + r1), s2 + (f2 + r2)
        code, w1, w2 = _solve(p, s1, s2, 3 * (y1 - u1) + v1, 3 * (y2 - u2) + v2)
        if code != 0:
            break
        v1, v2, u1, u2, y1, y2 = u1, u2, y1, y2, w1, w2
        done += 1
        if done % every == 0:
            at = done // every - 1
            momenta[at, 0], momenta[at, 1], charts[at, 0], charts[at, 1] = m1, m2, w1, w2
            poses[at, 0], poses[at, 1], poses[at, 2], poses[at, 3] = q0, q1, q2, q3
        d1, d2 = increment(p, s1, s2, w1, w2)
        settled = SETTLED * max(abs(s1), abs(s2))
        s1, l1 = _compensated(s1, l1, d1, settled)
        s2, l2 = _compensated(s2, l2, d2, settled)
        q0, q1, q2, q3 = move(p, w1, w2, q0, q1, q2, q3)
        f1, f2 = pulled(width, P, q0, q1, q2, q3)
        m1, m2 = (a * s1 + b * s2, c * s1 + d * s2) if rubs else (s1, s2)
        r1, r2 = (table[row, 1, 0], table[row, 1, 1]) if row < last else (0.0, 0.0)
        m1, m2 = m1 + (f1 + r1), m2 + (f2 + r2)
        row += 1
    assign(state, np.array((m1, m2, l1, l2, q0, q1, q2, q3, y1, y2, u1, u2, v1, v2, float(row))))
    return done, code


@njit(nogil=True, **COMPILED)
def _advance_many(
    p: Any,
    kick: Kick,
    state: np.ndarray,
    steps: int,
    every: int,
    momenta: np.ndarray,
    charts: np.ndarray,
    poses: np.ndarray,
) -> tuple[int, int]:
    """Advance any other body."""
    k, size = momenta.shape[1], poses.shape[1]
    m, lost, pose = state[:k].copy(), state[k : 2 * k].copy(), state[2 * k : 2 * k + size].copy()
    roots = state[2 * k + size : len(state) - 1].copy().reshape(3, -1)
    s, change, root, guess = np.empty(k), np.empty(k), roots[0].copy(), roots[0].copy()
    row, code, done, one = int(state[len(state) - 1]), 0, 0, np.zeros(1)
    one[0] = 1.0
    while done < steps:
        kicked(kick, row, 0, m, pose, s)
        w = prepared(p, s, one)  # a certificate may be for momenta of one energy
        for j in range(len(guess)):
            guess[j] = 3 * (roots[0, j] - roots[1, j]) + roots[2, j]
        code = solved(p, w, 0, s, guess, pose, root)
        if code != 0:
            break
        for j in range(len(root)):
            roots[2, j], roots[1, j], roots[0, j] = roots[1, j], roots[0, j], root[j]
        done += 1
        if done % every == 0:
            at = done // every - 1
            assign(momenta[at], m)
            assign(poses[at], pose)
            charted(p, s, root, charts[at])
        pushed(p, w, s, root, change, pose)
        add_compensated(s, lost, change)
        kicked(kick, row, 1, s, pose, m)
        row += 1
    for begin, part in ((0, m), (k, lost), (2 * k, pose), (2 * k + size, roots.ravel())):
        assign(state[begin:], part)
    state[len(state) - 1] = row
    return done, code


@njit(**COMPILED)
def add_compensated(s: np.ndarray, lost: np.ndarray, change: np.ndarray) -> None:
    """Add a change to momenta in place, by Kahan's summation."""
    settled = 0.0
    for x in s:
        settled = max(settled, SETTLED * abs(x))
    for i in range(len(s)):
        s[i], lost[i] = _compensated(s[i], lost[i], change[i], settled)


def start(forced: ForcedBody, momentum: np.ndarray, pose: np.ndarray, sizes: Any) -> tuple[int, np.ndarray]:
    """Return the outcome of the first root and the state of a run; `sizes` are those of a row of the body."""
    rest = np.tile(at_rest(forced.body), 3)
    state = np.concatenate((momentum, np.zeros_like(momentum), pose, rest, np.zeros(1 + sizes[1])))
    momenta, chart, poses = np.empty((1, len(momentum))), np.empty((1, sizes[1])), np.empty((1, len(pose)))
    _, code = advance(forced, state, 1, 1, momenta, chart, poses)
    state[len(state) - sizes[1] :] = chart[0] if code == 0 else np.nan
    roots = state[2 * len(momentum) + len(pose) : len(state) - 1 - sizes[1]].reshape(3, -1)
    roots[1:] = roots[0]
    return code, state


def advance(forced: ForcedBody, state: np.ndarray, steps: int, every: int, *rows: np.ndarray) -> tuple[int, int]:
    """Take up to `steps` steps, saving each `every`-th one; return how many were good and the outcome.

    After a failure the state is that of the last good step.
    """
    run = _advance_many if isinstance(forced.body, SecularBody | GeneralBody) else _advance_two
    return run(*forced, state[: len(state) - rows[1].shape[1]], steps, every, *rows)
