r"""The same half impulses of a weight, friction and rows of a table for tops in space and sleighs in the plane.

Both kernels solve w(y) m = B y + (c . y') y', y' = (-y_2, y_1), w = 1 + y_1^2 + e y_2^2. Half impulses of a weight are
affine in y, $L\,(I - \hat y)\,R^TF = f + N y$, those of friction $-K y/w$: so the step is the cubic

$$ (B + K)\,y + (c\cdot y')\,y' = w(y)\,(m + r_k + f + N y), \qquad m' = m + 2 J + \Delta, \quad
   \Delta = -2\,(c\cdot y')\,y'/w . $$

A root is certainly the principal one where it is the only one in a region that no part of the step leads out of
(docs/theory/forces.md, Proposition 18.3); else it is followed over growing parts of the step. Tops: the disc
|y|_B <= R with

$$ 1 - \frac{|c|R}{b^{3/2}} - \frac{2R}{b}\Bigl((1 + \tfrac{|K|}b)R + \frac{|c|R^2}{b^{3/2}}\Bigr)
   - \Bigl(1 + \frac{R^2}b\Bigr)\frac\nu b > 0, \qquad
   |m|,\ |m + a| < \frac R{1 + R^2/b} - \frac{\nu R}b, $$

b the least eigenvalue of B, |N| <= nu, half impulses a + N y, momenta in the dual norm. Sleighs: the strip |y_1| <= T,
in which the second equation gives y_2 and the first one grows with y_1.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._driver import CORRECTIONS, SETTLED, _unpack, converged, kahan_sum
from nonholo.kernels._scalar import BORROWING, COMPILED, PIECES, Body, Rows, move, quadratic, scalar, sqrt
from nonholo.kernels._small import assign
from nonholo.kernels.forced._kick import RENEWED, Kick, _numbers, apply_arms, to_body, turn_terms

_HALVINGS = 24
STRIP = 0.5
"""T: 53 degrees to either side."""


@scalar
def is_alone(b: float, c: float, K: float, nu: float, R: float) -> bool:
    """Return whether there is at most one root of a top within a radius."""
    pull = c * R / (b * sqrt(b))
    return 1 - pull - 2 * R / b * ((1 + K / b) * R + pull * R) - (1 + R * R / b) * nu / b > 0


@scalar
def certain_disc(B: Any, c: float, K: float, nu: float) -> tuple[float, float]:
    """Return R^2, and the square of the dual norm of momenta up to which a root in it is certain, -1 if there is none.

    B is given by its three numbers, c and K by their sizes.
    """
    half = (B[0] - B[2]) / 2
    least = (B[0] + B[2]) / 2 - sqrt(half * half + B[1] * B[1])
    low, high = 0.0, sqrt(least)
    for _ in range(_HALVINGS):
        R = (low + high) / 2
        if is_alone(least, c, K, nu, R):
            low = R
        else:
            high = R
    level = low / (1 + low * low / least) - nu * low / least
    return low * low, (level * level if level > 0 else -1.0)


@scalar
def is_in_strip(B: Any, c: float, K: Any, m: Any, r: Any, N: Any) -> bool:
    """Return whether all parts of the step of a sleigh have one root each in the strip: of momenta m and r + N y_1.

    The y_2 of the second equation is put into the first one, whose least slope in the strip is bounded; a slide
    that adds to it does no harm.
    """
    T, W = STRIP, 1 + STRIP * STRIP
    a1, a2, n1, n2, size = abs(m[0]) + abs(r[0]), abs(m[1]) + abs(r[1]), abs(N[0]), abs(N[2]), abs(c)
    rate = (2 * T * (a2 + n2 * T) + W * n2 + abs(K[2]) + 2 * size * T) / B[2]
    against = m[1] if c > 0 else -m[1]
    slide = ((against if against > 0 else 0.0) + abs(r[1])) * (1 + 3 * T * T)
    bent = size * (slide + 2 * T * (W + T * T) * n2 + 2 * T * abs(K[2])) / B[2]
    growth = B[0] - abs(K[1]) * rate - bent - 2 * T * (a1 + n1 * T) - W * n1
    return growth > 0 and T * growth > a1 + abs(K[1]) * a2 / B[2]


_BENT = 0.25  # most change of a Jacobian in one piece of a path, squared
_SHORTEST = 1e-7  # piece
_FOLDED = 1e-2  # of the determinant at rest


class Pull(NamedTuple):
    """Half impulses of a weight, friction and a table, in the units and axes of a kernel.

    Attributes:
        weight: F, (2,) for cosine and sine, (3,) for a quaternion; (0,) without a weight.
        arms: L, (2, len(F)).
        friction: K, (2, 2); (0, 0) without friction.
        rows: Half impulses of a table, (steps + 1, 2), the last one zero.
    """

    is_python = False
    weight: np.ndarray
    arms: np.ndarray
    friction: np.ndarray
    rows: np.ndarray


class Cubic(NamedTuple):
    """The numbers of body and forces in the cubic of a step.

    Attributes:
        A: B + K.
        B: The same without friction, B11, B12, B22.
        c: The coupling.
        e: Whether the second coordinate is in w.
        n: How many numbers F has.
        F: The weight.
        L: Its arms.
        K: Friction.
    """

    A: Any
    B: Any
    c: Any
    e: float
    n: int
    F: Any
    L: Any
    K: Any


@scalar
def cubic_of(p: Body, n: int, F: Any, L: Any, K: Any) -> Cubic:
    """Return the cubic of a body under forces."""
    b11, b12, b22, c1, c2, e = quadratic(p)
    return Cubic((b11 + K[0], b12 + K[1], b12 + K[2], b22 + K[3]), (b11, b12, b22), (c1, c2), e, n, F, L, K)


@scalar
def lean(n: int, L: Any, u: Any) -> tuple[float, float, float, float]:
    """Return N: half impulses of the weight u, as the body sees it, are L u + N y."""
    if n == 3:
        a1, a2 = apply_arms(L, -u[2], 0.0, u[0])
        b1, b2 = apply_arms(L, 0.0, -u[2], u[1])
        return a1, b1, a2, b2
    a1, a2 = apply_arms(L, u[1], -u[0], 0.0)
    return a1, 0.0, a2, 0.0


@scalar
def gap(q: Cubic, A: Any, a: Any, N: Any, y1: float, y2: float) -> tuple[float, float]:
    """Return what the cubic of momenta a + N y misses at y."""
    s, w = q.c[1] * y1 - q.c[0] * y2, 1 + y1 * y1 + q.e * y2 * y2
    m1, m2 = a[0] + (N[0] * y1 + N[1] * y2), a[1] + (N[2] * y1 + N[3] * y2)
    return A[0] * y1 + A[1] * y2 - s * y2 - w * m1, A[2] * y1 + A[3] * y2 + s * y1 - w * m2


@scalar
def slopes(q: Cubic, A: Any, a: Any, N: Any, y1: float, y2: float) -> tuple[float, float, float, float]:
    """Return its derivatives by y."""
    s, w = q.c[1] * y1 - q.c[0] * y2, 1 + y1 * y1 + q.e * y2 * y2
    m1, m2 = a[0] + (N[0] * y1 + N[1] * y2), a[1] + (N[2] * y1 + N[3] * y2)
    j11 = A[0] - q.c[1] * y2 - 2 * y1 * m1 - w * N[0]
    j12 = A[1] + q.c[0] * y2 - s - 2 * q.e * y2 * m1 - w * N[1]
    j21 = A[2] + q.c[1] * y1 + s - 2 * y1 * m2 - w * N[2]
    return j11, j12, j21, A[3] - q.c[0] * y1 - 2 * q.e * y2 * m2 - w * N[3]


@scalar
def solved_by(J: Any, g1: float, g2: float) -> tuple[float, float]:
    """Return the Newton correction of a gap."""
    inverse = 1 / (J[0] * J[3] - J[1] * J[2])
    return (J[1] * g2 - J[3] * g1) * inverse, (J[2] * g1 - J[0] * g2) * inverse


@njit(**COMPILED)
def refine(q: Cubic, A: Any, a: Any, N: Any, y1: float, y2: float) -> tuple[bool, float, float]:
    """Correct a guess with new slopes until the next correction would be below rounding."""
    for _ in range(CORRECTIONS):
        g1, g2 = gap(q, A, a, N, y1, y2)
        d1, d2 = solved_by(slopes(q, A, a, N, y1, y2), g1, g2)
        y1, y2 = y1 + d1, y2 + d2
        if converged(d1, d2, y1, y2):
            return True, y1, y2
    return False, y1, y2


@njit(**COMPILED)
def follow(q: Cubic, m: Any, r: Any, N: Any) -> tuple[int, float, float]:
    """Follow the root over growing parts of a step, of momenta m and half impulses r + N y; return the outcome too.

    Friction, which bends nothing, acts in full at all parts.
    """
    A, y1, y2, t, size = q.A, 0.0, 0.0, 0.0, 0.25
    J, det_at_rest = A, A[0] * A[3] - A[1] * A[2]
    det = det_at_rest
    for _ in range(PIECES):
        goal = t + size if t + size < 1.0 else 1.0
        square = goal * goal
        a = (goal * m[0] + square * r[0], goal * m[1] + square * r[1])
        M = (square * N[0], square * N[1], square * N[2], square * N[3])
        good, z1, z2 = refine(q, A, a, M, y1, y2)
        H = slopes(q, A, a, M, z1, z2)
        if good and bent(J, H) < _BENT:
            if goal == 1.0:
                return 0, z1, z2
            y1, y2, t, J, size = z1, z2, goal, H, 2 * size
            det = J[0] * J[3] - J[1] * J[2]
        elif size > _SHORTEST:
            size /= 4
        elif math.isfinite(H[0] + H[1] + H[2] + H[3]) and det > _FOLDED * det_at_rest:
            return 3, math.nan, math.nan
        else:
            return (1 if math.isfinite(a[0] + a[1]) else 5), math.nan, math.nan
    return 3, math.nan, math.nan


@scalar
def bent(J: Any, H: Any) -> float:
    """Return the square of the size of J^-1 (H - J)."""
    d0, d1, d2, d3 = H[0] - J[0], H[1] - J[1], H[2] - J[2], H[3] - J[3]
    det = J[0] * J[3] - J[1] * J[2]
    a, b = J[3] * d0 - J[1] * d2, J[3] * d1 - J[1] * d3
    c, d = J[0] * d2 - J[2] * d0, J[0] * d3 - J[2] * d1
    return (a * a + b * b + c * c + d * d) / (det * det)


@njit(forceinline=True, **COMPILED)
def root_of(
    q: Cubic, disc: tuple[float, float], m: Any, r: Any, N: Any, y1: float, y2: float
) -> tuple[int, float, float]:
    """Correct a guess twice with one slope and more if need be, and verify the root, or follow it."""
    a = (m[0] + r[0], m[1] + r[1])
    J = slopes(q, q.A, a, N, y1, y2)
    g1, g2 = gap(q, q.A, a, N, y1, y2)
    d1, d2 = solved_by(J, g1, g2)
    y1, y2 = y1 + d1, y2 + d2
    good = converged(d1, d2, y1, y2)
    if not good:
        g1, g2 = gap(q, q.A, a, N, y1, y2)
        e1, e2 = solved_by(J, g1, g2)
        y1, y2 = y1 + e1, y2 + e2
        w = 1 + y1 * y1 + y2 * y2
        good = 4 * (d1 * d1 + d2 * d2) * (e1 * e1 + e2 * e2) <= 1e-36 * w * w
        if not good:
            good, y1, y2 = refine(q, q.A, a, N, y1, y2)
    if good and is_certain(q, disc, m, r, N, y1, y2):
        return 0, y1, y2
    return follow(q, m, r, N)


@scalar
def is_certain(q: Cubic, disc: tuple[float, float], m: Any, r: Any, N: Any, y1: float, y2: float) -> bool:
    """Return whether a root is the principal one beyond doubt."""
    B = q.B
    if q.e == 0.0:
        return y1 * y1 <= STRIP * STRIP and is_in_strip(B, q.c[1], q.K, m, r, N)
    within = B[0] * y1 * y1 + 2 * B[1] * y1 * y2 + B[2] * y2 * y2 <= disc[0]
    return within and level_of(B, m[0], m[1]) <= disc[1] and level_of(B, m[0] + r[0], m[1] + r[1]) <= disc[1]


@scalar
def level_of(B: Any, m1: float, m2: float) -> float:
    """Return the square of the dual norm of momenta, times the determinant of B."""
    return (B[2] * m1 - 2 * B[1] * m2) * m1 + B[0] * m2 * m2


@njit(**COMPILED)
def numbers_of(p: Body, pull: Pull) -> Cubic:
    """Return the numbers of half impulses, whose friction stands where a kick has what friction leaves."""
    kick = _numbers(Kick(pull.friction, pull.weight, pull.arms, pull.rows))
    return cubic_of(p, kick.n, kick.F, kick.L, kick.A)


@scalar
def size_of(row: Any) -> float:
    """Return the length of a row."""
    total = 0.0
    for x in row:
        total += x * x
    return sqrt(total)


@scalar
def disc_of(q: Cubic) -> tuple[float, float]:
    """Return the disc of a top, and the level of its momenta times the determinant of B."""
    radius, level = certain_disc(q.B, size_of(q.c), size_of(q.K), sqrt(2.0) * size_of(q.L) * size_of(q.F))
    return radius, level * (q.B[0] * q.B[2] - q.B[1] * q.B[1])


@njit(nogil=True, **COMPILED)
def advance_pulled(p: Body, pull: Pull, state: np.ndarray, steps: int, every: int, rows: Rows) -> tuple[int, int]:
    """Advance a top in space or a sleigh in the plane under half impulses at the displacement."""
    return advance_cubic(p, numbers_of(p, pull), pull.rows, state, steps, every, rows)


@scalar
def move_exactly(p: Body, q: Cubic, y1: float, y2: float, pose: Any, carry: Any) -> tuple[Any, Any]:
    """Return the pose after a displacement, and what rounding took from a sleigh's place: a weight would see work."""
    if q.e != 0.0:
        return move(p, y1, y2, *pose), carry
    r0, r1, x, y = move(p, y1, y2, pose[0], pose[1], 0.0, 0.0)
    x, first = kahan_sum(pose[2], carry[0], x, 0.0)
    y, second = kahan_sum(pose[3], carry[1], y, 0.0)
    return (r0, r1, x, y), (first, second)


@njit(nogil=True, **BORROWING)
def advance_cubic(
    p: Body, q: Cubic, table: np.ndarray, state: np.ndarray, steps: int, every: int, rows: Rows
) -> tuple[int, int]:
    """Do the same, with the rows of a table; the state is that of `advance_two`."""
    momenta, charts, poses = rows
    q = Cubic(q.A, q.B, q.c, quadratic(p)[5], q.n, q.F, q.L, q.K)  # e is a constant of the kind of body
    m1, m2, l1, l2, q0, q1, q2, q3, y1, y2, u1, u2, v1, v2 = _unpack(state)
    t1, t2, carry, weight = state[14], state[15], (state[16], state[17]), (state[18], state[19], state[20])
    last, row, code, count, pose = len(table) - 1, int(state[21]), 0, 0, (q0, q1, q2, q3)
    disc = disc_of(q)
    while count < steps:
        if q.n > 0 and row % RENEWED == 0:
            weight = to_body(q.n, q.F, *pose)
        f1, f2 = apply_arms(q.L, *weight)
        at = min(row, last)
        r, N = (table[at, 0] + f1, table[at, 1] + f2), lean(q.n, q.L, weight)
        g1, g2 = 4 * (y1 + v1) - (6 * u1 + t1), 4 * (y2 + v2) - (6 * u2 + t2)
        code, w1, w2 = root_of(q, disc, (m1, m2), r, N, g1, g2)
        if code != 0:
            break
        t1, t2, v1, v2, u1, u2, y1, y2 = v1, v2, u1, u2, y1, y2, w1, w2
        count += 1
        row += 1
        if count % every == 0:
            at = count // every - 1
            momenta[at, 0], momenta[at, 1], charts[at, 0], charts[at, 1] = m1, m2, w1, w2
            poses[at, 0], poses[at, 1], poses[at, 2], poses[at, 3] = pose
        share = 1 / (1 + w1 * w1 + q.e * w2 * w2)
        push, K = 2 * (q.c[1] * w1 - q.c[0] * w2) * share, q.K
        j1 = r[0] + (N[0] * w1 + N[1] * w2) - (K[0] * w1 + K[1] * w2) * share
        j2 = r[1] + (N[2] * w1 + N[3] * w2) - (K[2] * w1 + K[3] * w2) * share
        floor = SETTLED * max(abs(m1), abs(m2))
        m1, l1 = kahan_sum(m1, l1, 2 * j1 + push * w2, floor)
        m2, l2 = kahan_sum(m2, l2, 2 * j2 - push * w1, floor)
        if q.n > 0:
            a, x, y, z = turn_terms(q.n, w1, w2, *weight)
            weight = (weight[0] - a * x, weight[1] - a * y, weight[2] - a * z)
        pose, carry = move_exactly(p, q, w1, w2, pose, carry)
    assign(state, (m1, m2, l1, l2, *pose, y1, y2, u1, u2, v1, v2, t1, t2, *carry, *weight, float(row)))
    return count, code
