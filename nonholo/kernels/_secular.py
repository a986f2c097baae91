r"""The step on SO(n) and SE(n) in O(n): two scalar unknowns, whatever n (docs/theory/secular-step.md).

Axes of the body in which the constrained inertia is diagonal, momenta in units of the displacement, $m = h\,r/2$. The
displacement has Cayley coordinates $y$, and with $\tau = |y|^2$, $\nu = c\cdot y + (1 + \tau)q$

$$ y_i = \frac{m_i + \tau(m_i + c_i)}{b_i + \nu}, \qquad
   m_i' = m_i + \frac{2}{1 + \tau}\bigl(\tau c_i - (\nu - M)\,y_i\bigr). $$

A sleigh has $q = a\,m_0 + M$, $M = ma^2$, with $m_0$ the momentum along the blade, $m_0' = m_0 + 2ma\tau/(1+\tau)$; a
top has q = M = 0 and minus its coupling for c.
"""

import math
from typing import NamedTuple

import numba
import numpy as np

from nonholo.kernels._scalar import COMPILED, scalar

SUMMED = {**COMPILED, "fastmath": COMPILED["fastmath"] | {"reassoc"}}
"""Options of sums without compensation: the order of terms is free, so that they run in vector registers."""

_CORRECTIONS = 12
_CONVERGED = 1e-18  # squared correction, relative to the squared scale of the unknowns


class SecularBody(NamedTuple):
    """A top or a sleigh in the axes that diagonalise its constrained inertia.

    Attributes:
        b: Eigenvalues of B, of a sleigh without the part of the arm.
        c: Coupling with the sign of a sleigh's: minus that of a top.
        mass: Mass of a sleigh, 1 for a top.
        arm: Distance of the centre of mass from the contact point along the blade; 0 for a top.
        offset: Position of the centre of mass across the blade; zeros for a top.
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
    return SecularBody(b, -np.asarray(coupling, dtype=np.float64), 1.0, 0.0, np.zeros_like(b), float(b.min()), False)


def secular_sleigh(b: np.ndarray, coupling: np.ndarray, mass: float, arm: float, offset: np.ndarray) -> SecularBody:
    """Pack a sleigh: eigenvalues of B about the centre of mass, coupling and offset in their axes."""
    b, c, offset = (np.array(x, dtype=np.float64) for x in (b, coupling, offset))
    return SecularBody(b, c, float(mass), float(arm), offset, float(b.min()), True)


@scalar
def coordinate(b: float, c: float, m: float, nu: float, tau: float) -> tuple[float, float, float]:
    """Return y, its derivative by tau and 1 / (b + nu)."""
    inverse = 1 / (b + nu)
    pushed = m + c
    return (m + tau * pushed) * inverse, pushed * inverse, inverse


@scalar
def term(c: float, y: float, nu: float, tau: float, lever: float) -> float:
    """Return the change of m in one step."""
    return 2 / (1 + tau) * (tau * c - (nu - lever) * y)


@scalar
def correction(
    sums: tuple[float, float, float, float, float, float, float], nu: float, tau: float, q: float
) -> tuple[float, float, float]:
    """Return the Newton corrections of nu and tau and the determinant of their equations.

    The sums are those of c y, y y, c y / (b + nu), c dy/dtau, y y / (b + nu), y dy/dtau, b y y.
    """
    cy, yy, cyr, ce, yyr, ye, _ = sums
    f1, f2 = nu - cy - (1 + tau) * q, tau - yy
    j11, j12, j21, j22 = 1 + cyr, -ce - q, 2 * yyr, 1 - 2 * ye
    det = j11 * j22 - j12 * j21
    return (j12 * f2 - j22 * f1) / det, (j21 * f1 - j11 * f2) / det, det


@numba.njit(cache=True, nogil=True, **SUMMED)
def sums_at(
    p: SecularBody, m: np.ndarray, share: float, nu: float, tau: float
) -> tuple[float, float, float, float, float, float, float]:
    """Return the seven sums of `correction` for the momenta `share` times m."""
    b, c = p.b, p.c
    cy, yy, cyr, ce, yyr, ye, byy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(len(b)):
        y, e, inverse = coordinate(b[i], c[i], share * m[i], nu, tau)
        cy += c[i] * y
        yy += y * y
        cyr += c[i] * y * inverse
        ce += c[i] * e
        yyr += y * y * inverse
        ye += y * e
        byy += b[i] * y * y
    return cy, yy, cyr, ce, yyr, ye, byy


@numba.njit(cache=True, nogil=True, **COMPILED)
def newton(
    p: SecularBody, m: np.ndarray, m0: float, share: float, nu: float, tau: float, any_sheet: bool
) -> tuple[bool, float, float, float]:
    """Correct nu and tau; tell whether they converged, on the sheet of the principal root if not on any.

    Also returns the sum of b y y, at a correction that is too small to matter.
    """
    q = share * p.arm * m0 + p.mass * p.arm * p.arm
    for _ in range(_CORRECTIONS):
        sums = sums_at(p, m, share, nu, tau)
        d1, d2, det = correction(sums, nu, tau, q)
        nu += d1
        tau += d2
        if not (math.isfinite(det) and (any_sheet or (det > 0 and p.least + nu > 0))):
            return False, nu, tau, sums[6]
        if d1 * d1 <= _CONVERGED * (p.least + nu) ** 2 and d2 * d2 <= _CONVERGED * abs(tau):
            return True, nu, tau, sums[6]
    return False, nu, tau, sums[6]
