"""Checks and preparations of a sweep before any work: the task, the design, one member tried, an empty store."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from nonholo import io
from nonholo.base.checks import count, error, shown
from nonholo.base.limits import within_disk, within_memory
from nonholo.base.progress import progress_bar
from nonholo.ensembles._describe import NO_NAME, design_text, differences, function_from, function_name
from nonholo.ensembles._ensemble_task import RULE, EnsembleTask, ensemble_task_from
from nonholo.ensembles._family_task import FamilyTask, family_task_from, imported_functions
from nonholo.ensembles._names import Axes, check_dimensions
from nonholo.ensembles._reductions import REDUCTIONS
from nonholo.ensembles.datasets import DatasetTask, dataset_task_from, is_own
from nonholo.ensembles.designs import Design, Grid, RandomDesign, axis_dimensions, block_of
from nonholo.ensembles.stores import AXIS, Output, SweepStore, Task, create_store, layout_of, open_store, probe_outputs
from nonholo.simulation import in_one_thread

_BLOCK = 4096  # most members of a block of a task that does not say how many
_PIECES = 32  # blocks of a small sweep, so that all cores have work to the end
_FILE = 4096  # bytes that a file takes at least, on most file systems
_LANES = 32  # members that a compiled loop takes at once
DESCRIBED = (DatasetTask, EnsembleTask, FamilyTask)
_MAKERS = {"EnsembleTask": ensemble_task_from, "FamilyTask": family_task_from, "DatasetTask": dataset_task_from}


def check_task(task: Any, design: Any) -> None:
    """Refuse what is no task and no design, or a design that the task does not know."""
    if not callable(task):
        remedy = "Pass an EnsembleTask, or a function of a MemberBlock."
        raise error("sweep(task=...)", "be callable", shown(task), remedy)
    if not isinstance(design, Grid | RandomDesign):
        remedy = "Pass nh.Grid({...}) or nh.RandomDesign(members, {...})."
        raise error("sweep(design=...)", "be a design", shown(design), remedy)
    if isinstance(task, DESCRIBED):
        task.check_design([*design.axes, *design.drawn])


def begin_store(
    task: Task, design: Design, path: Path, block: Any, scenario: str | None, *, progress: bool
) -> SweepStore:
    """Make the store of a sweep, after its task has been tried."""
    io.check_suffix(path, "sweep(store=...)")
    most, least = (task.block, _LANES) if isinstance(task, DESCRIBED) else (_BLOCK, 1)
    own = min(most, max(least, -(-design.members // _PIECES)))
    size = own if block is None else count("sweep(block=...)", block, "Pass how many members.")
    with in_one_thread(), progress_bar("compiling and trying a member", progress):
        results = probe_outputs(task, lambda first, some: block_of(design, first, some), design.members)
    axes = {name: tuple(f"{name}_{axis}" for axis in range(1, len(shape) + 1)) for name, shape in design.drawn.items()}
    draws = {name: Output(axes[name], shape, "float64", dict(AXIS)) for name, shape in design.drawn.items()}
    _check_names(design, draws, results)
    layout = layout_of(tuple(design.sizes.values()), size)
    _refuse_too_large(layout, draws | results, path)
    extra = {} if scenario is None else io.attributes_of_text(scenario)
    return create_store(path, _description(task, design), design, layout, draws | results, extra)


def _refuse_too_large(layout: io.Layout, outputs: dict[str, Output], path: Path) -> None:
    """Refuse blocks that memory does not hold, and results that the disk does not: numbers, and files of each block."""
    each = float(sum(math.prod(o.shape) * np.dtype(o.dtype).itemsize for o in outputs.values()))
    within_memory("sweep(block=...)", 2 * each * math.prod(layout.chunk), "Pass fewer members: a block is held whole.")
    on_disk = each * math.prod(layout.sizes) + _FILE * layout.blocks * (1 + len(outputs))
    within_disk("sweep(design=...)", on_disk, path, "Ask for fewer members, or for less of each.")


def _check_names(design: Design, draws: dict[str, Output], results: dict[str, Output]) -> None:
    """Refuse names that stand for two things, before anything is computed that nobody could open."""
    for name in filter(draws.__contains__, results):
        raise error("sweep(task=...)", "return names that the design does not have", shown(name), "Rename it.")
    members, lengths = tuple(design.sizes), tuple(design.sizes.values())
    coordinates = {name: Axes(axis_dimensions(name, x), x.shape) for name, x in design.axes.items()}
    outputs = (draws | results).items()
    check_dimensions({n: Axes(members + o.dimensions, lengths + o.shape) for n, o in outputs}, coordinates)


def grow(store: SweepStore, members: Any) -> SweepStore:
    """Return the store of a random design that is to have more members."""
    where, remedy = "resume(members=...)", "Pass a larger number, or leave it out."
    size, design = count(where, members, "Pass how many."), store.design
    if not isinstance(design, RandomDesign):
        raise error(where, "come with a random design", "a grid, which has no more members", "Run another grid.")
    if size < design.members:
        raise error(where, f"not be below the {design.members} members of the design", shown(size), remedy)
    if size == design.members:
        return store
    _refuse_too_large(io.Layout((size,), store.layout.chunk), store.outputs, store.path)
    with io.write_lock(store.path):
        return store.grow(size)


def check_same(store: SweepStore, task: Any, design: Design) -> None:
    """Refuse another task or design than that of a store, with the differences."""
    theirs = store.description
    if isinstance(task, EnsembleTask) and theirs["task"]["kind"] == "EnsembleTask":
        task = task.on_route_of(theirs["task"])
    ours = json.loads(json.dumps(_description(task, design)))
    flaws = list(differences(ours, theirs))
    if flaws:
        remedy = "Pass that task and design, or choose another path."
        raise error("sweep(store=...)", "hold this sweep", f"'{store.path}', where {'; '.join(flaws[:5])}", remedy)


def functions_of(store: str | Path) -> list[str]:
    """Return the names of the functions that the task of a store would import: all but those of the library."""
    entry = open_store(store).description["task"]
    if entry["kind"] == "FamilyTask":
        return imported_functions(entry)
    names = entry.get("reductions", []) if entry["kind"] in _MAKERS else [entry["name"]]
    names += filter(is_own, [entry.get("dataset", "")])
    return [name for name in names if name not in REDUCTIONS] + [entry[key] for key in (RULE,) if key in entry]


def restored_task(store: SweepStore, task: Any, *, trust: bool = False) -> Task:
    """Return the task of a store: the one that is given, or one made from its description.

    A function is imported by the name that the store gives only if the caller trusts it.
    """
    if task is not None:
        check_task(task, store.design)
        check_same(store, task, store.design)
        return _as_begun(store, task)
    _refuse_untrusted(store, functions_of(store.path), trust=trust)
    entry = store.description["task"]
    try:
        make = _MAKERS.get(entry["kind"], lambda entry: function_from(entry["name"]))
        return _as_begun(store, make(entry))
    except (ImportError, ValueError) as failure:
        remedy = f"Pass it: nonholo.resume('{store.path}', task=...)."
        raise error("resume(store=...)", "be a sweep whose task can be made again", f"{failure}", remedy) from failure


def _as_begun(store: SweepStore, task: Task) -> Task:
    """Return the task by the route that a store was begun with."""
    return task.on_route_of(store.description["task"]) if isinstance(task, EnsembleTask) else task


def _refuse_untrusted(store: SweepStore, names: list[str], *, trust: bool) -> None:
    remedy = f"Pass it: nonholo.resume('{store.path}', task=...)"
    if NO_NAME in names:
        raise error("resume(store=...)", "be a sweep whose task can be made again", NO_NAME, f"{remedy}.")
    if names and not trust:
        remedy += ", or trust=True (--trust) if you trust who made the store: what is named would run with your rights."
        got = f"'{store.path}', which names {', '.join(names)}"
        raise error("resume(store=...)", "name no function but the library's, unless trusted", got, remedy)


def _description(task: Any, design: Design) -> dict[str, Any]:
    entry = task.describe() if isinstance(task, DESCRIBED) else {"kind": "function", "name": function_name(task)}
    return {"task": entry, "design": design_text(design)}
