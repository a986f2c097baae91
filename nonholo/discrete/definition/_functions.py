"""Functions of one matrix, the library's or the user's, in JAX: values, derivatives along the group, momenta."""

import functools
from collections.abc import Callable

import equinox
import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.types import Array, Float
from nonholo.discrete.definition._precision import in_double
from nonholo.groups import AbstractMatrixGroup

_SAMPLES = 16
_EVEN = 1e-10  # relative difference of values that counts as rounding


def value_and_slope(lagrangian: Callable[[Array], Array], group: AbstractMatrixGroup) -> tuple[np.ndarray, np.ndarray]:
    """Return a discrete Lagrangian and its derivative along the group at the identity."""
    return in_double(_value_and_slope, lagrangian, group, np.zeros(group.dim))


@functools.partial(jax.jit, static_argnums=(0, 1))
def _value_and_slope(lagrangian: Callable[[Array], Array], group: AbstractMatrixGroup, x: Array) -> tuple[Array, Array]:
    return jax.value_and_grad(lambda x: lagrangian(group.exp(x)))(x)


def map_each(function: Callable[[Array], Array], W: Float[np.ndarray, "K N N"]) -> np.ndarray:
    """Return the values of a function of one matrix at each of several."""
    return in_double(_map_each, function, W)


@functools.partial(jax.jit, static_argnums=0)
def _map_each(function: Callable[[Array], Array], W: Array) -> Array:
    return jax.vmap(function)(W)


def is_even(function: Callable[[Array], Array], group: AbstractMatrixGroup) -> bool:
    """Tell whether a function takes the same value at W and its inverse, tried at random elements."""
    W = group.exp(0.5 * np.random.default_rng(0).normal(size=(_SAMPLES, group.dim)) / np.sqrt(group.dim))
    there, back = map_each(function, W), map_each(function, group.inverse(W))
    return bool(np.abs(there - back).max() <= _EVEN * np.abs(there).max())


def momenta_by_derivative(
    lagrangian: Callable[[Array], Array], group: AbstractMatrixGroup, W: Float[Array, "... N N"], side: str
) -> Float[Array, "... dim"]:
    """Return the momenta P(W) (left) or Ad*_W P(W) (right) of a discrete Lagrangian by automatic differentiation."""
    return in_double(functools.partial(_momenta, lagrangian, group, side=side), W)


@equinox.filter_jit
def _momenta(lagrangian: Callable[[Array], Array], group: AbstractMatrixGroup, W: Array, side: str) -> Array:
    return momenta_along(lagrangian, group, W, side)


def momenta_along(
    lagrangian: Callable[[Array], Array], group: AbstractMatrixGroup, W: Float[Array, "... N N"], side: str
) -> Float[Array, "... dim"]:
    """Return them as a JAX function of W."""

    def momentum(V: Array) -> Array:
        def varied(x: Array) -> Array:
            g = group.exp(x)
            return lagrangian(g @ V if side == "left" else V @ g)

        return jax.grad(varied)(jnp.zeros(group.dim, V.dtype))

    flat = jnp.reshape(W, (-1, *W.shape[-2:]))
    return jnp.reshape(jax.vmap(momentum)(flat), (*W.shape[:-2], group.dim))
