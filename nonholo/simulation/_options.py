"""The options of a run, checked, and what takes its steps."""

import dataclasses
from typing import Any

from nonholo.base.checks import choice, error, flags, shown, step_counts, within_memory
from nonholo.discrete import Discretization, as_discretization, refuse_composition
from nonholo.discrete.branching import BranchRule, RuleStepper, checked_rule, has_frame
from nonholo.orbit import AbstractStepper
from nonholo.simulation._crossings import watch_for
from nonholo.simulation._run import Run
from nonholo.systems import AbstractCoordinateDiscretization, refuse_in_coordinates, refuse_slip

FEW = 1 << 16  # numbers that fit into any memory


def check_forces(owner: str, discrete: Any, steps: int, *, free: str | None = None, in_jax: bool = False) -> None:
    """Refuse what runs with forces do not have, which `free` names, and more steps than their table has rows.

    Traced are numbers alone.
    """
    if (forced := discrete.forces) is None:
        return
    if free is not None:
        raise error(f"{owner}(discrete=...)", "have the principal branch under forces", free, "Leave both out.")
    if in_jax:
        refuse_slip(f"{owner}(discrete=...)", discrete.system)
    if in_jax and forced.needs_function:
        remedy = "Use Gravity, Friction or a table: what a function does is not traced."
        raise error(f"{owner}(discrete=...)", "have forces that are numbers", "a Python function", remedy)
    if forced.table is not None and steps > len(forced.table):
        remedy = "Pass fewer steps, or a force for each step."
        raise error(f"{owner}(steps=...)", "be at most one for each row of the forces", f"{steps}", remedy)


def checked_run(
    owner: str, discrete: Any, steps: Any, save_every: Any, branch: BranchRule, backend: str, events: Any, **how: bool
) -> Run:
    """Return a run with checked options, for any start; `how` are those that are True or False."""
    flags(owner, **how)
    (count, every), with_poses = step_counts(owner, steps, save_every), how["reconstruct"]
    stepper = stepper_of(discrete, branch, backend, with_poses=with_poses, owner=owner)
    if not isinstance(discrete, Discretization):
        others = {"branch": (branch, "principal"), "reconstruct": (with_poses, True), "backend": (backend, "auto")}
        refuse_in_coordinates(owner, **others)
    if discrete.forces is not None:
        check_forces(owner, discrete, count)
    watch = None if events is None else watch_for(owner, stepper, events)
    return Run(stepper, count, every, watch, how["throw"], how["progress"])


def stepper_of(
    discrete: Any, branch: BranchRule, backend: str, *, with_poses: bool, owner: str = "simulate"
) -> AbstractStepper[Any]:
    """Return what takes the steps of a run: the one place that asks for rule, backend and extra."""
    if not isinstance(discrete, Discretization) and isinstance(discrete, AbstractCoordinateDiscretization):
        return discrete.stepper(with_poses=True)
    as_discretization(f"{owner}(discrete=...)", discrete, compositions=True, forced=True)
    if isinstance(branch, str) and isinstance(backend, str) and (branch, backend) == ("principal", "auto"):
        return discrete.stepper(with_poses=with_poses)
    return _other_stepper(owner, discrete, branch, backend, with_poses=with_poses)


def _other_stepper(
    owner: str, discrete: Discretization, branch: BranchRule, backend: str, *, with_poses: bool
) -> AbstractStepper[Any]:
    rule = checked_rule(owner, discrete, branch)
    if not rule.is_principal:
        refuse_composition(f"{owner}(branch=...)", discrete, "Leave branch out: each substep takes the principal root.")
    choice(where := f"{owner}(backend=...)", backend, ("auto", "numba", "jax"))
    if not rule.is_principal or (backend == "jax" and discrete.is_balanced):
        check_forces(owner, discrete, 0, free=f"branch {rule.name!r} and backend {backend!r}")
    if rule.is_principal:
        return _principal(where, discrete, backend, with_poses=with_poses)
    if backend == "numba":
        got, remedy = f"the branch rule {rule.name!r}", "Only 'principal' runs compiled by numba."
        raise error(where, "be 'auto' or 'jax'", got, remedy)
    if has_frame(discrete) and backend == "auto":
        return RuleStepper(discrete, with_poses, rule)
    if not rule.is_nearest:
        raise error(where, "be 'auto'", f"{shown(backend)} with branch {rule.name!r}", "Leave it out.")
    return _by_definition(discrete, with_poses=with_poses, branch=rule.name)


def _principal(where: str, discrete: Discretization, backend: str, *, with_poses: bool) -> AbstractStepper[Any]:
    if backend == "jax":
        return _by_definition(discrete, with_poses=with_poses)
    if backend == "numba" and discrete.forces is None and discrete.route.compiled_route is None:
        remedy = "Pass backend='jax', or difference='matrix'."
        raise error(where, "have a closed form of the step", shown(discrete.difference), remedy)
    return discrete.stepper(with_poses=with_poses)


def _by_definition(discrete: Discretization, *, with_poses: bool, branch: str = "principal") -> AbstractStepper[Any]:
    by_definition = dataclasses.replace(discrete, wanted_route="definition")
    return by_definition.route.stepper(by_definition, with_poses=with_poses, branch=branch)


def refuse_too_large(owner: str, widths: tuple[int, ...], states: int) -> None:
    """Refuse more saved states, or larger poses, than memory holds; poses are the last of the widths."""
    *others, pose = 1, *widths
    what, remedy = ("reconstruct", "Pass reconstruct=False, raise") if pose > sum(others) else ("steps", "Raise")
    remedy += " save_every, or pass store=... (`simulate`) or reduce=... (`ensemble`)."
    within_memory(f"{owner}({what}=...)", 8.0 * states * (sum(others) + pose), remedy)


def refuse_many_matrices(where: str, discrete: Any, states: int, remedy: str, *, derivatives: int = 0) -> None:
    """Refuse more states in matrices, with derivatives of each, than memory holds."""
    numbers = 2 + discrete.system.rank + discrete.system.group.dim + 2 * discrete.system.group.size**2
    within_memory(where, 8.0 * states * numbers * (1 + derivatives), remedy)
