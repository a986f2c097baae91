"""`sweep`: a task for every member of a design, block by block into one store; `load_sweep`: the result."""

from pathlib import Path
from typing import Any

import xarray

from nonholo.base.checks import error, flags, path
from nonholo.ensembles._begin import begun, check_same, check_task, restored_task
from nonholo.ensembles._blocks import Work
from nonholo.ensembles._resume import continue_sweep
from nonholo.ensembles._scheduling import checked_scheduler
from nonholo.ensembles.designs import Design
from nonholo.ensembles.stores import open_store, opened_result, standing_of


def sweep(
    task: Any,
    design: Design,
    store: str | Path,
    scheduler: str | None = None,
    *,
    workers: int | None = None,
    block: int | None = None,
    resume: bool = False,
    progress: bool = False,
    scenario: str | None = None,
) -> xarray.Dataset:
    """Run a task for every member of a design and keep what it returns in one store.

    The result does not depend on how members are cut in blocks, on workers or on what was interrupted: members take
    their random numbers by their index. `outcome` says how each member ended; a member for which the task raises has
    no numbers (NaN, the least integer) and the outcome 100, and the others are done.

    Args:
        task: An `EnsembleTask`, or a function of a `MemberBlock` that returns a dictionary of arrays with a leading
            member axis. Of a tuple (dimensions, array) the names label the other axes.
        design: A `Grid` or a `RandomDesign`.
        store: A new path, usually named `*.zarr`; for a cluster one that all workers see.
        scheduler: "threads" (the default: embedded, nothing to start), "processes" for functions that hold the
            interpreter's lock, or the address `tcp://host:port` of a Dask scheduler.
        workers: How many threads or processes; by default one for each core.
        block: Most members in a block, which is one chunk on disk and one piece of work; a store that is there keeps
            its own.
        resume: Resume the store of this very task and design, if there is one.
        progress: Show a progress bar on standard error.
        scenario: Text that is kept in the store.

    Returns:
        The result, one dimension for each axis of a grid, else `member`; loaded lazily from the store.

    Raises:
        ValueError: A bad argument, a path with the suffix of another format, or a task that raises for every member
            tried, before anything is written; with `resume` another task or design than that of the store, with the
            difference.
        FileExistsError: There is something at the path.
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
        opened = open_store(store)
        check_same(opened, task, design)
        task = restored_task(opened, task)
    else:
        opened = begun(task, design, store, block, scenario, progress=progress)
    return continue_sweep(Work(opened, task), name, workers, progress)


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
    opened = open_store(path(where, store))
    if not opened.is_finished:
        got, remedy = f"'{store}', at {standing_of(store)}", f"Resume with nonholo.resume('{store}')."
        raise error(where, "be a finished sweep", got, remedy)
    opened.check(where, range(opened.layout.blocks))
    return opened_result(opened)
