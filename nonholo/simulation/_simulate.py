"""`simulate`: an orbit of the discrete map, from a checked start to a decoded result."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, overload

import numpy as np

from nonholo._checks import error, flags, path, shown
from nonholo._results import finished
from nonholo.discrete import Discretization
from nonholo.discrete._branch_rules import AbstractBranchRule, BranchRule
from nonholo.discrete._start import check_first_state
from nonholo.orbit import Orbit
from nonholo.simulation.events import run_compiled, run_with_events, watched
from nonholo.simulation.runs import (
    CompiledRun,
    Run,
    Start,
    checked_counts,
    closed_step,
    compiled_run,
    composed_runner,
    first_state,
    refuse_too_large,
    refuse_too_long,
    rule_runner,
)
from nonholo.simulation.stores import refuse_without_store, run_into_store
from nonholo.systems._coordinate_system import AbstractCoordinateDiscretization, OrbitT, refuse_in_coordinates


@overload
def simulate(
    discrete: Discretization,
    *,
    steps: int,
    body_velocity: Any = None,
    restricted_velocity: Any = None,
    displacement: Any = None,
    momentum: Any = None,
    configuration: Any = None,
    save_every: int = 1,
    branch: BranchRule = "principal",
    reconstruct: bool = True,
    backend: str = "auto",
    events: Any = None,
    throw: bool = True,
    progress: bool = False,
    store: str | Path | None = None,
    checkpoint_every: int | None = None,
    scenario: str | None = None,
) -> Orbit: ...
@overload
def simulate(
    discrete: AbstractCoordinateDiscretization[OrbitT],
    *,
    steps: int,
    configuration: Any,
    body_velocity: Any = None,
    displacement: Any = None,
    momentum: Any = None,
    save_every: int = 1,
    throw: bool = True,
    progress: bool = False,
) -> OrbitT: ...
def simulate(
    discrete: Discretization | AbstractCoordinateDiscretization,
    *,
    steps: int,
    body_velocity: Any = None,
    restricted_velocity: Any = None,
    displacement: Any = None,
    momentum: Any = None,
    configuration: Any = None,
    save_every: int = 1,
    branch: BranchRule = "principal",
    reconstruct: bool = True,
    backend: str = "auto",
    events: Any = None,
    throw: bool = True,
    progress: bool = False,
    store: str | Path | None = None,
    checkpoint_every: int | None = None,
    scenario: str | None = None,
) -> Any:
    r"""Run the discrete Euler-Poincare-Suslov map.

    $$ P(W_{k+1})|_{\mathfrak{d}} = (\mathrm{Ad}^*_{W_k} P(W_k))|_{\mathfrak{d}}, \qquad g_{k+1} = g_k W_k. $$

    The map is multivalued. The principal root is the one that momentum zero reaches along s r, 0 <= s <= 1; each root
    is verified to be it, since energy cannot tell (every root conserves it).

    Branch rules. "nearest" is the root reached from the present W by continuation of the right-hand side along the
    segment from $P(W)|_d$ to $(Ad^*_W P(W))|_d$: started with a `displacement` off the principal branch, this is how
    one goes on there. Every system with a left-invariant constraint has it. Of tops and sleighs with difference
    "matrix" all values are known: "smallest" and "largest" take the real one with that norm of the full momentum,
    "inner" and "outer" the one in that part of the invariant curve (n = 3 and det B > 2|c|^2, below the saddle's
    energy; of three there the nearest). A function `rule(found, present)` gets the `Branches` and the present W,
    and returns the index of a real one or None. A tie and a double root are `branch_unverified`.

    A discretised `LagrangeDAlembert` runs the map of its `CoordinateDiscretization.simulate`. It starts at a
    `configuration`, its q_0, and takes neither `restricted_velocity` nor `branch`, `reconstruct` and `backend`.

    Reference: [fedorov-zenkov-2004], equation (disc.momentum.eqn).

    Args:
        discrete: The discretised system.
        steps: Number of steps N; unthinned orbits have N + 1 states.
        body_velocity: Start with the principal W_0 that has the same momentum along the constraint (second order).
        restricted_velocity: The same, in rows of the constraint subspace.
        displacement: Start with this W_0, on the displacement variety; with branch "principal" on that branch. Not
            for compositions (order > 2), whose state is the restricted momentum.
        momentum: Start with this momentum, full (on the momentum locus) or along the constraint subspace.
        configuration: First pose, a matrix of the group; the identity by default.
        save_every: Keep every so many steps.
        branch: Which value of the map a step takes: "principal", "nearest", "smallest", "largest", "inner", "outer" or
            a function; see above. A velocity or restricted momentum starts at the principal W_0 with every rule.
        reconstruct: Also compute poses.
        backend: "numba" (closed forms, compiled), "jax" (the definition), or "auto" to choose.
        events: `Event`s, or functions of an orbit, whose changes of sign are found at every single step and located
            to rounding; see `Orbit.events`. A stopping event ends the run with the last saved state before it.
        throw: Raise if the run cannot go on; otherwise return the good steps and the outcome.
        progress: Show a progress bar on standard error.
        store: A new path. The saved states of a compiled run, and the crossings of its events, go there block by block,
            in bounded memory; `resume` and `extend` go on with it. An orbit that would fill 1 GiB is not returned whole
            but as its last block.
        checkpoint_every: Steps between two checkpoints of the store, a multiple of `save_every`; by default blocks of a
            few megabytes. A run that is stopped loses at most so many steps.
        scenario: A text that says how the orbit is made, kept in the store.

    Returns:
        The orbit; of a system in coordinates a `nonholo.lagrange_dalembert.CoordinateOrbit`.

    Raises:
        ValueError: A bad argument, before any work.
        FileExistsError: There is something at the path `store`.
        OSError: The disk is full; the store stays valid, and `resume` goes on.
        OutcomeError: The start is not on the principal branch, or, with `throw`, the run could not go on; then the
            error's `orbit` holds every good step.

    Example:
        >>> top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
        >>> orbit = nh.simulate(nh.discretize(top, 0.1), body_velocity=(0.4, 0.9, 0.0), steps=1000)
        >>> float(np.ptp(orbit.energy)) < 1e-14
        True
    """
    flags("simulate", reconstruct=reconstruct, throw=throw, progress=progress)
    starts = {"body_velocity": body_velocity, "displacement": displacement, "momentum": momentum}
    if isinstance(discrete, AbstractCoordinateDiscretization):
        refuse_in_coordinates(
            "simulate",
            restricted_velocity=(restricted_velocity, None),
            branch=(branch, "principal"),
            reconstruct=(reconstruct, True),
            backend=(backend, "auto"),
            events=(events, None),
            store=(store, None),
            checkpoint_every=(checkpoint_every, None),
            scenario=(scenario, None),
        )
        options = {"save_every": save_every, "throw": throw, "progress": progress}
        return discrete.simulate(configuration=configuration, steps=steps, **starts, **options)
    steps, every, rule = checked_counts(discrete, steps, save_every, branch, backend, displacement)
    starts["restricted_velocity"] = restricted_velocity
    closed = closed_step(discrete, rule, backend)
    refuse_too_long("simulate", discrete, steps, compiled=closed is not None)
    watch = None if events is None else watched("simulate", discrete, events, rule.name, reconstruct)
    kept = {"checkpoint_every": checkpoint_every, "scenario": scenario}
    if store is not None:
        store = path("simulate(store=...)", store)
        stored = compiled_run("simulate(store=...)", discrete, closed, every, reconstruct)
        refuse_too_large("simulate", discrete, 1, reconstruct)
        start = first_state(discrete, configuration, int(reconstruct), True, starts)
        return run_into_store(stored, start, steps, store, watch, **kept, throw=throw, progress=progress)
    refuse_without_store(**kept)
    if watch is None:  # an event may stop it long before
        refuse_too_large("simulate", discrete, 1 + steps // every, reconstruct)
    held = 1 + steps // every if reconstruct else 0
    start = first_state(discrete, configuration, held, closed is not None, starts)
    if closed is not None:
        going = CompiledRun(discrete, closed, every, reconstruct)
        return run_compiled(going, start, watch, steps, throw=throw, progress=progress)
    run = _uncompiled(discrete, start, rule, backend, reconstruct)
    orbit, done = run(steps, every, progress) if watch is None else run_with_events(run, watch, steps, every, progress)
    if start.demanded is not None and len(orbit):
        check_first_state(start.demanded, orbit[:1].displacement[0], orbit[:1].momentum[0])
    return finished(orbit, float(discrete.time_step), done, steps, throw)


def _uncompiled(
    discrete: Discretization, start: Start, rule: AbstractBranchRule, backend: str, reconstruct: bool
) -> Callable[[int, int, bool], tuple[Orbit, int]]:
    """Return what runs a map that is not compiled: from `steps`, `every`, `progress` to the orbit and the last step."""
    reduced, pose, demanded = start
    run = _by_definition(discrete, backend) if rule.is_principal else rule_runner(discrete, rule, backend, demanded)

    def orbit_of(steps: int, every: int, progress: bool) -> tuple[Orbit, int]:
        (momenta, charts, poses), outcome, done = run(reduced, pose, steps, every, progress)
        time, kept = discrete.time_step * (every * np.arange(len(momenta))), poses if reconstruct else None
        return Orbit(discrete, time, momenta, charts, kept, outcome, every, branch=rule.name), done

    return orbit_of


def _by_definition(discrete: Discretization, backend: str) -> Run:
    if backend == "numba":
        remedy = "Pass backend='jax', or difference='matrix'."
        raise error("simulate(backend=...)", "have a closed form of the step", shown(discrete.difference), remedy)
    from nonholo.discrete._definition import run_by_definition

    if discrete.order > 2:
        return composed_runner(discrete)
    return lambda *arguments: run_by_definition(discrete, *arguments)
