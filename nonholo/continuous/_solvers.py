"""Solvers of flows: of one motion the solver that its method names, of many their series side by side.

Series serve where the constraint is in the body and forces are linear. diffrax loads slowly: on first use.
"""

import functools
from collections.abc import Callable

import numpy as np

from nonholo.base.checks import choice, error, needs
from nonholo.base.types import Bool, Float, Int
from nonholo.continuous import _series
from nonholo.continuous._arrowhead import momenta_by_series
from nonholo.continuous._closed_form import closed_form
from nonholo.continuous._forced import has_series_under, heads, quadratic_under, under_forces
from nonholo.continuous._series import Problem, Solved, States
from nonholo.kernels import Quadratic, solve_members
from nonholo.orbit import turned_near
from nonholo.systems import AbstractSystem, System


def has_series(system: AbstractSystem, span: float) -> bool:
    """Return whether flows of a system over a time can be solved side by side.

    Example:
        >>> [has_series(each, 9.0) for each in (nh.ChaplyginSleigh(1.0, 1.0, 0.5), nh.VeselovaTop(np.eye(3)))]
        [True, False]
    """
    is_linear = system.forces is None or has_series_under(system.forces, span)
    return not system.is_spatial and _series.has_compact_rates(system.group) and is_linear


def _equations(
    system: AbstractSystem, inertias: Float[np.ndarray, "m dim dim"]
) -> tuple[Quadratic, Float[np.ndarray, "m k k"], Float[np.ndarray, "m Q"], Float[np.ndarray, "m k"]]:
    """Return the equations of members, and their velocities, factors and units of momenta; those of one are known."""
    group, S = system.group, system.canonical.constraint_subspace
    velocities, torques, sizes = _series.body_numbers(group, S, inertias)
    if len(inertias) == 1:
        f = _series.quadratic(system.canonical) if system.forces is None else quadratic_under(system.forces)
        return f, f.velocities[None], f.factors, sizes
    is_nonzero = (torques != 0).any(axis=0)
    f = _series.body_equations(group, S, velocities[0], is_nonzero.astype(np.float64))
    own = np.moveaxis(torques, -1, 1)[:, np.moveaxis(is_nonzero, -1, 0)]  # row by row of the equations
    factors = np.hstack([np.tile(f.factors[0, : f.factors.size - own.shape[1]], (len(own), 1)), own])
    return f, velocities, factors, sizes


def members_by_series(
    system: AbstractSystem,
    inertias: Float[np.ndarray, "m dim dim"],
    momenta: Float[np.ndarray, "M k"],
    poses: Float[np.ndarray, "M size"],
    elapsed: Float[np.ndarray, "K"],
    tolerance: float,
    stop: Bool[np.ndarray, "1"],
) -> tuple[States, Int[np.ndarray, "M"]]:
    """Return the states of members at times since the start, NaN where there is none, and how many each has.

    Args:
        system: A system that has series; those of the members differ from it in numbers only.
        inertias: Their inertia operators, or with an axis of length 1 that of all, as under forces.
        momenta: First momenta.
        poses: First poses.
        elapsed: Times since the start.
        tolerance: Relative error of a step.
        stop: Ends the work when it becomes true.
    """
    group, k = system.group, momenta.shape[1]
    f, velocities, factors, sizes = _equations(system, inertias)
    if system.forces is None:
        head = momenta / sizes
        units = _series.power_of_two((velocities @ head[..., None])[..., 0] * sizes)
        head = head / units[:, None]
    else:
        head, units = heads(system.forces, momenta, poses)
    parts, numbers = (poses, _series.first_heading(group, poses), head), (velocities, factors)
    limits = (elapsed, units), tolerance * _series.GUARD
    (path, angles, heads_after), counts = solve_members(f, numbers, parts, *limits, stop)
    for rows in (path, angles, heads_after):  # the first time that is not reached may have numbers that overflowed
        rows[np.arange(len(elapsed)) >= counts[:, None]] = np.nan
    path = group.normalize_pose(path)
    headings = turned_near(angles[..., 0], path) if group == _series.PLANE else None
    return States(heads_after[..., :k] * units[:, None, None] * sizes[:, None], path, headings), counts


Solver = Callable[[Problem], Solved]


def solver_of(system: System, method: str | None, begins: float, *, reconstruct: bool) -> tuple[Solver, bool]:
    """Return what solves the equations from a time on, and whether with poses; refuse an unknown method."""
    choice("flow(method=...)", method, (None, "closed_form", "diffrax"))
    if system.forces is not None:
        if method is not None:
            remedy = "Leave it out: the forces decide it."
            raise error("flow(method=...)", "be None under forces", repr(method), remedy)
        return functools.partial(under_forces, system.forces, begins), True
    alone = not reconstruct and method is None and system.canonical.normal_form is not None
    return functools.partial(momenta_by_series if alone else _solver_named(method), system.canonical), not alone


def _solver_named(method: str | None) -> Callable[..., Solved]:
    if method != "diffrax":
        return _series.by_series if method is None else closed_form
    with needs("jax", "flow(method='diffrax')"):
        from nonholo.continuous._integration_jax import integrate_by_diffrax

    return integrate_by_diffrax
