"""Resuming a run that was written to a store: the part of `resume` for orbits, and `extend`."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from nonholo import io
from nonholo.base.checks import count, error, flags, path, shown
from nonholo.base.limits import within_disk
from nonholo.base.results import Outcome
from nonholo.simulation._simulate import refuse_what_bodies_have
from nonholo.simulation.events import Watch
from nonholo.simulation.runs import check_forces, closed_step, compiled_run
from nonholo.simulation.stores import continue_run, refuse_other_functions, watch_of_store

if TYPE_CHECKING:
    from nonholo.io import Stream


def resume_run(store: str | Path, *, discrete: Any, events: Any, throw: bool, progress: bool) -> Any:
    """Resume the run of a store: what `resume` does once it has asked the store, and found no sweep."""
    stream, run, watch = _opened("resume", store, discrete, events)
    with io.locked(stream.path):
        return continue_run(run, io.open_stream(stream.path), watch, throw=throw, progress=progress)


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
    stream, run, watch = _opened("extend", store, discrete, events)
    with io.locked(stream.path):
        _refuse_ended(io.read_attributes(stream.path))
        size, remedy = 8.0 * (steps // run.every) * (1 + sum(run.sizes)), "Pass fewer steps."
        within_disk("extend(steps=...)", size, stream.path, remedy)
        longer = io.open_stream(stream.path).lengthened(steps)
        check_forces("extend", run.discrete, longer.plan.steps)
        longer.announce(steps)
        return continue_run(run, longer, watch, throw=throw, progress=progress)


def _refuse_ended(stored: dict[str, Any]) -> None:
    """Refuse a run that came to its end before its last step."""
    outcome, event = stored.get("outcome", Outcome.successful.name), stored.get("stopped_by")
    if event is not None:
        remedy = "Run it again without `stop`, or with a later one, to go past it."
        raise error("extend(store=...)", "be a run that can continue", f"one that the event {event!r} ended", remedy)
    if outcome != Outcome.successful.name:
        remedy = f"{Outcome[outcome].message} More steps from there do not exist."
        raise error("extend(store=...)", "be a run that can continue", f"outcome {outcome}", remedy)


def _opened(owner: str, store: str | Path, discrete: Any, events: Any) -> tuple["Stream", Any, Watch | None]:
    stream = io.open_stream(store)
    motion, every = io.restore_motion(io.read_attributes(store), discrete), stream.plan.every
    if not motion.runs_itself:
        run = compiled_run("resume(store=...)", motion, closed_step(motion), every, stream.reconstruct)
        return stream, run, watch_of_store(owner, stream, run, events)
    refuse_what_bodies_have(owner, events=events)
    run = motion.run(every)
    if discrete is not None:
        refuse_other_functions(owner, stream, run)
    return stream, run, None
