"""Runs of the discrete map in memory; those with events look for them at every step, whatever states they keep."""

import dataclasses
from typing import Any

from nonholo.base.checks import error
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome, finished
from nonholo.discrete import PRINCIPAL, Discretization
from nonholo.io import Plan
from nonholo.orbit import Orbit
from nonholo.simulation.events._blocks import NUMBERS, PIECE, computed_block, searched_first
from nonholo.simulation.events._event import Event, checked_events
from nonholo.simulation.events._search import Watch, search
from nonholo.simulation.runs import CompiledRun, FirstState, Runner, opened

_FIRST, _GROWTH = 16, 4  # steps of the first attempt of a run that cannot be resumed, and factor to the next


def watched(owner: str, discrete: Discretization, events: Any, branch: str, reconstruct: bool) -> Watch:
    """Return what a run looks for, after checking that it can."""
    return Watch(watched_events(owner, discrete, events, branch, reconstruct), discrete.after_parts)


def watched_events(
    owner: str, discrete: Discretization, events: Any, branch: str, reconstruct: bool
) -> dict[str, Event]:
    """Return events by name, refused where parts of a step are not defined or cannot be computed."""
    named, where = checked_events(owner, events), f"{owner}(events=...)"
    if branch != PRINCIPAL.name:
        remedy = "Run with branch='principal', or look for changes of sign in the states yourself."
        raise error(where, "have the principal branch, where parts of a step are defined", f"branch {branch!r}", remedy)
    if discrete.step_needs_pose and not reconstruct:
        got = "reconstruct=False with a step that depends on the pose"
        raise error(where, "have poses", got, "Run with reconstruct=True.")
    return named


def run_compiled(
    run: CompiledRun, start: FirstState, watch: Watch | None, steps: int, *, throw: bool, progress: bool
) -> Orbit:
    """Run a compiled step from a start, looking for events if there is a watch; return the orbit."""
    state, ended = opened(run, start, steps, throw)
    if ended is not None:
        return searched_first(watch, ended)[0]
    whole = Plan(steps, run.every, 1 + steps // run.every)  # one block
    with progress_bar("steps", progress) as report:
        block = computed_block(run, state, watch, whole, 0, lambda now: report(now, steps))
    return finished(block.orbit, float(run.discrete.time_step), block.done, steps, throw)


def run_with_events(run: Runner, watch: Watch, steps: int, every: int, progress: bool) -> tuple[Orbit, int]:
    """Run a step that is not compiled, keeping every state; return the orbit with what was found, and the last step.

    Such a run cannot be resumed. If an event may end it, it is tried with few steps, then again with more.
    """
    length, ends = min(steps, _FIRST), any(event.stop for event in watch.events.values())
    while True:
        orbit, done = run(length, 1, progress)
        seen, kept = searched(watch, orbit)
        if seen.stopped_by or orbit.outcome != Outcome.successful or length == steps:
            break
        length = min(steps, _GROWTH * length) if ends else steps
    orbit = dataclasses.replace(orbit[:kept:every], events=seen.log())
    if seen.stopped_by:
        return dataclasses.replace(orbit, outcome=Outcome.successful), kept - 1
    return orbit, done


def searched(watch: Watch, orbit: Orbit) -> tuple[Watch, int]:
    """Search an orbit of single steps; return what is known after it, and how many states belong to the motion."""
    kept, piece = 0, max(1, min(PIECE, NUMBERS // orbit.system.group.pose_size))
    for begun in range(0, max(1, len(orbit) - 1), piece):
        watch, count = search(watch, orbit.chosen(slice(begun, begun + piece + 1)))
        kept = begun + count
        if watch.stopped_by:
            break
    return watch, kept
