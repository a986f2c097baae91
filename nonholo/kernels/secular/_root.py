"""Which root of the secular step is principal: a ball in which it is certain, and a quick path outside it.

Reference: docs/theory/secular-step.md.
"""

import math

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import COMPILED, PIECES
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
def followed(p: SecularBody, m: np.ndarray, m0: float, room: np.ndarray) -> tuple[bool, float, float]:
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
        turned = abs(math.sqrt(abs(tau_found)) - math.sqrt(tau_guess)) <= jump * (1 + tau_guess)
        good = good and turned and abs(nu_found - nu_guess) <= jump * (p.least + nu)
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
