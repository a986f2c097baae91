"""Precision: every call of JAX is compiled, runs in a local 64-bit scope and gives NumPy arrays."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import numpy as np

from nonholo.base.numerics import double_precision

_compiled = functools.cache(functools.partial(jax.jit, static_argnums=0))


def in_double(function: Callable[..., Any], system: Any, *arguments: Any) -> Any:
    """Call a JAX function of a system, for which it is compiled, with 64-bit numbers; return NumPy arrays."""
    with double_precision():
        return jax.tree.map(np.asarray, _compiled(function)(system, *arguments))
