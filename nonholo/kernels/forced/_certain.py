r"""When the root of the cubic of a step is certainly the principal one (docs/theory/forces.md, Proposition 18.3).

It is the only one in a region that no part of the step leads out of. Tops: the disc |y|_B <= R with

$$ 1 - \frac{|c|R}{b^{3/2}} - \frac{2R}{b}\Bigl((1 + \tfrac{|K|}b)R + \frac{|c|R^2}{b^{3/2}}\Bigr)
   - \Bigl(1 + \frac{R^2}b\Bigr)\frac\nu b > 0, \qquad
   |m|,\ |m + a| < \frac R{1 + R^2/b} - \frac{\nu R}b, $$

b the least eigenvalue of B, |N| <= nu, half impulses a + N y, momenta in the dual norm. Sleighs: the strip |y_1| <= T,
in which the second equation gives y_2 and the first one grows with y_1.
"""

from typing import Any

from nonholo.kernels._scalar import scalar, sqrt

_HALVINGS = 24
STRIP = 0.5
"""T: 53 degrees to either side."""


@scalar
def is_alone(b: float, c: float, K: float, nu: float, R: float) -> bool:
    """Tell whether there is at most one root of a top within a radius."""
    pull = c * R / (b * sqrt(b))
    return 1 - pull - 2 * R / b * ((1 + K / b) * R + pull * R) - (1 + R * R / b) * nu / b > 0


@scalar
def certain_disc(B: Any, c: float, K: float, nu: float) -> tuple[float, float]:
    """Return R^2, and the square of the dual norm of momenta up to which a root in it is certain, -1 if there is none.

    B is given by its three numbers, c and K by their sizes.
    """
    half = (B[0] - B[2]) / 2
    least = (B[0] + B[2]) / 2 - sqrt(half * half + B[1] * B[1])
    low, high = 0.0, sqrt(least)
    for _ in range(_HALVINGS):
        R = (low + high) / 2
        if is_alone(least, c, K, nu, R):
            low = R
        else:
            high = R
    level = low / (1 + low * low / least) - nu * low / least
    return low * low, (level * level if level > 0 else -1.0)


@scalar
def is_in_strip(B: Any, c: float, K: Any, m: Any, r: Any, N: Any) -> bool:
    """Tell whether all parts of the step of a sleigh have one root each in the strip: of momenta m and r + N y_1.

    What the second equation gives to y_2 is put into the first one, whose least slope in the strip is bounded; a slide
    that adds to it does no harm.
    """
    T, W = STRIP, 1 + STRIP * STRIP
    a1, a2, n1, n2, size = abs(m[0]) + abs(r[0]), abs(m[1]) + abs(r[1]), abs(N[0]), abs(N[2]), abs(c)
    rate = (2 * T * (a2 + n2 * T) + W * n2 + abs(K[2]) + 2 * size * T) / B[2]
    against = m[1] if c > 0 else -m[1]
    slide = ((against if against > 0 else 0.0) + abs(r[1])) * (1 + 3 * T * T)
    bent = size * (slide + 2 * T * (W + T * T) * n2 + 2 * T * abs(K[2])) / B[2]
    growth = B[0] - abs(K[1]) * rate - bent - 2 * T * (a1 + n1 * T) - W * n1
    return growth > 0 and T * growth > a1 + abs(K[1]) * a2 / B[2]
