"""`ensemble`: many motions at once, from checked starts and parameters to decoded results or a user's reduction."""

import functools
from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeAlias

import numpy as np

from nonholo.base.calls import called
from nonholo.base.checks import choice, count, error, flags, function, refuse_given, shown
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome
from nonholo.discrete import Discretization, as_discretization
from nonholo.simulation._options import check_forces, refuse_too_large
from nonholo.simulation.events import Event, watched
from nonholo.simulation.members._events import joined_blocks, watched_block
from nonholo.simulation.members._families import check_systems
from nonholo.simulation.members._flows import ensemble_of_flows
from nonholo.simulation.members._in_coordinates import ensemble_in_coordinates
from nonholo.simulation.members._members import Members, checked_parameters
from nonholo.simulation.members._reduce import Reduced, joined
from nonholo.simulation.members._result import Ensemble
from nonholo.simulation.members._run import Plan, Report, counting, run_members, states_of
from nonholo.simulation.members._start import are_others, checked_rows, first_momenta
from nonholo.systems import (
    AbstractCoordinateDiscretization,
    AbstractSystem,
    Start,
    System,
    in_coordinates,
    refuse_in_coordinates,
)

Watched: TypeAlias = dict[str, Event] | None
Motions: TypeAlias = tuple[Members, np.ndarray, np.ndarray | None]

_DEFAULTS = {"backend": "auto", "reconstruct": True}
_KINDS = "A discretization has steps, a system times and rtol."
_BLOCK = 1 << 23  # numbers in a block of members that is reduced, 64 MiB


def ensemble(
    discrete: Discretization | System | AbstractCoordinateDiscretization,
    *,
    steps: int | None = None,
    times: Any = None,
    configuration: Any = None,
    body_velocity: Any = None,
    restricted_velocity: Any = None,
    displacement: Any = None,
    momentum: Any = None,
    save_every: int | None = None,
    parameters: Mapping[str, Any] | None = None,
    reduce: Callable[[Ensemble], Reduced] | None = None,
    reconstruct: bool = True,
    backend: str = "auto",
    events: Any = None,
    rtol: float | None = None,
    progress: bool = False,
) -> Any:
    r"""Run or solve many members of one system, that differ in where they start, in parameters, or in both.

    Each member takes the steps that `simulate` would take from its start, on the principal branch and verified; what
    becomes of it does not depend on the others. Tops with n = 3 and plane sleighs run in compiled blocks of 32 members,
    other systems one after another. All cores are used (`NUMBA_NUM_THREADS` sets how many), with the same result.

    Of a system in place of a discretization the flows are solved, by the series of `flow`: from one canonical momentum
    each has the bits of a flow alone.

    Systems in coordinates run one member after another, in one thread: each has the bits of its run by `simulate`. All
    of `configuration` and of the start may come as one row for each member, or once for all.

    A member that cannot continue keeps its good states: see `Ensemble` for what is where, and `outcome` for why.

    Args:
        discrete: The discretized system, or a system whose flow is asked for.
        steps: Number of steps N.
        times: Of a system instead: the times of the states, as in `flow`.
        configuration: In coordinates where members start, (M, n) or (n,); on a group of a `GroupLagrangeDAlembert`
            matrices. Other members start at the identity.
        body_velocity: One row for each member, (M, dim); with `parameters` one row for all, (dim,), will do. Members
            start at the identity with the principal W_0 that has the same momentum along the constraint.
        restricted_velocity: The same, in rows of the constraint subspace, (M, k).
        displacement: In coordinates start with these displacements.
        momentum: Start with these momenta, full ones (M, dim) on the momentum locus or those along the constraint
            subspace, (M, k). A member whose full momentum is not on it has outcome `off_momentum_locus`.
        save_every: Steps between saved states, the first one included; by default only the last state is kept.
        parameters: Arrays with a leading member axis by name: fields of the system that are numbers or tensors (mass,
            inertia, a, b, mass_tensor, ...), and "time_step". In coordinates "time_step" alone: compiled functions
            have their constants within.
        reduce: A function of an `Ensemble`, a block of the members in order, that returns an array or a dictionary of
            arrays with a leading member axis. It is called block by block, so that states are never all in memory.
        reconstruct: Also compute poses.
        backend: "numba" (closed forms, compiled), "jax", or "auto" to choose. By JAX tops with n = 3 and plane sleighs
            run in chunks on processors and all at once on accelerators, other systems by the definition.
        events: `Event`s, or functions, whose changes of sign are found at every single step of each member; see
            `Ensemble.events`. A function sees an `Orbit`: the states of many members one after another, or those of
            one member where parameters differ. A member that an event stops has no states after that.
        rtol: Of a system: the relative error of a step, as in `flow`.
        progress: Show a progress bar on standard error.

    Returns:
        The `Ensemble`, of flows a `FlowEnsemble`, in coordinates a `CoordinateEnsemble`; with `reduce` what it gave,
        blocks joined along the member axis.

    Raises:
        ValueError: A bad argument, before any work.

    Example:
        Sleighs with the center of mass ahead of the blade by different lengths, all pushed backwards, turn round:

        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), time_step=0.05)
        >>> batch = nh.ensemble(
        ...     sleigh, body_velocity=(0.01, -1.0, 0.0), parameters={"a": [0.2, 0.5, 1.0]}, steps=4000
        ... )
        >>> batch.restricted_momentum[:, 0, 1].round(3)
        array([1., 1., 1.])
    """
    flags("ensemble", reconstruct=reconstruct, progress=progress)
    if reduce is not None:
        function("ensemble(reduce=...)", reduce)
        reduce = functools.partial(called, "ensemble(reduce=...)", reduce)
    starts = {"body_velocity": body_velocity, "restricted_velocity": restricted_velocity, "momentum": momentum}
    run = {"parameters": parameters, "reduce": reduce, "progress": progress}
    of_steps = {"steps": steps, "save_every": save_every, "events": events}
    how, of_flow = {"backend": backend, "reconstruct": reconstruct}, {"times": times, "rtol": rtol}
    own = {"configuration": configuration, "displacement": displacement}
    if in_coordinates(discrete):
        absent = how | of_flow | {"restricted_velocity": starts.pop("restricted_velocity")}
        refuse_in_coordinates("ensemble", **{name: (value, _DEFAULTS.get(name)) for name, value in absent.items()})
        return ensemble_in_coordinates(discrete, **starts, **own, **of_steps, **run)
    _refuse("for bodies", "Members start at the identity.", **own)
    if isinstance(discrete, AbstractSystem):
        _refuse("for a flow", _KINDS, **of_steps, **how)
        return ensemble_of_flows(discrete, Start.of("ensemble", **starts), times, rtol, **run)
    _refuse("for a discretization", _KINDS, **of_flow)
    discrete = as_discretization("ensemble(discrete=...)", discrete, composed=True, forced=True)
    return _of_steps(discrete, Start.of("ensemble", **starts), **of_steps, **how, **run)


def _refuse(what: str, remedy: str, **given: Any) -> None:
    """Refuse arguments of another kind of ensemble, unless they are what they are by default."""
    refuse_given("ensemble", f"be left out {what}", remedy, **{n: (x, _DEFAULTS.get(n)) for n, x in given.items()})


def _of_steps(
    discrete: Discretization,
    start: Start,
    *,
    steps: Any,
    save_every: Any,
    events: Any,
    backend: str,
    reconstruct: bool,
    parameters: Any,
    reduce: Callable[[Ensemble], Any] | None,
    progress: bool,
) -> Any:
    """Run many members of a discretized body."""
    steps = count("ensemble(steps=...)", steps, "Pass the number of steps.")
    if save_every is not None:
        save_every = count("ensemble(save_every=...)", save_every, "Pass the steps between saved states, or None.")
    _check_backend(discrete, backend)
    check_forces("ensemble", discrete, steps, free="backend 'jax'" if backend == "jax" else None)
    plan = Plan(steps, save_every, bool(reconstruct), backend)
    motions = _motions(discrete, start, parameters, plan, whole=reduce is None)
    watch = watched("ensemble", discrete.stepper(posed=plan.posed), events)
    wanted = None if watch is None else watch.events
    with progress_bar("members", progress) as show:
        return _joined(motions, plan, wanted, reduce, counting(show, len(motions[0])))


def _joined(
    motions: Motions, plan: Plan, watched: Watched, reduce: Callable[[Ensemble], Any] | None, report: Report
) -> Any:
    """Run all members, block by block where only what is found of them is kept, and join that."""
    if reduce is not None:
        return joined(len(motions[0]), _blocks(*motions, plan, watched, reduce, report))
    if watched is None:
        return _block(*motions, plan, watched, report)
    blocks = _blocks(*motions, plan, watched, lambda block: block, report)
    return joined_blocks(motions[0], [block for _, block in blocks])


def _motions(discrete: Discretization, start: Start, parameters: Any, plan: Plan, *, whole: bool) -> Motions:
    """Return checked members, their first momenta along the constraint, and full ones that they have to have."""
    checked = checked_parameters(discrete, parameters)
    rows = checked_rows(discrete.system, checked, start)
    states = states_of(plan.steps, plan.every) * (len(rows) if whole else 1)
    widths = (discrete.system.rank, discrete.system.rank, plan.posed * discrete.system.group.pose_size)
    refuse_too_large("ensemble", widths, states)
    members = Members(discrete, checked, len(rows))
    check_systems(members)
    full = rows if start.name == "momentum" and rows.shape[1] != discrete.system.rank else None
    return members, first_momenta(members, start.name, rows), full


def _check_backend(discrete: Discretization, backend: str) -> None:
    choice("ensemble(backend=...)", backend, ("auto", "numba", "jax"))
    if backend == "numba" and discrete.route.compiled is None:
        remedy = "Pass backend='jax', or difference='matrix'."
        raise error("ensemble(backend=...)", "have a closed form of the step", shown(discrete.difference), remedy)


def _block(
    members: Members, momenta: np.ndarray, full: np.ndarray | None, plan: Plan, events: Watched, report: Report
) -> Ensemble:
    """Run a block of members; those whose full momentum is not that of the principal root do not start."""
    done = run_members(members, momenta, plan if events is None else plan._replace(every=1), report=report)
    if full is not None:
        _unstart(done, full, run_members(members, momenta, plan._replace(steps=1, every=1, posed=True)).momentum[:, 0])
    return done if events is None else watched_block(events, done, plan.every)


def _unstart(done: Ensemble, full: np.ndarray, found: np.ndarray) -> None:
    """Take the states from members that have another full momentum than the one they should start with."""
    missed = are_others(full, found)
    done.outcome[missed], done.steps_done[missed] = Outcome.off_momentum_locus, 0
    for states in (done.reduced_momentum, done.cayley, done.canonical_pose):
        if states is not None:
            states[missed] = np.nan


def _blocks(
    members: Members,
    momenta: np.ndarray,
    full: np.ndarray | None,
    plan: Plan,
    events: Watched,
    reduce: Callable[[Ensemble], Any],
    report: Report,
) -> Iterator[tuple[int, Any]]:
    """Run block by block; give the number of members of each, and what a function makes of it."""
    state = 2 * momenta.shape[1] + members.discrete.system.group.pose_size * plan.posed
    size = max(1, _BLOCK // (state * states_of(plan.steps, plan.every if events is None else 1)))
    blocks = [slice(begin, begin + size) for begin in range(0, len(members), size)]
    for part in blocks:
        rows = momenta[part], None if full is None else full[part]
        block = _block(members.part(part), *rows, plan, events, report)
        yield len(block), reduce(block)
