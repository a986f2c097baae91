"""Section 8: all complex images of a momentum of the top (n = 3, B diagonal) and of the sleigh (b = 0), and how many.

Momenta of the top are halved, r = z0 B z + |z|^2 c - (c, z) z; its displacement has the Cayley coordinates y = z / z0.
"""

import math

from nonholo_paper._twin import Matrix, Number, ctx

Two = tuple[Number, Number]


def secular(s: Number, r: Two, b: Two, c: Two) -> tuple[Number, Number, Two]:
    """Return numerator and denominator of |y|^2, and y times the denominator, for s = (c, y)."""
    over = s * (b[0] - s) * (b[1] - s) - c[0] * r[0] * (b[1] - s) - c[1] * r[1] * (b[0] - s)
    under = c[0] * (r[0] - c[0]) * (b[1] - s) + c[1] * (r[1] - c[1]) * (b[0] - s)
    parts = [(r[i] * under + (r[i] - c[i]) * over) / (b[i] - s) for i in range(2)]
    return over, under, (parts[0], parts[1])


def top_roots(r: Two, b: Two, c: Two) -> list[Number]:
    """Return the four values of (c, y), from the polynomial of degree four that says |y|^2 = |y|^2."""
    with ctx.workdps(ctx.dps + 20):  # finding the coefficients from five values loses a few digits
        places = [ctx.mpf(i) for i in range(5)]
        values = []
        for s in places:
            over, under, parts = secular(s, r, b, c)
            values.append(parts[0] ** 2 + parts[1] ** 2 - over * under)
        powers = ctx.matrix([[s**k for k in range(5)] for s in places])
        return ctx.polyroots(list(ctx.lu_solve(powers, ctx.matrix(values))), maxsteps=100, extraprec=100, asc=True)


def top_image(s: Number, r: Two, b: Two, c: Two) -> tuple[Two, Two]:
    """Return y and the next momentum."""
    over, under, parts = secular(s, r, b, c)
    y, tau = [part / under for part in parts], over / under
    after = [(b[i] * y[i] - tau * c[i] + s * y[i]) / (1 + tau) for i in range(2)]
    return (y[0], y[1]), (after[0], after[1])


def sleigh_roots(p: Two, body: tuple[Number, Number, Number]) -> list[Number]:
    """Return the three values of t, the tangent of half the step angle; a body is (m, J, a)."""
    m, J, a = body
    reach = a * p[1] + 2 * m * a**2
    return ctx.polyroots([-p[0], 2 * J + reach, -p[0], reach], maxsteps=100, extraprec=100, asc=True)


def sleigh_image(t: Number, p: Two, body: tuple[Number, Number, Number]) -> tuple[Matrix, Two]:
    """Return the displacement and the next momenta (p_theta, p_1)."""
    m, _, a = body
    sine, versine = 2 * t / (1 + t**2), 2 * t**2 / (1 + t**2)
    V_1 = p[1] / m + a * versine
    W = ctx.matrix([[1 - versine, -sine, V_1], [sine, 1 - versine, t * V_1], [0, 0, 1]])
    return W, (p[0] - 2 * a * m * t * V_1, p[1] + 2 * a * m * versine)


def printed_image_count(branches: int, steps: int) -> int:
    """Return the number of images if the branches commute, as translations of a torus do."""
    return math.comb(steps + branches - 1, branches - 1)
