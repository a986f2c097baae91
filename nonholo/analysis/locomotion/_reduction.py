r"""A planar system seen from its body: constraints and inertia, by JAX, over $(\omega, v_1, v_2, \dot s)$.

These and their derivatives by the shape are all that is compiled; the rest is linear algebra (`_equations.py`).
"""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.numerics import double_precision
from nonholo.base.types import Array
from nonholo.lagrange_dalembert import check_value

_BLOCK = 256  # points of a call: one compilation for any number of them


@dataclasses.dataclass(frozen=True)
class Reduction:
    """What the functions of this file are compiled for.

    Attributes:
        system: The system in coordinates.
        pose: Indices of x, y and theta.
        shape: Indices of the other coordinates.
    """

    system: Any
    pose: tuple[int, int, int]
    shape: tuple[int, ...]


def called(function: Callable[..., Any], reduction: Any, *points: Array) -> Any:
    """Return the values of a function at points, whose leading axes are free, as NumPy arrays in 64 bits."""
    leading = np.broadcast_shapes(*(point.shape[:-1] for point in points))
    count = int(np.prod(leading))
    flat = [np.broadcast_to(p, (*leading, p.shape[-1])).reshape(count, p.shape[-1]) for p in points]
    blocks = max(1, -(-count // _BLOCK))
    padded = [np.concatenate([p, np.zeros((blocks * _BLOCK - count, p.shape[1]))]) for p in flat]
    run = _compiled(function, reduction)
    with double_precision():
        parts = zip(*(np.split(p, blocks) for p in padded), strict=True)
        found = [jax.tree.map(np.asarray, run(*part)) for part in parts]
    return jax.tree.map(lambda *x: np.concatenate(x)[:count].reshape((*leading, *x[0].shape[1:])), *found)


@functools.cache
def _compiled(function: Callable[..., Any], reduction: Any) -> Callable[..., Any]:
    return jax.jit(jax.vmap(functools.partial(function, reduction)))


def _coordinates(r: Reduction, pose: Array, others: Array) -> Array:
    return jnp.zeros(3 + len(others)).at[np.array(r.pose)].set(pose).at[np.array(r.shape)].set(others)


def _velocities(r: Reduction, pose: Array, u: Array) -> Array:
    cos, sin = jnp.cos(pose[2]), jnp.sin(pose[2])
    return _coordinates(r, jnp.stack([cos * u[1] - sin * u[2], sin * u[1] + cos * u[2], u[0]]), u[3:])


def rows(r: Reduction, pose: Array, s: Array) -> Array:
    """Return the constraints at a pose (x, y, theta) as rows W = (B, C)."""
    n = 3 + len(s)
    if r.system.constraint_forms is None:
        return jnp.zeros((0, n))
    columns = jax.vmap(functools.partial(_velocities, r, pose), out_axes=1)(jnp.eye(n))
    return jnp.asarray(r.system.constraint_forms(_coordinates(r, pose, s)), float) @ columns


def lagrangian(r: Reduction, pose: Array, s: Array, u: Array) -> Array:
    r"""Return the Lagrangian at a pose, of u = $(\xi, \dot s)$."""
    return jnp.asarray(r.system.lagrangian(_coordinates(r, pose, s), _velocities(r, pose, u)), float)


def momenta(r: Reduction, s: Array, u: Array) -> Array:
    """Return the derivative of the Lagrangian by u."""
    return jax.grad(lagrangian, 3)(r, jnp.zeros(3), s, u)


def constraint_terms(r: Reduction, s: Array) -> tuple[Array, Array]:
    """Return W and its derivatives by the shape, whose axis is the last."""
    at_identity = functools.partial(rows, r, jnp.zeros(3))
    return at_identity(s), jax.jacfwd(at_identity)(s)


def inertia_terms(r: Reduction, s: Array) -> tuple[Array, Array]:
    """Return the inertia M of a quadratic Lagrangian and its derivatives by the shape."""

    def inertia(s: Array) -> Array:  # momenta are linear
        return jax.vmap(functools.partial(momenta, r, s))(jnp.eye(3 + len(s)))

    return inertia(s), jax.jacfwd(inertia)(s)


def moving_shape(gait: Callable[[Array], Array], time: Array) -> tuple[Array, Array]:
    """Return the shape of a gait and its velocity, at a time in an array of one."""
    return jax.jvp(gait, (time[0],), (jnp.ones_like(time[0]),))


def check_gait(gait: Any, m: int) -> None:
    """Refuse a gait that is no function time -> shape."""
    with double_precision():
        check_value("geometric_phase(gait=...)", gait, (m,), (jax.ShapeDtypeStruct((), float),), "the time", "the time")
