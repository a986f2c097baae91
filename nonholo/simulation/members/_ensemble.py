"""`ensemble`: many motions at once, from checked starts and parameters to decoded results or a user's reduction.

Joining what a user's reduction made of blocks of members.
"""

import functools
import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeAlias

import numpy as np

from nonholo import systems
from nonholo.base.calls import call
from nonholo.base.checks import count, error, flags, flow_times, flow_tolerances, function, refuse_given, within_memory
from nonholo.base.progress import progress_bar
from nonholo.continuous import ContinuousFlow, solver_of
from nonholo.discrete import PRINCIPAL, BranchRule, Discretization, as_discretization
from nonholo.orbit import First
from nonholo.simulation._crossings import refuse_resets, watch_for
from nonholo.simulation._options import check_forces, refuse_too_large, stepper_of
from nonholo.simulation.members._executors import Plan, Report, are_side_by_side, counting, run_members
from nonholo.simulation.members._members import Members, are_others, check_systems, firsts, in_rows
from nonholo.simulation.members._result import Ensemble, joined_blocks
from nonholo.systems import AbstractCoordinateDiscretization, AbstractCoordinateSystem, AbstractSystem, Start, System

_DEFAULTS = {"branch": PRINCIPAL.name, "backend": "auto", "reconstruct": True}
_BLOCK = 1 << 23  # numbers in a block of members that is reduced, 64 MiB

Reduced: TypeAlias = np.ndarray | dict[str, np.ndarray]
Options: TypeAlias = dict[str, Any]
_WHERE = "ensemble(reduce=...)"
_ONE = ""  # the name of an array that comes without one


def ensemble(
    discrete: Discretization | System | AbstractCoordinateDiscretization | AbstractCoordinateSystem,
    *,
    steps: int | None = None,
    times: Any = None,
    configuration: Any = None,
    project: bool = False,
    body_velocity: Any = None,
    restricted_velocity: Any = None,
    displacement: Any = None,
    momentum: Any = None,
    save_every: int | None = None,
    parameters: Mapping[str, Any] | None = None,
    reduce: Callable[[Ensemble], Reduced] | None = None,
    branch: BranchRule = PRINCIPAL.name,
    reconstruct: bool = True,
    backend: str = "auto",
    events: Any = None,
    rtol: float | None = None,
    progress: bool = False,
) -> Any:
    r"""Run or solve many members of one system, which differ in their starts, in parameters, or in both.

    Each member takes the steps that `simulate` would take from its start, on the branch of its rule and verified. Its
    result does not depend on the others. Tops with n = 3 and plane sleighs run in compiled blocks of 32 members,
    other systems, and all by other rules than "principal", one after another. All cores are used (`NUMBA_NUM_THREADS`
    sets how many), with the same result.

    For a system instead of a discretization the flows are solved, by the series of `flow`; from one canonical momentum
    each has the bits of a flow alone.

    Systems in coordinates run one member after another, in one thread: each has the bits of `simulate` or `flow` alone.

    The start and the `configuration` have one row for each member, or one for all.

    A member that cannot continue keeps its good states: see `Ensemble` for its arrays, and `outcome` for the reason.

    Args:
        discrete: The discretized system, or a system for its flow.
        steps: Number of steps N.
        times: Of a system instead: the times of the states, as in `flow`.
        configuration: First poses, matrices (M, N, N), in coordinates (M, n); one alone is that of all members. Bodies
            start at the identity by default.
        project: Start at the admissible configurations and velocities closest to these, as in `simulate`.
        body_velocity: One row for each member, (M, dim), or one for all. Of bodies members start with the principal
            W_0 that has the same momentum along the constraint.
        restricted_velocity: The same, in rows of the constraint subspace, (M, k).
        displacement: Start with these W_0, matrices (M, N, N), in coordinates (M, n). A member that would not be on the
            principal branch has outcome `branch_unverified`, unless it runs by another rule. Flows have none.
        momentum: Start with these momenta, full ones (M, dim) on the momentum locus or those along the constraint
            subspace, (M, k). A member whose full momentum is not on it has outcome `off_momentum_locus`.
        save_every: Steps between saved states, the first one included; by default only the last state is kept.
        parameters: Arrays with a leading member axis by name: fields of the system that are numbers or tensors (mass,
            inertia, a, b, mass_tensor, ...), of a `Forced` one those of the system inside, in coordinates the
            `parameters` of a `LagrangeDAlembert`, which is compiled once for all members; and "time_step".
        reduce: A function of an `Ensemble`, a block of the members in order, that returns an array or a dictionary of
            arrays with a leading member axis. It is called block by block, so that states are never all in memory.
        branch: Which value of the map a step takes, a name or a function, as in `simulate`.
        reconstruct: Also compute poses. Flows without them run one by one, as `flow` solves for momenta alone.
        backend: "numba" (closed forms, compiled), "jax", or "auto" to choose. By JAX tops with n = 3 and plane sleighs
            run in chunks on processors and all at once on accelerators, other systems by the definition.
        events: `Event`s, or functions, whose changes of sign are found at every single step of each member; see
            `Ensemble.events`. A function sees an orbit: the states of many members one after another, or those of
            one member where parameters differ or members run alone. A member has no states after the event that
            stops it.
        rtol: Of a system: the relative error of a step, as in `flow`.
        progress: Show a progress bar on standard error.

    Returns:
        The `Ensemble`; with `reduce` its results, blocks joined along the member axis.

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
        reduce = functools.partial(call, "ensemble(reduce=...)", reduce)
    starts = {"body_velocity": body_velocity, "restricted_velocity": restricted_velocity}
    starts |= {"displacement": displacement, "momentum": momentum}
    of_steps = {"steps": steps, "save_every": save_every, "events": events, "branch": branch, "backend": backend}
    of_steps["reconstruct"] = reconstruct
    make: Any = _of_times if isinstance(discrete, AbstractSystem | AbstractCoordinateSystem) else _of_steps
    motion, plan, widths = make(discrete, {"times": times, "rtol": rtol}, of_steps, starts)
    start = Start.of("ensemble", configuration, choices=motion.starts, project=project, **starts)
    start, several, numbers = in_rows(motion, start, parameters)
    members = Members(motion, numbers, several)
    _refuse_too_large(plan, widths, 1 if reduce is not None else several)
    check_systems(members)
    first = firsts(members, start, with_poses=widths[-1] > 0, at_once=not project and are_side_by_side(members, plan))
    _check_momenta(members, first, plan)
    with progress_bar("members", progress) as show:
        return _run_all(members, first, plan, sum(widths), reduce, counting(show, several))


def _refuse(what: str, **arguments: Any) -> None:
    """Refuse arguments of another kind of ensemble, unless they are what they are by default."""
    arguments = {name: (value, _DEFAULTS.get(name)) for name, value in arguments.items()}
    refuse_given("ensemble", f"be left out {what}", "A discretization has steps, a system times and rtol.", **arguments)


def _of_times(system: Any, of_flow: Options, of_steps: Options, starts: Options) -> tuple[Any, Plan, tuple[int, ...]]:
    """Return the motion of flows, what is done with every member, and how wide its columns are."""
    reconstruct = bool(of_steps.pop("reconstruct"))
    _refuse("for a flow", displacement=starts.pop("displacement"), **of_steps)
    time, rtol = flow_times(of_flow["times"]), of_flow["rtol"]
    if isinstance(system, AbstractCoordinateSystem):
        systems.refuse_in_coordinates("ensemble", reconstruct=(reconstruct, True))
        motion, error = system.flow_from(float(time[0])), 0.0 if rtol is None else flow_tolerances(rtol, 1.0)[0]
        widths = 1, *map(math.prod, motion.system.shapes)
        return motion, Plan(len(time) - 1, 1, times=time, rtol=error), widths
    rtol = 1e-14 if rtol is None else rtol
    plan = Plan(len(time) - 1, 1, reconstruct, times=time, rtol=flow_tolerances(rtol, 1.0)[0])
    with_poses = solver_of(system, None, float(time[0]), reconstruct=reconstruct)[1]
    return ContinuousFlow(system), plan, (1, system.rank, system.group.pose_size * with_poses)


def _of_steps(discrete: Any, of_flow: Options, of_steps: Options, starts: Options) -> tuple[Any, Plan, tuple[int, ...]]:
    """Return the motion of runs, what is done with every member, and how wide its columns are."""
    del starts
    steps, save_every, events, branch, backend, reconstruct = of_steps.values()
    if isinstance(discrete, AbstractCoordinateDiscretization):
        absent = {"branch": branch, "backend": backend, "reconstruct": reconstruct, **of_flow}
        systems.refuse_in_coordinates("ensemble", **{x: (value, _DEFAULTS.get(x)) for x, value in absent.items()})
    else:
        _refuse("for a discretization", **of_flow)
        as_discretization("ensemble(discrete=...)", discrete, compositions=True, forced=True)
    steps = count("ensemble(steps=...)", steps, "Pass the number of steps.")
    if save_every is not None:
        save_every = count("ensemble(save_every=...)", save_every, "Pass the steps between saved states, or None.")
    stepper = stepper_of(discrete, branch, backend, with_poses=bool(reconstruct), owner="ensemble")
    check_forces("ensemble", discrete, steps)
    by_name = None if events is None else watch_for("ensemble", stepper, events).events
    refuse_resets("ensemble", by_name or {}, "impacts of many members, whose steps are taken side by side")
    plan = Plan(steps, save_every, bool(reconstruct), branch, backend, by_name)
    return discrete, plan, tuple(stepper.columns.values())


def _refuse_too_large(plan: Plan, widths: tuple[int, ...], members: int) -> None:
    """Refuse more states than memory holds."""
    if plan.times is None:
        return refuse_too_large("ensemble", widths, members * plan.states)
    remedy = "Ask for fewer times, or pass reduce=..."
    return within_memory("ensemble(times=...)", 16.0 * sum(widths) * members * plan.states, remedy)


def _check_momenta(members: Members, starts: First, plan: Plan) -> None:
    """Refuse full momenta of flows that no admissible velocity has."""
    momenta = starts.demand
    if plan.times is None or momenta is None:
        return
    full = run_members(members, starts, plan._replace(steps=0, times=plan.times[:1])).momentum[:, 0]
    wrong = are_others(momenta, full)
    if wrong.any():
        member = int(np.argmax(wrong))
        remedy = f"With the same components along the constraint that of member {member} is {full[member].tolist()}."
        raise error("ensemble(momentum=...)", "belong to admissible velocities", f"{momenta[member].tolist()}", remedy)


def _run_all(members: Members, starts: First, plan: Plan, width: int, reduce: Any, report: Report) -> Any:
    """Run all members, block by block where only what is found of them is kept, and join that."""
    has_search = plan.events is not None and are_side_by_side(members, plan)  # in every step of a block
    if reduce is None and not has_search:
        return run_members(members, starts, plan, report=report)
    size = max(1, _BLOCK // (width * (1 + plan.steps if has_search else plan.states)))
    parts = [slice(begin, begin + size) for begin in range(0, len(members), size)]
    blocks = (run_members(members.part(part), starts.of(part), plan, report=report) for part in parts)
    if reduce is None:
        return joined_blocks(members, list(blocks))
    return join_blocks(len(members), ((len(block), reduce(block)) for block in blocks))


def join_blocks(members: int, blocks: Iterable[tuple[int, Reduced]]) -> Reduced:
    """Join the results of blocks, which come with their numbers of members, along the member axis.

    Each result is copied to its place when it comes, so that nothing else of its block is kept.

    Example:
        >>> join_blocks(3, [(2, np.array([0.0, 1.0])), (1, np.array([2.0]))])
        array([0., 1., 2.])
    """
    whole: dict[str, np.ndarray] = {}
    begin = 0
    for size, result in blocks:
        arrays = result if isinstance(result, dict) else {_ONE: result}
        rows = {name: _check_rows(size, value) for name, value in arrays.items()}
        whole = whole or {name: np.empty((members, *value.shape[1:]), value.dtype) for name, value in rows.items()}
        ours, first = ({name: value.shape[1:] for name, value in block.items()} for block in (rows, whole))
        if ours != first:
            raise error(_WHERE, "return one shape for all blocks", f"{ours} after {first}", "Pad with NaN.")
        for name, value in rows.items():
            whole[name] = whole[name].astype(np.result_type(whole[name], value), copy=False)
            whole[name][begin : begin + size] = value
        begin += size
    return whole.get(_ONE, whole)


def _check_rows(size: int, result: object) -> np.ndarray:
    """Refuse what does not have one row for each member of the block."""
    try:
        rows = np.asarray(result)
    except ValueError as failure:
        raise error(_WHERE, "return arrays", str(failure).rstrip("."), "Pad them with NaN.") from failure
    if rows.ndim == 0 or len(rows) != size:
        got = f"shape {rows.shape} for {size} members"
        raise error(_WHERE, "return arrays with a leading member axis", got, "Keep that axis.")
    return rows
