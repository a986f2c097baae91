"""`resume` and `extend`: going on with a run that was written to a store."""

from pathlib import Path
from typing import cast

from nonholo import io
from nonholo._checks import count, error
from nonholo._results import Outcome
from nonholo.discrete import Discretization
from nonholo.io import Stream
from nonholo.orbit import Orbit
from nonholo.simulation._stored_run import go_on
from nonholo.simulation._stretch import CompiledRun, compiled_run


def resume(
    store: str | Path, *, discrete: Discretization | None = None, throw: bool = True, progress: bool = False
) -> Orbit:
    """Go on with the run of a store from its last checkpoint, with the bits of a run that was never stopped.

    Every finished block is read first. A missing, cut or changed chunk is reported by name in a `RuntimeWarning`, and
    its block is computed again. A finished, sound store is only loaded.

    Args:
        store: A store that `simulate(..., store=...)` began.
        discrete: The discretisation of the run; needed only if its system or group is of your own making, which a
            store cannot hold. Another one than that of the store is refused.
        throw: Raise if the run cannot go on; otherwise return the good steps and the outcome.
        progress: Show a progress bar on standard error.

    Returns:
        The orbit, as from `simulate(..., store=...)`.

    Raises:
        FileNotFoundError: There is nothing at the path.
        ValueError: The path is no store of a run with checkpoints, or of another schema or discretisation.
        BlockingIOError: Another process is writing the store; the message names it.
        OSError: The disk is full; the store stays valid.
        OutcomeError: With `throw`, the run could not go on.

    Example:
        >>> orbit = nh.resume("run.zarr")  # doctest: +SKIP
    """
    path, run = _opened(store, discrete)
    with io.locked(path):
        return go_on(run, io.open_stream(path), throw=throw, progress=progress)


def extend(
    store: str | Path,
    steps: int,
    *,
    discrete: Discretization | None = None,
    throw: bool = True,
    progress: bool = False,
) -> Orbit:
    """Run past the end of the run of a store, with the bits of one that had been that long from the start.

    A last block that was not full is computed again with what follows it.

    Args:
        store: A store that `simulate(..., store=...)` made.
        steps: How many steps more.
        discrete: As in `resume`.
        throw: As in `resume`.
        progress: Show a progress bar on standard error.

    Returns:
        The whole orbit, as from `simulate(..., store=...)`.

    Raises:
        ValueError: A bad number of steps, or a run that ended because it could not go on; and as in `resume`.
        BlockingIOError: Another process is writing the store; the message names it.
        OSError: The disk is full; `resume` goes on.
        OutcomeError: With `throw`, the run could not go on.

    Example:
        >>> orbit = nh.extend("run.zarr", 1_000_000)  # doctest: +SKIP
    """
    steps = count("extend(steps=...)", steps, "Pass how many steps more.")
    path, run = _opened(store, discrete)
    with io.locked(path):
        outcome = io.read_attributes(path).get("outcome", Outcome.successful.name)
        if outcome != Outcome.successful.name:
            remedy = f"{Outcome[outcome].message} More steps from there do not exist."
            raise error("extend(store=...)", "be a run that can go on", f"outcome {outcome}", remedy)
        return go_on(run, io.open_stream(path).lengthened(steps), throw=throw, progress=progress)


def _opened(store: str | Path, discrete: Discretization | None) -> tuple[Path, CompiledRun]:
    stream: Stream = io.open_stream(store)
    motion = cast(Discretization, io.restore_motion(io.read_attributes(store), discrete))
    run = compiled_run("resume(store=...)", motion, "principal", "auto", stream.plan.every, stream.reconstruct)
    return stream.path, run
