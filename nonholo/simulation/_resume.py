"""Resuming a run that was written to a store: the part of `resume` for orbits, and `extend`."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from nonholo import io
from nonholo.base.checks import count, error, flags, path, shown
from nonholo.base.limits import within_disk
from nonholo.base.results import Outcome
from nonholo.simulation._options import check_forces, stepper_of
from nonholo.simulation._run import Run
from nonholo.simulation._same import refuse_other_functions, watch_of_store
from nonholo.simulation._stored import continued

if TYPE_CHECKING:
    from nonholo.io import Stream


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
