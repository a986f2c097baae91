"""`resume`: resuming what a store holds, an orbit or a sweep."""

import warnings
from pathlib import Path
from typing import Any

import xarray

from nonholo import io, simulation
from nonholo.base.checks import error, flags, path, shown
from nonholo.base.progress import progress_bar
from nonholo.discrete import Discretization
from nonholo.ensembles._begin import restored_task
from nonholo.ensembles._blocks import Done, Work
from nonholo.ensembles._scheduling import checked_scheduler, do_all
from nonholo.ensembles.stores import SweepStore, attributes_of, open_store, opened_result, standing_of


def resume(
    store: str | Path,
    *,
    discrete: Discretization | None = None,
    events: Any = None,
    task: Any = None,
    trust: bool = False,
    scheduler: str | None = None,
    workers: int | None = None,
    throw: bool = True,
    progress: bool = False,
) -> Any:
    """Resume the run or the sweep of a store, with the bits of one that was never stopped.

    Every finished block is read first. A missing, cut or changed chunk is reported by name in a `RuntimeWarning`, and
    its block is computed again, an orbit's from its last checkpoint. What is finished and sound is only opened.

    Args:
        store: A store that `simulate(..., store=...)` or `sweep` began.
        discrete: The discretization of an orbit; needed only if its system or group is custom, which a
            store cannot hold. Another one than that of the store is refused.
        events: The events of an orbit that looks for some: a store holds their names, directions and stops, but no
            functions. Others than those of the store are refused. To read a finished orbit `load_orbit` needs none.
        task: The task of a sweep; needed if it is, or holds, a custom function, which a store only names.
        trust: Import those functions by the names that the store gives. They run with your rights, whatever they are,
            so only for a store whose maker you trust; without it nothing runs that you did not pass.
        scheduler: As in `sweep`.
        workers: As in `sweep`.
        throw: Raise if an orbit cannot continue; otherwise return the good steps and the outcome.
        progress: Show a progress bar on standard error.

    Returns:
        The orbit, as from `simulate(..., store=...)`, or the result of the sweep.

    Raises:
        FileNotFoundError: There is nothing at the path.
        ValueError: The path is no store of a run with checkpoints or of a sweep, or of another schema, discretization,
            events or task.
        BlockingIOError: Another process is writing the store; the message names it.
        OSError: The disk is full; the store stays valid.
        OutcomeError: With `throw`, the orbit could not continue.

    Example:
        >>> orbit = nh.resume("run.zarr")  # doctest: +SKIP
    """
    flags("resume", trust=trust, throw=throw, progress=progress)
    store = path("resume(store=...)", store)
    stored = io.format_of(store)
    if stored is None and store.exists():
        got, remedy = f"'{store}', whose zarr.json does not say so", "Check the path, or run it again."
        raise error("resume(store=...)", "be a store of a run or a sweep", got, remedy)
    if stored == io.SWEEP_FORMAT:
        given, owner, remedy = {"discrete": discrete, "events": events}, "an orbit", "Pass task=..., or nothing."
    else:
        given, owner = {"task": task, "scheduler": scheduler, "workers": workers}, "a sweep"
        remedy = "Leave it out for an orbit."
    for name, value in given.items():
        if value is not None:
            got = f"{shown(value)} for '{store}'"
            raise error(f"resume({name}=...)", f"come with the store of {owner}", got, remedy)
    if stored != io.SWEEP_FORMAT:
        return simulation.resume_run(store, discrete=discrete, events=events, throw=throw, progress=progress)
    name, workers = checked_scheduler(scheduler, workers)
    opened = open_store(store)
    return continue_sweep(Work(opened, restored_task(opened, task, trust=trust)), name, workers, progress)


def continue_sweep(work: Work, scheduler: str, workers: int | None, progress: bool) -> xarray.Dataset:
    """Do every block that a store lacks, and open the result."""
    store = work.store
    with io.locked(store.path):
        store.prepare()
        with io.reporting_how_to_resume(store.path, "The sweep", lambda: standing_of(store.path)):
            _complete(work, scheduler, workers, progress)
    return opened_result(store)


def _complete(work: Work, scheduler: str, workers: int | None, progress: bool) -> None:
    """Do every block, tell what was damaged and who works with other versions."""
    store = work.store
    total, done, versions = store.design.members, 0, {attributes_of(store.path)["versions"]}
    with progress_bar("members", progress) as report:
        report(0, total)

        def take(finished: Done) -> None:
            nonlocal done
            done += finished.mark.members
            report(done, total)
            if finished.damaged:
                which = f"Block {finished.block} is computed again."
                _warn(f"The store '{store.path}' is damaged: {finished.damaged}. {which}")
            if finished.versions not in versions:
                versions.add(finished.versions)
                _warn(_other_versions(store, finished))

        do_all(work, scheduler, workers, take)
    if not store.is_finished:
        store.finish()


def _other_versions(store: SweepStore, finished: Done) -> str:
    return (
        f"The store '{store.path}' was begun with {attributes_of(store.path)['versions']}, but {finished.mark.writer} "
        f"has {finished.versions}: what it computes may differ in the last bits."
    )


def _warn(message: str) -> None:
    warnings.warn(message, RuntimeWarning, stacklevel=2)
