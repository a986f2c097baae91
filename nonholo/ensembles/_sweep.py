"""`sweep`: a task for every member of a design, block by block into one store; `load_sweep`: the result.

`resume`: resuming what a store holds, an orbit or a sweep. Before any work the task and the design are checked, one
member is tried, an empty store is made.
"""

import json
import math
import warnings
from pathlib import Path
from typing import Any, TextIO

import numpy as np
import xarray

from nonholo import io, simulation
from nonholo.base.checks import checked_path, count, error, flags, refuse_given, shown, within_disk, within_memory
from nonholo.base.progress import progress_bar
from nonholo.ensembles import stores
from nonholo.ensembles._ensemble_task import LANES, RULE, EnsembleTask, ensemble_task_from
from nonholo.ensembles._family_task import FamilyTask, family_task_from
from nonholo.ensembles._names import NO_NAME, check_dimensions, differences, function_from, function_name, is_own
from nonholo.ensembles._scheduling import Done, checked_scheduler, do_all
from nonholo.ensembles.datasets import DatasetTask, dataset_task_from
from nonholo.ensembles.designs import Design, Grid, RandomDesign, axis_dimensions, block_of
from nonholo.ensembles.stores import Output, SweepStore, Task, attributes_of, open_store, standing_of

_BLOCK = 4096  # most members of a block of a task that does not say how many
_PIECES = 32  # blocks of a small sweep, so that all cores have work to the end
_FILE = 4096  # bytes that a file takes at least, on most file systems
DESCRIBED = (DatasetTask, EnsembleTask, FamilyTask)
_MAKERS = {"EnsembleTask": ensemble_task_from, "FamilyTask": family_task_from, "DatasetTask": dataset_task_from}


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
    store = checked_path("sweep(store=...)", store)
    _check_task(task, design)
    if resume and store.exists():
        sweep_store = open_store(store, "sweep(store=...)")
        task = _same_task(sweep_store, task, design)
    else:
        sweep_store = _begin(task, design, store, block, scenario, progress=progress)
    return continue_sweep(sweep_store, task, name, workers, progress)


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
    sweep_store = open_store(checked_path(where, store))
    if not sweep_store.is_finished:
        got, remedy = f"'{store}', at {standing_of(store)}", f"Resume with nonholo.resume('{store}')."
        raise error(where, "be a finished sweep", got, remedy)
    sweep_store.check(where, range(sweep_store.layout.blocks))
    return stores.opened_result(sweep_store)


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
            functions. Other events raise an error. To read a finished orbit `load_orbit` needs none.
        task: The task of a sweep; needed if it is, or holds, a custom function, which a store only names.
        members: The new, larger number of members of a random design. The missing members are added in blocks of the
            same size, the others stay; the result has the bits of a sweep of all of them.
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
    store = checked_path("resume(store=...)", store)
    if (kind := io.places.format_of(store)) is None and store.exists():
        got, remedy = f"'{store}', whose zarr.json does not record it", "Check the path, or run it again."
        raise error("resume(store=...)", "be a store of a run or a sweep", got, remedy)
    if kind != io.places.SWEEP_FORMAT:
        others = {"task": task, "members": members, "scheduler": scheduler, "workers": workers}
        own = {name: (value, None) for name, value in others.items()}
        refuse_given("resume", f"come with the store of a sweep, not '{store}'", "Leave it out for an orbit.", **own)
        return simulation.resume_run(store, discrete=discrete, events=events, throw=throw, progress=progress)
    requirement, remedy = f"come with the store of an orbit, not '{store}'", "Pass task=..., or nothing."
    refuse_given("resume", requirement, remedy, discrete=(discrete, None), events=(events, None))
    name, workers = checked_scheduler(scheduler, workers)
    sweep_store = open_store(store, "resume(store=...)")
    task = _restored_task(sweep_store, task, trust=trust)
    if members is not None:
        sweep_store = _grow(sweep_store, members)
    return continue_sweep(sweep_store, task, name, workers, progress)


def continue_sweep(
    store: SweepStore, task: Task, scheduler: Any, workers: int | None, progress: bool
) -> xarray.Dataset:
    """Do every block that a store lacks, and open the result."""
    with io.places.write_lock(store.path):
        store.prepare()
        with io.orbits.reporting_how_to_resume(store.path, "The sweep", lambda: standing_of(store.path)):
            _complete(store, task, scheduler, workers, progress)
    return stores.opened_result(store)


def _complete(store: SweepStore, task: Task, scheduler: Any, workers: int | None, progress: bool) -> None:
    """Do every block, tell what was damaged and who works with other versions."""
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

        do_all(store, task, scheduler, workers, take)
    if not store.is_finished:
        store.blocks.finish({"finished": True})


def _warn(message: str) -> None:
    warnings.warn(message, RuntimeWarning, stacklevel=2)


def _check_task(task: Any, design: Any) -> None:
    """Refuse what is no task and no design, or a design that the task does not know."""
    if not callable(task):
        remedy = "Pass an EnsembleTask, or a function of a MemberBlock."
        raise error("sweep(task=...)", "be callable", shown(task), remedy)
    if not isinstance(design, Grid | RandomDesign):
        remedy = "Pass nh.Grid({...}) or nh.RandomDesign(members, {...})."
        raise error("sweep(design=...)", "be a design", shown(design), remedy)
    if isinstance(task, DESCRIBED):
        task.check_design([*design.axes, *design.drawn])


def _begin(task: Task, design: Design, place: Path, block: Any, scenario: str | None, *, progress: bool) -> SweepStore:
    """Make the store of a sweep, after its task has been tried."""
    io.places.check_suffix(place, "sweep(store=...)")
    most, least = (task.block, LANES) if isinstance(task, DESCRIBED) else (_BLOCK, 1)
    own = min(most, max(least, -(-design.members // _PIECES)))
    size = own if block is None else count("sweep(block=...)", block, "Pass how many members.")
    with simulation.in_one_thread(), progress_bar("compiling and trying a member", progress):
        results = stores.probe_outputs(task, lambda first, some: block_of(design, first, some), design.members)
    axes = {name: tuple(f"{name}_{axis}" for axis in range(1, len(shape) + 1)) for name, shape in design.drawn.items()}
    draws = {name: Output(axes[name], shape, "float64", dict(stores.AXIS)) for name, shape in design.drawn.items()}
    _check_names(design, draws, results)
    layout = stores.layout_of(tuple(design.sizes.values()), size)
    _refuse_too_large(layout, draws | results, place)
    extra = {} if scenario is None else io.provenance.attributes_of_text(scenario)
    return stores.create_store(place, _description(task, design), design, layout, draws | results, extra)


def _refuse_too_large(layout: io.blocks.Layout, outputs: dict[str, Output], place: Path) -> None:
    """Refuse blocks that memory does not hold, and results that the disk does not: numbers, and files of each block."""
    each = float(sum(math.prod(o.shape) * np.dtype(o.dtype).itemsize for o in outputs.values()))
    within_memory("sweep(block=...)", 2 * each * math.prod(layout.chunk), "Pass fewer members: a block is held whole.")
    on_disk = each * math.prod(layout.sizes) + _FILE * layout.blocks * (1 + len(outputs))
    within_disk("sweep(design=...)", on_disk, place, "Ask for fewer members, or for less of each.")


def _check_names(design: Design, draws: dict[str, Output], results: dict[str, Output]) -> None:
    """Refuse names that stand for two things, before anything is computed that nobody could open."""
    for name in filter(draws.__contains__, results):
        raise error("sweep(task=...)", "return names that the design does not have", shown(name), "Rename it.")
    members, lengths = tuple(design.sizes), tuple(design.sizes.values())
    coordinates = {name: (axis_dimensions(name, x), x.shape) for name, x in design.axes.items()}
    outputs = (draws | results).items()
    check_dimensions({n: (members + o.dimensions, lengths + o.shape) for n, o in outputs}, coordinates)


def _grow(store: SweepStore, members: Any) -> SweepStore:
    """Return the store of a random design that is to have more members."""
    where, remedy = "resume(members=...)", "Pass a larger number, or leave it out."
    size, design = count(where, members, "Pass how many."), store.design
    if not isinstance(design, RandomDesign):
        raise error(where, "come with a random design", "a grid, which has no more members", "Run another grid.")
    if size < design.members:
        raise error(where, f"not be below the {design.members} members of the design", shown(size), remedy)
    if size == design.members:
        return store
    _refuse_too_large(io.blocks.Layout((size,), store.layout.chunk), store.outputs, store.path)
    with io.places.write_lock(store.path):
        return store.grow(size)


def _same_task(store: SweepStore, task: Any, design: Design) -> Task:
    """Return the task by the route that began a store; refuse another one, or another design, with the differences."""
    theirs = store.description
    if isinstance(task, EnsembleTask) and theirs["task"]["kind"] == "EnsembleTask":
        task = task.on_route_of(theirs["task"])
    if flaws := list(differences(json.loads(json.dumps(_description(task, design))), theirs)):
        remedy = "Pass that task and design, or choose another path."
        raise error("sweep(store=...)", "hold this sweep", f"'{store.path}', where {'; '.join(flaws[:5])}", remedy)
    return task


@io.provenance.refusing_other_data("resume(store=...)", "a task of this version")
def functions_of(store: str | Path) -> list[str]:
    """Return the names of the functions that the task of a store would import: all but those of the library."""
    entry = open_store(store).description["task"]
    single = (entry.get(key, "") for key in ("name", "family", "dataset", RULE))
    return list(filter(is_own, map(str, (*single, *entry.get("reductions", [])))))


def _restored_task(store: SweepStore, task: Any, *, trust: bool) -> Task:
    """Return the task of a store: the one that is given, or one made from its description.

    A function is imported by the name that the store gives only if the caller trusts it.
    """
    if task is not None:
        _check_task(task, store.design)
        return _same_task(store, task, store.design)
    names, remedy = functions_of(store.path), f"Pass it: nonholo.resume('{store.path}', task=...)"
    if names and not trust and NO_NAME not in names:
        remedy += ", or trust=True (--trust) if you trust who made the store: what is named would run with your rights."
        got = f"'{store.path}', which names {', '.join(names)}"
        raise error("resume(store=...)", "name no function but the library's, unless trusted", got, remedy)
    entry = store.description["task"]
    try:
        if NO_NAME in names:  # before another one is imported
            raise ImportError(NO_NAME)
        return _MAKERS.get(entry["kind"], lambda entry: function_from(entry["name"]))(entry)
    except (AttributeError, ImportError, KeyError, TypeError, ValueError) as failure:
        requirement = "be a sweep whose task can be made again"
        raise error("resume(store=...)", requirement, f"{failure}", f"{remedy}.") from failure


def _description(task: Any, design: Design) -> dict[str, Any]:
    entry = task.describe() if isinstance(task, DESCRIBED) else {"kind": "function", "name": function_name(task)}
    return {"task": entry, "design": design.describe()}


_CSV = "sweep_to_csv(store=...)"


def sweep_to_csv(store: str | Path, target: str | Path | TextIO, *, overwrite: bool = False) -> None:
    """Write the last pose of each member of a sweep, with its number, its values of the design, its outcome and time.

    Columns of the pose are those of `Orbit.to_csv`, with angles between -pi and pi. Of a sweep that is not finished the
    finished blocks are written, and a `RuntimeWarning` gives their number.

    Args:
        store: A store of a sweep that kept "final_state" with poses.
        target: A new file, or a stream of text.
        overwrite: Replace an older file.

    Raises:
        FileExistsError: The target exists, and is not to be replaced.
        ValueError: The store holds no poses, or a system that it cannot hold as data, or is damaged; the message names
            the array and the chunk.

    Example:
        >>> sweep_to_csv("sweep.zarr", "poses.csv")  # doctest: +SKIP
    """
    sweep_store = open_store(checked_path(_CSV, store), _CSV)
    task = _task_with_poses(sweep_store)
    io.places.check_file(target, overwrite=overwrite)
    blocks = [block for block, _ in sweep_store.marks() if block < sweep_store.layout.blocks]
    sweep_store.check(_CSV, blocks)
    if len(blocks) < sweep_store.layout.blocks:
        warnings.warn(f"The sweep in '{store}' is not finished: {standing_of(store)}.", RuntimeWarning, stacklevel=2)
    with io.places.new_file(target, overwrite=overwrite) as file:
        one = block_of(sweep_store.design, 0, 1)
        values = [column for name, rows in one.items() for column in io.datasets.columns_of(name, rows.shape[1:], {})]
        names = ["member", *values, "outcome", *io.datasets.column_names(task.discrete.system.group)]
        file.writelines(io.tables.table_lines(names, (_columns(sweep_store, task, block) for block in blocks)))


def _task_with_poses(store: SweepStore) -> EnsembleTask:
    """Return the task without its reductions, of which poses need none."""
    entry = store.description["task"]
    if "final_state" not in entry.get("reductions", ()) or "final_pose" not in store.outputs:
        remedy = "Keep 'final_state' with reconstruct=True; nonholo.load_sweep(store) has other results."
        raise error(_CSV, "hold poses", f"'{store.path}', which holds none", remedy)
    try:
        return ensemble_task_from(entry | {"reductions": []})
    except (AttributeError, KeyError, TypeError, ValueError) as failure:
        remedy = "nonholo.load_sweep(store) has the poses as they are kept."
        raise error(_CSV, "hold its system as data", f"'{store.path}', {str(failure).rstrip('.')}", remedy) from failure


def _columns(store: SweepStore, task: EnsembleTask, block: int) -> list[np.ndarray]:
    piece = store.layout.piece(block)
    members = block_of(store.design, piece.first, piece.count)
    outcome, time, compact = (store.rows(name, piece) for name in ("outcome", "final_time", "final_pose"))
    group = task.discrete.system.group
    pose = io.datasets.separate_rows(group, group.matrix_from_pose(compact))
    values = (column for rows in members.values() for column in rows.reshape(piece.count, -1).T)
    return [members.index, *values, outcome, time, *pose.T]
