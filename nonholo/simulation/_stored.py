"""Runs that are written to a store block by block, in bounded memory: they can stop at any moment, and are resumed."""

import dataclasses
import functools
import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from nonholo import io
from nonholo.base.checks import checked_path, count, error, flags, shown, within_disk
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome
from nonholo.discrete import BranchRule
from nonholo.io.checkpoints import Checkpoint, Seen
from nonholo.orbit import AbstractStepper, First
from nonholo.simulation._crossings import watch_for
from nonholo.simulation._event import Event, checked_events, has_resets
from nonholo.simulation._options import check_forces, stepper_of
from nonholo.simulation._run import Reached, Run, blocks, compute_block, open_run, orbit_at, rows_of_block
from nonholo.simulation._search import Watch, search

if TYPE_CHECKING:
    from nonholo.io.orbits import Stream

_LOADED = 1 << 27  # numbers of an orbit that is returned whole, 1 GiB


def into_store(run: Run, first: First, path: Path, checkpoint_every: int | None, scenario: str | None) -> Any:
    """Run into a new store; return the orbit."""
    if run.stepper.branch == "callable":
        remedy = "Name a rule, or run in memory or by `iterate`."
        raise error("simulate(branch=...)", "be a rule that a store can name", "a function", remedy)
    io.places.check_target(path, new="simulate(store=...)")
    plan = run.plan(rows_of_block("simulate(checkpoint_every=...)", run, checkpoint_every))
    start, empty = open_run(run, first)
    if empty is not None:
        return empty
    there, events = dataclasses.replace(orbit_at(run.stepper, start.state, 0), save_every=run.every), None
    if start.watch is not None:
        there, events = dataclasses.replace(there, events=start.watch.log()), descriptions(start.watch.events)
    size = 8.0 * (1 + run.steps // run.every) * (1 + run.stepper.width)
    within_disk("simulate(store=...)", size, path, "Raise save_every to keep fewer states.")
    stream = io.orbits.create_stream(path, there, plan, _checkpoint(start), events, scenario)
    with io.places.write_lock(stream.path):
        return continue_run(run, stream)


def continue_run(run: Run, stream: "Stream") -> Any:
    """Compute what a locked store lacks, block after block; return the orbit, or its last block if it fills memory."""
    stream.prepare()
    others = io.provenance.other_versions(io.metadata.read_attributes(stream.path))
    if others and not stream.is_finished:
        message = f"The store '{stream.path}' was begun with {others}: the last bits of what follows may differ."
        warnings.warn(message, RuntimeWarning, stacklevel=3)
    with io.orbits.reporting_how_to_resume(
        stream.path, "The run", lambda: f"step {stream.steps_done()} of {stream.plan.steps}"
    ):
        end = _complete(run, stream)
    states = 1 + end.done // run.every + (0 if end.of_events is None else int(end.of_events.counts.sum()))
    if states * (2 + run.stepper.width) <= _LOADED:
        return run.finish(io.load_orbit(stream.path, discrete=run.stepper.motion), end.done)
    return run.finish(io.orbits.load_states(stream.path, run.stepper.motion, last=True), end.done)


def _complete(run: Run, stream: "Stream") -> Checkpoint:
    """Compute every block that is missing or damaged; return the end of the run."""
    last_mark, is_computed = max(stream.store.block_numbers(), default=-1), not stream.is_finished

    @functools.cache
    def look_up(number: int) -> Reached | None:
        sound = _sound(stream, number) if number <= last_mark else None
        return None if sound is None else reached_at(run, sound)

    begin, end, number = look_up(0) or reached_at(run, _first(stream)), None, 0
    with progress_bar("steps", run.progress) as report:
        for number, orbit, standing in blocks(run, stream.plan, begin, report, look_up):
            if orbit is None:
                end = stream.checkpoint(number + 1)
                continue
            is_computed, end = True, _checkpoint(standing)
            stream.write(number, orbit, end)
    end = end or _first(stream)
    if is_computed:
        stream.finish(end, number)
    return end


def _sound(stream: "Stream", block: int) -> Checkpoint | None:
    """Return the end of a block that is marked as finished; None, with a warning, if it is damaged."""
    try:
        return stream.sound(block) if _is_final(stream, block, stream.checkpoint(block + 1)) else None
    except io.blocks.DamagedError as flaw:
        message = f"The store '{stream.path}' is damaged: {flaw}. Block {block} is computed again from its checkpoint."
        warnings.warn(message, RuntimeWarning, stacklevel=6)
        return None


def _is_final(stream: "Stream", block: int, end: Checkpoint) -> bool:
    """Return whether a block needs no more rows: not so if the run was extended, or ended and was not yet cut."""
    return end.done == stream.plan.stop(block) or (end.is_last and stream.is_finished)


def _first(stream: "Stream") -> Checkpoint:
    try:
        return stream.checkpoint(0)
    except io.blocks.DamagedError as flaw:
        remedy = "The first state is lost: run it again."
        raise error("resume(store=...)", "hold the start of the run", str(flaw), remedy) from None


def descriptions(events: dict[str, Event]) -> list[dict[str, Any]]:
    """Return what a store can hold of events: everything but their functions."""
    return [
        {"name": name, "direction": int(event.direction), "stop": int(event.stop)}
        | ({} if event.reset is None else {"restitution": event.reset.restitution})
        for name, event in events.items()
    ]


def _checkpoint(standing: Reached) -> Checkpoint:
    """Return what a store keeps of a run between two blocks."""
    memory = None if standing.watch is None else seen_by(standing.watch)
    return Checkpoint(standing.step, standing.outcome, standing.state, memory)


def seen_by(watch: Watch) -> Seen:
    """Return what a checkpoint keeps of what is known of a motion."""
    values = np.empty(0) if watch.values is None else watch.values[:, 0]
    stop = -1 if watch.stopped_by is None else tuple(watch.events).index(watch.stopped_by)
    return Seen(np.array(watch.counts, dtype=np.int64), values, watch.heading or 0.0, stop)


def reached_at(run: Run, checkpoint: Checkpoint) -> Reached:
    """Return the state of a run at a checkpoint of its store."""
    watch, memory = run.watch, checkpoint.of_events
    if watch is not None and memory is not None:
        stopper = tuple(watch.events)[memory.last_event] if checkpoint.is_stopped else None
        facts = {"counts": tuple(map(int, memory.counts)), "values": memory.values[:, None], "heading": memory.heading}
        watch = dataclasses.replace(watch, stopped_by=stopper, **facts)
    return Reached(checkpoint.done, checkpoint.outcome, checkpoint.vector, watch)


def size_in_blocks(discrete: Any, branch: BranchRule, steps: int, every: int) -> int:
    """Return the bytes of all states of a run if it can go into a store block by block and takes several, else 0."""
    run = Run(stepper_of(discrete, branch, "auto", with_poses=True), steps, every, None, throw=False, progress=False)
    states = 1 + steps // every
    numbers = 8 * states * run.stepper.width
    return numbers if states > rows_of_block("", run, None) else 0


_SAME = 1e-9  # of 1 + the largest number: rounding of other versions and processors is far less


def watch_of_store(owner: str, stream: "Stream", stepper: AbstractStepper[Any], events: Any) -> Watch | None:
    """Return what the run of a store looks for; refused if it is not what the store says."""
    text, where = io.metadata.read_attributes(stream.path).get("events"), f"{owner}(events=...)"
    request, record = [] if events is None else events, json.loads(text or "[]")
    if text is None and not checked_events(owner, request):
        return None
    requirement = f"be the events of the store, {io.events_text(record)}"
    if events is None and record:
        remedy = "Pass events=[...] again, in that order with these directions and stops: a store holds no functions."
        raise error(where, requirement, f"None for '{stream.path}'", remedy)
    watch = watch_for(owner, stepper, request)
    own = descriptions(watch.events)
    if own != record:
        raise error(where, requirement, io.events_text(own), "Pass the ones it was run with.")
    _refuse_other_values(where, stream, stepper, watch)
    return watch


def _refuse_other_values(where: str, stream: "Stream", stepper: AbstractStepper[Any], watch: Watch) -> None:
    """Refuse events that have other values at the first state than the store says."""
    try:
        first = stream.checkpoint(0)
    except io.blocks.DamagedError:
        return  # whoever needs it to continue says so
    if first.of_events is None:
        return
    first_watch, _ = search(watch, orbit_at(stepper, first.vector, 0))
    for name, now, then in zip(watch.events, seen_by(first_watch).values, first.of_events.values, strict=True):
        if abs(now - then) > _SAME * (1 + abs(then)):
            got = f"another one of {name!r}: {now:.17g} instead of {then:.17g} at the first state"
            raise error(where, "be the functions of the store", got, "Pass the functions of the run.")


def refuse_other_functions(owner: str, stream: "Stream", run: Run) -> None:
    """Refuse a run whose first saved states of the last sound block are not those of the store, to the last bit.

    To rounding, if the store was begun with other versions.
    """
    block = _last_sound(stream)
    if block is None:
        return
    begin, end = stream.checkpoint(block), stream.sound(block)
    plan = stream.plan._replace(steps=min(begin.done + run.every, end.done))
    reached_then = reached_at(run, begin)
    if reached_then.watch is None or not has_resets(reached_then.watch.events):
        reached_then = Reached(begin.done, Outcome.successful, begin.vector, None)
    orbit, again = compute_block(run.stepper, plan, block, reached_then, lambda *_: None)
    tolerance = _SAME if io.provenance.other_versions(io.metadata.read_attributes(stream.path)) else 0.0
    begins = block * plan.rows
    columns = stream.columns(orbit, begins).items()
    place = (slice(begins, begins + len(orbit)),)
    pairs = {name: (rows, stream.store.rows(name, place)) for name, rows in columns}
    pairs["the last step"] = np.array(again.step), np.array(plan.steps)
    if again.step == end.done:  # of the row, which is among the variables, nothing is asked
        own = slice(run.stepper.width, None)
        pairs["the state"] = again.state[own], end.vector[own]
    off, name = max((_difference(now, then), name) for name, (now, then) in pairs.items())
    if off > tolerance:
        got = f"{name} other by {off:.3g} of its size after step {begin.done}, which was computed again"
        remedy = "Pass the discretization it was run with, on the same kind of processor."
        raise error(f"{owner}(discrete=...)", "have the functions of the store", got, remedy)


def _difference(now: np.ndarray, then: np.ndarray) -> float:
    """Return the largest difference, relative to 1 + the largest number; impulses may be unknown on one side."""
    return np.nanmax(np.abs(now - then), initial=0.0) / (1 + np.nanmax(np.abs(then), initial=0.0))


def _last_sound(stream: "Stream") -> int | None:
    """Return the last block that took steps and is sound."""
    for block in sorted(stream.store.block_numbers(), reverse=True):
        try:
            if stream.sound(block).done > stream.checkpoint(block).done:
                return block
        except io.blocks.DamagedError:
            continue  # whoever computes it again says so
    return None


def resume_run(store: str | Path, *, discrete: Any, events: Any, throw: bool, progress: bool) -> Any:
    """Resume the run of a store: what `resume` does once it has asked the store, and found no sweep."""
    stream, run = _open("resume", store, discrete, events, throw=throw, progress=progress)
    with io.places.write_lock(stream.path):
        return continue_run(run, io.orbits.open_stream(stream.path))


def extend(
    store: str | Path,
    steps: int,
    *,
    discrete: Any = None,
    events: Any = None,
    task: Any = None,
    trust: bool = False,
    throw: bool = True,
    progress: bool = False,
) -> Any:
    """Run past the end of the run of a store, with the bits of one that had been that long from the start.

    A last block that was not full is computed again with what follows it. The same call again, after one that was
    stopped, adds nothing twice: it does what is left.

    Args:
        store: A store that `simulate(..., store=...)` made.
        steps: How many steps more.
        discrete: As in `resume`.
        events: As in `resume`.
        task: As in `resume`, for a sweep; the members of a sweep are not extended, so an orbit refuses one.
        trust: As in `resume`; the store of an orbit names no functions, so nothing changes.
        throw: As in `resume`.
        progress: Show a progress bar on standard error.

    Returns:
        The whole orbit, as from `simulate(..., store=...)`.

    Raises:
        ValueError: A bad number of steps, or a run that ended because it could not continue, or by an event; and as in
            `resume`.
        BlockingIOError: Another process is writing the store; the message names it.
        OSError: The disk is full; `resume` continues.
        OutcomeError: With `throw`, the run could not continue.

    Example:
        >>> orbit = nh.extend("run.zarr", 1_000_000)  # doctest: +SKIP
    """
    flags("extend", trust=trust, throw=throw, progress=progress)
    store = checked_path("extend(store=...)", store)
    if task is not None:
        raise error("extend(task=...)", "come with the store of a sweep", shown(task), "Leave it out for an orbit.")
    steps = count("extend(steps=...)", steps, "Pass how many steps more.")
    stream, run = _open("extend", store, discrete, events, throw=throw, progress=progress)
    with io.places.write_lock(stream.path):
        attributes = io.metadata.read_attributes(stream.path)
        outcome, event = attributes.get("outcome", Outcome.successful.name), attributes.get("stopped_by")
        if event is not None:
            got = f"one that the event {event!r} ended"
            remedy = "Run it again without `stop`, or with a later one, to go past it."
            raise error("extend(store=...)", "be a run that can continue", got, remedy)
        if outcome != Outcome.successful.name:
            remedy = f"{Outcome[outcome].message} More steps from there do not exist."
            raise error("extend(store=...)", "be a run that can continue", f"outcome {outcome}", remedy)
        size = 8.0 * (steps // run.every) * (1 + run.stepper.width)
        within_disk("extend(steps=...)", size, stream.path, "Pass fewer steps.")
        longer = io.orbits.open_stream(stream.path).longer(steps)
        check_forces("extend", run.stepper.motion, longer.plan.steps)
        longer.announce(steps)
        return continue_run(run._replace(steps=longer.plan.steps), longer)


def _open(owner: str, store: Any, discrete: Any, events: Any, *, throw: bool, progress: bool) -> tuple["Stream", Run]:
    stream, attributes = io.orbits.open_stream(store, f"{owner}(store=...)"), io.metadata.read_attributes(store)
    motion = io.provenance.restore_motion(attributes, discrete, owner)
    backend = "jax" if motion.route_name == "definition" else "auto"
    stepper = stepper_of(motion, attributes.get("branch", "principal"), backend, with_poses=stream.reconstruct)
    watch = watch_of_store(owner, stream, stepper, events)
    run = Run(stepper, stream.plan.steps, stream.plan.every, watch, throw, progress)
    if discrete is not None:
        refuse_other_functions(owner, stream, run)
    return stream, run
