r"""The equations on the sphere of half-angle coordinates: linear algebra in O(n), and a box that a path does not leave.

All moves but three are eliminated: those of z0, of mu and of the z_i with the least |z0 b_i + mu|, which may vanish.

By a box it is proved which root is the continuation of another one. The equations are quadratic in
$x = (z_0, w, z)$, with $\mu = c\cdot z + w$, and linear in s. With the derivative J at a root, its tangent t and the
bilinear part H, the roots x + u at $s + \sigma$ are the fixed points of

$$ u \mapsto \sigma t - \tfrac12 J^{-1}H(u, u) . $$

Where $|u_j| \le R_j$, the entries of the last term are at most $G_j(R)$, and those of its derivative, in the norm of
the box, at most $2G_j(R)/R_j$. Boxes have entries for z0, w, all z and mu.

Reference: docs/theory/secular-step.md, "A path", "A box for every piece".
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
            slope = p.b[i] * x[2 + i] + 2 * z0 * p.c[i]
            push = right[2 + i] + 2 * p.c[i] * rho - x[2 + i] * dmu - slope * move[0]
            move[2 + i] = push / (z0 * p.b[i] + mu)
            move[1] -= p.c[i] * move[2 + i]
    if p.arm == 0:
        move[1] = 0.0
    return -det if odd else det


_ROOM = 4.5  # what is left for the bend, of its first estimate: 1 were too little, and the box grows with it
_ROUNDING = 1e-12  # of the unknowns, which a box may be smaller than


@njit(nogil=True, **COMPILED)
def _push(p: SecularBody, R: np.ndarray, i: int) -> float:
    """Return the bound of the quadratic part of a momentum equation."""
    return (R[0] * p.b[i] + R[-1]) * R[2 + i] + R[0] * R[0] * abs(p.c[i])


@njit(nogil=True, **COMPILED)
def write_bends(p: SecularBody, x: np.ndarray, R: np.ndarray, G: np.ndarray) -> None:
    """Write the bounds G of the entries of J^-1 H(u, u) / 2 in the box R."""
    k, z0, mu = len(p.b), x[0], total_factor(p, x)
    j, _ = least_factor(p, z0, mu)
    square, zF, cF = R[0] * R[0] / 2, 0.0, 0.0
    for i in range(k):
        square += R[2 + i] * R[2 + i] / 2
        if i != j:
            F = _push(p, R, i) / abs(z0 * p.b[i] + mu)
            zF += abs(x[2 + i]) * F
            cF += abs(p.c[i]) * F
    slid = R[1] * R[0]
    first, second, third = square + zF, cF if p.arm == 0 else slid + abs(z0) * cF, _push(p, R, j)
    inverse = np.zeros((3, 3))
    inverse[0, 0] = inverse[1, 1] = inverse[2, 2] = 1.0
    eliminate(reduced_matrix(p, x, mu, j), inverse)
    inverse = np.abs(inverse)
    G[0] = inverse[0, 0] * first + inverse[0, 1] * second + inverse[0, 2] * third
    G[-1] = inverse[1, 0] * first + inverse[1, 1] * second + inverse[1, 2] * third
    G[2 + j] = inverse[2, 0] * first + inverse[2, 1] * second + inverse[2, 2] * third
    G[1] = G[-1] + abs(p.c[j]) * G[2 + j]
    for i in range(k):
        if i != j:
            slope = abs(p.b[i] * x[2 + i] + 2 * z0 * p.c[i])
            G[2 + i] = (_push(p, R, i) + abs(x[2 + i]) * G[-1] + slope * G[0]) / abs(z0 * p.b[i] + mu)
            G[1] += abs(p.c[i]) * G[2 + i]
    G[1] = 0.0 if p.arm == 0 else min(G[1], (slid + abs(x[1]) * G[0]) / abs(z0))


@njit(nogil=True, **COMPILED)
def write_box(p: SecularBody, x: np.ndarray, way: np.ndarray, R: np.ndarray) -> float:
    """Write a box for a predicted move; return less than one if the path surely stays in it, as its only root."""
    n = len(x)
    for i in range(n):
        R[i] = abs(way[i])
    R[n] = abs(total_factor(p, way))
    room, G, worst = np.empty_like(R), np.empty_like(R), 0.0
    write_bends(p, x, R, room)
    for i in range(n + 1):
        room[i] *= _ROOM
        R[i] += room[i]
    write_bends(p, x, R, G)
    for i in range(n + 1):
        if not math.isfinite(G[i]):
            return math.inf
        if G[i] > 0:
            worst = max(worst, 2 * G[i] / R[i], G[i] / room[i])
    return worst


@njit(nogil=True, **COMPILED)
def holds(p: SecularBody, x: np.ndarray, R: np.ndarray, root: np.ndarray) -> bool:
    """Return whether the box about x has a root in it."""
    move, scale = root - x, abs(x[1])
    for i in range(len(p.b)):
        scale += abs(p.c[i] * x[2 + i])
        if not abs(move[2 + i]) <= R[2 + i] + _ROUNDING:
            return False
    mu, slack = total_factor(p, move), _ROUNDING * scale
    return abs(move[0]) <= R[0] + _ROUNDING and abs(move[1]) <= R[1] + slack and abs(mu) <= R[-1] + slack
