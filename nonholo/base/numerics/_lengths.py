"""Rows whose first numbers are divided by their length, such as unit quaternions."""

import math

import numpy as np

from nonholo.base.compiled import njit
from nonholo.base.types import Array, Float


def of_length_one(x: Float[Array, "... n"], count: int) -> Float[Array, "... n"]:
    """Return arrays whose first `count` numbers are divided by their length, by JAX where it traces them.

    Example:
        >>> of_length_one(np.array([3.0, 4.0, 7.0]), 2)
        array([0.6, 0.8, 7. ])
    """
    if isinstance(x, np.ndarray) and x.dtype.char == "d":
        rows = np.ascontiguousarray(x)
        quotients = np.empty(rows.shape)
        _divide_by_lengths(rows.reshape(-1, x.shape[-1]), count, quotients.reshape(-1, x.shape[-1]))
        return quotients
    xp, head = x.__array_namespace__(), x[..., :count]
    return xp.concatenate([head / xp.sqrt((head * head).sum(axis=-1, keepdims=True)), x[..., count:]], axis=-1)


@njit(nogil=True, error_model="numpy")
def _divide_by_lengths(rows: np.ndarray, count: int, quotients: np.ndarray) -> None:
    for i in range(len(rows)):
        total = rows[i, 0] * rows[i, 0]
        for m in range(1, count):
            total += rows[i, m] * rows[i, m]
        length = math.sqrt(total)
        for m in range(rows.shape[1]):
            quotients[i, m] = rows[i, m] / length if m < count else rows[i, m]
