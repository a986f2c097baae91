"""The start of a motion: checks of a system at a point, and the velocity or displacement it sets out with."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import array, error, is_moderate, scale
from nonholo.base.numerics import double_precision
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert import _equations as equations
from nonholo.lagrange_dalembert import compiled
from nonholo.lagrange_dalembert._flow import admissible_velocity, nearest_place
from nonholo.lagrange_dalembert._newton import orientation
from nonholo.lagrange_dalembert.functions import in_double, place
from nonholo.systems import inadmissible, reach_of

_TOLERANCE = 1e-9  # relative, for velocities and displacements that a user computed in floating point
_DEGENERATE = 1e-10  # least singular value of scaled matrices, below which they are called singular
_CONSISTENT = 1e-7  # relative; looser, since the functions may difference numerically
_SMALL = 1e-6  # length of the displacement at which l_d is compared with its limit
_CLOSE = 1e-4  # what the comparison must reach: far above rounding and the error of the limit


def _at(function: Any, system: Any, *arguments: Any) -> Any:
    """Return the arrays of function(system, ...), by formulas or by JAX."""
    return compiled.value(function, system, *arguments) or in_double(function, system, *arguments)


def _argument(system: Any, name: str) -> str:
    return f"{type(system).__name__}({name}=...)"


def point(owner: str, system: Any, configuration: Any, time: float = 0.0, *, project: bool = False) -> np.ndarray:
    """Return the place of an admissible configuration at which the constraint forms are finite and independent.

    With `project` it is the admissible one next to the configuration in the kinetic energy.
    """
    where, n = f"{owner}(configuration=...)", system.dimension
    q = system.places.configuration(where, configuration)
    if project and system.constraints > system.velocity_constraints:
        nearest = in_double(nearest_place, system, place(system, q, time))[:n]
        q = q if np.isnan(nearest).any() else nearest
    x = place(system, q, time)
    A, units = forms_and_units(system, x)
    if system.constraints > system.velocity_constraints:
        _check_place(where, system, x, (A, _reach(x, units)))
    _check_rows(_argument(system, "constraint_forms" if system.holonomic is None else "holonomic"), A * units, q)
    return x


def forms_and_units(system: Any, x: np.ndarray) -> tuple[Float[np.ndarray, "s n"], Float[np.ndarray, "n"]]:
    """Return the forms, and units of velocities in which each has the same kinetic energy; 1 where they have none."""
    *_, units, A, _ = _at(_kinetics, system, x, np.zeros(system.dimension))
    return A, np.where(np.isfinite(units), units, 1.0)


def _reach(x: np.ndarray, units: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
    """Return lengths beside which a place is measured; one on a group is seen from itself."""
    return reach_of(x[: len(units)] if x.ndim == 1 else np.zeros(len(units)), units)


def _check_place(where: str, system: Any, x: np.ndarray, along: tuple[np.ndarray, np.ndarray]) -> None:
    """Refuse a place that prescribed motions or holonomic constraints do not allow, with the nearest one that they do.

    Where a surface is curved its radius measures the place, too.
    """
    (A, reach), n = along, system.dimension
    for index, motion in system.plain.prescribed:
        with double_precision():
            target = float(motion(x[-1]))
        if not abs(x[index] - target) <= _TOLERANCE * (reach[index] + abs(target)):
            got, remedy = f"{x[index]:.17g}", f"Set coordinate {index} to {target:.17g}."
            raise error(where, "agree with prescribed motions", got, remedy)
    if system.holonomic is None:
        return
    residual, bend = (np.abs(in_double(each, system, x)) for each in (equations.holonomic_residual, _bend))
    reach = np.minimum(reach, np.divide(np.abs(A), bend, out=np.full_like(bend, np.inf), where=bend > 0))
    if not np.all(residual <= _TOLERANCE * (np.abs(A) * (np.abs(x[:n]) + reach)).sum(axis=1)):
        nearest = in_double(nearest_place, system, x)[:n]
        got = f"residual {np.array2string(in_double(equations.holonomic, system, x), precision=6)}"
        remedy = "Start elsewhere." if np.isnan(nearest).any() else f"The nearest admissible one is {nearest.tolist()}."
        raise error(where, "satisfy the holonomic constraints", got, remedy)


def _check_rows(what: str, A: Float[np.ndarray, "s n"], at: np.ndarray) -> None:
    """Refuse constraint forms that are not finite, or not independent, at a configuration."""
    if not is_moderate(A, np.inf):
        raise error(what, "be finite at the start", f"{A.tolist()}", "Start where the constraint is defined.")
    lengths = np.linalg.norm(A, axis=1, keepdims=True)
    units = A / (lengths + (lengths == 0))
    if len(A) > A.shape[1] or (len(A) and np.linalg.svd(units, compute_uv=False)[-1] < _DEGENERATE):
        got = f"rank {np.linalg.matrix_rank(A)} of {len(A)} rows at {at.tolist()}"
        raise error(what, "have independent rows", got, "Drop the constraints that follow from others.")


def consistent(system: Any, q: np.ndarray, h: Any) -> None:
    """Refuse discrete constraints that short steps along the constraint do not satisfy."""
    if system.discrete_constraints is None:
        return
    where, rest = _argument(system, "discrete_constraints"), system.places.at_rest
    at_rest, slope = _at(_constraint_slope, system, q, np.zeros(system.dimension), h)
    A, units = forms_and_units(system, q)
    most = _TOLERANCE / h * np.abs(slope) @ _reach(q, units)
    if not np.all(np.isfinite(at_rest)) or np.any(np.abs(at_rest) > most):
        raise error(where, f"vanish {rest}", f"{at_rest.tolist()} at {q.tolist()}", "Subtract its value there.")
    span_gap = np.abs(slope @ np.linalg.svd(A)[2][len(A) :].T)
    if not span_gap.max() <= _CONSISTENT * np.linalg.norm(slope, axis=1).max() or np.linalg.matrix_rank(slope) < len(A):
        got = f"derivatives {slope.tolist()} beside the forms {A.tolist()} at {q.tolist()}"
        remedy = "Discretize the same forms, or change the forms."
        raise error(where, "have derivatives along the displacement that span the constraint forms", got, remedy)


def velocity(owner: str, system: Any, q: np.ndarray, value: Any, *, project: bool) -> tuple[np.ndarray, ...]:
    """Return the momentum, the place and the velocity, which satisfies the constraint of a Lagrangian regular there.

    With `project` it is the admissible one closest to the value in the kinetic energy.
    """
    where = f"{owner}(body_velocity=...)"
    v = array(where, value, (system.dimension,), f"Pass the {system.dimension} velocities.")
    p, units, A, residual = _check_regular(system, q, v)
    if project:
        v = in_double(admissible_velocity, system, q, v)
        return momentum(system, q, v), q, v
    if not np.count_nonzero(residual):
        return p, q, v
    rounding = np.finfo(float).eps * np.linalg.norm(A * units, axis=1) * np.linalg.norm(v / units)  # of small terms
    if np.any(np.abs(residual) > _TOLERANCE * (np.abs(A) @ np.abs(v) + np.abs(A @ v - residual)) + rounding):
        raise inadmissible(where, residual, v - np.linalg.pinv(A) @ residual)
    return p, q, v


def _check_regular(system: Any, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return the momentum and what follows the matrix in `_kinetics`, of a Lagrangian that determines accelerations."""
    what = _argument(system, "discrete_lagrangian" if system.lagrangian is None else "lagrangian")
    value, *gradients, matrix, units, A, residual = _at(_kinetics, system, q, v)
    if not all(is_moderate(x, np.inf) for x in (value, *gradients)):
        number, *slopes = (x.tolist() for x in (value, *gradients))
        got = f"value {number}, gradients {slopes} at {q.tolist()}, velocity {v.tolist()}"
        raise error(what, "be finite and differentiable", got, "Start elsewhere, or smooth it with jnp.where.")
    least = np.linalg.svd(matrix, compute_uv=False)[-1]
    if not least > _DEGENERATE:
        got = f"least singular value {least:.3g} of the equations at {q.tolist()}, velocity {v.tolist()}"
        raise error(what, "determine the accelerations", got, "Give every admissible direction a kinetic energy.")
    if system.has_limit and np.any(v):  # a discrete Lagrangian is about h times the Lagrangian in short steps
        h, limit = _SMALL / np.linalg.norm(v), gradients[1]
        p = np.mean(_at(equations.momenta, system, q, v, h), axis=0)
        if not np.linalg.norm(p - limit) <= _CLOSE * np.linalg.norm(limit):
            got = f"momentum {p.tolist()} at the small step {h:.3g}, in the limit {limit.tolist()}"
            remedy = "Include the factor time_step; pass lagrangian= if it is not a quadratic form."
            raise error(_argument(system, "discrete_lagrangian"), "tend to time_step times the Lagrangian", got, remedy)
    return gradients[1], units, A, residual


def of_momentum(owner: str, system: Any, q: np.ndarray, value: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a checked momentum, the place and the admissible velocity that has its part along the constraint."""
    n = system.dimension
    where = f"{owner}(momentum=...)"
    p = array(where, value, (n,), f"Pass the {n} momenta; only their action on admissible velocities counts.")
    _check_regular(system, q, np.zeros(n))
    v = in_double(equations.inverse_legendre, system, q, p)
    _check_regular(system, q, v)
    return p, q, v


def velocity_of_displacement(system: Any, q: np.ndarray, value: Any, h: float) -> np.ndarray:
    """Return the velocity d/h of a displacement that satisfies the discrete constraint."""
    where = "simulate(displacement=...)"
    v = system.places.velocity(where, value, h)
    _check_regular(system, q, v)
    residual, slope = _at(_constraint_slope, system, q, v, h)
    if np.any(np.abs(residual) > _TOLERANCE * (np.abs(slope) @ np.abs(v) + np.abs(slope @ v - residual))):
        nearest = system.places.displacement(in_double(equations.corrected_velocity, system, h, q, v), h)
        got = f"residual {np.array2string(residual, precision=6)}"
        remedy = f"The nearest admissible displacement is {nearest.tolist()}."
        raise error(where, "satisfy the discrete constraint", got, remedy)
    return v


def regularity(system: Any, q: Any, q_next: Any, time_step: Any) -> float:
    """Return the least singular value of the scaled regularity matrix of a step."""
    owner, n = "regularity", system.dimension
    h = scale(f"{owner}(time_step=...)", time_step, "Pass a positive time step.")
    first = array(f"{owner}(q=...)", q, (n,), f"Pass the {n} coordinates.")
    second = array(f"{owner}(q_next=...)", q_next, (n,), f"Pass the {n} coordinates.")
    return float(in_double(orientation, system, place(system, first, 0.0), (second - first) / h, h)[1])


def _constraint_slope(system: Any, q: Array, v: Array, h: Array) -> tuple[Array, Array]:
    """Return the discrete constraints of a step and their derivatives along its velocity."""
    slope = jax.jacfwd(equations.discrete_constraints, argnums=2)(system, q, v, h)
    return equations.discrete_constraints(system, q, v, h), slope


def _kinetics(system: Any, q: Array, v: Array) -> tuple[Array, ...]:
    """Return L, its slopes, the second of which is the momentum, the scaled continuous equations, units, A, A v - b."""

    def of_velocity(v: Array) -> tuple[Array, tuple[Array, ...]]:
        value, (along_q, p) = jax.value_and_grad(equations.lagrangian, argnums=(1, 2))(system, q, v)
        return p, (value, along_q, p)

    kinetic, values = jax.jacfwd(of_velocity, has_aux=True)(v)
    matrix, units = equations.matrix_of_mass(system, q, kinetic)
    return *values, matrix, units.velocity, equations.forms(system, q), equations.constraint(system, q, v)


def _bend(system: Any, x: Array) -> Array:
    """Return the second derivatives of all constraints by each coordinate; zero but of holonomic ones."""
    return jnp.diagonal(jax.jacfwd(equations.forms, argnums=1)(system, x)[:, :, : system.dimension], axis1=1, axis2=2)


def momentum(system: Any, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return the momentum of a velocity."""
    return _at(_kinetics, system, q, v)[2]
