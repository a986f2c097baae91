"""Resuming a run that was written to a store: the part of `resume` for orbits, and `extend`."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from nonholo import io
from nonholo.base.checks import count, error, flags, path, shown
from nonholo.base.limits import within_disk
from nonholo.base.results import Outcome
from nonholo.orbit import AbstractStepper
from nonholo.simulation._options import check_forces, stepper_of
from nonholo.simulation._run import Reached, Run, computed, orbit_at
from nonholo.simulation._stored import continued, descriptions, reached_at, seen_by
from nonholo.simulation.events import Watch, checked_events, search, watched

if TYPE_CHECKING:
    from nonholo.io import Stream

_SAME = 1e-9  # of 1 + the largest number: rounding of other versions and processors is far less


def watch_of_store(owner: str, stream: "Stream", stepper: AbstractStepper[Any], events: Any) -> Watch | None:
    """Return what the run of a store looks for; refused if it is not what the store says."""
    text, where = io.read_attributes(stream.path).get("events"), f"{owner}(events=...)"
    chosen, stored = [] if events is None else events, json.loads(text or "[]")
    if text is None and not checked_events(owner, chosen):
        return None
    wanted = f"be the events of the store, {io.events_text(stored)}"
    if events is None and stored:
        remedy = "Pass events=[...] again, in that order with these directions and stops: a store holds no functions."
        raise error(where, wanted, f"None for '{stream.path}'", remedy)
    watch = watched(owner, stepper, chosen)
    passed = descriptions(watch.events)
    if passed != stored:
        raise error(where, wanted, io.events_text(passed), "Pass the ones it was run with.")
    _refuse_other_values(where, stream, stepper, watch)
    return watch


def _refuse_other_values(where: str, stream: "Stream", stepper: AbstractStepper[Any], watch: Watch) -> None:
    """Refuse events that have other values at the first state than the store says."""
    try:
        first = stream.checkpoint(0)
    except io.DamagedError:
        return  # whoever needs it to continue says so
    if first.of_events is None:
        return
    seen, _ = search(watch, orbit_at(stepper, first.vector, 0))
    for name, now, then in zip(watch.events, seen_by(seen).values, first.of_events.values, strict=True):
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
    for block in sorted(stream.block_numbers(), reverse=True):
        try:
            if stream.sound(block).done > stream.checkpoint(block).done:
                return block
        except io.DamagedError:
            continue  # whoever computes it again says so
    return None


def resume_run(store: str | Path, *, discrete: Any, events: Any, throw: bool, progress: bool) -> Any:
    """Resume the run of a store: what `resume` does once it has asked the store, and found no sweep."""
    stream, run = _opened("resume", store, discrete, events, throw=throw, progress=progress)
    with io.write_lock(stream.path):
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
    with io.write_lock(stream.path):
        _refuse_ended(io.read_attributes(stream.path))
        numbers, remedy = 1 + sum(run.stepper.columns.values()), "Pass fewer steps."
        size = 8.0 * (steps // run.every) * numbers
        within_disk("extend(steps=...)", size, stream.path, remedy)
        longer = io.open_stream(stream.path).longer(steps)
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
