"""Runs of maps that are not compiled: which of them there are, and how each is run."""

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from nonholo.base.checks import error, needs, shown
from nonholo.discrete import Discretization, check_first_state, has_frame
from nonholo.orbit import Orbit
from nonholo.simulation.runs._by_rule import Run, run_by_rule
from nonholo.simulation.runs._first_state import FirstState
from nonholo.simulation.runs._options import RunOptions

Runner: TypeAlias = Callable[[int, int, bool], tuple[Orbit, int]]


def uncompiled_run(discrete: Discretization, start: FirstState, options: RunOptions) -> Runner:
    """Return what runs a map that is not compiled: from `steps`, `every`, `progress` to the orbit and the last step."""
    principal = options.rule.is_principal
    run = _principal_run(discrete, options) if principal else _rule_run(discrete, start, options)

    def orbit_of(steps: int, every: int, progress: bool) -> tuple[Orbit, int]:
        (momenta, charts, poses), outcome, done = run(start.reduced, start.pose, steps, every, progress)
        time, posed = discrete.time_step * (every * np.arange(len(momenta))), poses if options.reconstruct else None
        orbit = Orbit(discrete, time, momenta, charts, posed, outcome, every, branch=options.rule.name)
        if start.demanded is not None and len(orbit):
            check_first_state(start.demanded, orbit[:1].displacement[0], orbit[:1].momentum[0])
        return orbit, done

    return orbit_of


def _principal_run(discrete: Discretization, options: RunOptions) -> Run:
    route: Any = discrete.route
    if discrete.forces is not None:
        return route.run
    if options.backend == "numba":
        remedy = "Pass backend='jax', or difference='matrix'."
        raise error("simulate(backend=...)", "have a closed form of the step", shown(discrete.difference), remedy)
    with needs("jax", "simulate(...) of a step that is not compiled"):
        from nonholo.discrete.definition import run_by_definition, run_composed_by_definition

    run = run_composed_by_definition if discrete.order > 2 else run_by_definition
    return lambda *arguments: run(discrete, *arguments)


def _rule_run(discrete: Discretization, start: FirstState, options: RunOptions) -> Run:
    """Return the run by a rule, from the displacement or full momentum of the start if one is demanded."""
    where, rule, demanded = "simulate(backend=...)", options.rule, start.demanded
    if options.backend == "numba":
        got = f"the branch rule {rule.name!r}"
        raise error(where, "be 'auto' or 'jax'", got, "Only 'principal' runs compiled by numba.")
    if has_frame(discrete) and options.backend == "auto":
        return lambda *arguments: run_by_rule(discrete, rule, demanded, *arguments)
    if rule.needs_all_values:
        got = f"{shown(options.backend)} with branch {rule.name!r}"
        raise error(where, "be 'auto'", got, "Leave it out.")
    with needs("jax", "simulate(branch=...) of a step that is not compiled"):
        from nonholo.discrete.definition import run_by_definition

    chart = None
    if demanded is not None and demanded.ndim == 2:
        frame = discrete.system.frame
        chart = discrete.variety.coordinates(discrete.system.group.inverse(frame) @ demanded @ frame)
    return lambda *arguments: run_by_definition(discrete, *arguments, nearest=True, chart=chart)
