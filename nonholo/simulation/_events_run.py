"""Runs of the discrete map that look for events at every step, whatever states they keep."""

import dataclasses
import operator
from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from nonholo import kernels
from nonholo._checks import error
from nonholo._progress import progress_bar
from nonholo._results import Outcome, finished
from nonholo.discrete import Discretization
from nonholo.discrete._branch_rules import BranchRule
from nonholo.io import Plan
from nonholo.orbit import Orbit
from nonholo.simulation._events import Event, checked_events
from nonholo.simulation._events_between import between_states
from nonholo.simulation._events_log import EventLog, joined_logs
from nonholo.simulation._events_scan import Watch, search
from nonholo.simulation._prepared import Start
from nonholo.simulation._rule_run import Rows
from nonholo.simulation._stored_run import rows_of_block
from nonholo.simulation._stretch import CompiledRun, opened
from nonholo.systems import AbstractLRSystem

KernelRows: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray]

_PIECE, _NUMBERS = 1 << 14, 1 << 20  # at most in a stretch that is searched at once: states, numbers in an array
_SHORT = 256  # steps of the first stretch, which an event may soon end; others are at most as long as all before
_FIRST, _GROWTH = 16, 4  # steps of the first attempt of a run that cannot be gone on with, and factor to the next


def watched(owner: str, discrete: Discretization, events: Any, rule: BranchRule, reconstruct: bool) -> Watch:
    """Return what a run looks for, after checking that it can."""
    return Watch(watched_events(owner, discrete, events, rule, reconstruct), between_states(discrete))


def watched_events(
    owner: str, discrete: Discretization, events: Any, rule: BranchRule, reconstruct: bool
) -> dict[str, Event]:
    """Return events by name, refused where parts of a step are not defined or cannot be computed."""
    named, where = checked_events(owner, events), f"{owner}(events=...)"
    if rule != "principal":
        remedy = "Run with branch='principal', or look for changes of sign in the states yourself."
        raise error(where, "have the principal branch, where parts of a step are defined", f"branch {rule!r}", remedy)
    if isinstance(discrete.system, AbstractLRSystem) and not reconstruct:
        got = "reconstruct=False with a right-invariant constraint, whose step depends on the pose"
        raise error(where, "have poses", got, "Run with reconstruct=True.")
    return named


class Piece(NamedTuple):
    """A stretch of a watched run.

    Attributes:
        rows: The saved states as the kernel sees them: momenta, charts, poses.
        begun: The step before which the stretch begins.
        done: The last good step.
        outcome: How it ended.
        log: The crossings in it.
    """

    rows: KernelRows
    begun: int
    done: int
    outcome: Outcome
    log: EventLog


def watched_pieces(
    run: CompiledRun, vector: np.ndarray, watch: Watch, plan: Plan, report: Callable[[int], object]
) -> Iterator[Piece]:
    """Go through a compiled run block by block, looking for events at every step; end with the run."""
    fine, state = dataclasses.replace(run, every=1), vector[sum(run.sizes) :]
    last = _each(lambda row: row[None], np.split(vector[: sum(run.sizes)], np.cumsum(run.sizes)[:-1]))
    for block in range(plan.blocks):
        begin, done, stop = plan.begin(block), plan.begin(block), plan.stop(block)
        first, watch = fine.orbit(last, begin, True, Outcome.successful), dataclasses.replace(watch, parts=())
        watch, _ = search(watch, first, begin)
        kept, code = [_each(operator.itemgetter(slice(0, int(block == 0))), last)], 0
        while code == 0 and done < stop and watch.stopped_by is None:
            code, seen = _advanced(run, state, last, min(stop - done, max(done, _SHORT)))
            watch, count = search(watch, fine.orbit(seen, done, True, Outcome.successful), done)
            saved = slice(run.every - done % run.every, count, run.every)
            kept.append(_each(operator.itemgetter(saved), seen))
            last, done = _each(operator.itemgetter(slice(count - 1, count)), seen), done + count - 1
            report(done)
        outcome = Outcome.successful if watch.stopped_by else Outcome(code)
        yield Piece(_each(np.concatenate, zip(*kept, strict=True)), begin, done, outcome, watch.log())
        if outcome != Outcome.successful or watch.stopped_by:
            return


def _advanced(run: CompiledRun, state: np.ndarray, last: KernelRows, most: int) -> tuple[int, KernelRows]:
    """Take steps with the state of a kernel; return the outcome, and the rows from the last one on."""
    size = min(max(1, min(_PIECE, _NUMBERS // max(1, *run.sizes))), most)
    rows = _each(lambda row: np.concatenate((row, np.empty((size, row.shape[1])))), last)
    good, code = kernels.advance(run.closed.body, state, size, 1, _each(operator.itemgetter(slice(1, None)), rows))
    return code, _each(operator.itemgetter(slice(0, 1 + good)), rows)


def _each(function: Callable[[Any], np.ndarray], rows: Iterable[Any]) -> KernelRows:
    """Apply a function to momenta, charts and poses."""
    momenta, charts, poses = map(function, rows)
    return momenta, charts, poses


def compiled_with_events(
    run: CompiledRun, start: Start, watch: Watch, steps: int, *, throw: bool, progress: bool
) -> Orbit:
    """Run a compiled step from a start, looking for events; return the orbit with what was found."""
    vector, first = opened(run, start, steps, throw)
    if not len(first):
        return dataclasses.replace(first, events=search(watch, first, 0)[0].log())
    plan = Plan(steps, run.every, rows_of_block("simulate(steps=...)", run, steps, None))
    with progress_bar("steps", progress) as report:
        pieces = list(watched_pieces(run, vector, watch, plan, lambda done: report(done, steps)))
    rows, end = _each(np.concatenate, zip(*(piece.rows for piece in pieces), strict=True)), pieces[-1]
    log = joined_logs([piece.log for piece in pieces])
    orbit = dataclasses.replace(run.orbit(rows, 0, True, end.outcome), events=log)
    return finished(orbit, float(run.discrete.time_step), end.done, steps, throw)


def run_with_events(
    run: Callable[[int, int, bool], tuple[Rows, Outcome, int]],
    orbit_of: Callable[[Rows, Outcome, int], Orbit],
    watch: Watch,
    steps: int,
    every: int,
    progress: bool,
) -> tuple[Orbit, int]:
    """Run a step that is not compiled, keeping every state; return the orbit with what was found, and the last step.

    Such a run cannot be gone on with. If an event may end it, it is tried with few steps, then again with more.
    """
    length, ends = min(steps, _FIRST), any(event.stop for event in watch.events.values())
    while True:
        rows, outcome, done = run(length, 1, progress)
        seen, kept = searched(watch, orbit_of(rows, outcome, 1))
        if seen.stopped_by or outcome != Outcome.successful or length == steps:
            break
        length = min(steps, _GROWTH * length) if ends else steps
    if seen.stopped_by:
        outcome, done = Outcome.successful, kept - 1
    momenta, charts, poses = rows
    thin = slice(0, kept, every)
    orbit = orbit_of((momenta[thin], charts[thin], poses if poses is None else poses[thin]), outcome, every)
    return dataclasses.replace(orbit, events=seen.log()), done


def searched(watch: Watch, orbit: Orbit) -> tuple[Watch, int]:
    """Search an orbit of single steps; return what is known after it, and how many states belong to the motion."""
    kept, piece = 0, max(1, min(_PIECE, _NUMBERS // orbit.system.group.pose_size))
    for begun in range(0, max(1, len(orbit) - 1), piece):
        watch, count = search(watch, orbit.chosen(slice(begun, begun + piece + 1)), begun)
        kept = begun + count
        if watch.stopped_by:
            break
    return watch, kept
