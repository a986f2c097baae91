"""Runs of a block of members: tops and plane sleighs 32 at a time, other systems one by one, both in threads."""

import contextlib
import contextvars
import functools
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from typing import Any, NamedTuple, TypeAlias

import numba
import numpy as np

from nonholo import kernels
from nonholo.base.checks import needs
from nonholo.base.progress import until
from nonholo.discrete import PRINCIPAL, Discretization
from nonholo.orbit import Orbit
from nonholo.simulation._options import stepper_of
from nonholo.simulation._run import Run, ended
from nonholo.simulation.members._families import ScalarMembers, body_of, in_lanes, scalar_members
from nonholo.simulation.members._members import Members
from nonholo.simulation.members._result import Ensemble
from nonholo.systems import Start

_PART = 8192  # members in a piece of work of one thread, a multiple of what a compiled block holds

_THREADS: contextvars.ContextVar[int | None] = contextvars.ContextVar("threads", default=None)

Report: TypeAlias = Callable[[int], None]
Starts: TypeAlias = tuple[np.ndarray, np.ndarray]  # scaled momenta and poses


@contextlib.contextmanager
def in_one_thread() -> Iterator[None]:
    """Run ensembles inside in one thread, for callers that run several of them at a time."""
    token = _THREADS.set(1)
    try:
        yield
    finally:
        _THREADS.reset(token)


def threads_to_use() -> int:
    """Return one `in_one_thread`, else as many as numba may use."""
    return _THREADS.get() or int(numba.config.NUMBA_NUM_THREADS)  # pyright: ignore


def counting(show: Callable[[int, int], None], total: int) -> Report:
    """Return a function that adds up how many members are done, and shows it."""
    done = 0

    def report(more: int) -> None:
        nonlocal done
        done += more
        show(done, total)

    return report


class Plan(NamedTuple):
    """The work on every member.

    Attributes:
        steps: Number of steps.
        every: Steps between saved states; None for the last one alone.
        posed: Whether to compute poses.
        backend: "auto", "numba" or "jax".
    """

    steps: int
    every: int | None
    posed: bool
    backend: str


def run_members(
    members: Members, momenta: np.ndarray, plan: Plan, threads: int | None = None, report: Report = lambda _: None
) -> Ensemble:
    """Run a block of members from canonical momenta.

    Args:
        members: Who runs.
        momenta: First momenta along the constraint subspace, (M, k).
        plan: What to do.
        threads: How many; by default one `in_one_thread`, else all that numba may use.
        report: Called with the number of members that are done.
    """
    threads = threads or threads_to_use()
    if in_lanes(members):
        return _run_scalar(members, momenta, plan, threads, report)
    return _run_each(members, momenta, plan, threads, report)


def _run_scalar(members: Members, momenta: np.ndarray, plan: Plan, threads: int, report: Report) -> Ensemble:
    scalar = scalar_members(members)
    steps, every, posed, backend = plan
    count, states = len(members), states_of(steps, every)
    rows = _rows(count, states, posed)
    fields, run = scalar.fields, _advance_by_jax if backend == "jax" else _advance
    advance = functools.partial(run, body_of(members))

    def work(part: slice, stop: np.ndarray) -> None:
        pieces = _unfilled(kernels.MemberRows(*(array[part] for array in rows)))
        scale = np.broadcast_to(scalar.scale, (count,))[part, None]
        first = scalar.pose if scalar.route is None else scalar.route.encode_poses(scalar.pose)
        poses = np.array(np.broadcast_to(first, (count, 4))[part], order="C")  # never read-only: compiled once
        own = fields if fields.shape[1] == 1 else fields[:, part]
        begun = momenta[part] * scale if scalar.route is None else scalar.route.encode(momenta[part])
        advance(own, (begun, poses), plan, pieces, stop)
        if scalar.route is None:
            np.divide(pieces.momenta, scale[:, None], out=pieces.momenta)
        else:
            _decode(scalar, pieces)

    if backend == "jax":
        threads = 1  # XLA has its own
    in_threads(work, _parts(count, threads, backend), threads, report)
    return Ensemble(members, steps, every, *rows[:2], rows.poses if posed else None, *rows[3:], momenta)


def _decode(scalar: ScalarMembers, pieces: kernels.MemberRows) -> None:
    """Take rows of a kernel to canonical units and axes, in place."""
    good, route = np.isfinite(pieces.momenta[..., 0]), scalar.route
    pieces.momenta[good] = route.decode(pieces.momenta[good])
    pieces.charts[good] = route.from_kernel(pieces.charts[good])
    if pieces.poses.shape[1]:
        pieces.poses[good] = route.decode_poses(pieces.poses[good])


def _rows(count: int, states: int, posed: bool) -> kernels.MemberRows:
    """Return rows for the states of members, not yet NaN: threads that run a part of them touch its memory first."""
    empty = (np.empty((count, kept, size)) for kept, size in ((states, 2), (states, 2), (states * posed, 4)))
    return kernels.MemberRows(*empty, *np.zeros((2, count), dtype=np.int64))


def _unfilled(rows: kernels.MemberRows) -> kernels.MemberRows:
    """Return rows whose states are NaN, as those of members that do not get there stay."""
    for states in rows[:3]:
        states.fill(np.nan)
    return rows


def _advance(
    body: Any, fields: np.ndarray, starts: Starts, plan: Plan, rows: kernels.MemberRows, stop: np.ndarray
) -> None:
    """Run members by the compiled loop."""
    one = body(*(float(x) for x in fields[:, 0]))
    tables = None if fields.shape[1] == 1 else kernels.tables_of(fields)
    kernels.advance_members(one, tables, *starts, plan.steps, plan.every or 0, rows, stop)


def _advance_by_jax(
    body: Any, fields: np.ndarray, starts: Starts, plan: Plan, rows: kernels.MemberRows, stop: np.ndarray
) -> None:
    """Run members by JAX, and those whose roots are not certain by the compiled loop."""
    with needs("jax", "ensemble(backend='jax')"):
        from nonholo.simulation.members._by_jax import advance_by_jax

    uncertain = advance_by_jax(body(*fields), *starts, plan.steps, plan.every or 0, rows)
    again = np.flatnonzero(uncertain)
    if again.size:
        found = _unfilled(_rows(len(again), rows.momenta.shape[1], plan.posed))
        own, (momenta, poses) = fields if fields.shape[1] == 1 else fields[:, again], starts
        _advance(body, own, (momenta[again], poses[again]), plan, found, stop)
        for array, values in zip(rows, found, strict=True):
            array[again] = values


def _run_each(members: Members, momenta: np.ndarray, plan: Plan, threads: int, report: Report) -> Ensemble:
    count, states = len(members), states_of(plan.steps, plan.every)
    codes, done = np.zeros((2, count), dtype=np.int64)
    found: dict[int, Orbit] = {}

    def work(part: slice, stop: np.ndarray) -> None:
        with until(lambda: bool(stop[0])):
            for member in range(part.start, part.stop):
                found[member], done[member] = _run_one(members.of(member), momenta[member], plan)
                codes[member] = found[member].outcome

    compiled = plan.backend != "jax" and members.discrete.route.compiled is not None
    in_threads(work, [slice(i, i + 1) for i in range(count)], threads if compiled else 1, report)
    orbits = [found[member] for member in range(count)]
    reduced = _filled([orbit.reduced_momentum for orbit in orbits], states)
    charts = _filled([orbit.canonical_chart for orbit in orbits], states)
    poses = [orbit.canonical_pose for orbit in orbits if orbit.canonical_pose is not None]
    posed = _filled(poses, states) if poses else None
    return Ensemble(members, plan.steps, plan.every, reduced, charts, posed, codes, done, momenta)


def _run_one(discrete: Discretization, momentum: np.ndarray, plan: Plan) -> tuple[Orbit, int]:
    """Return the states that one member keeps as an orbit, and its number of good steps."""
    stepper = stepper_of(discrete, PRINCIPAL.name, plan.backend, posed=plan.posed)
    start = Start("simulate", "momentum", discrete.system.from_canonical(momentum))
    run = Run(stepper, plan.steps, plan.every or plan.steps, None, throw=False, progress=False)
    return ended(run, discrete.first(start, posed=stepper.has_poses), whole=plan.every is not None)


def _filled(kept: list[np.ndarray], states: int) -> np.ndarray:
    """Return the rows of all members in one array, NaN where a member has none."""
    filled = np.full((len(kept), states, kept[0].shape[1]), np.nan)
    for member, rows in enumerate(kept):
        filled[member, : len(rows)] = rows
    return filled


def states_of(steps: int, every: int | None) -> int:
    """Return how many states of each member are kept."""
    return 1 if every is None else 1 + steps // every


def _parts(count: int, threads: int, backend: str) -> list[slice]:
    """Cut members into pieces of work: whole blocks of the kernel, some for each thread, or what JAX takes at once."""
    if backend == "jax":
        with needs("jax", "ensemble(backend='jax')"):
            from nonholo.simulation.members._by_jax import chunk

        size = chunk() or count
    else:
        blocks = -(-count // kernels.LANES)
        size = kernels.LANES * max(1, min(_PART // kernels.LANES, blocks // (4 * threads)))
    return [slice(begin, min(begin + size, count)) for begin in range(0, count, size)]


def in_threads(work: Callable[[slice, np.ndarray], None], parts: list[slice], threads: int, report: Report) -> None:
    """Do all pieces of work, which release the interpreter's lock, and report each."""
    for part in _finished(work, parts, threads):
        report(part.stop - part.start)


def _finished(work: Callable[[slice, np.ndarray], None], parts: list[slice], threads: int) -> Iterator[slice]:
    """Give pieces of work as they are done; what ends this thread, Ctrl-C among it, soon ends the others."""
    pool, stop = ThreadPoolExecutor(threads), np.zeros(1, dtype=np.bool_)
    try:
        waiting = {pool.submit(work, part, stop): part for part in parts}
        for future in as_completed(waiting):
            future.result()
            yield waiting[future]
    finally:
        stop[0] = True
        pool.shutdown(cancel_futures=True)
