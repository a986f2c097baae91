"""Executors of a block of members: lanes of a closed form, series of flows, or one by one; work in threads."""

import contextlib
import contextvars
import dataclasses
import functools
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from typing import Any, NamedTuple, TypeAlias, cast

import numpy as np

from nonholo import kernels
from nonholo.base.checks import needs
from nonholo.base.progress import setting, until
from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Float
from nonholo.continuous import has_series, members_by_series
from nonholo.discrete import PRINCIPAL, BranchRule
from nonholo.orbit import AbstractStepper, First
from nonholo.simulation._event import Event
from nonholo.simulation._flow import flow_from
from nonholo.simulation._options import stepper_of
from nonholo.simulation._run import Run, run_to_end
from nonholo.simulation._search import Watch
from nonholo.simulation.members._members import Members, ScalarMembers, are_others, inertias_of, naming
from nonholo.simulation.members._result import Ensemble, log_of, stack_rows, watched_block
from nonholo.systems import in_coordinates

_PART = 8192  # members in a piece of work of one thread, a multiple of what a compiled block holds
_FLOWS = 1024  # flows in a piece of work,
_BESIDE = 8  # those that are solved side by side,
_NUMBERS = 1 << 20  # and the most numbers in their states
_SOON = 1 << 16  # steps of the compiled loop over members that take a few milliseconds, less than threads,
_SOON_ALONE = 1 << 12  # those of other compiled loops,
_SOON_TURNED = 1 << 9  # and the units of time in which a body moves by one that its series take

_THREADS: contextvars.ContextVar[int | None] = contextvars.ContextVar("threads", default=None)

Report: TypeAlias = Callable[[int], None]
Starts: TypeAlias = tuple[np.ndarray, np.ndarray]  # scaled momenta and poses


def in_one_thread() -> contextlib.AbstractContextManager[None]:
    """Run ensembles inside in one thread, for callers that run several of them at a time."""
    return setting(_THREADS, 1)


def threads_to_use() -> int:
    """Return one `in_one_thread`, else as many as `NUMBA_NUM_THREADS` says, else one for each core."""
    text = os.environ.get("NUMBA_NUM_THREADS", "")
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return _THREADS.get() or (int(text) if text.isdigit() and int(text) > 0 else cores)


def counting(show: Callable[[int, int], None], total: int) -> Report:
    """Return a function that adds up how many members are done, and shows it."""
    count = 0

    def report(more: int) -> None:
        nonlocal count
        count += more
        show(count, total)

    return report


class Plan(NamedTuple):
    """The work on every member.

    Attributes:
        steps: Number of steps; of a flow the number of times after the first.
        every: Steps between saved states; None for the last one alone.
        with_poses: Whether to compute poses.
        branch: The branch rule.
        backend: "auto", "numba" or "jax".
        events: The events of the runs, by name; None without.
        times: Those of a flow.
        rtol: The relative error of its steps; 0 for the default of each motion.
    """

    steps: int
    every: int | None
    with_poses: bool = True
    branch: BranchRule = PRINCIPAL.name
    backend: str = "auto"
    events: dict[str, Event] | None = None
    times: Float[np.ndarray, "K"] | None = None
    rtol: float = 0.0

    @property
    def states(self) -> int:
        """How many states of each member are kept."""
        return 1 if self.every is None else 1 + self.steps // self.every


def run_members(members: Members, starts: First, plan: Plan, report: Report = lambda _: None) -> Ensemble:
    """Run a block of members.

    Args:
        members: Who runs.
        starts: Their checked starts.
        plan: The plan of the run.
        report: Called with the number of members that are done.
    """
    threads = threads_to_use()
    if plan.times is None and are_side_by_side(members, plan):  # events are sought in all steps
        whole = plan if plan.events is None else plan._replace(every=1)
        block = run_in_lanes(members, starts, whole, threads, report)
        return block if plan.events is None else watched_block(plan.events, block, plan.every)
    run = run_by_series if _has_series(members, plan) else run_one_by_one
    return run(members, starts, plan, threads, report)


def _has_series(members: Members, plan: Plan) -> bool:
    """Return whether flows are solved side by side; under forces those of one body are."""
    system, times = members.discrete.system, plan.times
    if times is None or members.in_coordinates:
        return False
    alike = system.forces is None or not members.of_system
    return plan.with_poses and alike and has_series(system, times[-1] - times[0])


def are_side_by_side(members: Members, plan: Plan) -> bool:
    """Return whether members are computed side by side, in numbers of their closed form."""
    return plan.branch == PRINCIPAL.name and members.lanes is not None


def run_in_lanes(members: Members, starts: First, plan: Plan, threads: int, report: Report) -> Ensemble:
    """Run members of a closed form side by side, 32 at a time, or by JAX, without their events."""
    scalar, count, (momenta, first) = ScalarMembers(members), len(members), starts.numbers
    rows = _rows(count, plan.states, with_poses=plan.with_poses)
    lanes = _Lanes(scalar.body, scalar.fields, scalar.to_canonical)
    advance = _advance_by_jax if plan.backend == "jax" else _advance

    def work(part: slice, stop: np.ndarray) -> None:
        pieces = _fill_nan(kernels.MemberRows(*(array[part] for array in rows)))
        scale, axes = np.broadcast_to(scalar.scale, (count,))[part, None], scalar.axes.at(part)
        places = axes.poses(first[part] if first.strides[0] else first[:1])
        poses = np.array(np.broadcast_to(places, (len(scale), 4)), order="C")  # never read-only: compiled once
        advance(lanes.of(part), (scale * axes.momenta(momenta[part]), poses), plan, pieces, stop)

    if plan.backend == "jax":
        threads = 1  # XLA has its own
    elif count * plan.steps <= _SOON:
        threads = 0
    in_threads(work, _parts(count, threads, plan.backend), threads, report)
    columns = {"reduced_momentum": rows.momenta, "cayley": rows.charts}
    columns |= {"canonical_pose": rows.poses} if plan.with_poses else {}
    batch = Ensemble(members, plan.steps, plan.every, columns, *rows[3:], momenta, first)
    if starts.demand is not None:
        free, probe = starts._replace(demand=None), plan._replace(steps=1, every=1, with_poses=True)
        _refuse_other_starts(batch, starts.demand, run_in_lanes(members, free, probe, threads, lambda _: None))
    return batch


def _refuse_other_starts(batch: Ensemble, demand: np.ndarray, probe: Ensemble) -> None:
    """Take the states from members that start with another full momentum or displacement than they should."""
    outcome = Outcome.off_momentum_locus if demand.ndim == 2 else Outcome.branch_unverified
    others = are_others(demand, (probe.momentum if demand.ndim == 2 else probe.displacement)[:, 0])
    batch.outcome[others], batch.steps_done[others] = outcome, 0
    for column in batch.columns.values():
        column[others] = np.nan


def _rows(count: int, states: int, *, with_poses: bool) -> kernels.MemberRows:
    """Return rows for the states of members, not yet NaN: threads that run a part of them touch its memory first."""
    empty = (np.empty((count, number, size)) for number, size in ((states, 2), (states, 2), (states * with_poses, 4)))
    return kernels.MemberRows(*empty, *np.zeros((2, count), dtype=np.int64))


def _fill_nan(rows: kernels.MemberRows) -> kernels.MemberRows:
    """Return rows whose states are NaN, as those of members that do not get there stay."""
    for states in rows[:3]:
        states.fill(np.nan)
    return rows


class _Lanes(NamedTuple):
    """The numbers of members that a loop needs.

    Attributes:
        body: Makes a body of the kernel.
        fields: Numbers of their bodies, (f, members), or (f, 1) where those of all are the same.
        axes: How their record is taken to canonical numbers.
    """

    body: Callable[..., Any]
    fields: np.ndarray
    axes: kernels.MemberAxes

    def of(self, some: Any) -> "_Lanes":
        """Return the same of some members."""
        fields, numbers = self.fields, self.axes.numbers
        own = self.axes if len(numbers) == 1 else self.axes._replace(numbers=numbers[some])
        return self._replace(fields=fields if fields.shape[1] == 1 else fields[:, some], axes=own)


def _advance(lanes: _Lanes, starts: Starts, plan: Plan, rows: kernels.MemberRows, stop: np.ndarray) -> None:
    """Run members by the compiled loop."""
    one = lanes.body(*(float(x) for x in lanes.fields[:, 0]))
    tables = None if lanes.fields.shape[1] == 1 else kernels.tables_of(lanes.fields)
    kernels.advance_members(one, tables, lanes.axes, *starts, plan.steps, plan.every or 0, rows, stop)


def _advance_by_jax(lanes: _Lanes, starts: Starts, plan: Plan, rows: kernels.MemberRows, stop: np.ndarray) -> None:
    """Run members by JAX, and those whose roots are not certain by the compiled loop."""
    with needs("jax", "ensemble(backend='jax')"):
        from nonholo.simulation.members._by_jax import advance_by_jax

    body, (momenta, poses) = lanes.body(*lanes.fields), starts
    again = np.flatnonzero(advance_by_jax(body, lanes.axes, starts, plan.steps, plan.every or 0, rows))
    if again.size:
        fresh = _fill_nan(_rows(len(again), rows.momenta.shape[1], with_poses=plan.with_poses))
        _advance(lanes.of(again), (momenta[again], poses[again]), plan, fresh, stop)
        for array, values in zip(rows, fresh, strict=True):
            array[again] = values


def run_one_by_one(members: Members, starts: First, plan: Plan, threads: int, report: Report) -> Ensemble:
    """Run members alone, each as it runs by `simulate` or `flow`."""
    count, orbits, good = len(members), {}, np.zeros(len(members), dtype=np.int64)

    def work(part: slice, _: np.ndarray) -> None:
        with naming(member := part.start):
            orbits[member], good[member] = _run_alone(members.of(member), starts.of(member), plan)

    stepper = None if plan.times is not None else _stepper_of(members.discrete, plan)
    is_soon = stepper is not None and (not stepper.in_threads or count * plan.steps <= _SOON_ALONE)
    threads = 0 if is_soon or members.in_coordinates else threads
    in_threads(work, [slice(i, i + 1) for i in range(count)], threads, report)
    each, (momenta, places, *_) = [orbits[member] for member in range(count)], starts.numbers
    codes = np.array([int(orbit.outcome) for orbit in each])
    columns = stack_rows(each, plan.states) | _times(plan, count)
    branch = getattr(stepper, "branch", PRINCIPAL.name)
    batch = Ensemble(members, plan.steps, plan.every, columns, codes, good, momenta, places, branch=branch)
    return batch if plan.events is None else dataclasses.replace(batch, events=log_of(batch, each))


def _stepper_of(motion: Any, plan: Plan) -> AbstractStepper[Any]:
    return stepper_of(motion, plan.branch, plan.backend, with_poses=plan.with_poses, owner="ensemble")


def _run_alone(motion: Any, first: First, plan: Plan) -> tuple[Any, int]:
    """Return the states that one member keeps as an orbit, and its number of good steps, of a flow of later times."""
    if plan.times is not None:
        flow = motion.solve if in_coordinates(motion) else functools.partial(flow_from, motion.system)
        orbit = flow(first, plan.times, plan.rtol, reconstruct=plan.with_poses)
        return orbit, len(orbit) - 1
    stepper = _stepper_of(motion, plan)
    watch = None if plan.events is None else Watch(plan.events, motion.after_parts)
    run = Run(stepper, plan.steps, plan.every or plan.steps, watch, throw=False, progress=False)
    try:
        return run_to_end(run, first, whole=plan.every is not None)
    except OutcomeError as early:
        return dataclasses.replace(cast(Any, early.orbit), outcome=early.outcome), 0


def run_by_series(members: Members, starts: First, plan: Plan, threads: int, report: Report) -> Ensemble:
    """Solve for the flows of members side by side."""
    count, pieces, time, (momenta, poses) = len(members), {}, cast(np.ndarray, plan.times), starts.numbers

    def work(part: slice, stop: np.ndarray) -> None:
        options = time - time[0], plan.rtol, stop
        inertias, system = inertias_of(members.part(part)), members.discrete.system
        pieces[part.start] = members_by_series(system, inertias, momenta[part], poses[part], *options)

    numbers = (momenta.shape[1] + poses.shape[1]) * len(time)
    size = max(1, min(_FLOWS, _NUMBERS // numbers, max(_BESIDE, -(-count // 8))))
    group, free = members.discrete.system.group, members.discrete.system.forces is None
    is_short = free and count <= _FLOWS and count * numbers <= _SOON
    if is_short and count * _motion_bound(members, starts, time) <= _SOON_TURNED:
        size, threads = count, 0
    parts = [slice(begin, min(begin + size, count)) for begin in range(0, count, size)]
    in_threads(work, parts, threads, report)
    states, counts = zip(*(pieces[part.start] for part in parts), strict=True)
    names = "reduced_momentum", "canonical_pose", "turned"
    parts_of = dict(zip(names, zip(*states, strict=True), strict=True))
    columns = {name: np.concatenate(rows) for name, rows in parts_of.items() if rows[0] is not None}
    good = np.concatenate(counts)
    early = Outcome.not_converged if free else Outcome.too_stiff
    codes = np.where(good == len(time), int(Outcome.successful), int(early))
    if group.has_drift:
        sound = np.maximum(1, group.leading_elements(group.matrix_from_pose(columns["canonical_pose"])))
        codes[sound < good], good = int(Outcome.nonfinite), np.minimum(sound, good)
        for column in columns.values():
            column[np.arange(len(time)) >= good[:, None]] = np.nan
    return Ensemble(members, plan.steps, plan.every, columns | _times(plan, count), codes, good - 1, momenta, poses)


def _motion_bound(members: Members, starts: First, time: np.ndarray) -> float:
    """Return by how much a body at most moves, in its algebra, and more where its inertia is uneven."""
    inertia, S = inertias_of(members), members.discrete.system.canonical.constraint_subspace
    velocity = np.linalg.solve(S @ inertia @ S.T, starts.numbers[0][..., None])[..., 0] @ S
    speed, span = float(np.abs(velocity).max(initial=0.0)), float(abs(time[-1] - time[0]))
    return speed * span * float(np.linalg.cond(inertia).max())


def _times(plan: Plan, count: int) -> dict[str, np.ndarray]:
    """Return the times of flows as a column."""
    return {} if plan.times is None else {"time": np.broadcast_to(plan.times, (count, len(plan.times)))}


def _parts(count: int, threads: int, backend: str) -> list[slice]:
    """Cut members into pieces of work: whole blocks of the kernel, some for each thread, or what JAX takes at once."""
    if backend == "jax":
        with needs("jax", "ensemble(backend='jax')"):
            from nonholo.simulation.members._by_jax import chunk

        size = chunk() or count
    else:
        blocks = -(-count // kernels.LANES)
        size = kernels.LANES * max(1, min(_PART // kernels.LANES, blocks // (4 * threads) if threads else blocks))
    return [slice(begin, min(begin + size, count)) for begin in range(0, count, size)]


def in_threads(work: Callable[[slice, np.ndarray], None], parts: list[slice], threads: int, report: Report) -> None:
    """Do all pieces of work and report each; what ends this thread, Ctrl-C among it, soon ends the others.

    Args:
        work: Does a piece; beside others it releases the interpreter's lock, and ends soon when the array becomes true.
        parts: The pieces.
        threads: How many; 0 for this one, which Ctrl-C reaches only between calls of compiled code.
        report: Called with the number of members of a piece.
    """
    stop = np.zeros(1, dtype=np.bool_)
    if not threads:
        for part in parts:
            work(part, stop)
            report(part.stop - part.start)
        return

    def do(part: slice) -> None:
        with until(lambda: bool(stop[0])):
            work(part, stop)

    pool = ThreadPoolExecutor(threads)
    try:
        waiting = {pool.submit(do, part): part for part in parts}
        for future in as_completed(waiting):
            future.result()
            report(waiting[future].stop - waiting[future].start)
    finally:
        stop[0] = True
        pool.shutdown(cancel_futures=True)
