r"""Which root of the secular step is principal: a ball in which it is certain, and paths to it outside that ball.

A path is followed in two numbers as long as that is quick, then on the sphere of half-angle coordinates. With
$z_0 = \cos\frac\theta2$, $z = z_0y$ and $\mu = z_0\nu = c\cdot z + w$ the equations for the momenta $s\,m$ are there

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
from nonholo.kernels.secular._sphere import holds, solve_linear, total_factor, write_box
from nonholo.kernels.secular._step import SecularBody, newton

_SINES = 200  # trial angles of the ball
_MARGIN = 1 - 1e-9
_FIRST = 0.125  # first step along the path, of 1
_JUMP = 0.02  # a corrector that moves further, relative to the scale of an unknown, has left the branch
_FIRST_JUMP = 0.25  # the same for the first step, from the identity
_SHORTEST = 1e-9  # step along the path, relative to s, below which it is given up


@njit(nogil=True, **COMPILED)
def level_of(p: SecularBody, m: np.ndarray, m0: float) -> float:
    """Return the energy in the units of the kernel, which every step keeps."""
    lever, total = p.mass * p.arm * p.arm, m0 * m0 / p.mass
    for i in range(len(p.b)):
        total += m[i] * m[i] / (p.b[i] + lever)
    return total


@njit(nogil=True, **COMPILED)
def certain_radius(p: SecularBody, level: float) -> float:
    r"""Return the squared radius of the ball in which a root of that energy is certainly principal, or zero.

    With $\\kappa = \\sin\\theta\\,u$ the equations are a contraction in the metric of the energy where their part that
    is not linear has the Lipschitz constant L < 1; the ball must reach as far as the momentum of that energy.
    """
    lever, pull = p.mass * p.arm * p.arm, math.sqrt(np.sum(p.c * p.c))
    least, push = p.least + lever, 2 * abs(p.arm) * math.sqrt(p.mass * level)
    best = 0.0
    for i in range(1, _SINES):
        sine = i / _SINES
        cosine = math.sqrt(1 - sine * sine)
        half = sine / (1 + cosine)
        bend = (1 + half * half) / cosine
        slope = lever * (bend - 1) + push * bend / 2 + pull * math.sqrt(sine * sine / (cosine * cosine) + half * half)
        room = (1 - slope / least) * math.sqrt(least) * sine
        if room > 0 and 4 * level <= _MARGIN * room * room:
            best = least * sine * sine
    return best


@njit(nogil=True, **COMPILED)
def follow(p: SecularBody, m: np.ndarray, m0: float, room: np.ndarray) -> tuple[bool, float, float]:
    """Follow nu and tau from momentum zero along s (m, m0), 0 <= s <= 1, as far as y is finite and nu > -min b."""
    lever = p.mass * p.arm * p.arm
    s, nu, tau, before, nu_before, tau_before = 0.0, lever, 0.0, 0.0, lever, 0.0
    size = _FIRST
    for _ in range(PIECES):
        size = min(size, 1.0 - s)
        ahead = 1.0 if size == 1.0 - s else s + size
        nu_guess, tau_guess = nu, tau
        if s > 0:
            nu_guess += (nu - nu_before) * (ahead - s) / (s - before)
            tau_guess = max(0.0, tau + (tau - tau_before) * ((ahead / s) ** 2 - 1) / (1 - (before / s) ** 2))
        good, nu_found, tau_found, _ = newton(p, m, m0, ahead, nu_guess, tau_guess, False, room)
        jump = _JUMP if s > 0 else _FIRST_JUMP
        is_near = abs(math.sqrt(abs(tau_found)) - math.sqrt(tau_guess)) <= jump * (1 + tau_guess)
        good = good and is_near and abs(nu_found - nu_guess) <= jump * (p.least + nu)
        if good:
            before, nu_before, tau_before = s, nu, tau
            s, nu, tau, size = ahead, nu_found, tau_found, 2 * size
            if s == 1.0:
                return True, nu, tau
        elif size > _SHORTEST * max(s, 1e-300):
            size /= 4
        else:
            break
    return False, nu, tau


_MOST, _FEWER = 4.0, 0.1  # times the last step along the path
_SAFE = 0.9  # of the step that is expected to be certain
_SMALLEST = 1e-9  # step along the path, relative to s, below which the branch is given up
_FAST = 20.0  # speed, relative to the average one, of a path that is about to end in a fold
_CORRECTIONS = 8
_CONVERGED = 1e-12  # correction on the sphere, after which the next one is below rounding
_AT_PI = 1e-75  # stands for z0 = 0, which y cannot be divided by


@njit(nogil=True, **COMPILED)
def _write_gap(p: SecularBody, m: np.ndarray, m0: float, s: float, x: np.ndarray, right: np.ndarray) -> None:
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
def _correct(p: SecularBody, m: np.ndarray, m0: float, s: float, guess: np.ndarray) -> tuple[bool, np.ndarray]:
    """Correct a guess at fixed s; return whether it converged."""
    x, right, move = guess.copy(), np.empty_like(guess), np.empty_like(guess)
    for _ in range(_CORRECTIONS):
        _write_gap(p, m, m0, s, x, right)
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
    good, nu, tau = follow(p, m, m0, room)
    if good:
        return 0, nu, tau
    return on_the_sphere(p, m, m0, room)


@njit(nogil=True, **COMPILED)
def _begin(p: SecularBody, m: np.ndarray, m0: float, x: np.ndarray, rate: np.ndarray) -> None:
    """Write the unknowns at momentum zero, and the rates of the right-hand sides."""
    x[0], x[1] = 1.0, p.mass * p.arm * p.arm
    rate[1] = p.arm * m0
    for i in range(len(p.b)):
        rate[2 + i] = m[i]


@njit(nogil=True, **COMPILED)
def _piece(
    p: SecularBody, m: np.ndarray, m0: float, ahead: float, x: np.ndarray, way: np.ndarray, box: np.ndarray
) -> tuple[float, bool, np.ndarray]:
    """Return the doubt of a predicted move, whether it leads to the root of the path ahead, and that root."""
    doubt, good, root = write_box(p, x, way, box), False, x
    if doubt < 1:
        good, root = _correct(p, m, m0, ahead, x + way)
    infinite = p.slides and p.arm == 0 and m0 != 0  # the slide of a displacement at angle pi
    return doubt, good and holds(p, x, box, root) and not (infinite and root[0] <= 0), root


@njit(nogil=True, **COMPILED)
def on_the_sphere(p: SecularBody, m: np.ndarray, m0: float, room: np.ndarray) -> tuple[int, float, float]:
    """Follow all unknowns along s (m, m0), also through angle pi; return the outcome, nu and tau."""
    x, rate = np.zeros(2 + len(p.b)), np.zeros(2 + len(p.b))
    _begin(p, m, m0, x, rate)
    s, size, tangent, box = 0.0, 1.0, np.empty_like(x), np.empty(len(x) + 1)
    for _ in range(PIECES):
        solve_linear(p, x, rate, tangent)
        speed = _length(tangent)
        size = min(size, 1.0 - s, 1 / speed if speed > 0 else 1.0)
        if not size > 0:  # the squares overflow
            return 5, np.nan, np.nan
        ahead = 1.0 if size == 1.0 - s else s + size
        doubt, good, root = _piece(p, m, m0, ahead, x, size * tangent, box)
        if good:
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
