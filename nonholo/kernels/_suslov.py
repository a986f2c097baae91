r"""The step of the Suslov top on SO(3) in Cayley coordinates (docs/theory/suslov-top.md).

Canonical frame, momenta in units of the displacement: $m = h\,r/2$. The displacement $W$ has Cayley coordinates $y$
(tan of half the step angle times its direction in $\mathfrak{d}$) that satisfy two quadratics,

$$ B y + (c\cdot y^\perp)\,y^\perp - (1 + |y|^2)\,m = 0, \qquad y^\perp = (-y_2, y_1), $$

and $m' = m - 2\,(c\cdot y^\perp)\,y^\perp / (1 + |y|^2)$. The fold curve is where the Jacobian determinant vanishes.
"""

from typing import Any, NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import COMPILED, PIECES, scalar, sqrt


class SuslovBody(NamedTuple):
    """B, c and the squared radius within which every root is the principal one."""

    b11: Any
    b12: Any
    b22: Any
    c1: Any
    c2: Any
    certain: Any


def suslov_body(constrained_inertia: Any, coupling: Any) -> SuslovBody:
    """Pack the parameters of a top; concrete ones get the radius of the certificate, traced ones a smaller one."""
    if isinstance(constrained_inertia, np.ndarray) and isinstance(coupling, np.ndarray):
        return SuslovBody(*(float(x) for x in suslov_table(constrained_inertia, coupling)))
    (b11, b12), (_, b22) = constrained_inertia
    c1, c2 = coupling
    xp = constrained_inertia.__array_namespace__()
    middle, half = (b11 + b22) / 2, xp.sqrt((b11 - b22) * (b11 - b22) / 4 + b12 * b12)
    length, pull = xp.sqrt(c1 * c1 + c2 * c2), xp.sqrt((b11 * c1 + b12 * c2) ** 2 + (b12 * c1 + b22 * c2) ** 2)
    low, high = middle - half, middle + half
    below = low * high / (2 * (pull + length * high) + low * high)  # the root of a convex cubic, by its chord
    return SuslovBody(b11, b12, b22, c1, c2, (0.999 * xp.minimum(below, 0.7 * low / length)) ** 2)


def suslov_table(B: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Return the parameters of one top or of many (leading axes of B and c), one row for each field of a body."""
    return np.stack([B[..., 0, 0], B[..., 0, 1], B[..., 1, 1], c[..., 0], c[..., 1], _certain_radius(B, c) ** 2])


def _certain_radius(B: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Return the radius of the disc that no fold reaches, in a unit of mass in which no square over- or underflows."""
    unit = np.exp2(np.floor(np.log2(np.abs(B).max(axis=(-2, -1)))))[..., None]
    B, c = B / unit[..., None], c / unit
    low, high = np.moveaxis(np.linalg.eigvalsh(B), -1, 0)
    length, pull = np.linalg.norm(c, axis=-1), np.linalg.norm((B @ c[..., None])[..., 0], axis=-1)
    with np.errstate(divide="ignore"):
        return 0.999 * np.minimum(_positive_root(pull + 2 * length * high, low * high, pull), 0.7 * low / length)


def _positive_root(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Return the positive root of a x^3 + b x^2 + c x = b, at most 1; Newton's method from 1 only comes down to it."""
    x = np.ones_like(b)
    for _ in range(200):
        change = (((a * x + b) * x + c) * x - b) / ((3 * a * x + 2 * b) * x + c)
        x = x - change
        if np.all(change <= 1e-9 * x):
            break
    return x


@scalar
def inertia(p: SuslovBody) -> tuple[float, float, float]:
    """Return B."""
    return p.b11, p.b12, p.b22


@scalar
def quadratic(p: SuslovBody) -> tuple[float, float, float, float, float, float]:
    """Return B, c and 1: the quadratics of all momenta."""
    return p.b11, p.b12, p.b22, p.c1, p.c2, 1.0


@scalar
def c_perp(p: SuslovBody, y1: float, y2: float) -> float:
    """Return c . y_perp, which drives the momentum."""
    return p.c2 * y1 - p.c1 * y2


@scalar
def residual(p: SuslovBody, m1: float, m2: float, y1: float, y2: float) -> tuple[float, float]:
    """Return the two quadratics at y."""
    s = c_perp(p, y1, y2)
    weight = 1 + y1 * y1 + y2 * y2
    return p.b11 * y1 + p.b12 * y2 - s * y2 - weight * m1, p.b12 * y1 + p.b22 * y2 + s * y1 - weight * m2


@scalar
def slopes(p: SuslovBody, m1: float, m2: float, y1: float, y2: float) -> tuple[float, float, float, float]:
    """Return the derivative of the two quadratics by y; at a root that of m, times 1 + |y|^2."""
    s = c_perp(p, y1, y2)
    j11 = p.b11 - p.c2 * y2 - 2 * y1 * m1
    j12 = p.b12 + p.c1 * y2 - s - 2 * y2 * m1
    j21 = p.b12 + p.c2 * y1 + s - 2 * y1 * m2
    return j11, j12, j21, p.b22 - p.c1 * y1 - 2 * y2 * m2


@scalar
def correction(p: SuslovBody, m1: float, m2: float, y1: float, y2: float) -> tuple[float, float]:
    """Return the Newton correction of y."""
    d1, d2, _, _ = corrections(p, m1, m2, y1, y2)
    return d1, d2


@scalar
def corrections(p: SuslovBody, m1: float, m2: float, y1: float, y2: float) -> tuple[float, float, float, float]:
    """Return the Newton correction d of y, and the one after it with the same slopes.

    Of the two quadratics d leaves exactly their terms of second order: the equations at d without the others.
    """
    g1, g2 = residual(p, m1, m2, y1, y2)
    j11, j12, j21, j22 = slopes(p, m1, m2, y1, y2)
    inverse = 1 / (j11 * j22 - j12 * j21)
    d1, d2 = (j12 * g2 - j22 * g1) * inverse, (j21 * g1 - j11 * g2) * inverse
    s, square = c_perp(p, d1, d2), d1 * d1 + d2 * d2
    h1, h2 = -s * d2 - square * m1, s * d1 - square * m2
    return d1, d2, (j12 * h2 - j22 * h1) * inverse, (j21 * h1 - j11 * h2) * inverse


@scalar
def is_certain(p: SuslovBody, m1: float, m2: float, y1: float, y2: float) -> bool:
    """Return whether a root is certainly the principal one: it lies in the disc that no fold reaches."""
    return y1 * y1 + y2 * y2 <= p.certain


@scalar
def increment(p: SuslovBody, m1: float, m2: float, y1: float, y2: float) -> tuple[float, float]:
    """Return m' - m."""
    push = 2 * c_perp(p, y1, y2) / (1 + y1 * y1 + y2 * y2)
    return push * y2, -push * y1


@scalar
def move(
    p: SuslovBody, y1: float, y2: float, q0: float, q1: float, q2: float, q3: float
) -> tuple[float, float, float, float]:
    """Return the quaternion of g W, renormalized: W turns about the body axis (-y2, y1, 0)."""
    z0 = 1 / sqrt(1 + y1 * y1 + y2 * y2)
    x, y = -y2 * z0, y1 * z0
    r0, r1 = q0 * z0 - q1 * x - q2 * y, q0 * x + q1 * z0 - q3 * y
    r2, r3 = q0 * y + q2 * z0 + q3 * x, q3 * z0 + q1 * y - q2 * x
    unit = (3 - (r0 * r0 + r1 * r1 + r2 * r2 + r3 * r3)) / 2
    return r0 * unit, r1 * unit, r2 * unit, r3 * unit


_LONGEST_ARC = 0.1  # radians of the half-turn sphere per continuation step
_CLOSE = 0.02  # a corrector that moves further has left the branch


@njit(**COMPILED)
def principal(p: SuslovBody, m1: float, m2: float) -> tuple[int, float, float]:
    """Follow the root from momentum zero along s m, 0 <= s <= 1; return the outcome and y.

    Works on the sphere of half-angle quaternions, where the branch is smooth through angle pi.
    """
    z = (1.0, 0.0, 0.0)
    s, size = 0.0, 1.0
    for _ in range(PIECES):
        d0, d1, d2, det = _tangent(p, s * m1, s * m2, z, m1, m2)
        size = min(size, 1.0 - s, _LONGEST_ARC / np.sqrt(d0 * d0 + d1 * d1 + d2 * d2))
        if not size > 0:  # the squares overflow
            return 5, np.nan, np.nan
        guess = (z[0] + size * d0, z[1] + size * d1, z[2] + size * d2)
        good, root = _correct(p, (s + size) * m1, (s + size) * m2, guess)
        if good:
            z, s, size = root, (1.0 if size == 1.0 - s else s + size), 2 * size
            if s == 1.0:
                z0 = z[0] if z[0] != 0 else 1e-75
                return 0, z[1] / z0, z[2] / z0
        elif size > 1e-9:
            size /= 4
        elif det < 1e-2 * (p.b11 * p.b22 - p.b12 * p.b12):
            return 1, np.nan, np.nan
        else:
            return (3 if np.isfinite(det) else 5), np.nan, np.nan
    return 3, np.nan, np.nan


@njit(**COMPILED)
def _correct(p, m1, m2, guess):  # noqa: ANN001, ANN202
    z = guess
    for _ in range(6):
        g1, g2 = _homogeneous_residual(p, m1, m2, z)
        d0, d1, d2, det = _solve(p, m1, m2, z, -g1, -g2, (1 - z[0] * z[0] - z[1] * z[1] - z[2] * z[2]) / 2)
        z = (z[0] + d0, z[1] + d1, z[2] + d2)
        shift = (z[0] - guess[0]) ** 2 + (z[1] - guess[1]) ** 2 + (z[2] - guess[2]) ** 2
        if not (det > 0 and shift < _CLOSE * _CLOSE):
            return False, z
        if d0 * d0 + d1 * d1 + d2 * d2 < 1e-24:
            return True, z
    return False, z


@njit(**COMPILED)
def _tangent(p, m1, m2, z, r1, r2):  # noqa: ANN001, ANN202
    weight = z[0] * z[0] + z[1] * z[1] + z[2] * z[2]
    return _solve(p, m1, m2, z, r1 * weight, r2 * weight, 0.0)


@scalar
def _homogeneous_residual(p, m1, m2, z):  # noqa: ANN001, ANN202
    z0, z1, z2 = z
    s = c_perp(p, z1, z2)
    weight = z0 * z0 + z1 * z1 + z2 * z2
    g1 = z0 * (p.b11 * z1 + p.b12 * z2) - s * z2 - weight * m1
    return g1, z0 * (p.b12 * z1 + p.b22 * z2) + s * z1 - weight * m2


@scalar
def _solve(p, m1, m2, z, g1, g2, g3):  # noqa: ANN001, ANN202
    """Solve the linearized homogeneous equations with the third right-hand side along z; also the determinant."""
    z0, z1, z2 = z
    s = c_perp(p, z1, z2)
    a0 = p.b11 * z1 + p.b12 * z2 - 2 * z0 * m1
    a1 = z0 * p.b11 - p.c2 * z2 - 2 * z1 * m1
    a2 = z0 * p.b12 + p.c1 * z2 - s - 2 * z2 * m1
    b0 = p.b12 * z1 + p.b22 * z2 - 2 * z0 * m2
    b1 = z0 * p.b12 + p.c2 * z1 + s - 2 * z1 * m2
    b2 = z0 * p.b22 - p.c1 * z1 - 2 * z2 * m2
    n0, n1, n2 = a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0
    det = z0 * n0 + z1 * n1 + z2 * n2
    u0, u1, u2 = b1 * z2 - b2 * z1, b2 * z0 - b0 * z2, b0 * z1 - b1 * z0
    v0, v1, v2 = z1 * a2 - z2 * a1, z2 * a0 - z0 * a2, z0 * a1 - z1 * a0
    return (
        (g1 * u0 + g2 * v0 + g3 * n0) / det,
        (g1 * u1 + g2 * v1 + g3 * n1) / det,
        (g1 * u2 + g2 * v2 + g3 * n2) / det,
        det,
    )
