"""Precision: every call of JAX runs in a local 64-bit scope and gives NumPy arrays."""

from collections.abc import Callable
from typing import Any

import jax
import numpy as np

from nonholo.base.numerics import double_precision


def in_double(function: Callable[..., Any], *arguments: Any) -> Any:
    """Call a JAX function with 64-bit numbers; return NumPy arrays."""
    with double_precision():
        return jax.tree.map(np.asarray, function(*arguments))
