r"""Solvers of flows: of one motion the solver that its method names, of many their series side by side.

Series serve where the constraint is in the body and forces are linear. diffrax loads slowly: on first use.

Momenta of tops and sleighs without poses take O(n) operations a Taylor coefficient. In the principal axes of B, with
$D = B + ma_1^2$, $\pi = Dw$ and $p_1 = mu$ (`NormalForm`), the momenta along the rows of the form are
$(\pi + \alpha p_1, p_1)$. The kernel's numbers are $\pi/\sqrt D$ and $p_1/\sqrt m$.
"""

import functools
from collections.abc import Callable
from typing import cast

import numpy as np

from nonholo.base.checks import choice, error, needs
from nonholo.base.numerics import applied
from nonholo.base.results import Outcome
from nonholo.base.types import Bool, Float, Int
from nonholo.continuous import _series
from nonholo.continuous._closed_form import closed_form
from nonholo.continuous._forced import has_series_under, heads, quadratic_under, under_forces
from nonholo.continuous._series import GUARD, Problem, Solved, States, power_of_two
from nonholo.kernels import Arrowhead, solve_arrowhead, solve_members
from nonholo.orbit import looked_at, turned_near
from nonholo.systems import AbstractSystem, NormalForm, System


def momenta_by_series(system: AbstractSystem, problem: Problem) -> Solved:
    """Solve for the momenta of a top or sleigh, without its pose."""
    form, elapsed, tolerance = cast(NormalForm, system.normal_form), problem.elapsed, problem.tolerances[0] * GUARD
    f, x = arrowhead(form)[0], encode(form, problem.momentum)
    unit = power_of_two(np.append(np.sqrt(f.rates) * x, f.rates.max() * (f.coupling @ x)))
    start, end = np.zeros((2, len(x) + 1)), float(elapsed[-1]) * unit
    start[0, :-1] = x / unit
    rows, nodes = solve_arrowhead(f, start, elapsed[1:] * unit, end, tolerance)
    outcome = Outcome.successful if len(rows) == len(elapsed) - 1 else Outcome.not_converged
    states = States(decode(form, np.vstack([start[0, :-1], rows]) * unit), None, None)
    at = functools.partial(_between, form, nodes, unit, end, tolerance)
    ends = [*(node[0, -1] for node in nodes), end]
    return Solved(states, outcome, at, functools.partial(looked_at, ends, unit))


def _between(
    form: NormalForm, nodes: list[np.ndarray], unit: float, end: float, tolerance: float, elapsed: np.ndarray
) -> States:
    """Return the states at times since the start, in the order of the solve, from the nodes before them."""
    f, times, begins = arrowhead(form)[0], elapsed * unit, np.array([node[0, -1] for node in nodes])
    backward = np.copysign(1.0, end)
    after = np.maximum(np.searchsorted(backward * begins, backward * times) - 1, 0)
    parts = (solve_arrowhead(f, nodes[node], times[after == node], end, tolerance)[0] for node in np.unique(after))
    return States(decode(form, np.concatenate([np.empty((0, len(f.rates))), *parts]) * unit), None, None)


def arrowhead(form: NormalForm) -> tuple[Arrowhead, Float[np.ndarray, "k"]]:
    r"""Return the equations that the kernel solves, and the units $\sqrt D$, of a sleigh then $\sqrt m$."""
    b, c = form.principal[0], form.to_principal(form.coupling)
    if not form.is_sleigh:
        return Arrowhead(1 / b, c / np.sqrt(b)), np.sqrt(b)
    D, slide = b + form.mass * form.arm**2, np.sqrt(form.mass)
    f = Arrowhead(np.append(1 / D, 0.0), np.append(c / np.sqrt(D), -form.arm * slide))
    return f, np.append(np.sqrt(D), slide)


def encode(form: NormalForm, momentum: Float[np.ndarray, "k"]) -> Float[np.ndarray, "k"]:
    """Return the numbers of the kernel from canonical momenta."""
    r = momentum if form.frame_map is None else form.frame_map @ momentum
    return form.to_principal(form.turned_about(r, -1.0)) / arrowhead(form)[1]


def decode(form: NormalForm, rows: Float[np.ndarray, "K k"]) -> Float[np.ndarray, "K k"]:
    """Return canonical momenta from the numbers of the kernel."""
    momenta = form.turned_about(form.from_principal(rows * arrowhead(form)[1]), 1.0)
    return momenta if form.frame_map is None else applied(np.linalg.inv(form.frame_map), momenta)


def has_series(system: AbstractSystem, span: float) -> bool:
    """Return whether flows of a system over a time can be solved side by side.

    Example:
        >>> [has_series(each, 9.0) for each in (nh.ChaplyginSleigh(1.0, 1.0, 0.5), nh.VeselovaTop(np.eye(3)))]
        [True, False]
    """
    is_linear = system.forces is None or has_series_under(system.forces, span)
    return not system.is_spatial and _series.has_compact_rates(system.group) and is_linear


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
    group, S, k = system.group, system.canonical.constraint_subspace, momenta.shape[1]
    velocities, torques, sizes = _series.body_numbers(group, S, inertias)
    if len(inertias) == 1:  # its equations are known
        f = _series.quadratic(system.canonical) if system.forces is None else quadratic_under(system.forces)
        velocities, factors = f.velocities[None], f.factors
    else:
        is_nonzero = (torques != 0).any(axis=0)
        f = _series.body_equations(group, S, velocities[0], is_nonzero.astype(np.float64))
        own = np.moveaxis(torques, -1, 1)[:, np.moveaxis(is_nonzero, -1, 0)]  # row by row of the equations
        factors = np.hstack([np.tile(f.factors[0, : f.factors.size - own.shape[1]], (len(own), 1)), own])
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
