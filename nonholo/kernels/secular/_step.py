r"""The step on SO(n) and SE(n) in O(n): two scalar unknowns for every n (docs/theory/secular-step.md).

Axes of the body in which the constrained inertia is diagonal, momenta in units of the displacement, $m = h\,r/2$. The
displacement has Cayley coordinates $y$, and with $\tau = |y|^2$, $\nu = c\cdot y + (1 + \tau)q$

$$ y_i = \frac{m_i + \tau(m_i + c_i)}{b_i + \nu}, \qquad
   m_i' = m_i + \frac{2}{1 + \tau}\bigl(\tau c_i - (\nu - M)\,y_i\bigr). $$

A sleigh has $q = a\,m_0 + M$, $M = ma^2$, with $m_0$ the momentum along the blade, $m_0' = m_0 + 2ma\tau/(1+\tau)$; a
top has q = M = 0 and minus its coupling for c.
"""

import math
from typing import NamedTuple, TypeAlias

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import COMPILED, scalar

Sums: TypeAlias = tuple[float, float, float, float, float, float, float]

_CORRECTIONS = 12
_CONVERGED = 1e-18  # squared correction, relative to the squared scale of the unknowns
_LANES = 16  # partial sums of each kind
_MANY = 24  # terms from which they are faster


class SecularBody(NamedTuple):
    """A top or a sleigh in the axes that diagonalize its constrained inertia.

    Attributes:
        b: Eigenvalues of B, of a sleigh without the part of the arm.
        c: Coupling with the sign of a sleigh's: minus that of a top.
        mass: Mass of a sleigh, 1 for a top.
        arm: Distance of the center of mass from the contact point along the blade; 0 for a top.
        offset: Position of the center of mass across the blade; zeros for a top.
        least: The least of b.
        slides: Whether it is a sleigh.
    """

    b: np.ndarray
    c: np.ndarray
    mass: float
    arm: float
    offset: np.ndarray
    least: float
    slides: bool


def secular_top(b: np.ndarray, coupling: np.ndarray) -> SecularBody:
    """Pack a top: eigenvalues of B and the coupling in their axes."""
    b = np.array(b, dtype=np.float64)
    c = -np.asarray(coupling, dtype=np.float64)
    return SecularBody(b, c, 1.0, 0.0, np.zeros_like(b), float(b.min()), False)


def secular_sleigh(b: np.ndarray, coupling: np.ndarray, mass: float, arm: float, offset: np.ndarray) -> SecularBody:
    """Pack a sleigh: eigenvalues of B about the center of mass, coupling and offset in their axes."""
    b, c, offset = (np.array(x, dtype=np.float64) for x in (b, coupling, offset))
    return SecularBody(b, c, float(mass), float(arm), offset, float(b.min()), True)


@scalar
def coordinate(b: float, c: float, m: float, nu: float, tau: float) -> tuple[float, float, float]:
    """Return y, its derivative by tau and 1 / (b + nu)."""
    inverse = 1 / (b + nu)
    rate = m + c
    return (m + tau * rate) * inverse, rate * inverse, inverse


@scalar
def term(c: float, y: float, nu: float, tau: float, lever: float) -> float:
    """Return the change of m in one step."""
    return 2 / (1 + tau) * (tau * c - (nu - lever) * y)


@scalar
def correction(sums: Sums, nu: float, tau: float, q: float) -> tuple[float, float, float]:
    """Return the Newton corrections of nu and tau and the determinant of their equations.

    The sums are those of c y, y y, c y / (b + nu), c dy/dtau, y y / (b + nu), y dy/dtau, b y y.
    """
    cy, yy, cyr, ce, yyr, ye, _ = sums
    f1, f2 = nu - cy - (1 + tau) * q, tau - yy
    j11, j12, j21, j22 = 1 + cyr, -ce - q, 2 * yyr, 1 - 2 * ye
    det = j11 * j22 - j12 * j21
    return (j12 * f2 - j22 * f1) / det, (j21 * f1 - j11 * f2) / det, det


@njit(**COMPILED)
def room_for_sums() -> np.ndarray:
    """Return the array that `sums_at` writes to, made once for a run."""
    return np.empty(7 * _LANES)


@njit(forceinline=True, **COMPILED)
def sums_at(p: SecularBody, m: np.ndarray, share: float, nu: float, tau: float, room: np.ndarray) -> Sums:
    """Return the seven sums of `correction` for the momenta `share` times m.

    Few terms are added in order. Many run in vector registers: as far as they come out even, the term i goes to the
    partial sum i modulo `_LANES`; the partial sums are added in order, and to them the other terms.
    """
    if len(p.b) < _MANY:
        return _in_order(p.b, p.c, m, share, nu, tau, 0, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    return _in_lanes(p.b, p.c, m, share, nu, tau, room)


@njit(forceinline=True, **COMPILED)
def _in_order(
    b: np.ndarray, c: np.ndarray, m: np.ndarray, share: float, nu: float, tau: float, first: int, sums: Sums
) -> Sums:
    """Return sums to which the terms from the first one on are added."""
    for i in range(first, len(b)):
        k = np.uint64(i)  # a signed index would be tested for counting from the end
        sums = _add(sums, _terms(b[k], c[k], share * m[k], nu, tau))
    return sums


@njit(**COMPILED)
def _in_lanes(b: np.ndarray, c: np.ndarray, m: np.ndarray, share: float, nu: float, tau: float, s: np.ndarray) -> Sums:
    even = len(b) - len(b) % _LANES
    s[:] = 0.0
    for i in range(0, even, _LANES):
        for j in range(_LANES):
            k = np.uint64(i + j)
            cy, yy, cyr, ce, yyr, ye, byy = _terms(b[k], c[k], share * m[k], nu, tau)
            s[j] += cy
            s[_LANES + j] += yy
            s[2 * _LANES + j] += cyr
            s[3 * _LANES + j] += ce
            s[4 * _LANES + j] += yyr
            s[5 * _LANES + j] += ye
            s[6 * _LANES + j] += byy
    for i in range(7):
        total = 0.0
        for j in range(_LANES):
            total += s[_LANES * i + j]
        s[i] = total
    return _in_order(b, c, m, share, nu, tau, even, (s[0], s[1], s[2], s[3], s[4], s[5], s[6]))


@scalar
def _terms(b: float, c: float, m: float, nu: float, tau: float) -> Sums:
    y, e, inverse = coordinate(b, c, m, nu, tau)
    cy, yy = c * y, y * y
    return cy, yy, cy * inverse, c * e, yy * inverse, y * e, b * yy


@scalar
def _add(s: Sums, t: Sums) -> Sums:
    return s[0] + t[0], s[1] + t[1], s[2] + t[2], s[3] + t[3], s[4] + t[4], s[5] + t[5], s[6] + t[6]


@njit(nogil=True, **COMPILED)
def newton(
    p: SecularBody, m: np.ndarray, m0: float, share: float, nu: float, tau: float, any_sheet: bool, room: np.ndarray
) -> tuple[bool, float, float, float]:
    """Correct nu and tau; return whether they converged, on the sheet of the principal root if not on any.

    Also returns the sum of b y y, at a correction that is too small to matter.
    """
    q = share * p.arm * m0 + p.mass * p.arm * p.arm
    for _ in range(_CORRECTIONS):
        sums = sums_at(p, m, share, nu, tau, room)
        d1, d2, det = correction(sums, nu, tau, q)
        nu += d1
        tau += d2
        if not (math.isfinite(det) and (any_sheet or (det > 0 and p.least + nu > 0))):
            return False, nu, tau, sums[6]
        if d1 * d1 <= _CONVERGED * (p.least + nu) ** 2 and d2 * d2 <= _CONVERGED * abs(tau):
            return True, nu, tau, sums[6]
    return False, nu, tau, sums[6]
