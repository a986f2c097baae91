"""The start of a motion on a group: checks of a system at a pose, and the velocity that it sets out with."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import array, error
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert._newton import root
from nonholo.lagrange_dalembert._precision import in_double
from nonholo.lagrange_dalembert._start import admissible
from nonholo.lagrange_dalembert.on_groups import _equations as equations
from nonholo.lagrange_dalembert.on_groups._system import GroupLagrangeDAlembert
from nonholo.systems import in_group

_TOLERANCE = 1e-9  # relative, for matrices and velocities that a user computed in floating point
_DEGENERATE = 1e-10  # least singular value of scaled matrices, below which they are called singular
_SMALL = 1e-6  # length of the displacement at which l_d is compared with its limit
_CLOSE = 1e-4  # what the comparison must reach: far above rounding and the error of the limit


def pose(owner: str, system: GroupLagrangeDAlembert, configuration: Any) -> Float[np.ndarray, "N N"]:
    """Return a configuration at which the constraint forms are finite and independent."""
    group = system.group
    g = group.identity if configuration is None else in_group(f"{owner}(configuration=...)", group, configuration)
    A = in_double(_forms, system, g)
    what = "GroupLagrangeDAlembert(constraint_forms=...)"
    if not np.all(np.isfinite(A)):
        raise error(what, "be finite at the start", f"{A.tolist()}", "Start where the constraint is defined.")
    if _least(A) < _DEGENERATE:
        got = f"rank {np.linalg.matrix_rank(A)} of {len(A)} rows at {g.tolist()}"
        raise error(what, "have independent rows", got, "Drop the constraints that follow from others.")
    return g


def of_velocity(owner: str, system: GroupLagrangeDAlembert, g: np.ndarray, given: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return a velocity that satisfies the constraint, at which the Lagrangian is regular, and its momentum."""
    where = f"{owner}(body_velocity=...)"
    w = array(where, given, (system.group.dim,), "Use `vee` to turn a matrix into coordinates.")
    p = regular(system, g, w)
    return admissible(where, in_double(_forms, system, g), w), p


def of_momentum(
    owner: str, system: GroupLagrangeDAlembert, g: np.ndarray, momentum: Any
) -> tuple[np.ndarray, np.ndarray]:
    """Return the admissible velocity that has the same momenta along the constraint, and the checked momentum."""
    where, n = f"{owner}(momentum=...)", system.group.dim
    p = array(where, momentum, (n,), f"Pass the {n} momenta; only their action on admissible velocities counts.")
    regular(system, g, np.zeros(n))
    w, code = in_double(_inverse_legendre, system, g, p)
    if code:
        raise error(where, "belong to a velocity", f"{p.tolist()}", "Start with body_velocity= instead.")
    regular(system, g, w)
    return w, p


def of_displacement(
    system: GroupLagrangeDAlembert, g: np.ndarray, given: Any, h: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return log(W)/h and P(W) of a displacement that satisfies the discrete constraint."""
    where = "simulate(displacement=...)"
    v = system.group.log(in_group(where, system.group, given)) / h
    missed, slope = in_double(_constraint_slope, system, g, v, h)
    if not np.all(np.abs(missed) <= _TOLERANCE * (np.abs(slope) @ np.abs(v))):
        got = f"residual {np.array2string(missed, precision=6)}"
        raise error(where, "satisfy the discrete constraint", got, "Start with body_velocity= instead.")
    return v, in_double(_momenta, system, v, h)[0]


def regular(system: GroupLagrangeDAlembert, g: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Return the momentum of a velocity; refuse Lagrangians that are irregular there or contradict each other."""
    kind = "lagrangian" if system.lagrangian is not None else "discrete_lagrangian"
    what, at = f"GroupLagrangeDAlembert({kind}=...)", f"at velocity {w.tolist()}"
    p, matrix = in_double(_limits, system, g, w)
    if not (np.all(np.isfinite(p)) and np.all(np.isfinite(matrix))):
        got = f"momentum {p.tolist()}, matrix of the equations {matrix.tolist()} {at}"
        raise error(what, "be finite and twice differentiable", got, "Smooth it with jnp.where.")
    least = np.linalg.svd(matrix, compute_uv=False)[-1]
    if not least > _DEGENERATE:
        got = f"least singular value {least:.3g} of the equations {at}"
        raise error(what, "determine the accelerations", got, "Give every admissible direction a kinetic energy.")
    if np.any(w):
        _tends(system, w, p)
    return p


def _tends(system: GroupLagrangeDAlembert, w: np.ndarray, p: np.ndarray) -> None:
    h = _SMALL / np.linalg.norm(w)
    found = np.mean(in_double(_momenta, system, w, h), axis=0)
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
    value, slope = in_double(_constraint_slope, system, g, np.zeros(system.group.dim), h)
    if not (np.all(np.isfinite(value)) and np.all(np.isfinite(slope))):
        got = f"values {value.tolist()}, derivatives {slope.tolist()} at the start"
        raise error(where, "be finite and differentiable at W = I", got, "Smooth them with jnp.where.")
    if np.abs(value).max() > _TOLERANCE * np.abs(slope).max():
        raise error(where, "vanish at W = I", f"{value.tolist()} at the start", "Subtract what is left.")
    A = in_double(_forms, system, g)
    both = np.concatenate([_unit(A), _unit(slope)])
    if _least(slope) < _DEGENERATE or np.linalg.matrix_rank(both, tol=_CLOSE) > len(A):
        got = f"derivatives {slope.tolist()} at W = I, forms {A.tolist()}"
        raise error(where, "have derivatives that span the constraint forms", got, "Check one against the other.")


def _unit(rows: np.ndarray) -> np.ndarray:
    lengths = np.linalg.norm(rows, axis=1, keepdims=True)
    return rows / np.where(lengths == 0, 1, lengths)


def _least(rows: np.ndarray) -> float:
    return float(np.linalg.svd(_unit(rows), compute_uv=False)[-1]) if len(rows) else 1.0


def _limits_of(system: GroupLagrangeDAlembert, g: Array, w: Array) -> tuple[Array, Array]:
    return equations.continuous_momentum(system, w), equations.acceleration_matrix(system, g, w)[0]


def _inverse_legendre_of(system: GroupLagrangeDAlembert, g: Array, p: Array) -> tuple[Array, Array]:
    rows, zero = equations.forms(system, g), jnp.zeros_like(p)

    def matrix_at(w: Array) -> tuple[Any, Any, Any]:
        matrix, units = equations.acceleration_matrix(system, g, w)
        return matrix, units, (equations.continuous_momentum(system, w), rows @ w)

    sign = jnp.sign(jnp.linalg.det(matrix_at(zero)[0]))
    w, _, code = root(matrix_at, rows, p, zero, zero, sign)
    return w, code


def _constraint_slope_of(system: GroupLagrangeDAlembert, g: Array, v: Array, h: Array) -> tuple[Array, Array]:
    slope = jax.jacfwd(equations.discrete_constraints, argnums=2)(system, g, v, h)
    return equations.discrete_constraints(system, g, v, h), slope


_forms = jax.jit(equations.forms, static_argnums=0)
_momenta = jax.jit(equations.momenta, static_argnums=0)
_limits = jax.jit(_limits_of, static_argnums=0)
_inverse_legendre = jax.jit(_inverse_legendre_of, static_argnums=0)
_constraint_slope = jax.jit(_constraint_slope_of, static_argnums=0)
