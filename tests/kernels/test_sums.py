"""The compensated sums of the compiled loops."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from nonholo.kernels import _driver
from nonholo.kernels.secular import run as secular_run

Sum = Callable[[float, float, float, float], tuple[float, float]]


@pytest.mark.parametrize("add", [_driver.kahan_sum, secular_run._kahan_sum], ids=["two momenta", "many momenta"])
def test_rounding_does_not_gather(add: Sum) -> None:
    """After a hundred thousand terms a compensated sum is off by one rounding at most."""
    terms = np.random.default_rng(0).uniform(0.0, 0.1, 100_000).tolist()
    total, lost = 1.0, 0.0
    for term in terms:
        total, lost = add(total, lost, term, 0.0)
    exact = math.fsum([1.0, *terms])
    assert abs(total - exact) <= math.ulp(exact)
