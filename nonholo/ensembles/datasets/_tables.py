"""A data set as tables: a CSV file for each part, a row for each state."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from nonholo import io
from nonholo.base.limits import within_disk
from nonholo.ensembles.datasets._task import SPLITS
from nonholo.ensembles.stores import Output, SweepStore

_BYTES = 24.0  # of a number as text


def write_tables(store: SweepStore, folder: Path, ends: tuple[int, ...]) -> None:
    """Write the orbits of a finished store, those of each part to a file: their number, the time, all that varies."""
    names = [name for name, each in store.outputs.items() if each.dimensions[:1] == ("step",)]
    names.sort(key=lambda name: name != "time")
    columns = ["orbit", *(column for name in names for column in _columns(name, store.outputs[name]))]
    states = store.outputs["time"].shape[0] * store.design.members
    within_disk("dataset(file_format='csv')", _BYTES * states * len(columns), folder, "Free space, then call it again.")
    for part, begin, end in zip(SPLITS, (0, *ends), ends, strict=False):
        if begin < end:
            with io.new_file(folder / f"{part}.csv", overwrite=True) as file:
                file.writelines(io.table_lines(columns, _rows(store, names, begin, end)))


def _columns(name: str, output: Output) -> Iterator[str]:
    """Give the names of the numbers of a field: those of coordinates alone, others with that of the field."""
    if len(output.shape) == 1:
        yield name
        return
    labels = output.attributes.get("components") or [str(i) for i in range(output.shape[1])]
    for place in np.ndindex(output.shape[1:]):
        own = [labels[place[0]], *map(str, place[1:])]
        yield "_".join(own if name == "configuration" else [name.replace("_configuration", ""), *own])


def _rows(store: SweepStore, names: list[str], begin: int, end: int) -> Iterator[np.ndarray]:
    """Give the states of some orbits, block by block; rows after the end of an orbit are left out."""
    for block in range(store.layout.blocks):
        piece = store.layout.piece(block)
        members = np.arange(piece.first, piece.first + piece.count)
        wanted = (members >= begin) & (members < end)
        if not wanted.any():
            continue
        fields = [store.rows(name, piece)[wanted] for name in names]
        states = np.concatenate([each.reshape(*each.shape[:2], -1) for each in fields], axis=2)
        rows = np.empty((*states.shape[:2], 1 + states.shape[2]), dtype=object)  # whole numbers are written as such
        rows[..., 0], rows[..., 1:] = members[wanted, None], states
        yield rows[np.isfinite(states[..., 0])]
