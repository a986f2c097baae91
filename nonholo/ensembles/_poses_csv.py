"""The last poses of the members of a sweep as CSV, block by block."""

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

import numpy as np

from nonholo import io
from nonholo.base.checks import error, path
from nonholo.ensembles._ensemble_task import EnsembleTask, ensemble_task_from
from nonholo.ensembles.designs import MemberBlock, block_of
from nonholo.ensembles.stores import SweepStore, open_store, standing_of

_WHERE = "sweep_to_csv(store=...)"
_WANTED = ("outcome", "final_time", "final_pose")


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
    sweep_store = open_store(path("sweep_to_csv(store=...)", store))
    task = _task(sweep_store)
    io.check_file(target, overwrite=overwrite)
    blocks = [block for block, _ in sweep_store.marks() if block < sweep_store.layout.blocks]
    sweep_store.check(_WHERE, blocks)
    if len(blocks) < sweep_store.layout.blocks:
        warnings.warn(f"The sweep in '{store}' is not finished: {standing_of(store)}.", RuntimeWarning, stacklevel=2)
    with io.new_file(target, overwrite=overwrite) as file:
        values = [name for name, _ in _flat(block_of(sweep_store.design, 0, 1))]
        names = ["member", *values, "outcome", *io.column_names(task.discrete.system.group)]
        file.writelines(io.table_lines(names, (_rows(sweep_store, task, block) for block in blocks)))


def _task(store: SweepStore) -> EnsembleTask:
    """Return the task without its reductions, of which poses need none."""
    entry = store.description["task"]
    if "final_state" not in entry.get("reductions", ()) or "final_pose" not in store.outputs:
        remedy = "Keep 'final_state' with reconstruct=True; nonholo.load_sweep(store) has other results."
        raise error(_WHERE, "hold poses", f"'{store.path}', which holds none", remedy)
    try:
        return ensemble_task_from(entry | {"reductions": []})
    except ValueError as failure:
        remedy = "nonholo.load_sweep(store) has the poses as they are kept."
        got = f"'{store.path}', {str(failure).rstrip('.')}"
        raise error(_WHERE, "hold its system as data", got, remedy) from failure


def _rows(store: SweepStore, task: EnsembleTask, block: int) -> np.ndarray:
    piece = store.layout.piece(block)
    members = block_of(store.design, piece.first, piece.count)
    outcome, time, compact = (store.rows(name, piece) for name in _WANTED)
    group = task.discrete.system.group
    pose = io.separate_rows(group, group.matrix_from_pose(compact))
    columns = [members.index, *(values for _, values in _flat(members)), outcome, time, *pose.T]
    rows = np.empty((piece.count, len(columns)), dtype=object)  # whole numbers are written as such
    for place, column in enumerate(columns):
        rows[:, place] = column.tolist()
    return rows


def _flat(block: MemberBlock) -> Iterator[tuple[str, np.ndarray]]:
    """Give every number of the values of members a name."""
    for name, values in block.items():
        for place in np.ndindex(values.shape[1:]):
            yield "_".join([name, *map(str, place)]), values[:, *place]
