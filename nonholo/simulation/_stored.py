"""Runs that are written to a store block by block, in bounded memory: they can stop at any moment, and go on later."""

import dataclasses
import functools
import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from nonholo import io
from nonholo.base.checks import count, error, flags, path, shown
from nonholo.base.limits import within_disk
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome
from nonholo.discrete import BranchRule
from nonholo.io import Checkpoint, Seen
from nonholo.orbit import AbstractStepper, First
from nonholo.simulation._options import check_forces, stepper_of
from nonholo.simulation._run import Reached, Run, blocks, computed, opened, orbit_at, rows_of_block
from nonholo.simulation.events import Event, Watch, checked_events, search, watched

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
    with io.locked(stream.path):
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
    return f"{stream.reached()} of {stream.plan.steps}"


def _completed(run: Run, stream: "Stream") -> Checkpoint:
    """Compute every block that is missing or damaged; return the end of the run."""
    marked, is_computed = max(stream.marked(), default=-1), not stream.is_finished

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
    states = 1 + reached.done // run.every + (0 if reached.seen is None else int(reached.seen.counts.sum()))
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
    watch, seen = run.watch, kept.seen
    if watch is not None and seen is not None:
        stopped = tuple(watch.events)[seen.stopped] if kept.is_stopped else None
        known = {"counts": tuple(map(int, seen.counts)), "values": seen.values[:, None], "heading": seen.heading}
        watch = dataclasses.replace(watch, stopped_by=stopped, **known)
    return Reached(kept.done, kept.outcome, kept.vector, watch)


def size_in_blocks(discrete: Any, branch: BranchRule, steps: int, every: int) -> int:
    """Return the bytes of all states of a run if it can go into a store block by block and takes several, else 0."""
    run = Run(stepper_of(discrete, branch, "auto", posed=True), steps, every, None, throw=False, progress=False)
    states = 1 + steps // every
    numbers = 8 * states * run.stepper.width
    return numbers if states > rows_of_block("", run, None) else 0


_SAME = 1e-9  # of 1 + the largest number: rounding of other versions and processors is far less


def watch_of_store(owner: str, stream: "Stream", stepper: AbstractStepper[Any], events: Any) -> Watch | None:
    """Return what the run of a store looks for; refused if it is not what the store says."""
    text, where = io.read_attributes(stream.path).get("events"), f"{owner}(events=...)"
    chosen, stored = [] if events is None else events, json.loads(text or "[]")
    if text is None and not checked_events(owner, chosen):
        return None
    wanted = f"be the events of the store, {io.described(stored)}"
    if events is None and stored:
        remedy = "Pass events=[...] again, in that order with these directions and stops: a store holds no functions."
        raise error(where, wanted, f"None for '{stream.path}'", remedy)
    watch = watched(owner, stepper, chosen)
    passed = descriptions(watch.events)
    if passed != stored:
        raise error(where, wanted, io.described(passed), "Pass the ones it was run with.")
    _refuse_other_values(where, stream, stepper, watch)
    return watch


def _refuse_other_values(where: str, stream: "Stream", stepper: AbstractStepper[Any], watch: Watch) -> None:
    """Refuse events that have other values at the first state than the store says."""
    try:
        first = stream.checkpoint(0)
    except io.DamagedError:
        return  # whoever needs it to continue says so
    if first.seen is None:
        return
    seen, _ = search(watch, orbit_at(stepper, first.vector, 0))
    for name, now, then in zip(watch.events, seen_by(seen).values, first.seen.values, strict=True):
        if abs(now - then) > _SAME * (1 + abs(then)):
            got = f"another one of {name!r}: {now:.17g} instead of {then:.17g} at the first state"
            raise error(where, "be the functions of the store", got, "Pass those it was run with.")


def refuse_other_functions(owner: str, stream: "Stream", run: Run) -> None:
    """Refuse a run whose first saved states of the last sound block are not those of the store, to the last bit.

    To rounding, if the store was begun with other versions.
    """
    block = _last_sound(stream)
    if block is None:
        return
    begin, reached = stream.checkpoint(block), stream.sound(block)
    plan = stream.plan._replace(steps=min(begin.done + run.every, reached.done))
    reached_then = reached_at(run, begin)
    if reached_then.watch is None or not reached_then.watch.has_walls:
        reached_then = Reached(begin.done, Outcome.successful, begin.vector, None)
    orbit, again = computed(run.stepper, plan, block, reached_then, lambda *_: None)
    tolerance = _SAME if io.other_versions(io.read_attributes(stream.path)) else 0.0
    pairs = {
        name: (rows, stream.rows(name, block * plan.rows, len(orbit)))
        for name, rows in stream.columns(orbit, block * plan.rows).items()
    }
    pairs["the last step"] = np.array(again.done), np.array(plan.steps)
    if again.done == reached.done:  # of the row, which is among the variables, nothing is asked
        own = slice(run.stepper.width, None)
        pairs["the state"] = again.state[own], reached.vector[own]
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
    for block in sorted(stream.marked(), reverse=True):
        try:
            if stream.sound(block).done > stream.checkpoint(block).done:
                return block
        except io.DamagedError:
            continue  # whoever computes it again says so
    return None


def resume_run(store: str | Path, *, discrete: Any, events: Any, throw: bool, progress: bool) -> Any:
    """Resume the run of a store: what `resume` does once it has asked the store, and found no sweep."""
    stream, run = _opened("resume", store, discrete, events, throw=throw, progress=progress)
    with io.locked(stream.path):
        return continued(run, io.open_stream(stream.path))


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
    store = path("extend(store=...)", store)
    if task is not None:
        raise error("extend(task=...)", "come with the store of a sweep", shown(task), "Leave it out for an orbit.")
    steps = count("extend(steps=...)", steps, "Pass how many steps more.")
    stream, run = _opened("extend", store, discrete, events, throw=throw, progress=progress)
    with io.locked(stream.path):
        _refuse_ended(io.read_attributes(stream.path))
        numbers, remedy = 1 + sum(run.stepper.columns.values()), "Pass fewer steps."
        size = 8.0 * (steps // run.every) * numbers
        within_disk("extend(steps=...)", size, stream.path, remedy)
        longer = io.open_stream(stream.path).lengthened(steps)
        check_forces("extend", run.stepper.motion, longer.plan.steps)
        longer.announce(steps)
        return continued(run._replace(steps=longer.plan.steps), longer)


def _refuse_ended(stored: dict[str, Any]) -> None:
    """Refuse a run that came to its end before its last step."""
    outcome, event = stored.get("outcome", Outcome.successful.name), stored.get("stopped_by")
    if event is not None:
        remedy = "Run it again without `stop`, or with a later one, to go past it."
        raise error("extend(store=...)", "be a run that can continue", f"one that the event {event!r} ended", remedy)
    if outcome != Outcome.successful.name:
        remedy = f"{Outcome[outcome].message} More steps from there do not exist."
        raise error("extend(store=...)", "be a run that can continue", f"outcome {outcome}", remedy)


def _opened(
    owner: str, store: str | Path, discrete: Any, events: Any, *, throw: bool, progress: bool
) -> tuple["Stream", Run]:
    stream, stored = io.open_stream(store), io.read_attributes(store)
    motion = io.restore_motion(stored, discrete)
    backend = "jax" if motion.route_name == "definition" else "auto"
    stepper = stepper_of(motion, stored.get("branch", "principal"), backend, posed=stream.reconstruct)
    watch = watch_of_store(owner, stream, stepper, events)
    run = Run(stepper, stream.plan.steps, stream.plan.every, watch, throw, progress)
    if discrete is not None:
        refuse_other_functions(owner, stream, run)
    return stream, run
