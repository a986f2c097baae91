"""Real roots of a real cubic in closed form, polished by Newton's method; compiled, allocation-free."""

import math

import numba


@numba.njit(cache=True)
def real_cubic_roots(a: float, b: float, c: float, d: float) -> tuple[int, float, float, float]:
    r"""Return the number of real roots of $a t^3 + b t^2 + c t + d$, $a \ne 0$, and three slots that hold them.

    Trigonometric form for three real roots, Cardano's with the sign that avoids cancellation for one; each root then
    gets two Newton corrections on the polynomial itself. A double root counts twice.

    Example:
        >>> count, *roots = real_cubic_roots(1.0, -6.0, 11.0, -6.0)
        >>> count, *sorted(round(root, 12) for root in roots)
        (3, 1.0, 2.0, 3.0)
    """
    shift = b / (3 * a)
    p = (3 * a * c - b * b) / (9 * a * a)
    q = (2 * b * b * b - 9 * a * b * c + 27 * a * a * d) / (54 * a * a * a)
    discriminant = q * q + p * p * p
    if discriminant > 0:
        big = -math.copysign((abs(q) + math.sqrt(discriminant)) ** (1 / 3), q)
        root = _polish(a, b, c, d, big - p / big - shift)
        return 1, root, root, root
    radius = math.sqrt(max(-p, 0.0))
    cube = radius * radius * radius
    if cube == 0:  # a triple root, or closer to one than numbers can tell
        return 3, -shift, -shift, -shift
    angle = math.acos(max(-1.0, min(1.0, -q / cube))) / 3
    first = 2 * radius * math.cos(angle) - shift
    second = 2 * radius * math.cos(angle + 2 * math.pi / 3) - shift
    third = 2 * radius * math.cos(angle - 2 * math.pi / 3) - shift
    return 3, _polish(a, b, c, d, first), _polish(a, b, c, d, second), _polish(a, b, c, d, third)


@numba.njit(cache=True, error_model="numpy")
def _polish(a: float, b: float, c: float, d: float, root: float) -> float:
    value = ((a * root + b) * root + c) * root + d
    for _ in range(2):
        better = root - value / ((3 * a * root + 2 * b) * root + c)
        after = ((a * better + b) * better + c) * better + d
        if abs(after) < abs(value):  # not so at a multiple root, where the slope is rounding, nor for a quotient 0/0
            root, value = better, after
    return root
