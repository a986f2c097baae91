r"""A box that a path on the sphere does not leave: which root is the continuation of another one is proved.

The equations are quadratic in $x = (z_0, w, z)$, with $\mu = c\cdot z + w$, and linear in s. With the derivative J at a
root, its tangent t and the bilinear part H, the roots x + u at $s + \sigma$ are the fixed points of

$$ u \mapsto \sigma t - \tfrac12 J^{-1}H(u, u) . $$

Where $|u_j| \le R_j$, the entries of the last term are at most $G_j(R)$, and those of its derivative, in the norm of
the box, at most $2G_j(R)/R_j$. Boxes have entries for z0, w, all z and mu.

Reference: docs/theory/secular-step.md, "A box for every piece".
"""

import math

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import COMPILED
from nonholo.kernels._small import eliminate
from nonholo.kernels.secular._linear import least_factor, reduced_matrix, total_factor
from nonholo.kernels.secular._step import SecularBody

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
            turned = abs(p.b[i] * x[2 + i] + 2 * z0 * p.c[i])
            G[2 + i] = (_push(p, R, i) + abs(x[2 + i]) * G[-1] + turned * G[0]) / abs(z0 * p.b[i] + mu)
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
    """Tell whether the box about x has a root in it."""
    move, scale = root - x, abs(x[1])
    for i in range(len(p.b)):
        scale += abs(p.c[i] * x[2 + i])
        if not abs(move[2 + i]) <= R[2 + i] + _ROUNDING:
            return False
    mu, slack = total_factor(p, move), _ROUNDING * scale
    return abs(move[0]) <= R[0] + _ROUNDING and abs(move[1]) <= R[1] + slack and abs(mu) <= R[-1] + slack
