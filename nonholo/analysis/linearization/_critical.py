"""`critical_values`: where along a parameter a steady motion begins or ceases to be unstable."""

import itertools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy.optimize import bisect, brentq

from nonholo.analysis.linearization._linearize import Linearization
from nonholo.base.checks import array, count, error, instance, shown
from nonholo.base.types import Float, Inexact

_NEUTRAL = 1e-7  # relative to the largest eigenvalue: what neither grows nor decays, up to rounding


def critical_values(
    linearization: Callable[[float], Linearization], interval: Sequence[float], *, samples: int = 65
) -> Float[np.ndarray, "M"]:
    r"""Return the values of a parameter at which eigenvalues begin or cease to grow.

    Eigenvalues of `linearize` that grow are counted at equally spaced values. Between two neighbors with other numbers
    of them the real part that changes its sign, of maps $\log|\mu|$, is followed to its zero by Brent's method; where
    eigenvalues meet on the imaginary axis, and stay there, the place is found by bisection. Two changes between two
    neighboring values are not seen: take more samples.

    Args:
        linearization: Maps a value to what `nonholo.linearize` returns there, with as many states everywhere.
        interval: The least and the largest value.
        samples: How many values are looked at first.

    Raises:
        ValueError: A function that returns something else, an interval that does not rise, no samples.

    Example:
        A heavy top stands upright above the spin $2\sqrt{Amgl}/C$, here with A = 1.2, C = 1:

        >>> weight = nh.Gravity(force=[0.0, 0.0, -9.81], point=[0.0, 0.0, 0.3])
        >>> top = nh.Forced(nh.RigidBody(np.diag([0.5, 0.5, 0.7])), weight)
        >>> of = lambda spin: nh.linearize(top, body_velocity=(0.0, 0.0, spin))
        >>> found = nh.critical_values(of, (1.0, 6.0), samples=5)
        >>> bool(np.allclose(found, 2 * np.sqrt(1.2 * 9.81 * 0.3), rtol=1e-9))
        True
    """
    where, remedy = "critical_values(interval=...)", "Pass the least and the largest value."
    low, high = array(where, interval, (2,), remedy)
    if not low < high:
        raise error(where, "rise", shown(interval), remedy)
    places = np.linspace(low, high, 1 + count("critical_values(samples=...)", samples, "Pass a positive number."))
    rows = [_rates(linearization, value) for value in places]
    least = _NEUTRAL * max(np.abs(row).max(initial=0.0) for row in rows)
    changes = [
        i for i, (row, other) in enumerate(itertools.pairwise(rows)) if _growing(row, least) != _growing(other, least)
    ]
    return np.array([_changed(linearization, least, places[i : i + 2], rows[i : i + 2]) for i in changes])


def _rates(linearization: Callable[[float], Linearization], value: float) -> Inexact[np.ndarray, "d"]:
    """Return the eigenvalues at a value, of maps their logarithms."""
    found: Any = linearization(float(value))
    remedy = "Return nh.linearize(...) of the value."
    instance("critical_values(linearization=...)", found, Linearization, "return a Linearization", remedy)
    values = found.eigenvalues.astype(complex)
    return values if found.time_step is None else np.log(values) / found.time_step


def _growing(rates: np.ndarray, least: float) -> int:
    return int((np.real(rates) > least).sum())


def _changed(linearization: Any, least: float, ends: np.ndarray, rows: list[np.ndarray]) -> float:
    """Return where between two values the number of growing eigenvalues changes.

    As many eigenvalues as are neutral at both ends, the smallest, are left out.
    """
    neutral = min(int((np.abs(np.real(row)) <= least).sum()) for row in rows)
    few, many = min(_growing(row, least) for row in rows), _growing(rows[0], least)

    def growth(rates: np.ndarray) -> np.ndarray:
        rest = rates[np.argsort(np.abs(rates), kind="stable")[neutral:]]
        return np.sort(np.real(rest))[::-1]

    def change(x: float) -> float:
        return growth(_rates(linearization, x))[few]

    def is_alike(x: float) -> float:
        return 1.0 if _growing(_rates(linearization, x), least) == many else -1.0

    before, after = (growth(row)[few] for row in rows)
    crosses = before * after < 0 and min(abs(before), abs(after)) > least
    found: Any = brentq(change, *ends, xtol=1e-14) if crosses else bisect(is_alike, *ends, xtol=1e-14)
    return float(found)
