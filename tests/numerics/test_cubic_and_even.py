"""Real roots of cubics and even functions against mpmath."""

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nonholo.numerics import half_cotangent, real_cubic_roots, sinc, versine

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
