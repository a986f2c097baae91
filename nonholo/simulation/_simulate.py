"""`simulate`: an orbit of the discrete map, from a checked start to a decoded result."""

import functools
from pathlib import Path
from typing import Any, overload

from nonholo.base.checks import flags, path, refuse_given, step_counts
from nonholo.base.results import finished
from nonholo.discrete import BranchRule, Discretization
from nonholo.orbit import Orbit
from nonholo.simulation.events import Watch, run_compiled, run_with_events, simulated, watched
from nonholo.simulation.runs import (
    CompiledRun,
    RunOptions,
    closed_step,
    compiled_run,
    first_state,
    opened,
    refuse_too_large,
    refuse_too_long,
    uncompiled_run,
)
from nonholo.simulation.stores import refuse_without_store, run_into_store
from nonholo.systems import AbstractCoordinateDiscretization, OrbitT, Start, in_coordinates, refuse_in_coordinates

_DEFAULTS = {"branch": "principal", "reconstruct": True, "backend": "auto"}  # of what a system in coordinates lacks


def refuse_what_bodies_have(owner: str, **given: Any) -> None:
    """Refuse what runs of systems in coordinates do not have, unless it is the default."""
    refuse_in_coordinates(owner, **{name: (value, _DEFAULTS.get(name)) for name, value in given.items()})


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
    events: Any = None,
    throw: bool = True,
    progress: bool = False,
    store: str | Path | None = None,
    checkpoint_every: int | None = None,
    scenario: str | None = None,
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
    one continues there. Every system with a left-invariant constraint has it. Of tops and sleighs with difference
    "matrix" all values are known: "smallest" and "largest" take the real one with that norm of the full momentum,
    "inner" and "outer" the one in that part of the invariant curve (n = 3 and det B > 2|c|^2, below the saddle's
    energy; of three there the nearest). A function `rule(found, present)` gets the `Branches` and the present W,
    and returns the index of a real one or None. A tie and a double root are `branch_unverified`.

    A discretized `LagrangeDAlembert` runs the map of its `CoordinateDiscretization.simulate`. It starts at a
    `configuration`, its q_0, and takes neither `restricted_velocity` nor `branch`, `reconstruct` and `backend`.

    Reference: [fedorov-zenkov-2004], equation (disc.momentum.eqn).

    Args:
        discrete: The discretized system.
        steps: Number of steps N; unthinned orbits have N + 1 states.
        body_velocity: Start with the principal W_0 that has the same momentum along the constraint (second order).
        restricted_velocity: The same, in rows of the constraint subspace.
        displacement: Start with this W_0, on the displacement variety; with branch "principal" on that branch. Not
            for compositions (order > 2), whose state is the restricted momentum.
        momentum: Start with this momentum, full (on the momentum locus) or along the constraint subspace.
        configuration: First pose, a matrix of the group; the identity by default.
        save_every: Steps between saved states.
        branch: Which value of the map a step takes: "principal", "nearest", "smallest", "largest", "inner", "outer" or
            a function; see above. A velocity or restricted momentum starts at the principal W_0 with every rule.
        reconstruct: Also compute poses.
        backend: "numba" (closed forms, compiled), "jax" (the definition), or "auto" to choose.
        events: `Event`s, or functions of an orbit, whose changes of sign are found at every single step and located
            to rounding; see `Orbit.events`. A stopping event ends the run with the last saved state before it.
        throw: Raise if the run cannot continue; otherwise return the good steps and the outcome.
        progress: Show a progress bar on standard error.
        store: A new path. The saved states of a run that is compiled or in coordinates, and the crossings of its
            events, go there block by block, in bounded memory; `resume` and `extend` continue it. An orbit that would
            fill 1 GiB is not returned whole but as its last block.
        checkpoint_every: Steps between two checkpoints of the store, a multiple of `save_every`; by default blocks of a
            few megabytes. A run that is stopped loses at most this many steps.
        scenario: A text that says how the orbit is made, kept in the store.

    Returns:
        The orbit; of a system in coordinates a `nonholo.lagrange_dalembert.CoordinateOrbit`.

    Raises:
        ValueError: A bad argument, before any work.
        FileExistsError: There is something at the path `store`.
        OSError: The disk is full; the store stays valid, and `resume` continues.
        OutcomeError: The start is not on the principal branch, or, with `throw`, the run could not continue; then the
            error's `orbit` holds every good step.

    Example:
        >>> top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
        >>> orbit = nh.simulate(nh.discretize(top, 0.1), body_velocity=(0.4, 0.9, 0.0), steps=1000)
        >>> float(np.ptp(orbit.energy)) < 1e-14
        True
    """
    flags("simulate", reconstruct=reconstruct, throw=throw, progress=progress)
    starts = {"body_velocity": body_velocity, "displacement": displacement, "momentum": momentum}
    common = {"steps": steps, "save_every": save_every, "throw": throw, "progress": progress}
    how = {"branch": branch, "reconstruct": reconstruct, "backend": backend}
    kept = {"store": store, "checkpoint_every": checkpoint_every, "scenario": scenario}
    if in_coordinates(discrete):
        refuse_what_bodies_have("simulate", restricted_velocity=restricted_velocity, **how)
        return _run_in_coordinates(discrete, {"configuration": configuration, **starts}, common, events, kept)
    options = RunOptions.of(discrete, **common, **how)
    start = Start.of("simulate", configuration, **starts, restricted_velocity=restricted_velocity)
    closed = closed_step(discrete, options.rule, options.backend)
    refuse_too_long("simulate", discrete, options.steps, compiled=closed is not None)
    watch = None if events is None else watched("simulate", discrete, events, options.rule.name, options.reconstruct)
    return (_run_in_memory if store is None else _run_into_store)(discrete, start, options, watch, **kept)


def _run_in_coordinates(
    discrete: AbstractCoordinateDiscretization,
    start: dict[str, Any],
    common: dict[str, Any],
    events: Any,
    kept: dict[str, Any],
) -> Any:
    if kept["store"] is None:
        refuse_without_store(**kept)
        return simulated(discrete, events, **start, **common)
    remedy = "Run in memory with events, or into a store without."
    refuse_given("simulate", "be left out of a stored run in coordinates", remedy, events=(events, None))
    steps, every = step_counts(common["steps"], common["save_every"])
    store, throw = path("simulate(store=...)", kept.pop("store")), common["throw"]
    run = discrete.run(every)
    how = {"throw": throw, "progress": common["progress"], **kept}
    return run_into_store(run, lambda: run.opened(discrete.start(**start), steps, throw), steps, store, None, **how)


def _run_into_store(
    discrete: Discretization, start: Start, options: RunOptions, watch: Watch | None, store: Any, **kept: Any
) -> Orbit:
    store, posed = path("simulate(store=...)", store), options.reconstruct
    closed = closed_step(discrete, options.rule, options.backend)
    run = compiled_run("simulate(store=...)", discrete, closed, options.every, posed)
    refuse_too_large("simulate", discrete, 1, posed)
    first = first_state(discrete, start, posed=posed, compiled=True)
    begin = functools.partial(opened, run, first, options.steps, options.throw)
    how = {"throw": options.throw, "progress": options.progress, **kept}
    return run_into_store(run, begin, options.steps, store, watch, **how)


def _run_in_memory(
    discrete: Discretization, start: Start, options: RunOptions, watch: Watch | None, **kept: Any
) -> Orbit:
    refuse_without_store(**kept)
    closed = closed_step(discrete, options.rule, options.backend)
    steps, every, posed, throw = options.steps, options.every, options.reconstruct, options.throw
    if watch is None:  # an event may stop it long before
        refuse_too_large("simulate", discrete, 1 + steps // every, posed)
    first = first_state(discrete, start, posed=posed, compiled=closed is not None)
    if closed is not None:
        run = CompiledRun(discrete, closed, every, posed)
        return run_compiled(run, first, watch, steps, throw=throw, progress=options.progress)
    slow, counts = uncompiled_run(discrete, first, options), (steps, every, options.progress)
    orbit, done = slow(*counts) if watch is None else run_with_events(slow, watch, *counts)
    return finished(orbit, float(discrete.time_step), done, steps, throw)
