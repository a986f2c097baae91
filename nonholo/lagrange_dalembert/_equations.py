r"""The equations: discrete Lagrangian and constraints by rule, momenta as their derivatives, the scaled matrix.

Steps are described by (q, v) with $v = (q' - q)/h$, not by (q, q'), so that rules do not lose digits in q' - q.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from nonholo.base.types import Array
from nonholo.lagrange_dalembert._system import LagrangeDAlembert
from nonholo.lagrange_dalembert._tracing import TwoPoint


def forms(system: LagrangeDAlembert, q: Array) -> Array:
    """Return the rows A(q), none for a free system."""
    if system.constraint_forms is None:
        return jnp.zeros((0, q.shape[0]))
    return jnp.asarray(system.constraint_forms(q), dtype=q.dtype)


def discrete_lagrangian(system: LagrangeDAlembert, q: Array, v: Array, h: Array) -> Array:
    """Return L_d(q, q + h v)."""
    if system.discrete_lagrangian is not None:
        return jnp.asarray(system.discrete_lagrangian(q, q + h * v, h))
    if system.rule == "midpoint":
        return h * system.lagrangian(q + h * v / 2, v)
    return h * (system.lagrangian(q, v) + system.lagrangian(q + h * v, v)) / 2


def discrete_constraints(system: LagrangeDAlembert, q: Array, v: Array, h: Array) -> Array:
    """Return F(q, q + h v)."""
    if system.discrete_constraints is not None:
        return jnp.asarray(system.discrete_constraints(q, q + h * v, h))
    if system.rule == "midpoint":
        return forms(system, q + h * v / 2) @ v
    return (forms(system, q) + forms(system, q + h * v)) @ v / 2


def momenta(system: LagrangeDAlembert, q: Array, v: Array, h: Array) -> tuple[Array, Array]:
    r"""Return $P = -D_1 L_d$ and $P^+ = D_2 L_d$."""
    along_q, along_v = jax.grad(discrete_lagrangian, argnums=(1, 2))(system, q, v, h)
    arriving = along_v / h  # at fixed q the end point moves by h times the change of v
    return arriving - along_q, arriving


def momentum(system: LagrangeDAlembert, q: Array, v: Array) -> Array:
    r"""Return $\partial L/\partial v$."""
    return jax.grad(system.lagrangian, argnums=1)(q, v)


def discrete_energy(system: LagrangeDAlembert, q: Array, v: Array, h: Array) -> Array:
    r"""Return $E = -\partial L_d/\partial h$ at fixed end points; where h is not known to L_d, E at the midpoint."""
    d = h * v
    if isinstance(system.discrete_lagrangian, TwoPoint):
        return energy(system, q + d / 2, v)
    return -jax.grad(lambda step: discrete_lagrangian(system, q, d / step, step))(h)


def energy(system: LagrangeDAlembert, q: Array, v: Array) -> Array:
    r"""Return $v\cdot\partial L/\partial v - L$."""
    return v @ momentum(system, q, v) - system.lagrangian(q, v)


def ahead(_: LagrangeDAlembert, q: Array, v: Array, h: Array) -> Array:
    """Return the configuration after a step."""
    return q + h * v


def displaced(*_: object) -> tuple[()]:
    """Return nothing: the displacement is h v."""
    return ()


def rate(_: LagrangeDAlembert, _q: Array, v: Array) -> Array:
    """Return the rate of change of a configuration."""
    return v


def normalized(_: LagrangeDAlembert, q: Array) -> Array:
    """Return the configuration as it is: rounding errors lead to another one."""
    return q


def force(system: LagrangeDAlembert, q: Array, v: Array) -> Array:
    r"""Return $\partial L/\partial q$ less the change of $\partial L/\partial v$ with q."""
    along_q = jax.grad(system.lagrangian)(q, v)
    _, carried = jax.jvp(lambda x: momentum(system, x, v), (q,), (v,))
    return along_q - carried


class Scaled(NamedTuple):
    """Units of a bordered matrix: of velocities, and of the rows of both borders."""

    velocity: Array
    forms: Array
    constraints: Array


def bordered(mass: Array, right: Array, below: Array, kinetic: Array) -> tuple[Array, Scaled]:
    r"""Return $\begin{pmatrix} M & -A^T \\ F & 0 \end{pmatrix}$ without units, and the units.

    Velocities are measured in units of $|\partial^2 L/\partial v_i^2|^{-1/2}$ (1 where it vanishes), which does not
    degenerate where M does; the rows of A and F get length one.
    """
    unit = 1 / jnp.sqrt(jnp.where(jnp.diag(kinetic) == 0, 1.0, jnp.abs(jnp.diag(kinetic))))
    lengths = [jnp.sqrt(jnp.sum((rows * unit) ** 2, axis=1)) for rows in (right, below)]
    a, f = (jnp.where(length == 0, 1.0, length) for length in lengths)
    s = right.shape[0]
    corner = jnp.zeros((s, s))
    upper = jnp.concatenate([mass * unit * unit[:, None], -(right * unit).T / a], axis=1)
    lower = jnp.concatenate([below * unit / f[:, None], corner], axis=1)
    return jnp.concatenate([upper, lower]), Scaled(unit, a, f)


def solve_bordered(matrix: Array, units: Scaled, force: Array, off: Array) -> tuple[Array, Array]:
    r"""Solve $M x - A^T\lambda$ = force, F x = off, given the matrix without units."""
    n = force.shape[0]
    solution = jnp.linalg.solve(matrix, jnp.concatenate([force * units.velocity, off / units.constraints]))
    return solution[:n] * units.velocity, solution[n:] / units.forms


def kinetic_matrix(system: LagrangeDAlembert, q: Array, v: Array, _h: Any = None) -> Array:
    r"""Return $\partial^2 L/\partial v^2$."""
    return jax.hessian(system.lagrangian, argnums=1)(q, v)


def newton_matrix(
    system: LagrangeDAlembert, q: Array, v: Array, h: Array, kinetic: Array
) -> tuple[Array, Scaled, tuple[Array, Array]]:
    """Return the scaled regularity matrix of a step, its units, and P and F at the step."""

    def values(w: Array) -> tuple[Array, Array]:
        return momenta(system, q, w, h)[0], discrete_constraints(system, q, w, h)

    mass, below = jax.jacfwd(values)(v)
    matrix, units = bordered(mass, forms(system, q), below, kinetic)
    return matrix, units, values(v)


def acceleration_matrix(system: LagrangeDAlembert, q: Array, v: Array) -> tuple[Array, Scaled]:
    """Return the scaled matrix of the continuous equations: the regularity matrix for h -> 0."""
    kinetic, A = kinetic_matrix(system, q, v), forms(system, q)
    return bordered(kinetic, A, A, kinetic)
