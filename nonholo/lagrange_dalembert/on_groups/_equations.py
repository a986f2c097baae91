r"""The equations on a group: momenta as derivatives of l_d, constraints in body coordinates, the scaled matrix.

A displacement is described by v with $W = e^{hv}$, not by the matrix, so that the default rule loses no digits in
log W and continues beyond angles of pi.
"""

import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.numerics import double_precision
from nonholo.base.types import Array
from nonholo.lagrange_dalembert._equations import Scaled, bordered
from nonholo.lagrange_dalembert.on_groups._system import GroupLagrangeDAlembert


def forms(system: GroupLagrangeDAlembert, g: Array) -> Array:
    """Return the rows a(g), none for a free system."""
    if system.constraint_forms is None:
        return jnp.zeros((0, system.group.dim))
    return jnp.asarray(system.constraint_forms(g))


def constraint(system: GroupLagrangeDAlembert, g: Array, v: Array) -> Array:
    """Return a(g) v."""
    return forms(system, g) @ v


def holonomic(_system: GroupLagrangeDAlembert, _g: Array) -> Array:
    """Return nothing: no constraint is one of poses alone."""
    return jnp.zeros(0)


def holonomic_residual(system: GroupLagrangeDAlembert, _g: Array) -> Array:
    """Return zeros, one for each constraint."""
    return jnp.zeros(system.constraints)


def displaced(system: GroupLagrangeDAlembert, v: Array, h: Array) -> tuple[Array]:
    """Return the displacement W."""
    return (_displacement(system, v, h),)


def _displacement(system: GroupLagrangeDAlembert, v: Array, h: Array) -> Array:
    return system.group.exp(h * v)


def ahead(system: GroupLagrangeDAlembert, g: Array, v: Array, h: Array) -> Array:
    """Return the pose after a step."""
    return normalized(system, g @ _displacement(system, v, h))


def discrete_constraints(system: GroupLagrangeDAlembert, g: Array, v: Array, h: Array) -> Array:
    """Return F(g, W)."""
    if system.discrete_constraints is not None:
        return jnp.asarray(system.discrete_constraints(g, _displacement(system, v, h), h))
    return forms(system, g @ _displacement(system, v, h / 2)) @ v


def momenta(system: GroupLagrangeDAlembert, _g: Array, v: Array, h: Array) -> tuple[Array, Array]:
    r"""Return P(W) and $P^+(W) = \mathrm{Ad}^*_W P(W)$.

    With D the matrix of derivatives of l_d they are the covectors $\mathrm{tr}\,D^TE_iW$ and $\mathrm{tr}\,D^TWE_i$.
    """
    W = _displacement(system, v, h)
    D = jax.grad(system.discrete_lagrangian)(W, h)
    coordinates = system.group.coordinates
    return coordinates.dual_vector(D @ W.T), coordinates.dual_vector(W.T @ D)


def discrete_energy(system: GroupLagrangeDAlembert, _g: Array, v: Array, h: Array) -> Array:
    r"""Return $-\partial l_d/\partial h$ at fixed W."""
    return -jax.grad(system.discrete_lagrangian, argnums=1)(_displacement(system, v, h), h)


def kinetic_matrix(system: GroupLagrangeDAlembert, _g: Any, _v: Any, h: Array) -> Array:
    r"""Return h times the second derivative of $l_d(e^x)$ at x = 0: the inertia operator of a quadratic Lagrangian."""

    def at(x: Array) -> Array:
        return h * system.discrete_lagrangian(system.group.exp(x), h)

    return jax.hessian(at)(jnp.zeros(system.group.dim))


def lagrangian(system: GroupLagrangeDAlembert, w: Array) -> Array:
    r"""Return $l(\omega)$: the given one, or the quadratic form that belongs to l_d."""
    if system.lagrangian is not None:
        return system.lagrangian(w)
    return w @ _inertia(system) @ w / 2


@functools.lru_cache(maxsize=64)
def _inertia(system: GroupLagrangeDAlembert) -> Any:
    """Return the inertia operator of the quadratic form, as numbers."""
    with jax.ensure_compile_time_eval(), double_precision():
        return np.asarray(jax.jit(functools.partial(kinetic_matrix, system, None, None))(1.0))


def momentum(system: GroupLagrangeDAlembert, _g: Array, w: Array) -> Array:
    r"""Return $\partial l/\partial\omega$."""
    return jax.grad(lagrangian, argnums=1)(system, w)


def energy(system: GroupLagrangeDAlembert, g: Array, w: Array) -> Array:
    r"""Return $\omega\cdot\partial l/\partial\omega - l$."""
    return w @ momentum(system, g, w) - lagrangian(system, w)


def rate(system: GroupLagrangeDAlembert, g: Array, w: Array) -> Array:
    """Return the rate of change of a pose."""
    return g @ system.group.hat(w)


def beside(system: GroupLagrangeDAlembert, g: Array, xi: Array) -> Array:
    r"""Return the pose $g e^\xi$."""
    return g @ system.group.exp(xi)


def frame(system: GroupLagrangeDAlembert, g: Array, v: Array, time: Array) -> Array:
    """Return from where poses are seen after a time: from a body that moves steadily."""
    return g @ _displacement(system, v, time)


def departure(system: GroupLagrangeDAlembert, g: Array, after: Array) -> Array:
    r"""Return the $\xi$ of a pose $g e^\xi$."""
    return system.group.log(system.group.inverse(g) @ after)


def departure_rate(system: GroupLagrangeDAlembert, v: Array, xi: Array, w: Array) -> Array:
    r"""Return the rate of a small $\xi$ between poses that move with the body velocities v and w."""
    return w - v + system.group.bracket(xi, v)


def force(system: GroupLagrangeDAlembert, g: Array, w: Array) -> Array:
    r"""Return $\mathrm{ad}^*_\omega p$, what accelerates a free body."""
    return system.group.coad(w, momentum(system, g, w))


def acceleration_matrix(system: GroupLagrangeDAlembert, g: Array, w: Array) -> tuple[Array, Scaled]:
    """Return the scaled matrix of the continuous equations."""
    kinetic, A = mass_matrix(system, g, w), forms(system, g)
    return bordered(kinetic, A, A, kinetic)


def mass_matrix(system: GroupLagrangeDAlembert, _g: Array, w: Array) -> Array:
    r"""Return $\partial^2 l/\partial\omega^2$."""
    return jax.hessian(lagrangian, argnums=1)(system, w)


def normalized(system: GroupLagrangeDAlembert, g: Array) -> Array:
    """Return the element of the group next to a matrix in which rounding errors have gathered."""
    group = system.group
    return group.matrix_from_pose(group.normalize_pose(group.pose_from_matrix(g)))
