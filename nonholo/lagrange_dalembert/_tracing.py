"""Checks of functions that users pass: JAX must be able to trace them, in 64 bit."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp

from nonholo._checks import error


def traced_shape(where: str, function: Callable[..., Any], arguments: tuple[Any, ...], of: str) -> tuple[int, ...]:
    """Return the shape of a function's value; `of` says in words what it is called with."""
    if not callable(function):
        raise error(where, "be a function", repr(function), "Pass a function of jax.numpy arrays.")
    try:
        traced = jax.make_jaxpr(lambda *x: jnp.asarray(function(*x)))(*arguments)
    except Exception as failure:
        got = f"{type(failure).__name__}: {str(failure).splitlines()[0]}"
        remedy = f"Write it with jax.numpy, for arrays of {of}; use jnp.where, not `if`."
        raise error(where, f"be traceable by JAX on {of}", got, remedy) from failure
    if any(getattr(constant, "dtype", None) == jnp.float32 for constant in traced.consts):
        remedy = "Keep parameters as Python numbers or NumPy arrays, not as jax.numpy arrays made outside."
        raise error(where, "use 64-bit numbers", "a captured 32-bit array", remedy)
    shape, kind = traced.out_avals[0].shape, traced.out_avals[0].dtype.kind
    if kind == "c" or (kind != "f" and shape == ()):
        got = "complex numbers" if kind == "c" else "an integer"
        raise error(where, "return real numbers that it computes from its arguments", got, "Return a smooth formula.")
    return shape
