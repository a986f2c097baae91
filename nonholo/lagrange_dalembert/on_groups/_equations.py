r"""The equations on a group, and the start of a motion there.

Momenta as derivatives of l_d, constraints in body coordinates, the scaled matrix; then checks of a system at a pose,
and the velocity that it sets out with. A displacement is described by v with $W = e^{hv}$, not by the matrix, so that
the default rule loses no digits in log W and continues beyond angles of pi.
"""

import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import array, error
from nonholo.base.numerics import double_precision
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert._equations import Scaled, bordered_matrix
from nonholo.lagrange_dalembert._flow import admissible_velocity
from nonholo.lagrange_dalembert._newton import root
from nonholo.lagrange_dalembert._room import in_double
from nonholo.lagrange_dalembert._start import (
    DEGENERATE,
    admissible,
    check_rows,
    constraint_slope,
    least_value,
    unit_rows,
)
from nonholo.lagrange_dalembert.on_groups._system import GroupLagrangeDAlembert
from nonholo.systems import in_group


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


def displacements(system: GroupLagrangeDAlembert, v: Array, h: Array) -> tuple[Array]:
    """Return the displacement W."""
    return (_displacement(system, v, h),)


def _displacement(system: GroupLagrangeDAlembert, v: Array, h: Array) -> Array:
    return system.group.exp(h * v)


def ahead(system: GroupLagrangeDAlembert, g: Array, v: Array, h: Array) -> Array:
    """Return the pose after a step."""
    return normalize(system, g @ _displacement(system, v, h))


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
    return bordered_matrix(kinetic, A, A, kinetic)


def mass_matrix(system: GroupLagrangeDAlembert, _g: Array, w: Array) -> Array:
    r"""Return $\partial^2 l/\partial\omega^2$."""
    return jax.hessian(lagrangian, argnums=1)(system, w)


def normalize(system: GroupLagrangeDAlembert, g: Array) -> Array:
    """Return the element of the group next to a matrix in which rounding errors have gathered."""
    group = system.group
    return group.matrix_from_pose(group.normalize_pose(group.pose_from_matrix(g)))


_TOLERANCE = 1e-9  # relative, for matrices and velocities that a user computed in floating point
_SMALL = 1e-6  # length of the displacement at which l_d is compared with its limit
_CLOSE = 1e-4  # what the comparison must reach: far above rounding and the error of the limit


def point(
    owner: str, system: GroupLagrangeDAlembert, configuration: Any, time: float = 0.0, *, project: bool
) -> Float[np.ndarray, "N N"]:
    """Return a configuration at which the constraint forms are finite and independent."""
    del time, project
    group = system.group
    g = group.identity if configuration is None else in_group(f"{owner}(configuration=...)", group, configuration)
    check_rows("GroupLagrangeDAlembert(constraint_forms=...)", in_double(forms, system, g), g)
    return g


def velocity(
    owner: str, system: GroupLagrangeDAlembert, g: np.ndarray, value: Any, *, project: bool
) -> Float[np.ndarray, "dim"]:
    """Return a velocity that satisfies the constraint, at which the Lagrangian is regular."""
    where = f"{owner}(body_velocity=...)"
    w = array(where, value, (system.group.dim,), "Use `vee` to turn a matrix into coordinates.")
    regular(system, g, w)
    if project:
        return in_double(admissible_velocity, system, g, w)
    A = in_double(forms, system, g)
    return admissible(where, A, w, A @ w)


def of_momentum(
    owner: str, system: GroupLagrangeDAlembert, g: np.ndarray, momentum: Any
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a checked momentum, the pose and the admissible velocity with the same components along the constraint."""
    where, n = f"{owner}(momentum=...)", system.group.dim
    p = array(where, momentum, (n,), f"Pass the {n} momenta; only their action on admissible velocities counts.")
    regular(system, g, np.zeros(n))
    w, code = in_double(_inverse_legendre, system, g, p)
    if code:
        raise error(where, "belong to a velocity", f"{p.tolist()}", "Start with body_velocity= instead.")
    regular(system, g, w)
    return p, g, w


def velocity_of_displacement(system: GroupLagrangeDAlembert, g: np.ndarray, value: Any, h: float) -> np.ndarray:
    """Return log(W)/h of a displacement that satisfies the discrete constraint."""
    where = "simulate(displacement=...)"
    v = system.group.log(in_group(where, system.group, value)) / h
    residual, slope = in_double(constraint_slope, system, g, v, h)
    if not np.all(np.abs(residual) <= _TOLERANCE * (np.abs(slope) @ np.abs(v))):
        got = f"residual {np.array2string(residual, precision=6)}"
        raise error(where, "satisfy the discrete constraint", got, "Start with body_velocity= instead.")
    return v


def regular(system: GroupLagrangeDAlembert, g: np.ndarray, w: np.ndarray) -> None:
    """Refuse Lagrangians that are irregular there or contradict each other."""
    kind = "lagrangian" if system.lagrangian is not None else "discrete_lagrangian"
    what, at = f"GroupLagrangeDAlembert({kind}=...)", f"at velocity {w.tolist()}"
    p, matrix = in_double(_limits, system, g, w)
    if not (np.all(np.isfinite(p)) and np.all(np.isfinite(matrix))):
        got = f"momentum {p.tolist()}, matrix of the equations {matrix.tolist()} {at}"
        raise error(what, "be finite and twice differentiable", got, "Smooth it with jnp.where.")
    least = np.linalg.svd(matrix, compute_uv=False)[-1]
    if not least > DEGENERATE:
        got = f"least singular value {least:.3g} of the equations {at}"
        raise error(what, "determine the accelerations", got, "Give every admissible direction a kinetic energy.")
    if np.any(w):
        _tends(system, g, w, p)


def _tends(system: GroupLagrangeDAlembert, g: np.ndarray, w: np.ndarray, p: np.ndarray) -> None:
    h = _SMALL / np.linalg.norm(w)
    momentum = np.mean(in_double(momenta, system, g, w, h), axis=0)
    if not np.linalg.norm(momentum - p) <= _CLOSE * np.linalg.norm(p):
        where = "GroupLagrangeDAlembert(discrete_lagrangian=...)"
        got = f"momentum {momentum.tolist()} at the small step {h:.3g}, in the limit {p.tolist()}"
        remedy = "Include the factor time_step; pass lagrangian= if it is not a quadratic form."
        raise error(where, "tend to time_step times the Lagrangian", got, remedy)


def consistent(system: GroupLagrangeDAlembert, g: np.ndarray, h: float) -> None:
    """Refuse discrete constraints that do not vanish at W = I, or not with the tangent space of the forms."""
    if system.discrete_constraints is None:
        return
    where = "GroupLagrangeDAlembert(discrete_constraints=...)"
    value, slope = in_double(constraint_slope, system, g, np.zeros(system.group.dim), h)
    if not (np.all(np.isfinite(value)) and np.all(np.isfinite(slope))):
        got = f"values {value.tolist()}, derivatives {slope.tolist()} at the start"
        raise error(where, "be finite and differentiable at W = I", got, "Smooth them with jnp.where.")
    if np.abs(value).max() > _TOLERANCE * np.abs(slope).max():
        raise error(where, "vanish at W = I", f"{value.tolist()} at the start", "Subtract what is left.")
    A = in_double(forms, system, g)
    both = np.concatenate([unit_rows(A), unit_rows(slope)])
    if least_value(slope) < DEGENERATE or np.linalg.matrix_rank(both, tol=_CLOSE) > len(A):
        got = f"derivatives {slope.tolist()} at W = I, forms {A.tolist()}"
        raise error(where, "have derivatives that span the constraint forms", got, "Check one against the other.")


def _limits(system: GroupLagrangeDAlembert, g: Array, w: Array) -> tuple[Array, Array]:
    return momentum(system, g, w), acceleration_matrix(system, g, w)[0]


def _inverse_legendre(system: GroupLagrangeDAlembert, g: Array, p: Array) -> tuple[Array, Array]:
    rows, zero = forms(system, g), jnp.zeros_like(p)

    def matrix_at(w: Array) -> tuple[Any, Any, Any]:
        matrix, units = acceleration_matrix(system, g, w)
        return matrix, units, (momentum(system, g, w), rows @ w)

    sign = jnp.sign(jnp.linalg.det(matrix_at(zero)[0]))
    w, _, code = root(matrix_at, rows, p, zero, zero, sign)
    return w, code
