"""One question in several units of mass, length and time: what its answers must agree in."""

from collections.abc import Callable
from typing import Any

import numpy as np

UNITS = ("mass", "length", "time")
J = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
WIDE = np.cov(np.random.default_rng(0).normal(size=(4, 9)))
_MIXED = np.random.default_rng(5).normal(size=(3, 6))
Answer = dict[str, Any]


def in_space(mass: float, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the mass tensor of a body in space, in homogeneous coordinates, and rows that mix turns and slides."""
    lengths = np.append(np.full(3, length), 1.0)
    return WIDE * np.outer(lengths, lengths) * mass, _MIXED * np.repeat([1.0, length], 3)


def is_refused(call: Callable[[], object]) -> bool:
    """Tell whether a call ends in a ValueError."""
    try:
        call()
    except ValueError:
        return True
    return False


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
