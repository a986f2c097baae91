"""Accelerations of a system in coordinates: its equations, solved densely, for tests against other derivations."""

from typing import Any

import jax
import jax.numpy as jnp

from nonholo.base.types import Array
from nonholo.lagrange_dalembert import LagrangeDAlembert


def acceleration(system: LagrangeDAlembert, q: Array, v: Array, force: Any = 0.0) -> Array:
    """Return v' of M v' - A^T lambda = L_q - (L_v)_q v + force and A v' = -A' v."""
    momentum = jax.grad(system.lagrangian, argnums=1)
    M, A = jax.jacfwd(momentum, argnums=1)(q, v), system.constraint_forms(q)
    bias = jax.jvp(lambda x: momentum(x, v), (q,), (v,))[1]
    turned = jax.jvp(lambda x: system.constraint_forms(x) @ v, (q,), (v,))[1]
    matrix = jnp.block([[M, -A.T], [A, jnp.zeros((len(A), len(A)))]])
    right = jnp.concatenate([jax.grad(system.lagrangian)(q, v) - bias + force, -turned])
    return jnp.linalg.solve(matrix, right)[: len(q)]


def admissible(system: LagrangeDAlembert, q: Array, free: tuple[int, ...], rates: Array) -> Array:
    """Return the velocity that satisfies the constraint, some of its components given."""
    A = system.constraint_forms(q)
    rest = [i for i in range(len(q)) if i not in free]
    solved = jnp.linalg.solve(A[:, jnp.array(rest)], -A[:, jnp.array(free)] @ rates)
    return jnp.zeros(len(q)).at[jnp.array(free)].set(rates).at[jnp.array(rest)].set(solved)
