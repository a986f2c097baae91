r"""The step of the Chaplygin sleigh on SE(2) in Cayley coordinates (docs/theory/chaplygin-sleigh.md).

Canonical frame (b = 0), momenta in units of the displacement: $m = h\,(\pi, p_1)$ with $\pi = p_\theta + b\,p_1$. The
first Cayley coordinate $t = \tan(\Delta\theta/2)$ satisfies the half-angle cubic

$$ \hat p\,t^3 - \pi t^2 + (2J + \hat p)\,t - \pi = 0, \qquad \hat p = a\,p_1 + 2ma^2, $$

and the second is $y_2 = (p_1(1+t^2) + 2am\,t^2)/2m$, half the slide along the chord divided by $\cos(\Delta\theta/2)$.
"""

import math
from typing import Any, NamedTuple

from nonholo.base.compiled import njit
from nonholo.base.numerics import real_cubic_roots
from nonholo.kernels._scalar import COMPILED, scalar, sqrt


class SleighBody(NamedTuple):
    """Mass, moment of inertia about the center of mass, offset along the blade."""

    mass: float
    inertia: float
    a: float


@scalar
def inertia(p: SleighBody) -> tuple[float, float, float]:
    """Return the moment of inertia about the contact, zero, and the mass."""
    return p.inertia + p.mass * p.a * p.a, 0.0, p.mass


@scalar
def quadratic(p: SleighBody) -> tuple[float, float, float, float, float, float]:
    """Return twice the inertia along the constraint, c = (0, -2 m a) and 0: both equations of a displacement."""
    return 2 * (p.inertia + p.mass * p.a * p.a), 0.0, 2 * p.mass, 0.0, -2 * p.mass * p.a, 0.0


@scalar
def p_hat(p: SleighBody, m2: float) -> float:
    """Return the shifted momentum along the blade, the first coefficient of the cubic."""
    return p.a * (m2 + 2 * p.mass * p.a)


@scalar
def slide(p: SleighBody, m2: float, t: float) -> float:
    """Return the second Cayley coordinate."""
    return (m2 * (1 + t * t) + 2 * p.a * p.mass * t * t) / (2 * p.mass)


@scalar
def residual(p: SleighBody, m1: float, m2: float, y1: float, y2: float) -> tuple[float, float]:
    """Return the cubic at y1 and the defect of y2."""
    hat = p_hat(p, m2)
    return ((hat * y1 - m1) * y1 + 2 * p.inertia + hat) * y1 - m1, y2 - slide(p, m2, y1)


@scalar
def slope(p: SleighBody, m1: float, m2: float, t: float) -> float:
    """Return the derivative of the cubic."""
    hat = p_hat(p, m2)
    return (3 * hat * t - 2 * m1) * t + 2 * p.inertia + hat


@scalar
def correction(p: SleighBody, m1: float, m2: float, y1: float, y2: float) -> tuple[float, float]:
    """Return the Newton correction of y1, and of y2 to what belongs to the corrected y1."""
    dt = -residual(p, m1, m2, y1, y2)[0] / slope(p, m1, m2, y1)
    return dt, slide(p, m2, y1 + dt) - y2


@scalar
def corrections(p: SleighBody, m1: float, m2: float, y1: float, y2: float) -> tuple[float, float, float, float]:
    """Return the Newton correction of y, and the one after it with the same slope, for what the first one leaves."""
    dt, d2 = correction(p, m1, m2, y1, y2)
    hat = p_hat(p, m2)
    et = ((m1 - 3 * hat * y1) - hat * dt) * dt * dt / slope(p, m1, m2, y1)
    return dt, d2, et, slide(p, m2, y1 + dt + et) - (y2 + d2)


def slopes(p: SleighBody, m1: Any, m2: Any, y1: Any, y2: Any) -> tuple[Any, Any, Any, Any]:
    """Return the derivative of m by y at a root, times 1 + t^2."""
    weight, pull = 1 + y1 * y1, -2 * y1 * (2 * p.mass * p.a + m2)
    first = p_hat(p, m2) * weight + p.a * y1 * pull + 2 * p.inertia * (1 - y1 * y1) / weight
    return first, 2 * p.a * p.mass * y1, pull, 2 * p.mass


@scalar
def is_certain(p: SleighBody, m1: float, m2: float, y1: float, y2: float) -> bool:
    """Return whether a root is certainly the principal one: on the middle sheet, turning by at most 120 degrees."""
    return (slope(p, m1, m2, y1) >= 0) & (y1 * y1 <= 3) & (y1 * m1 >= 0)


@scalar
def increment(p: SleighBody, m1: float, m2: float, y1: float, y2: float) -> tuple[float, float]:
    """Return m' - m."""
    weight = 4 * p.a * p.mass * y1 / (1 + y1 * y1)
    return -weight * y2, weight * y1


@scalar
def move(
    p: SleighBody, y1: float, y2: float, q0: float, q1: float, q2: float, q3: float
) -> tuple[float, float, float, float]:
    """Return the pose (cos, sin, x, y) of g W, its heading renormalized."""
    scale = 1 / (1 + y1 * y1)
    cos, sin = (1 - y1 * y1) * scale, 2 * y1 * scale
    along = 2 * y2 * scale
    across = y1 * along
    x, y = q2 + q0 * along - q1 * across, q3 + q1 * along + q0 * across
    r0, r1 = q0 * cos - q1 * sin, q1 * cos + q0 * sin
    unit = (3 - (r0 * r0 + r1 * r1)) / 2
    return r0 * unit, r1 * unit, x, y


@njit(**COMPILED)
def principal(p: SleighBody, m1: float, m2: float) -> tuple[int, float, float]:
    """Return the outcome and the root that momentum zero reaches along s m, 0 <= s <= 1.

    Decided exactly from the deltoid on which real roots merge: see the certificate in docs/theory/chaplygin-sleigh.md.
    """
    if not (math.isfinite(m1) and math.isfinite(m2)):
        return 5, math.nan, math.nan
    hat = p_hat(p, m2)
    count, t1, t2, t3 = _half_angle_roots(p, m1, hat)
    for t in (t1, t2, t3):
        if is_certain(p, m1, m2, t, 0.0):
            return 0, t, slide(p, m2, t)
    if count == 1 and p.a != 0 and _passes_the_cusp(p, abs(m1), hat):
        return 0, t1, slide(p, m2, t1) if t1 * t1 < 3 else _far_slide(p, m1, t1)
    return (2 if m1 == 0 else 1), math.nan, math.nan


@njit(**COMPILED)
def _half_angle_roots(p: SleighBody, m1: float, hat: float) -> tuple[int, float, float, float]:
    """Return the finite real roots of the half-angle cubic, solving for 1/t where that has the larger leading term."""
    middle = 2 * p.inertia + hat
    if hat == 0 and abs(m1) <= p.inertia:
        root = m1 / (p.inertia + math.sqrt(p.inertia * p.inertia - m1 * m1))
        return 1, root, root, root
    if abs(hat) >= abs(m1):
        return real_cubic_roots(hat, -m1, middle, -m1)
    count, s1, s2, s3 = real_cubic_roots(-m1, middle, -m1, hat)
    return count, 1 / _nonzero(s1), 1 / _nonzero(s2), 1 / _nonzero(s3)


@scalar
def _nonzero(s: float) -> float:
    return s if s != 0 else 1e-75


@scalar
def _far_slide(p: SleighBody, m1: float, t: float) -> float:
    """Return the second Cayley coordinate of a root of the cubic, without p_1 + 2am, which cancels at angle pi."""
    return ((m1 * (1 / t + t) - 2 * p.inertia) / p.a - 2 * p.a * p.mass) / (2 * p.mass)


@scalar
def _passes_the_cusp(p: SleighBody, m1: float, hat: float) -> bool:
    """Return whether the segment from (0, 2 m a^2) to (m1, hat), m1 >= 0, passes outside the upper right cusp."""
    start = 2 * p.mass * p.a * p.a
    return 3 * sqrt(3.0) * (hat - start) - (1 - 4 * start / p.inertia) * m1 > 0
