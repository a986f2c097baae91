"""Parts of bodies as they look from above, and formulas of motions, which examples share."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.numerics import double_precision
from nonholo.base.types import Array, Float

Place = tuple[float, float]


def wheel(place: Place, diameter: float, angle: Array | float = 0.0, width: float = 0.3) -> Float[np.ndarray, "4 2"]:
    """Return a wheel at a place that rolls along a direction, its width in parts of its diameter."""
    corners = diameter / 2 * np.array([[-1.0, -width], [1.0, -width], [1.0, width], [-1.0, width]])
    return np.array(place) + corners @ turn(angle)


def pair(place: Place, half: float, diameter: float, angle: Array | float = 0.0) -> list[Float[np.ndarray, "P 2"]]:
    """Return an axle and its two wheels, turned together."""
    ends = np.array(place) + np.array([[0.0, -half], [0.0, half]]) @ turn(angle)
    return [ends, *(wheel(end, diameter, angle) for end in ends)]


def turn(angle: Array | float) -> Float[np.ndarray, "2 2"]:
    """Return the matrix that turns rows."""
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def rate(index: int) -> Callable[[Array, Array], Array]:
    """Return the function (configuration, velocity) -> one component of the velocity."""
    return lambda _q, v: v[..., index]


def speed_ahead(q: Array, v: Array) -> Array:
    """Return the speeds of bodies with the coordinates (x, y, heading) along their headings."""
    return v[..., 0] * np.cos(q[..., 2]) + v[..., 1] * np.sin(q[..., 2])


def on_circle(q: Array, v: Array, speed: float, heading: int = 2) -> Callable[[Array], Array]:
    """Return the motion (K,) -> (K, n) whose rates are constant but for those of the place (x, y), which turn.

    The chord of an arc is as long as the arc times sinc, also without turning.
    """

    def motion(time: Array) -> Array:
        t = np.asarray(time)
        half = v[heading] * t / 2
        ahead = np.array([np.cos(q[heading] + half), np.sin(q[heading] + half)])
        return q + np.concatenate([speed * t * np.sinc(half / np.pi) * ahead, np.multiply.outer(v[2:], t)]).T

    return motion


def of_states(function: Callable[[Array, Array], Array]) -> Callable[[Array, Array], Array]:
    """Return a function of JAX of one configuration and velocity as one of many, in double precision."""
    many = jax.jit(jnp.vectorize(function, signature="(n),(m)->()"))

    def values(q: Array, v: Array) -> Array:
        with double_precision():
            return np.asarray(many(q, v))

    return values


def energy_of(system: Any) -> Callable[[Array, Array], Array]:
    r"""Return the energy $v\cdot\partial L/\partial v - L$ of many states of a system."""
    lagrangian = system.plain.lagrangian

    def energy(q: Array, v: Array) -> Array:
        value, along = jax.jvp(lambda u: lagrangian(q, u), (v,), (v,))
        return along - value

    return of_states(energy)
