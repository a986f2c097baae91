"""Iterated Lie brackets of a basis of admissible velocities, by derivatives."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from scipy.linalg import qr

from nonholo.base.numerics import double_precision
from nonholo.base.types import Array, Float


@double_precision()
def forms_at(system: Any, q: Float[np.ndarray, "n"]) -> Float[np.ndarray, "s n"]:
    """Return the constraint forms as rows of length one."""
    rows = np.asarray(_forms(system, jnp.asarray(q)))
    return rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), np.finfo(float).tiny)


@double_precision()
def brackets(system: Any, q: Float[np.ndarray, "n"], length: int) -> Float[np.ndarray, "n words"]:
    """Return the brackets [X_i, [X_j, ... ]] of a length of basis fields, one for each word, as columns.

    The basis is X = (I, Y(q)), the identity in coordinates that the constraints leave free at q.
    """
    forms = forms_at(system, q)
    factors: Any = qr(forms, pivoting=True, mode="r")
    pivots, free = np.split(factors[1], [len(forms)])
    x = jnp.asarray(q)
    scaling = np.linalg.inv(_forms(system, x)[:, pivots])
    return np.asarray(_compiled(system, tuple(pivots.tolist()), tuple(free.tolist()), length)(scaling, x))


@functools.cache
def _compiled(
    system: Any, pivots: tuple[int, ...], free: tuple[int, ...], length: int
) -> Callable[[Array, Array], Array]:
    """Return the function of a place and of the inverse there of the columns of the forms at the pivots."""
    dependent, independent = np.array(pivots, int), np.array(free, int)

    def basis(scaling: Array, x: Array) -> Array:
        rows, n, k = scaling @ _forms(system, x), len(x), len(free)
        change, found = rows[:, dependent] - jnp.eye(n - k), jnp.zeros((n - k, k))
        for _ in range(length):  # each gains an order in x - q, where the derivatives are taken
            found = -rows[:, independent] - change @ found
        return jnp.zeros((n, k)).at[independent].set(jnp.eye(k)).at[dependent].set(found)

    def longer(fields: Any, scaling: Array, x: Array) -> Array:
        own = functools.partial(basis, scaling)
        shorter = functools.partial(fields, scaling)
        values, along = jax.vmap(lambda v: jax.jvp(shorter, (x,), (v,)), 1, (None, 2))(own(x))
        across = jax.vmap(lambda w: jax.jvp(own, (x,), (w,))[1], 1, 1)(values)
        return (along - across).reshape(len(x), -1)

    fields: Any = basis
    for _ in range(length - 1):
        fields = functools.partial(longer, fields)
    return jax.jit(fields)


def _forms(system: Any, q: Array) -> Array:
    given = system.constraint_forms
    return jnp.zeros((0, len(q))) if given is None else jnp.asarray(given(q), float)
