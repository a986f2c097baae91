"""Half an impulse that is linear in the momenta: friction, a force that is fixed in space, rows of a table.

Tops in space and sleighs in the plane have a separate loop, with numbers in place of arrays.
"""

from typing import Any, NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._driver import SETTLED, _solve, _unpack, converged, kahan_sum
from nonholo.kernels._scalar import (
    BORROWING,
    COMPILED,
    Body,
    Rows,
    corrections,
    increment,
    inertia,
    inlining,
    is_certain,
    move,
    scalar,
)
from nonholo.kernels._small import assign

_TERMS = 14  # of a series at norm 1/2
_DOUBLINGS = 1100  # more than any finite number needs


class Kick(NamedTuple):
    """Half an impulse, in the units and axes of a kernel.

    Attributes:
        keep: A, what is left of the momenta, (k, k); (0, 0) where all is.
        weight: F, as long as a row of poses that are matrices, (2,) for cosine and sine, (3,) for a quaternion; (0,)
            without a force that is fixed in space.
        arms: L, (k, len(F)).
        rows: r, (steps + 1, k), at both ends of each step; the last one is zero and acts after all steps.
    """

    is_python = False
    keep: np.ndarray
    weight: np.ndarray
    arms: np.ndarray
    rows: np.ndarray


@scalar
def room_for_kick(kick: Kick) -> np.ndarray:
    """Return room for what the weight adds to momenta."""
    return np.empty(kick.rows.shape[1])


@inlining
def pulled_by_weight(kick: Kick, force: np.ndarray, pose: np.ndarray) -> None:
    """Write what the weight adds to momenta at a pose that is a matrix."""
    n, k = len(kick.weight), len(force)
    force[:] = 0.0
    for j in range(n):
        total = 0.0
        for i in range(n):
            total += kick.weight[i] * pose[n * i + j]
        for i in range(k):
            force[i] += kick.arms[i, j] * total


@inlining
def after_friction(kick: Kick, m: np.ndarray, i: int) -> float:
    """Return what friction leaves of a momentum, a number of A m."""
    if len(kick.keep) == 0:
        return m[i]
    total = 0.0
    for j in range(len(m)):
        total += kick.keep[i, j] * m[j]
    return total


@inlining
def linear(kick: Kick, force: np.ndarray, node: int, row: int, m: np.ndarray, out: np.ndarray) -> int:
    """Write the momenta after half an impulse of a step, from what the weight adds; return the outcome, zero."""
    at = min(row, len(kick.rows) - 1)
    for i in range(len(m)):
        out[i] = after_friction(kick, m, i) + (force[i] + kick.rows[at, i])
    return 0


@scalar
def to_body(
    n: int, F: tuple[float, float, float], q0: float, q1: float, q2: float, q3: float
) -> tuple[float, float, float]:
    """Return R^T F at a compact pose, of a quaternion (3) or in the plane (2)."""
    x, y, z = F
    if n == 3:
        u1, u2, u3 = q2 * z - q3 * y, q3 * x - q1 * z, q1 * y - q2 * x
        return (
            x - 2 * (q0 * u1 - (q2 * u3 - q3 * u2)),
            y - 2 * (q0 * u2 - (q3 * u1 - q1 * u3)),
            z - 2 * (q0 * u3 - (q1 * u2 - q2 * u1)),
        )
    return q0 * x + q1 * y, q0 * y - q1 * x, 0.0


@scalar
def _times(A: Any, B: Any) -> tuple[float, float, float, float]:
    """Return A B of matrices with two rows."""
    first, second = A[0] * B[0] + A[1] * B[2], A[0] * B[1] + A[1] * B[3]
    return first, second, A[2] * B[0] + A[3] * B[2], A[2] * B[1] + A[3] * B[3]


@scalar
def _plus(A: Any, a: float, B: Any) -> tuple[float, float, float, float]:
    """Return A + a B."""
    return A[0] + a * B[0], A[1] + a * B[1], A[2] + a * B[2], A[3] + a * B[3]


@scalar
def friction_flow(p: Body, C: Any, time: float) -> tuple[Any, Any]:
    r"""Return A and V of friction $\dot r = a - Dr$ with two momenta over a time: $r' = Ar + Va$; $D = CB^{-1}$.

    $$ V(t) = \int_0^t e^{-sD}ds, \qquad A(t) = I + E(t), \qquad V(2t) = 2V + EV, \qquad E(2t) = 2E + EE : $$

    the series of a part of the time, which is doubled, by sums and products alone, as every processor has them.
    """
    b11, b12, b22 = inertia(p)
    one, none, lean = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 0.0), b12 / b11
    second, fourth = (C[1] - C[0] * lean) / (b22 - b12 * lean), (C[3] - C[2] * lean) / (b22 - b12 * lean)
    D = (C[0] - second * b12) / b11, second, (C[2] - fourth * b12) / b11, fourth
    X, doublings = _plus(none, -time, D), 0
    while doublings < _DOUBLINGS and abs(X[0]) + abs(X[1]) + abs(X[2]) + abs(X[3]) > 0.5:
        X, time, doublings = _plus(none, 0.5, X), time / 2, doublings + 1
    phi = one
    for k in range(_TERMS, 1, -1):
        phi = _plus(one, 1 / k, _times(X, phi))
    E, V = _times(X, phi), _plus(none, time, phi)
    for _ in range(doublings):
        V, E = _plus(_times(E, V), 2.0, V), _plus(_times(E, E), 2.0, E)
    return _plus(one, 1.0, E), V


RENEWED = 64
"""Steps after which the weight as the body sees it is taken from the pose again, so that the two do not drift apart."""


class Numbers(NamedTuple):
    """A kick without its rows, as numbers: how many of F there are, whether there is an A, then F, L and A."""

    n: int
    keeps: bool
    F: tuple[float, float, float]
    L: tuple[float, float, float, float, float, float]
    A: tuple[float, float, float, float]


@scalar
def turn_terms(n: int, y1: float, y2: float, x: float, y: float, z: float) -> tuple[float, float, float, float]:
    """Return a and v of W^T u = u - a v for u = (x, y, z) and the rotation of a displacement.

    It turns about (-y2, y1, 0), or in the plane by 2 atan y1. So the force at the next node does not wait for its pose,
    whose square root would be the longest way of a step.
    """
    if n == 3:
        square, lean = y1 * y1 + y2 * y2, y1 * x + y2 * y
        return 2 / (1 + square), y1 * (z + lean), y2 * (z + lean), square * z - lean
    return 2 / (1 + y1 * y1), y1 * (y1 * x - y), y1 * (x + y1 * y), 0.0


@scalar
def apply_arms(L: Any, x: float, y: float, z: float) -> tuple[float, float]:
    """Return L (x, y, z)."""
    return L[0] * x + (L[1] * y + L[2] * z), L[3] * x + (L[4] * y + L[5] * z)


@scalar
def turn_weight(n: int, L: Any, y1: float, y2: float, u: Any) -> tuple[float, float, Any]:
    """Return the two of L W^T u, and W^T u; only the last product of each waits for a quotient."""
    a, v1, v2, v3 = turn_terms(n, y1, y2, *u)
    f1, f2 = apply_arms(L, *u)
    h1, h2 = apply_arms(L, v1, v2, v3)
    return f1 - a * h1, f2 - a * h2, (u[0] - a * v1, u[1] - a * v2, u[2] - a * v3)


@scalar
def kicked_two(kick: Numbers, m1: float, m2: float, k1: float, k2: float) -> tuple[float, float]:
    """Return A m + k."""
    A = kick.A
    if kick.keeps:
        return A[0] * m1 + A[1] * m2 + k1, A[2] * m1 + A[3] * m2 + k2
    return m1 + k1, m2 + k2


@njit(**COMPILED)
def _numbers(kick: Kick) -> Numbers:
    """Return the numbers of a kick: arrays would be counted at every step of a loop."""
    F, L, a, n = np.zeros(3), np.zeros(6), np.zeros(4), len(kick.weight)
    for j in range(n):
        F[j], L[j], L[3 + j] = kick.weight[j], kick.arms[0, j], kick.arms[1, j]
    for j in range(2 * len(kick.keep)):
        a[j] = kick.keep[j // 2, j % 2]
    F3, L6, A4 = (F[0], F[1], F[2]), (L[0], L[1], L[2], L[3], L[4], L[5]), (a[0], a[1], a[2], a[3])
    return Numbers(n, len(kick.keep) > 0, F3, L6, A4)


@njit(forceinline=True, **COMPILED)
def _root(p: Body, heavy: bool, m1: float, m2: float, y1: float, y2: float) -> tuple[int, float, float]:
    """Correct a guess and verify that it is the principal root; under a weight by two corrections of one slope.

    Without one the root has the bits of a free step. An error of the second correction is a product of both.
    """
    d1, d2, e1, e2 = corrections(p, m1, m2, y1, y2)
    y1, y2 = y1 + d1, y2 + d2
    good = converged(d1, d2, y1, y2)
    if heavy and not good:
        y1, y2 = y1 + e1, y2 + e2
        weight = 1 + y1 * y1 + y2 * y2
        good = 4 * (d1 * d1 + d2 * d2) * (e1 * e1 + e2 * e2) <= 1e-36 * weight * weight
    if good and is_certain(p, m1, m2, y1, y2):
        return 0, y1, y2
    return _solve(p, m1, m2, y1, y2)


@njit(forceinline=True, **COMPILED)
def _next_node(p: Body, n: int, F: Any, row: int, y1: float, y2: float, q: Any, weight: Any) -> Any:
    """Return the pose of the next node, and the weight there: as it is, or now and then from the pose."""
    q = move(p, y1, y2, *q)
    return q, (to_body(n, F, *q) if n > 0 and row % RENEWED == 0 else weight)


@njit(nogil=True, **COMPILED)
def advance_two(p: Body, kick: Kick, state: np.ndarray, steps: int, every: int, rows: Rows) -> tuple[int, int]:
    """Advance a top in space or a sleigh in the plane, with numbers in place of arrays."""
    return advance_numbers(p, _numbers(kick), kick.rows, state, steps, every, rows)


@njit(nogil=True, **BORROWING)
def advance_numbers(
    p: Body, kick: Numbers, table: np.ndarray, state: np.ndarray, steps: int, every: int, rows: Rows
) -> tuple[int, int]:
    """Do the same, with the rows of a kick."""
    momenta, charts, poses = rows
    m1, m2, l1, l2, q0, q1, q2, q3, y1, y2, u1, u2, v1, v2 = _unpack(state)
    t1, t2, f1, f2, weight = state[14], state[15], state[16], state[17], (state[18], state[19], state[20])
    last, row, code, count = len(table) - 1, int(state[21]), 0, 0
    n, F, L, q = kick.n, kick.F, kick.L, (q0, q1, q2, q3)
    if row == 0:
        weight = to_body(n, F, *q)
        f1, f2 = apply_arms(L, *weight)
    while count < steps:
        r1, r2 = table[min(row, last), 0], table[min(row, last), 1]
        s1, s2 = kicked_two(kick, m1, m2, f1 + r1, f2 + r2)
        g1, g2 = 3 * (y1 - u1) + v1, 3 * (y2 - u2) + v2
        if n > 0:
            g1, g2 = 4 * (y1 + v1) - (6 * u1 + t1), 4 * (y2 + v2) - (6 * u2 + t2)
        code, w1, w2 = _root(p, n > 0, s1, s2, g1, g2)
        if code != 0:
            break
        if count > 0:  # not before: processors begin with what stands first, and no root waits for a pose
            q, weight = _next_node(p, n, F, row, y1, y2, q, weight)
        t1, t2, v1, v2, u1, u2, y1, y2 = v1, v2, u1, u2, y1, y2, w1, w2
        count += 1
        row += 1
        if count % every == 0:
            at = count // every - 1
            momenta[at, 0], momenta[at, 1], charts[at, 0], charts[at, 1] = m1, m2, w1, w2
            poses[at, 0], poses[at, 1], poses[at, 2], poses[at, 3] = q
        d1, d2 = increment(p, s1, s2, w1, w2)
        floor = SETTLED * max(abs(s1), abs(s2))
        s1, l1 = kahan_sum(s1, l1, d1, floor)
        s2, l2 = kahan_sum(s2, l2, d2, floor)
        if n > 0:
            f1, f2, weight = turn_weight(n, L, w1, w2, weight)
        m1, m2 = kicked_two(kick, s1, s2, f1 + r1, f2 + r2)
    if count > 0:
        q, weight = _next_node(p, n, F, row, y1, y2, q, weight)
    assign(state, (m1, m2, l1, l2, *q, y1, y2, u1, u2, v1, v2, t1, t2, f1, f2, *weight, float(row)))
    return count, code
