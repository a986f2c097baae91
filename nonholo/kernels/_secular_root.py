"""The ball in which a root of the secular step is certainly the principal one.

Reference: docs/theory/secular-step.md.
"""

import math

import numba
import numpy as np

from nonholo.kernels._scalar import COMPILED
from nonholo.kernels._secular import SecularBody

_SINES = 200  # trial angles of the ball
_MARGIN = 1 - 1e-9


@numba.njit(cache=True, nogil=True, **COMPILED)
def level_of(p: SecularBody, m: np.ndarray, m0: float) -> float:
    """Return the energy in the units of the kernel, which every step keeps."""
    lever, total = p.mass * p.arm * p.arm, m0 * m0 / p.mass
    for i in range(len(p.b)):
        total += m[i] * m[i] / (p.b[i] + lever)
    return total


@numba.njit(cache=True, nogil=True, **COMPILED)
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
