"""Numbers side by side, on which processors work at once: in compiled code a vector, in plain Python an array.

How many there are tells the length of a tuple, which the compiler knows. One lane is a plain number. Each lane has the
bits that it would have alone: products and sums are rounded one by one.
"""

from typing import Any

import numpy as np

from nonholo.base.compiled import compiled_in

ONE, FOUR, EIGHT = (0,), (0,) * 4, (0,) * 8


def load(array: np.ndarray, row: int, at: int, lanes: tuple[int, ...]) -> Any:
    """Return number `at` of all lanes in a row of an array, where it stands at lanes · at and after."""
    L = len(lanes)
    return array[row, at] if L == 1 else array[row, at * L : (at + 1) * L].copy()


def store(array: np.ndarray, row: int, at: int, lanes: tuple[int, ...], value: Any) -> None:
    """Write number `at` of all lanes in a row of an array."""
    array[row, at * len(lanes) : (at + 1) * len(lanes)] = value


def spread(value: Any, lanes: tuple[int, ...]) -> Any:
    """Return a number for each lane; a row as it is."""
    return value if len(lanes) == 1 or np.ndim(value) else np.array([value] * len(lanes))


compiled_in("nonholo.kernels._vectors")
