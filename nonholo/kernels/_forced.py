r"""Runs with forces: half an impulse at each end of a step, and the step of the body between them.

A node k has the momenta m. A step begins at $s = K_k(m)$ with the root over s, and ends, after the increment and the
move, with $K_k$ once more at the pose of the next node (docs/theory/forces.md). The half impulse is

$$ K_k(m) = A\,m + P\,R^TF + r_k, $$

with R the rotation of the pose, F a force fixed in space, and a row for each step. A run's state is one array:
momenta of the next node, their compensations, its pose, the last three roots, the number of its step, and the chart at
which it began.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._driver import SETTLED, _compensated, _solve
from nonholo.kernels._interface import Body, increment, move
from nonholo.kernels._scalar import COMPILED, scalar
from nonholo.kernels._small import assign, assign_rows
from nonholo.kernels._substeps import at_rest, charted, prepared, pushed, solved
from nonholo.kernels.general import GeneralBody
from nonholo.kernels.secular import SecularBody

_ONE = np.ones(1)


class Kick(NamedTuple):
    """Half an impulse, in the units and axes of a kernel.

    Attributes:
        keep: A, what is left of the momenta, (k, k); (0, 0) where all is.
        pull: P, (k, n); (0, 0) without a force that is fixed in space.
        weight: F, (n,); (0,) without.
        rows: r, one for each step, (steps, k); none acts after the last one.
        stride: N where poses are matrices row by row; 0 for a quaternion (n = 3) or cosine and sine (n = 2).
    """

    keep: np.ndarray
    pull: np.ndarray
    weight: np.ndarray
    rows: np.ndarray
    stride: int


class ForcedBody(NamedTuple):
    """A body of an order-2 step and its half impulse."""

    body: Any
    kick: Kick


@njit(**COMPILED)
def kicked(kick: Kick, row: int, m: np.ndarray, pose: np.ndarray, out: np.ndarray) -> None:
    """Write the momenta after half an impulse of a step."""
    seen = np.zeros(len(kick.weight))
    _turned_back(kick.weight, pose, kick.stride, seen)
    for i in range(len(m)):
        total = m[i]
        if len(kick.keep) > 0:
            total = 0.0
            for j in range(len(m)):
                total += kick.keep[i, j] * m[j]
        force = 0.0
        for j in range(len(seen)):
            force += kick.pull[i, j] * seen[j]
        if row < len(kick.rows):
            force += kick.rows[row, i]
        out[i] = total + force


@njit(**COMPILED)
def _turned_back(weight: np.ndarray, pose: np.ndarray, stride: int, out: np.ndarray) -> None:
    """Write $R^TF$."""
    n = len(weight)
    if stride > 0:
        for j in range(n):
            out[j] = 0.0
            for i in range(n):
                out[j] += pose[i * stride + j] * weight[i]
    elif n == 3:
        turned = _from_quaternion(weight[0], weight[1], weight[2], pose[0], pose[1], pose[2], pose[3])
        out[0], out[1], out[2] = turned
    elif n == 2:
        out[0], out[1] = _from_angle(weight[0], weight[1], pose[0], pose[1])


@scalar
def _from_quaternion(
    f: float, g: float, h: float, w: float, x: float, y: float, z: float
) -> tuple[float, float, float]:
    a, b, c = 2 * (g * z - h * y), 2 * (h * x - f * z), 2 * (f * y - g * x)
    return f + (w * a + (b * z - c * y)), g + (w * b + (c * x - a * z)), h + (w * c + (a * y - b * x))


@scalar
def _from_angle(f: float, g: float, cos: float, sin: float) -> tuple[float, float]:
    return cos * f + sin * g, cos * g - sin * f


@scalar
def _pulled(n: int, F: Any, P: Any, q: Any) -> tuple[float, float]:
    r"""Return $P\,R^TF$ of two momenta at a compact pose."""
    if n == 3:
        u, v, w = _from_quaternion(F[0], F[1], F[2], q[0], q[1], q[2], q[3])
        return P[0] * u + P[1] * v + P[2] * w, P[3] * u + P[4] * v + P[5] * w
    if n == 2:
        u, v = _from_angle(F[0], F[1], q[0], q[1])
        return P[0] * u + P[1] * v, P[3] * u + P[4] * v
    return 0.0, 0.0


@njit(**COMPILED)
def _numbers(kick: Kick):  # noqa: ANN202
    """Return F, P row by row and A row by row as numbers."""
    F, P, A, n = np.zeros(3), np.zeros((2, 3)), np.zeros((2, 2)), len(kick.weight)
    for j in range(n):
        F[j], P[0, j], P[1, j] = kick.weight[j], kick.pull[0, j], kick.pull[1, j]
    if len(kick.keep) > 0:
        assign_rows(A, kick.keep)
    of_force, of_pull = (F[0], F[1], F[2]), (P[0, 0], P[0, 1], P[0, 2], P[1, 0], P[1, 1], P[1, 2])
    return of_force, of_pull, (A[0, 0], A[0, 1], A[1, 0], A[1, 1])


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
    m1, m2, l1, l2, q0, q1, q2, q3 = state[0], state[1], state[2], state[3], state[4], state[5], state[6], state[7]
    y1, y2, u1, u2, v1, v2 = state[8], state[9], state[10], state[11], state[12], state[13]
    row, code, done = int(state[14]), 0, 0
    n, rubs, table, last = len(kick.weight), len(kick.keep) > 0, kick.rows, len(kick.rows)
    F, P, A = _numbers(kick)
    f1, f2 = _pulled(n, F, P, (q0, q1, q2, q3))
    while done < steps:
        r1, r2 = (table[row, 0], table[row, 1]) if row < last else (0.0, 0.0)
        s1, s2 = (A[0] * m1 + A[1] * m2, A[2] * m1 + A[3] * m2) if rubs else (m1, m2)
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
        f1, f2 = _pulled(n, F, P, (q0, q1, q2, q3))
        m1, m2 = (A[0] * s1 + A[1] * s2, A[2] * s1 + A[3] * s2) if rubs else (s1, s2)
        m1, m2 = m1 + (f1 + r1), m2 + (f2 + r2)
        row += 1
    assign(state, np.array((m1, m2, l1, l2, q0, q1, q2, q3, y1, y2, u1, u2, v1, v2, float(row))))
    return done, code


@njit(nogil=True, **COMPILED)
def _advance_many(
    p: Any,
    kick: Kick,
    one: np.ndarray,
    state: np.ndarray,
    steps: int,
    every: int,
    momenta: np.ndarray,
    charts: np.ndarray,
    poses: np.ndarray,
) -> tuple[int, int]:
    """Advance any other body; `one` is the weight of its only substep."""
    k, size = momenta.shape[1], poses.shape[1]
    m, lost, pose = state[:k].copy(), state[k : 2 * k].copy(), state[2 * k : 2 * k + size].copy()
    roots = state[2 * k + size : len(state) - 1].copy().reshape(3, -1)
    s, change, root, guess = np.empty(k), np.empty(k), roots[0].copy(), roots[0].copy()
    row, code, done = int(state[len(state) - 1]), 0, 0
    while done < steps:
        kicked(kick, row, m, pose, s)
        w = prepared(p, s, one)  # a certificate may be for momenta of one energy
        for j in range(len(guess)):
            guess[j] = 3 * (roots[0, j] - roots[1, j]) + roots[2, j]
        code = solved(p, w, 0, s, guess, pose, root)
        if code != 0:
            break
        _remember(roots, root)
        done += 1
        if done % every == 0:
            at = done // every - 1
            assign(momenta[at], m)
            assign(poses[at], pose)
            charted(p, s, root, charts[at])
        pushed(p, w, s, root, change, pose)
        add_compensated(s, lost, change)
        kicked(kick, row, s, pose, m)
        row += 1
    assign(state, m)
    assign(state[k:], lost)
    assign(state[2 * k :], pose)
    assign(state[2 * k + size :], roots.ravel())
    state[len(state) - 1] = row
    return done, code


@njit(**COMPILED)
def _remember(roots: np.ndarray, root: np.ndarray) -> None:
    """Put a root before the last ones."""
    for j in range(len(root)):
        roots[2, j], roots[1, j], roots[0, j] = roots[1, j], roots[0, j], root[j]


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


def advance(
    forced: ForcedBody,
    state: np.ndarray,
    steps: int,
    every: int,
    momenta: np.ndarray,
    charts: np.ndarray,
    poses: np.ndarray,
) -> tuple[int, int]:
    """Take up to `steps` steps, saving each `every`-th one; return how many were good and the outcome.

    After a failure the state is that of the last good step.
    """
    body, kick = forced
    rest, rows = state[: len(state) - charts.shape[1]], (momenta, charts, poses)
    if isinstance(body, SecularBody | GeneralBody):
        return _advance_many(body, kick, _ONE, rest, steps, every, *rows)
    return _advance_two(body, kick, rest, steps, every, *rows)


def run_by_kicks(
    body: Any,
    kick: Callable[[int, int, np.ndarray, np.ndarray], np.ndarray],
    momentum: np.ndarray,
    pose: np.ndarray,
    steps: int,
    report: Callable[[int, np.ndarray, np.ndarray, np.ndarray], Any],
) -> int:
    """Run the same steps with a Python function for half an impulse; return the outcome.

    Args:
        body: The body of the step.
        kick: From node, step, momenta and pose to momenta.
        momentum: Those of the first node.
        pose: That of the first node.
        steps: How many.
        report: Called with each good node: its number, momenta, chart and pose.
    """
    m, lost, pose = momentum.copy(), np.zeros_like(momentum), pose.copy()
    roots = np.tile(at_rest(body), (3, 1))
    root, change = roots[0].copy(), np.empty_like(m)
    for k in range(steps + 1):
        s = kick(k, k, m, pose)
        w = prepared(body, s, _ONE)
        code = solved(body, w, 0, s, 3 * (roots[0] - roots[1]) + roots[2], pose, root)
        if code != 0:
            return code
        _remember(roots, root)
        if k == 0:
            roots[1:] = root
        chart = np.empty_like(m if not isinstance(body, GeneralBody) else root)
        charted(body, s, root, chart)
        report(k, m, chart, pose)
        if k < steps:
            pushed(body, w, s, root, change, pose)
            add_compensated(s, lost, change)
            m = kick(k + 1, k, s, pose)
    return 0
