"""One question in several units of mass, length and time: what its answers must agree in."""

from collections.abc import Callable
from typing import Any

import numpy as np

UNITS = ("mass", "length", "time")
Answer = dict[str, Any]


def same_answers(function: Callable[..., Answer], arguments: tuple[Any, ...], error: float, unit: str) -> None:
    """Check that words, counts and outcomes are the same in other units, and numbers up to rounding errors."""
    is_changed = np.array([unit == name for name in UNITS])
    expected = function(*arguments, 1.0, 1.0, 1.0)
    for exponent in (-40, -18, 18, 40):  # even: units of velocities are roots of masses
        scaled = function(*arguments, *np.where(is_changed, 2.0**exponent, 1.0).tolist())
        for name, wanted in expected.items():
            if isinstance(wanted, np.ndarray):
                np.testing.assert_allclose(scaled[name], wanted, rtol=0, atol=error, err_msg=f"{name}, 2**{exponent}")
            else:
                assert scaled[name] == wanted, (name, exponent)
