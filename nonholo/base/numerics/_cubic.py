"""Real roots of a real cubic by square roots and Newton's method, which give the same bits everywhere; compiled."""

import math

from nonholo.base.compiled import njit


@njit(error_model="numpy")
def real_cubic_roots(a: float, b: float, c: float, d: float) -> tuple[int, float, float, float]:
    r"""Return the number of real roots of $a t^3 + b t^2 + c t + d$, $a \ne 0$, and three slots that hold them.

    Newton's method comes to one root from outside; the others are those of the quadratic that is left when it is
    divided out, from the end that does not cancel (Kahan, "To solve a real cubic equation", 1986). Each root then gets
    two Newton corrections on the polynomial itself. A double root counts twice. Quotients of coefficients may be as
    large as 1e100.

    Example:
        >>> count, *roots = real_cubic_roots(1.0, -6.0, 11.0, -6.0)
        >>> count, *sorted(round(root, 12) for root in roots)
        (3, 1.0, 2.0, 3.0)
    """
    root = _polish(a, b, c, d, _outer_root(a, b, c, d))
    linear = a * root + b
    constant = linear * root + c
    if abs(a * root * root * root) > abs(d):
        constant = -d / root
        linear = (constant - c) / root
    discriminant = linear * linear / 4 - a * constant
    if not discriminant >= 0:
        return 1, root, root, root
    far = -(linear / 2 + math.copysign(math.sqrt(discriminant), linear))
    near = constant / far if far != 0 else 0.0
    return 3, root, _polish(a, b, c, d, far / a), _polish(a, b, c, d, near)


@njit(error_model="numpy")
def _outer_root(a: float, b: float, c: float, d: float) -> float:
    """Return the root on that side of the inflection where there is one only, or where the outermost one is simple.

    From a start beyond it Newton's method comes down to it, until rounding takes it another way.
    """
    middle = -b / a / 3
    value, slope = _value_and_slope(a, b, c, d, middle)
    side = -math.copysign(1.0, value / a)
    reach = _above_cube_root(abs(value / a))
    if slope / a < 0:
        reach = 1.3247179572447461 * max(reach, math.sqrt(-slope / a))  # the root of u^3 = u + 1
    t = middle + side * reach
    for _ in range(100):
        value, slope = _value_and_slope(a, b, c, d, t)
        further = t - value / slope
        if not (side * middle <= side * further < side * t):
            break
        t = further
    return t


@njit(error_model="numpy")
def _value_and_slope(a: float, b: float, c: float, d: float, t: float) -> tuple[float, float]:
    return ((a * t + b) * t + c) * t + d, (3 * a * t + 2 * b) * t + c


@njit(error_model="numpy")
def _above_cube_root(x: float) -> float:
    """Return a bound of x^(1/3): Newton's method, here from x^(1/4 + 1/16), comes down to it from its first step on."""
    fourth = math.sqrt(math.sqrt(x))
    root = fourth * math.sqrt(math.sqrt(fourth))
    for _ in range(2):
        root = (2 * root + x / (root * root)) / 3
    return root if x > 0 else x


@njit(error_model="numpy")
def _polish(a: float, b: float, c: float, d: float, root: float) -> float:
    value, slope = _value_and_slope(a, b, c, d, root)
    for _ in range(2):
        better = root - value / slope
        after, steeper = _value_and_slope(a, b, c, d, better)
        if abs(after) < abs(value):  # not so at a multiple root, where the slope is rounding, nor for a quotient 0/0
            root, value, slope = better, after, steeper
    return root
