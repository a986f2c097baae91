"""`sweep`: a task for every member of a design, block by block into one store; `load_sweep`: the result.

`resume`: resuming what a store holds, an orbit or a sweep.
"""

import warnings
from pathlib import Path
from typing import Any

import xarray

from nonholo import io, simulation
from nonholo.base.checks import error, flags, path, shown
from nonholo.base.progress import progress_bar
from nonholo.ensembles._begin import begin_store, check_same, check_task, grow, restored_task
from nonholo.ensembles._scheduling import Done, Work, checked_scheduler, do_all
from nonholo.ensembles.designs import Design
from nonholo.ensembles.stores import attributes_of, open_store, opened_result, standing_of


def sweep(
    task: Any,
    design: Design,
    store: str | Path,
    scheduler: Any = None,
    *,
    workers: int | None = None,
    block: int | None = None,
    resume: bool = False,
    progress: bool = False,
    scenario: str | None = None,
) -> xarray.Dataset:
    """Run a task for every member of a design and keep its results in one store.

    The result does not depend on blocks, workers or interruptions: members take their random numbers by their
    index. `outcome` records how each member ended. If the task raises for a member, its
    numbers are missing (NaN, the least integer) and its outcome is 100. The other members run.

    Args:
        task: An `EnsembleTask`, or a function of a `MemberBlock` that returns a dictionary of arrays with a leading
            member axis. In a tuple (dimensions, array) the names label the other axes.
        design: A `Grid` or a `RandomDesign`.
        store: A new path, usually named `*.zarr`; for a cluster one that all workers see.
        scheduler: "threads" (the default: embedded, nothing to start), "processes" for functions that hold the
            interpreter's lock, the address `tcp://host:port` of a Dask scheduler, or a `distributed.Client`, which
            stays open.
        workers: How many threads or processes; by default one for each core.
        block: Most members in a block, which is one chunk on disk and one piece of work; an existing store keeps its
            block size.
        resume: Resume the store of this very task and design, if there is one.
        progress: Show a progress bar on standard error.
        scenario: Text that is kept in the store.

    Returns:
        The result, one dimension for each axis of a grid, else `member`; loaded lazily from the store.

    Raises:
        ValueError: A bad argument, a path with the suffix of another format, or a task that raises for every member
            tried, before anything is written; with `resume` a task or design that differs from the store's; the
            message shows the difference.
        FileExistsError: The path exists.
        BlockingIOError: Another process is writing the store; the message names it.
        OSError: The disk is full, or a worker process was killed; the store stays valid, and `resume` continues.

    Example:
        >>> from tempfile import TemporaryDirectory
        >>> def sums(block):
        ...     return {"total": block["x"] + block["y"]}
        >>> with TemporaryDirectory() as folder:
        ...     result = nh.sweep(sums, nh.Grid({"x": [1.0, 2.0], "y": [10.0, 20.0, 30.0]}), f"{folder}/sums.zarr")
        ...     result["total"].sel(x=2.0).values
        array([12., 22., 32.])
    """
    name, workers = checked_scheduler(scheduler, workers)
    flags("sweep", resume=resume, progress=progress)
    store = path("sweep(store=...)", store)
    check_task(task, design)
    if resume and store.exists():
        sweep_store = open_store(store)
        check_same(sweep_store, task, design)
        task = restored_task(sweep_store, task)
    else:
        sweep_store = begin_store(task, design, store, block, scenario, progress=progress)
    return continue_sweep(Work(sweep_store, task), name, workers, progress)


def load_sweep(store: str | Path) -> xarray.Dataset:
    """Open the result of a finished sweep, after checking every chunk of it.

    Args:
        store: The store of a sweep.

    Raises:
        FileNotFoundError: There is nothing at the path.
        ValueError: The path is no store of a sweep, has another schema, is not finished, or is damaged; the message
            names the array and the chunk.

    Example:
        >>> result = nh.load_sweep("sweep.zarr")  # doctest: +SKIP
    """
    where = "load_sweep(store=...)"
    sweep_store = open_store(path(where, store))
    if not sweep_store.is_finished:
        got, remedy = f"'{store}', at {standing_of(store)}", f"Resume with nonholo.resume('{store}')."
        raise error(where, "be a finished sweep", got, remedy)
    sweep_store.check(where, range(sweep_store.layout.blocks))
    return opened_result(sweep_store)


def resume(
    store: str | Path,
    *,
    discrete: Any = None,
    events: Any = None,
    task: Any = None,
    members: int | None = None,
    trust: bool = False,
    scheduler: Any = None,
    workers: int | None = None,
    throw: bool = True,
    progress: bool = False,
) -> Any:
    """Resume the run or the sweep of a store, with the bits of one that was never stopped.

    Every finished block is read first. A missing, cut or changed chunk is reported by name in a `RuntimeWarning`, and
    its block is computed again, an orbit's from its last checkpoint. A store that is finished and sound is only opened.

    Args:
        store: A store that `simulate(..., store=...)` or `sweep` began.
        discrete: The discretization of an orbit; needed only if its system, group or Lagrangian is custom, which a
            store cannot hold. Another one than that of the store is refused; in coordinates its last saved states,
            computed again, must have the bits of the store.
        events: The events of an orbit that looks for some: a store holds their names, directions and stops, but no
            functions. Others than those of the store are refused. To read a finished orbit `load_orbit` needs none.
        task: The task of a sweep; needed if it is, or holds, a custom function, which a store only names.
        members: How many members a random design is to have, more than it has: it grows by those that are missing, in
            blocks as large as before. Those that are there stay; the result has the bits of a sweep of all of them.
        trust: Import those functions by the names that the store gives. They run with your rights: name only
            functions of a store whose maker you trust; without it nothing runs that you did not pass.
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
    kind = io.format_of(store)
    if kind is None and store.exists():
        got, remedy = f"'{store}', whose zarr.json does not record it", "Check the path, or run it again."
        raise error("resume(store=...)", "be a store of a run or a sweep", got, remedy)
    if kind == io.SWEEP_FORMAT:
        others, owner, remedy = {"discrete": discrete, "events": events}, "an orbit", "Pass task=..., or nothing."
    else:
        others, owner = {"task": task, "members": members, "scheduler": scheduler, "workers": workers}, "a sweep"
        remedy = "Leave it out for an orbit."
    for name, value in others.items():
        if value is not None:
            got = f"{shown(value)} for '{store}'"
            raise error(f"resume({name}=...)", f"come with the store of {owner}", got, remedy)
    if kind != io.SWEEP_FORMAT:
        return simulation.resume_run(store, discrete=discrete, events=events, throw=throw, progress=progress)
    name, workers = checked_scheduler(scheduler, workers)
    sweep_store = open_store(store)
    work = Work(sweep_store, restored_task(sweep_store, task, trust=trust))
    if members is not None:
        work = work._replace(store=grow(sweep_store, members))
    return continue_sweep(work, name, workers, progress)


def continue_sweep(work: Work, scheduler: Any, workers: int | None, progress: bool) -> xarray.Dataset:
    """Do every block that a store lacks, and open the result."""
    store = work.store
    with io.write_lock(store.path):
        store.prepare()
        with io.reporting_how_to_resume(store.path, "The sweep", lambda: standing_of(store.path)):
            _complete(work, scheduler, workers, progress)
    return opened_result(store)


def _complete(work: Work, scheduler: Any, workers: int | None, progress: bool) -> None:
    """Do every block, tell what was damaged and who works with other versions."""
    store = work.store
    total, count, versions = store.design.members, 0, {attributes_of(store.path)["versions"]}
    with progress_bar("members", progress) as report:
        report(0, total)

        def take(piece: Done) -> None:
            nonlocal count
            count += piece.mark.members
            report(count, total)
            if piece.damage:
                which = f"Block {piece.block} is computed again."
                _warn(f"The store '{store.path}' is damaged: {piece.damage}. {which}")
            if piece.versions not in versions:
                versions.add(piece.versions)
                others = f"{piece.mark.writer} has {piece.versions}: what it computes may differ in the last bits."
                ours = attributes_of(store.path)["versions"]
                _warn(f"The store '{store.path}' was begun with {ours}, but {others}")

        do_all(work, scheduler, workers, take)
    if not store.is_finished:
        store.finish()


def _warn(message: str) -> None:
    warnings.warn(message, RuntimeWarning, stacklevel=2)
