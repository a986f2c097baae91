r"""The principal root of the secular step by its path: in two numbers, or on the sphere of half-angle coordinates.

With $z_0 = \cos\frac\theta2$, $z = z_0y$ and $\mu = z_0\nu = c\cdot z + w$ the equations for the momenta $s\,m$ are

$$ (z_0b_i + \mu)\,z_i = s\,m_i + |z|^2c_i, \qquad z_0^2 + |z|^2 = 1, \qquad wz_0 = q(s), $$

and w = 0 where q = 0 for all s. Here nothing is special at angle $\pi$, $z_0 = 0$. Newton's corrections cost O(n):
given those of $z_0$ and $\mu$ each $z_i$ has its own equation; the one with the least $|z_0b_i + \mu|$, which may
vanish, is solved along with the others.

Reference: docs/theory/secular-step.md, "A path".
"""

import math

import numpy as np

from nonholo._compiled import njit
from nonholo.kernels._scalar import COMPILED, PIECES
from nonholo.kernels._secular import SecularBody, newton
from nonholo.kernels._secular_root import followed, level_of
from nonholo.kernels._small import eliminate

_LONGEST = 0.1  # predicted move on the sphere of one step
_CLOSE = 0.02  # a corrector that moves further has left the branch,
_BENT = 0.2  # and one that moves further than this share of the predicted move: folds of uneven bodies are tiny
_SMALLEST = 1e-9  # step along the path, relative to s, below which the branch is given up
_FAST = 20.0  # move on the sphere, per relative step, of a path that is about to end in a fold
_CORRECTIONS = 8
_CONVERGED = 1e-12  # correction on the sphere, after which the next one is below rounding
_AT_PI = 1e-75  # stands for z0 = 0, which y cannot be divided by


@njit(nogil=True, **COMPILED)
def _least(p: SecularBody, z0: float, mu: float) -> tuple[int, bool]:
    """Return where |z0 b + mu| is least, and whether an odd number of the others are negative."""
    pivot, least, odd = 0, math.inf, False
    for i in range(len(p.b)):
        factor = z0 * p.b[i] + mu
        odd = odd != (factor < 0)
        if abs(factor) < least:
            pivot, least = i, abs(factor)
    return pivot, odd != (z0 * p.b[pivot] + mu < 0)


@njit(nogil=True, **COMPILED)
def _sums(
    p: SecularBody, x: np.ndarray, mu: float, right: np.ndarray, rho: float, pivot: int
) -> tuple[float, float, float, float, float, float]:
    """Return the sums of z and of c times what right-hand side, dz0 and dmu each move z by, all but the pivot."""
    z0, zR, zg, zz, cR, cg, cz = x[0], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(len(p.b)):
        if i != pivot:
            c, z = p.c[i], x[2 + i]
            inverse = 1 / (z0 * p.b[i] + mu)
            R, g = (right[2 + i] + 2 * c * rho) * inverse, (p.b[i] * z + 2 * z0 * c) * inverse
            zR += z * R
            zg += z * g
            zz += z * z * inverse
            cR += c * R
            cg += c * g
            cz += c * z * inverse
    return zR, zg, zz, cR, cg, cz


@njit(nogil=True, **COMPILED)
def solve_linear(p: SecularBody, x: np.ndarray, right: np.ndarray, move: np.ndarray) -> float:
    """Write the move of (z0, w, z) that changes sphere, w z0 and momenta by `right`; return the determinant.

    The determinant is that of the pivot and the two sums, with the sign of the whole one, relative to z0 = 1, z = 0.
    """
    z0, w, rho = x[0], x[1], right[0]
    mu = w
    for i in range(len(p.b)):
        mu += p.c[i] * x[2 + i]
    j, odd = _least(p, z0, mu)
    zR, zg, zz, cR, cg, cz = _sums(p, x, mu, right, rho, j)
    c, z, g = p.c[j], x[2 + j], p.b[j] * x[2 + j] + 2 * z0 * p.c[j]
    A, B = np.empty((3, 3)), np.empty((3, 1))
    A[0, 0], A[0, 1], A[0, 2], B[0, 0] = z0 - zg, -zz, z, rho - zR
    A[1, 0], A[1, 1], A[1, 2], B[1, 0] = cg, 1 + cz, -c, cR
    if p.arm != 0:
        A[1, 0], A[1, 1], A[1, 2], B[1, 0] = w + z0 * cg, z0 * (1 + cz), -z0 * c, right[1] + z0 * cR
    A[2, 0], A[2, 1], A[2, 2], B[2, 0] = g, z, z0 * p.b[j] + mu, right[2 + j] + 2 * c * rho
    det = eliminate(A, B) / (p.b[j] + p.mass * p.arm * p.arm)
    move[0], dmu, move[2 + j] = B[0, 0], B[1, 0], B[2, 0]
    move[1] = dmu - c * move[2 + j]
    for i in range(len(p.b)):
        if i != j:
            turned = p.b[i] * x[2 + i] + 2 * z0 * p.c[i]
            push = right[2 + i] + 2 * p.c[i] * rho - x[2 + i] * dmu - turned * move[0]
            move[2 + i] = push / (z0 * p.b[i] + mu)
            move[1] -= p.c[i] * move[2 + i]
    if p.arm == 0:
        move[1] = 0.0
    return -det if odd else det


@njit(nogil=True, **COMPILED)
def _missed(p: SecularBody, m: np.ndarray, m0: float, s: float, x: np.ndarray, right: np.ndarray) -> None:
    """Write by how much the equations are missed."""
    z0, w, square, mu = x[0], x[1], 0.0, x[1]
    for i in range(len(p.b)):
        mu += p.c[i] * x[2 + i]
        square += x[2 + i] ** 2
    right[0] = (1 - z0 * z0 - square) / 2
    right[1] = s * p.arm * m0 + p.mass * p.arm * p.arm - w * z0
    for i in range(len(p.b)):
        right[2 + i] = s * m[i] + square * p.c[i] - (z0 * p.b[i] + mu) * x[2 + i]


@njit(nogil=True, **COMPILED)
def _length(move: np.ndarray) -> float:
    """Return the length of a move on the sphere."""
    total = move[0] * move[0]
    for i in range(2, len(move)):
        total += move[i] * move[i]
    return math.sqrt(total)


@njit(nogil=True, **COMPILED)
def _corrected(
    p: SecularBody, m: np.ndarray, m0: float, s: float, guess: np.ndarray, close: float
) -> tuple[bool, np.ndarray]:
    """Correct a guess at fixed s; tell whether it converged to a root so close."""
    x, right, move = guess.copy(), np.empty_like(guess), np.empty_like(guess)
    for _ in range(_CORRECTIONS):
        _missed(p, m, m0, s, x, right)
        det = solve_linear(p, x, right, move)
        for i in range(len(x)):
            x[i] += move[i]
        if not (det > 0 and _length(x - guess) <= close):
            return False, x
        if _length(move) < _CONVERGED:
            return True, x
    return False, x


@njit(nogil=True, **COMPILED)
def principal(p: SecularBody, m: np.ndarray, m0: float, room: np.ndarray) -> tuple[int, float, float]:
    """Follow the root from momentum zero along s (m, m0), 0 <= s <= 1; return the outcome, nu and tau.

    Two numbers are quick to follow; where they fail, all unknowns are.
    """
    if not math.isfinite(level_of(p, m, m0)):
        return 5, np.nan, np.nan
    good, nu, tau = followed(p, m, m0, room)
    if good:
        return 0, nu, tau
    return on_the_sphere(p, m, m0, room)


@njit(nogil=True, **COMPILED)
def on_the_sphere(p: SecularBody, m: np.ndarray, m0: float, room: np.ndarray) -> tuple[int, float, float]:
    """Follow all unknowns along s (m, m0), also through angle pi; return the outcome, nu and tau."""
    x, rate = np.zeros(2 + len(p.b)), np.zeros(2 + len(p.b))
    x[0], x[1] = 1.0, p.mass * p.arm * p.arm
    rate[1] = p.arm * m0
    for i in range(len(p.b)):
        rate[2 + i] = m[i]
    infinite = p.slides and p.arm == 0 and m0 != 0  # the slide of a displacement at angle pi
    s, size, tangent = 0.0, 1.0, np.empty_like(x)
    for _ in range(PIECES):
        solve_linear(p, x, rate, tangent)
        speed = _length(tangent)
        size = min(size, 1.0 - s, _LONGEST / speed if speed > 0 else 1.0)
        if not size > 0:  # the squares overflow
            return 5, np.nan, np.nan
        ahead = 1.0 if size == 1.0 - s else s + size
        good, root = _corrected(p, m, m0, ahead, x + size * tangent, min(_CLOSE, _BENT * size * speed))
        if good and not (infinite and root[0] <= 0):
            s, x, size = ahead, root, 2 * size
            if s == 1.0:
                nu, tau = _in_cayley_coordinates(p, m, m0, x, room)
                return 0, nu, tau
        elif size > _SMALLEST * max(s, 1e-300):
            size /= 4
        else:
            return (1 if speed * s > _FAST else 2), np.nan, np.nan
    return 3, np.nan, np.nan


@njit(nogil=True, **COMPILED)
def _in_cayley_coordinates(
    p: SecularBody, m: np.ndarray, m0: float, x: np.ndarray, room: np.ndarray
) -> tuple[float, float]:
    """Return nu and tau of a root, to rounding."""
    z0, mu, square = math.copysign(max(abs(x[0]), _AT_PI), x[0]), x[1], 0.0
    for i in range(len(p.b)):
        mu += p.c[i] * x[2 + i]
        square += x[2 + i] ** 2
    nu, tau = mu / z0, square / (z0 * z0)
    if tau < 1:
        good, finer_nu, finer_tau, _ = newton(p, m, m0, 1.0, nu, tau, True, room)
        if good:
            return finer_nu, finer_tau
    return nu, tau
