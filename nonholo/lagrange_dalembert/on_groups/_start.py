"""The start of a motion on a group: checks of a system at a pose, and the velocity that it sets out with."""

from typing import Any

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import array, error
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert._accelerations import admissible_velocity
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
from nonholo.lagrange_dalembert.on_groups import _equations as equations
from nonholo.lagrange_dalembert.on_groups._system import GroupLagrangeDAlembert
from nonholo.systems import in_group

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
    check_rows("GroupLagrangeDAlembert(constraint_forms=...)", in_double(equations.forms, system, g), g)
    return g


def velocity(
    owner: str, system: GroupLagrangeDAlembert, g: np.ndarray, given: Any, *, project: bool
) -> Float[np.ndarray, "dim"]:
    """Return a velocity that satisfies the constraint, at which the Lagrangian is regular."""
    where = f"{owner}(body_velocity=...)"
    w = array(where, given, (system.group.dim,), "Use `vee` to turn a matrix into coordinates.")
    regular(system, g, w)
    if project:
        return in_double(admissible_velocity, system, g, w)
    A = in_double(equations.forms, system, g)
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


def velocity_of_displacement(system: GroupLagrangeDAlembert, g: np.ndarray, given: Any, h: float) -> np.ndarray:
    """Return log(W)/h of a displacement that satisfies the discrete constraint."""
    where = "simulate(displacement=...)"
    v = system.group.log(in_group(where, system.group, given)) / h
    missed, slope = in_double(constraint_slope, system, g, v, h)
    if not np.all(np.abs(missed) <= _TOLERANCE * (np.abs(slope) @ np.abs(v))):
        got = f"residual {np.array2string(missed, precision=6)}"
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
    found = np.mean(in_double(equations.momenta, system, g, w, h), axis=0)
    if not np.linalg.norm(found - p) <= _CLOSE * np.linalg.norm(p):
        where = "GroupLagrangeDAlembert(discrete_lagrangian=...)"
        got = f"momentum {found.tolist()} at the small step {h:.3g}, in the limit {p.tolist()}"
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
    A = in_double(equations.forms, system, g)
    both = np.concatenate([unit_rows(A), unit_rows(slope)])
    if least_value(slope) < DEGENERATE or np.linalg.matrix_rank(both, tol=_CLOSE) > len(A):
        got = f"derivatives {slope.tolist()} at W = I, forms {A.tolist()}"
        raise error(where, "have derivatives that span the constraint forms", got, "Check one against the other.")


def _limits(system: GroupLagrangeDAlembert, g: Array, w: Array) -> tuple[Array, Array]:
    return equations.momentum(system, g, w), equations.acceleration_matrix(system, g, w)[0]


def _inverse_legendre(system: GroupLagrangeDAlembert, g: Array, p: Array) -> tuple[Array, Array]:
    rows, zero = equations.forms(system, g), jnp.zeros_like(p)

    def matrix_at(w: Array) -> tuple[Any, Any, Any]:
        matrix, units = equations.acceleration_matrix(system, g, w)
        return matrix, units, (equations.momentum(system, g, w), rows @ w)

    sign = jnp.sign(jnp.linalg.det(matrix_at(zero)[0]))
    w, _, code = root(matrix_at, rows, p, zero, zero, sign)
    return w, code
