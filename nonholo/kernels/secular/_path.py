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

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import COMPILED, PIECES
from nonholo.kernels.secular._box import holds, write_box
from nonholo.kernels.secular._linear import solve_linear, total_factor
from nonholo.kernels.secular._root import followed, level_of
from nonholo.kernels.secular._step import SecularBody, newton

_MOST, _FEWER = 4.0, 0.1  # times the last step along the path
_SAFE = 0.9  # of the step that is expected to be certain
_SMALLEST = 1e-9  # step along the path, relative to s, below which the branch is given up
_FAST = 20.0  # speed, relative to the average one, of a path that is about to end in a fold
_CORRECTIONS = 8
_CONVERGED = 1e-12  # correction on the sphere, after which the next one is below rounding
_AT_PI = 1e-75  # stands for z0 = 0, which y cannot be divided by


@njit(nogil=True, **COMPILED)
def _missed(p: SecularBody, m: np.ndarray, m0: float, s: float, x: np.ndarray, right: np.ndarray) -> None:
    """Write by how much the equations are missed."""
    z0, w, square, mu = x[0], x[1], 0.0, total_factor(p, x)
    for i in range(len(p.b)):
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
def _corrected(p: SecularBody, m: np.ndarray, m0: float, s: float, guess: np.ndarray) -> tuple[bool, np.ndarray]:
    """Correct a guess at fixed s; tell whether it converged."""
    x, right, move = guess.copy(), np.empty_like(guess), np.empty_like(guess)
    for _ in range(_CORRECTIONS):
        _missed(p, m, m0, s, x, right)
        det = solve_linear(p, x, right, move)
        for i in range(len(x)):
            x[i] += move[i]
        if not (det > 0 and _length(move) < 1):
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
    s, size, tangent, box = 0.0, 1.0, np.empty_like(x), np.empty(len(x) + 1)
    for _ in range(PIECES):
        solve_linear(p, x, rate, tangent)
        speed = _length(tangent)
        size = min(size, 1.0 - s, 1 / speed if speed > 0 else 1.0)
        if not size > 0:  # the squares overflow
            return 5, np.nan, np.nan
        ahead = 1.0 if size == 1.0 - s else s + size
        doubt, good, root = write_box(p, x, size * tangent, box), False, x
        if doubt < 1:
            good, root = _corrected(p, m, m0, ahead, x + size * tangent)
        if good and holds(p, x, box, root) and not (infinite and root[0] <= 0):
            s, x, size = ahead, root, size * min(_MOST, _SAFE / max(doubt, 1e-3))
            if s == 1.0:
                nu, tau = _in_cayley_coordinates(p, m, m0, x, room)
                return 0, nu, tau
        elif size > _SMALLEST * max(s, 1e-300):
            size *= max(_FEWER, min(0.5, _SAFE / doubt))
        else:
            return (1 if speed * s > _FAST * _turn(x) else 2), np.nan, np.nan
    return 3, np.nan, np.nan


@njit(nogil=True, **COMPILED)
def _turn(x: np.ndarray) -> float:
    """Return the distance on the sphere from the identity."""
    total = (x[0] - 1) ** 2
    for i in range(2, len(x)):
        total += x[i] * x[i]
    return math.sqrt(total)


@njit(nogil=True, **COMPILED)
def _in_cayley_coordinates(
    p: SecularBody, m: np.ndarray, m0: float, x: np.ndarray, room: np.ndarray
) -> tuple[float, float]:
    """Return nu and tau of a root, to rounding."""
    z0, mu, square = math.copysign(max(abs(x[0]), _AT_PI), x[0]), total_factor(p, x), 0.0
    for i in range(len(p.b)):
        square += x[2 + i] ** 2
    nu, tau = mu / z0, square / (z0 * z0)
    if tau < 1:
        good, finer_nu, finer_tau, _ = newton(p, m, m0, 1.0, nu, tau, True, room)
        if good:
            return finer_nu, finer_tau
    return nu, tau
