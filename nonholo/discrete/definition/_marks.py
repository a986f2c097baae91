"""What a state without a value is for JAX: NaN, with the derivative NaN, which leaves other states alone."""

import jax
import jax.numpy as jnp

from nonholo.base.types import Array

_HUGE = 1e300


@jax.custom_jvp
def marked(value: Array, cause: Array, good: Array) -> Array:
    """Return a finite value where it is good, and NaN elsewhere.

    There the derivative is NaN along whatever moves the value or the cause of the failure; cotangents that are zero
    stay zero, since what comes later depends on nothing there.
    """
    del cause
    return jnp.where(good, value, jnp.nan)


@marked.defjvp
def _tangent(primals: tuple[Array, ...], tangents: tuple[Array, ...]) -> tuple[Array, Array]:
    (value, cause, good), (moved, caused, _) = primals, tangents
    many, none = jnp.where(good, 1.0, _HUGE).astype(value.dtype), jnp.where(good, 1.0, 0.0).astype(value.dtype)
    moved = moved + jnp.where(good, 0.0, 1.0).astype(value.dtype) * caused
    overflown = moved * many * many  # zero or infinite where it is not good, and so is the transpose
    return marked(value, cause, good), overflown * none * many * many
