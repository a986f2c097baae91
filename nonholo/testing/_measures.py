"""The comparison of two arrays and the measurement of a derivative."""

from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.base.checks import error, shown


def gap(found: Any, expected: Any) -> float:
    """Return the largest difference between arrays of one shape, relative to one plus the largest entry expected.

    Example:
        >>> gap([0.0, 3.5], [0.0, 3.0])
        0.125
    """
    return _difference(found, expected) / (1 + largest(expected))


def relative(found: Any, expected: Any) -> float:
    """Return the largest difference between arrays of one shape, relative to the largest entry expected.

    Example:
        >>> relative([0.0, 3.5], [0.0, 4.0])
        0.125
    """
    return _difference(found, expected) / max(largest(expected), np.finfo(np.float64).tiny)


def _difference(found: Any, expected: Any) -> float:
    found, expected = np.asarray(found), np.asarray(expected)
    if found.shape != expected.shape:
        raise ValueError(f"shape {found.shape} where {expected.shape} is expected")
    return largest(found - expected)


def largest(values: Any) -> float:
    """Return the largest absolute value, zero of none.

    Example:
        >>> largest([1.0, -2.0])
        2.0
    """
    return float(np.abs(values).max(initial=0.0))


def derivative(function: Callable[[float], Any], step: float = 1e-3) -> np.ndarray:
    """Return the derivative at zero by the central difference of order four.

    Example:
        >>> bool(abs(derivative(np.exp) - 1) < 1e-12)
        True
    """
    near = np.asarray(function(step)) - np.asarray(function(-step))
    far = np.asarray(function(2 * step)) - np.asarray(function(-2 * step))
    return (8 * near - far) / (12 * step)


def seeded(rng: Any) -> np.random.Generator:
    """Return a generator from a seed or a generator, and always the same one from None.

    Example:
        >>> float(seeded(None).normal()) == float(seeded(0).normal())
        True
    """
    try:
        return np.random.default_rng(0 if rng is None else rng)
    except (TypeError, ValueError):
        raise error("check_...(rng=...)", "be a seed or a generator", shown(rng), "Pass an integer >= 0.") from None
