"""Linear algebra of the equations on the sphere of half-angle coordinates, in O(n).

All moves but three are eliminated: those of z0, of mu and of the z_i with the least |z0 b_i + mu|, which may vanish.

Reference: docs/theory/secular-step.md, "A path".
"""

import math

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import COMPILED
from nonholo.kernels._small import eliminate
from nonholo.kernels.secular._step import SecularBody


@njit(nogil=True, **COMPILED)
def total_factor(p: SecularBody, x: np.ndarray) -> float:
    """Return mu = c.z + w."""
    mu = x[1]
    for i in range(len(p.b)):
        mu += p.c[i] * x[2 + i]
    return mu


@njit(nogil=True, **COMPILED)
def least_factor(p: SecularBody, z0: float, mu: float) -> tuple[int, bool]:
    """Return where |z0 b + mu| is least, and whether an odd number of the others are negative."""
    pivot, least, odd = 0, math.inf, False
    for i in range(len(p.b)):
        factor = z0 * p.b[i] + mu
        odd = odd != (factor < 0)
        if abs(factor) < least:
            pivot, least = i, abs(factor)
    return pivot, odd != (z0 * p.b[pivot] + mu < 0)


@njit(nogil=True, **COMPILED)
def reduced_matrix(p: SecularBody, x: np.ndarray, mu: float, j: int) -> np.ndarray:
    """Return the matrix of the three equations that are left: sphere, mu and the momentum of the pivot j."""
    z0, w, zg, zz, cg, cz = x[0], x[1], 0.0, 0.0, 0.0, 0.0
    for i in range(len(p.b)):
        if i != j:
            c, z = p.c[i], x[2 + i]
            inverse = 1 / (z0 * p.b[i] + mu)
            g = (p.b[i] * z + 2 * z0 * c) * inverse
            zg += z * g
            zz += z * z * inverse
            cg += c * g
            cz += c * z * inverse
    A, c, z = np.empty((3, 3)), p.c[j], x[2 + j]
    A[0, 0], A[0, 1], A[0, 2] = z0 - zg, -zz, z
    A[1, 0], A[1, 1], A[1, 2] = cg, 1 + cz, -c
    if p.arm != 0:
        A[1, 0], A[1, 1], A[1, 2] = w + z0 * cg, z0 * (1 + cz), -z0 * c
    A[2, 0], A[2, 1], A[2, 2] = p.b[j] * z + 2 * z0 * c, z, z0 * p.b[j] + mu
    return A


@njit(nogil=True, **COMPILED)
def solve_linear(p: SecularBody, x: np.ndarray, right: np.ndarray, move: np.ndarray) -> float:
    """Write the move of (z0, w, z) that changes sphere, w z0 and momenta by `right`; return the determinant.

    The determinant is that of the pivot and the two sums, with the sign of the whole one, relative to z0 = 1, z = 0.
    """
    z0, mu, rho = x[0], total_factor(p, x), right[0]
    j, odd = least_factor(p, z0, mu)
    A, B, zR, cR = reduced_matrix(p, x, mu, j), np.empty((3, 1)), 0.0, 0.0
    for i in range(len(p.b)):
        if i != j:
            R = (right[2 + i] + 2 * p.c[i] * rho) / (z0 * p.b[i] + mu)
            zR += x[2 + i] * R
            cR += p.c[i] * R
    B[0, 0], B[1, 0], B[2, 0] = rho - zR, cR, right[2 + j] + 2 * p.c[j] * rho
    if p.arm != 0:
        B[1, 0] = right[1] + z0 * cR
    det = eliminate(A, B) / (p.b[j] + p.mass * p.arm * p.arm)
    move[0], dmu, move[2 + j] = B[0, 0], B[1, 0], B[2, 0]
    move[1] = dmu - p.c[j] * move[2 + j]
    for i in range(len(p.b)):
        if i != j:
            turned = p.b[i] * x[2 + i] + 2 * z0 * p.c[i]
            push = right[2 + i] + 2 * p.c[i] * rho - x[2 + i] * dmu - turned * move[0]
            move[2 + i] = push / (z0 * p.b[i] + mu)
            move[1] -= p.c[i] * move[2 + i]
    if p.arm == 0:
        move[1] = 0.0
    return -det if odd else det
