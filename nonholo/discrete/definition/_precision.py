"""Precision of the JAX route: eager calls run in a local 64-bit scope, traced calls must already be 64-bit."""

import contextlib
import contextvars
import functools
from collections.abc import Callable
from typing import Any

import equinox
import jax
import numpy as np

from nonholo.base.checks import is_traced
from nonholo.base.numerics import double_precision
from nonholo.base.progress import compiling, setting
from nonholo.discrete._scheme import register

_float32 = contextvars.ContextVar("float32_allowed", default=False)
register()


def allow_float32() -> contextlib.AbstractContextManager[None]:
    """Let the JAX route be traced in 32 bits, where energy is conserved to 1e-7 instead of rounding.

    Example:
        >>> with nh.allow_float32():
        ...     pass
    """
    return setting(_float32, True)


def in_double(function: Callable[..., Any], *arguments: Any) -> Any:
    """Call a JAX function: eagerly in a 64-bit scope with NumPy results, or as it is on traced 64-bit input."""
    tracers = [x for x in jax.tree.leaves(arguments) if is_traced(x)]
    if not tracers:
        with double_precision(), compiling("a map", compiling, (function, jax.tree.structure(arguments))):
            return jax.tree.map(np.asarray, function(*arguments))
    if not _float32.get() and any(x.dtype == np.float32 for x in tracers):
        raise TypeError(
            "`nonholo` must be traced in 64 bits. Got float32. Wrap the call in `with jax.enable_x64(True):`, "
            "or accept single precision with `with nonholo.allow_float32():`."
        )
    return function(*arguments)


def compile_double(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a JAX function, which is then called as `in_double` calls it."""
    return functools.wraps(function)(functools.partial(in_double, equinox.filter_jit(function)))
