"""Real roots of cubics and even functions against mpmath."""

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nonholo.base.numerics import half_cotangent, real_cubic_roots, sinc, versine

coefficient = st.floats(-5, 5)


@given(st.floats(0.1, 5), coefficient, coefficient, coefficient)
def test_roots_annihilate_the_cubic(a: float, b: float, c: float, d: float) -> None:
    """Each root has a normwise backward error of rounding, and the number of real ones is that of the discriminant."""
    count, *roots = real_cubic_roots(a, b, c, d)
    for root in roots:
        size = (abs(a) + abs(b) + abs(c) + abs(d)) * max(1.0, abs(root)) ** 3
        assert abs(((a * root + b) * root + c) * root + d) <= 1e-14 * size
    with mpmath.workdps(50):
        exact = mpmath.mpf
        disc = exact(b) ** 2 * exact(c) ** 2 - 4 * exact(a) * exact(c) ** 3 - 4 * exact(b) ** 3 * exact(d)
        disc += 18 * exact(a) * exact(b) * exact(c) * exact(d) - 27 * exact(a) ** 2 * exact(d) ** 2
    if abs(disc) > 1e-9:
        assert count == (3 if disc > 0 else 1)


def _drawn(kind: str, rng: np.random.Generator) -> tuple[float, ...]:
    """Draw coefficients of a cubic that is hard in some way."""
    sign, small = rng.choice([-1.0, 1.0]), 10.0 ** rng.uniform(-30, -5)
    s, t = rng.choice(np.arange(-50.0, 50.0), 2, replace=False)
    roots = {
        "double root": (s, s, t),
        "triple root": (s, s, s),
        "nearly double root": (s, s * (1 + 10.0 ** rng.uniform(-12, -4)), t),
        "roots of different size": rng.normal(size=3) * 10.0 ** rng.uniform(-12, 12, 3),
        "simple integers": rng.choice(np.arange(-50.0, 50.0), 3, replace=False),
    }
    if kind in roots:
        x, y, z = roots[kind]
        return 1.0, -(x + y + z), x * y + y * z + z * x, -x * y * z
    return {
        "tiny leading coefficient": (sign * small, *rng.normal(size=3)),
        "coefficients of different size": tuple(rng.normal(size=4) * 10.0 ** rng.uniform(-8, 8, 4)),
        "a root at zero": (*rng.normal(size=3), 0.0),
        "sleigh of little push": (small, -s * small, 2.0, -s * small),
    }[kind]


KINDS = ["double root", "triple root", "nearly double root", "roots of different size", "simple integers"]
KINDS += ["tiny leading coefficient", "coefficients of different size", "a root at zero", "sleigh of little push"]


@pytest.mark.parametrize("kind", KINDS)
def test_hard_cubics(kind: str) -> None:
    """All real roots; each has a backward error of rounding, and a simple one lies as near to a true one as that lets.

    Horner's rule rounds each of the four terms three times at most, and Newton's method ends where that hides the rest.
    """
    rng, eps = np.random.default_rng(1), 2.0**-52
    for _ in range(200):
        coefficients = tuple(map(float, _drawn(kind, rng)))
        count, *found = real_cubic_roots(*coefficients)
        with mpmath.workdps(60):
            a, b, c, d = map(mpmath.mpf, coefficients)
            roots = list(map(mpmath.mpf, found))
            sizes = [mpmath.fsum(map(abs, (a * t**3, b * t**2, c * t, d))) for t in roots]

            def value(t: mpmath.mpf) -> mpmath.mpf:
                return ((a * t + b) * t + c) * t + d  # noqa: B023

            assert all(abs(value(t)) <= 2 * eps * size for t, size in zip(roots, sizes, strict=True)), coefficients
            terms = b**2 * c**2, -4 * a * c**3, -4 * b**3 * d, 18 * a * b * c * d, -27 * a**2 * d**2
            discriminant = mpmath.fsum(terms)
            if abs(discriminant) <= 100 * eps * mpmath.fsum(map(abs, terms)):
                continue  # roots that rounding of the coefficients makes double or complex
            assert count == len(set(found)) == (3 if discriminant > 0 else 1), coefficients
            for t, size in zip(roots, sizes, strict=True):
                bound = 4 * eps * size / abs(3 * a * t**2 + 2 * b * t + c)
                assert mpmath.sign(value(t - bound)) * mpmath.sign(value(t + bound)) <= 0, coefficients


@pytest.mark.parametrize("squared", [0.0, 1e-300, 1e-12, 9.9e-4, 1.01e-3, 1.0, 9.8, np.pi**2])
def test_even_functions_to_rounding(squared: float) -> None:
    """sinc, versine and half cotangent are accurate on both sides of their switch to series."""
    with mpmath.workdps(40):
        t = mpmath.sqrt(mpmath.mpf(squared))
        exact = (
            (1, mpmath.mpf(1) / 2, 1)
            if t == 0
            else (mpmath.sin(t) / t, 2 * (mpmath.sin(t / 2) / t) ** 2, t / 2 * mpmath.cot(t / 2))
        )
    for function, value in zip((sinc, versine, half_cotangent), exact, strict=True):
        assert abs(float(function(np.float64(squared))) - float(value)) < 4e-16
