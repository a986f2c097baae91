"""The sink of runs that are written to a store block by block, in bounded memory, and can stop at any moment."""

import dataclasses
import functools
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from nonholo import io
from nonholo.base.checks import error
from nonholo.base.limits import within_disk
from nonholo.base.progress import progress_bar
from nonholo.discrete import BranchRule
from nonholo.io import Checkpoint, Seen
from nonholo.orbit import First
from nonholo.simulation._options import stepper_of
from nonholo.simulation._run import Reached, Run, blocks, opened, orbit_at, rows_of_block
from nonholo.simulation.events import Event, Watch

if TYPE_CHECKING:
    from nonholo.io import Stream

_LOADED = 1 << 27  # numbers of an orbit that is returned whole, 1 GiB


def into_store(run: Run, first: First, path: Path, checkpoint_every: int | None, scenario: str | None) -> Any:
    """Run into a new store; return the orbit."""
    if run.stepper.branch == "callable":
        remedy = "Name a rule, or run in memory or by `iterate`."
        raise error("simulate(branch=...)", "be a rule that a store can name", "a function", remedy)
    io.check_target(path, new="simulate(store=...)")
    plan = run.plan(rows_of_block("simulate(checkpoint_every=...)", run, checkpoint_every))
    begun, empty = opened(run, first)
    if empty is not None:
        return empty
    there, events = dataclasses.replace(orbit_at(run.stepper, begun.state, 0), save_every=run.every), None
    if begun.watch is not None:
        there, events = dataclasses.replace(there, events=begun.watch.log()), descriptions(begun.watch.events)
    remedy = "Raise save_every to keep fewer states."
    numbers = 1 + run.stepper.width
    within_disk("simulate(store=...)", 8.0 * (1 + run.steps // run.every) * numbers, path, remedy)
    stream = io.create_stream(path, there, plan, _checkpoint(begun), events, scenario)
    with io.write_lock(stream.path):
        return continued(run, stream)


def continued(run: Run, stream: "Stream") -> Any:
    """Compute what a locked store lacks, block after block, and return the orbit."""
    stream.prepare()
    _warn_of_other_versions(stream)
    with io.reporting_how_to_resume(stream.path, "The run", lambda: f"step {_standing(stream)}"):
        reached = _completed(run, stream)
    return run.finished(_loaded(run, stream, reached), reached.done)


def _warn_of_other_versions(stream: "Stream") -> None:
    """Say so if what is still to compute may differ in its last bits from a run with the versions of the store."""
    others = io.other_versions(io.read_attributes(stream.path))
    if others and not stream.is_finished:
        message = f"The store '{stream.path}' was begun with {others}: the last bits of what follows may differ."
        warnings.warn(message, RuntimeWarning, stacklevel=4)


def _standing(stream: "Stream") -> str:
    return f"{stream.steps_done()} of {stream.plan.steps}"


def _completed(run: Run, stream: "Stream") -> Checkpoint:
    """Compute every block that is missing or damaged; return the end of the run."""
    marked, is_computed = max(stream.block_numbers(), default=-1), not stream.is_finished

    @functools.cache
    def known(number: int) -> Reached | None:
        sound = _sound(stream, number) if number <= marked else None
        return None if sound is None else reached_at(run, sound)

    begin, end, number = known(0) or reached_at(run, _first(stream)), None, 0
    with progress_bar("steps", run.progress) as report:
        for number, orbit, reached in blocks(run, stream.plan, begin, report, known):
            if orbit is None:
                end = stream.checkpoint(number + 1)
                continue
            is_computed, end = True, _checkpoint(reached)
            stream.write(number, orbit, end)
    end = end or _first(stream)
    if is_computed:
        stream.finish(end, number)
    return end


def _sound(stream: "Stream", block: int) -> Checkpoint | None:
    """Return the end of a block that is marked as finished; None, with a warning, if it is damaged."""
    try:
        return stream.sound(block) if _is_final(stream, block, stream.checkpoint(block + 1)) else None
    except io.DamagedError as flaw:
        message = f"The store '{stream.path}' is damaged: {flaw}. Block {block} is computed again from its checkpoint."
        warnings.warn(message, RuntimeWarning, stacklevel=6)
        return None


def _is_final(stream: "Stream", block: int, reached: Checkpoint) -> bool:
    """Tell whether a block needs no more rows: not so if the run was extended, or ended and was not yet cut."""
    return reached.done == stream.plan.stop(block) or (reached.is_last and stream.is_finished)


def _first(stream: "Stream") -> Checkpoint:
    try:
        return stream.checkpoint(0)
    except io.DamagedError as flaw:
        remedy = "It is lost: run it again."
        raise error("resume(store=...)", "hold the start of the run", str(flaw), remedy) from None


def _loaded(run: Run, stream: "Stream", reached: Checkpoint) -> Any:
    """Return the orbit, of one that would fill the memory the last block."""
    states = 1 + reached.done // run.every + (0 if reached.of_events is None else int(reached.of_events.counts.sum()))
    if states * (2 + run.stepper.width) <= _LOADED:
        return io.load_orbit(stream.path, discrete=run.stepper.motion)
    return io.load_last_block(stream.path, run.stepper.motion)


def descriptions(events: dict[str, Event]) -> list[dict[str, Any]]:
    """Return what a store can hold of events: everything but their functions."""
    return [
        {"name": name, "direction": int(event.direction), "stop": int(event.stop)}
        | ({} if event.reset is None else {"restitution": event.reset.restitution})
        for name, event in events.items()
    ]


def _checkpoint(reached: Reached) -> Checkpoint:
    """Return what a store keeps of a run between two blocks."""
    seen = None if reached.watch is None else seen_by(reached.watch)
    return Checkpoint(reached.done, reached.outcome, reached.state, seen)


def seen_by(watch: Watch) -> Seen:
    """Return what a checkpoint keeps of what is known of a motion."""
    values = np.empty(0) if watch.values is None else watch.values[:, 0]
    stopped = -1 if watch.stopped_by is None else tuple(watch.events).index(watch.stopped_by)
    return Seen(np.array(watch.counts, dtype=np.int64), values, watch.heading or 0.0, stopped)


def reached_at(run: Run, kept: Checkpoint) -> Reached:
    """Return the state of a run at a checkpoint of its store."""
    watch, seen = run.watch, kept.of_events
    if watch is not None and seen is not None:
        stopped = tuple(watch.events)[seen.last_event] if kept.is_stopped else None
        known = {"counts": tuple(map(int, seen.counts)), "values": seen.values[:, None], "heading": seen.heading}
        watch = dataclasses.replace(watch, stopped_by=stopped, **known)
    return Reached(kept.done, kept.outcome, kept.vector, watch)


def size_in_blocks(discrete: Any, branch: BranchRule, steps: int, every: int) -> int:
    """Return the bytes of all states of a run if it can go into a store block by block and takes several, else 0."""
    run = Run(stepper_of(discrete, branch, "auto", posed=True), steps, every, None, throw=False, progress=False)
    states = 1 + steps // every
    numbers = 8 * states * run.stepper.width
    return numbers if states > rows_of_block("", run, None) else 0
