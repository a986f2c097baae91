"""The poses of a store, chunk by chunk: of an unfinished run those of its finished blocks."""

import json
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import zarr

from nonholo.base.checks import error
from nonholo.io._attributes import system_of
from nonholo.io._chunks import DamagedError, checked_block, opened_array
from nonholo.io._load import check_seals, read_attributes, stored_names
from nonholo.io._orbit_store import Stream, open_stream
from nonholo.io._places import owner_of
from nonholo.io.datasets import Stretch

_WHERE = "store_to_csv(store=...)"
_COMPACT, _RECORDED = ("time", "canonical_pose", "turned"), ("time", "configuration")


class StoredPoses(NamedTuple):
    """The part of a store that holds the poses: its system, the number of saved states, their arrays and the names."""

    path: Path
    system: Any
    rows: int
    places: dict[str, str]
    arrays: dict[str, zarr.Array]

    def check(self) -> None:
        """Read everything once, so that damage is found before the first row is used."""
        for _ in self.stretches():
            pass

    def stretches(self) -> Iterator[Stretch]:
        """Return the states chunk after chunk; only one chunk is in memory."""
        chunk = self.arrays["time"].chunks[0]
        for number in range(-(-self.rows // chunk)):
            own_rows = slice(self.rows - number * chunk)
            columns: dict[str, np.ndarray] = {}
            for name, array in self.arrays.items():
                index = (number,) + (0,) * (array.ndim - 1)
                columns[name] = checked_block(self.path, self.places[name], array, index)[own_rows]
            time, places = columns.pop("time"), columns.get("canonical_pose", columns.get("configuration"))
            yield Stretch(time, np.asarray(places), columns.get("turned"))


def open_poses(path: Path) -> StoredPoses:
    """Open a store, finished or not; a warning gives the length of an unfinished one."""
    attributes = read_attributes(path)
    try:
        shapes = json.loads(attributes["arrays"])
        system = system_of(
            attributes, _WHERE, "Write the orbit of nonholo.load_orbit(path, discrete=...) with its to_csv."
        )
        names = _RECORDED if "constraint_residual" in shapes else _COMPACT
        places = {name: array for name, array in stored_names(shapes, names).items() if array in shapes}
    except KeyError as failure:
        raise error(_WHERE, "hold complete attributes", f"'{path}' without {failure}", "Run it again.") from failure
    if names[1] not in places:
        remedy = "Run it again with reconstruct=True: poses cannot be added later."
        raise error(_WHERE, "hold poses", f"'{path}', which was run with reconstruct=False", remedy)
    if "outcome" in attributes:
        check_seals(path, attributes)
        arrays = {name: opened_array(path, array, tuple(shapes[array])) for name, array in places.items()}
        return StoredPoses(path, system, shapes["time"][0], places, arrays)
    stream = open_stream(path)
    rows = _state_count(stream)
    _warn(path, max(0, rows - 1) * stream.plan.every, stream.plan.steps)
    arrays = {name: opened_array(path, array, None) for name, array in places.items()}
    return StoredPoses(path, system, rows, places, arrays)


def _state_count(stream: Stream) -> int:
    """Return the number of saved states in the full blocks of an unfinished run, refused if one is damaged."""
    try:
        full = stream.full_blocks()
        for block in range(full):
            stream.sound(block)
    except DamagedError as flaw:
        remedy = f"nonholo.resume({str(stream.path)!r}) computes its block again."
        raise error(_WHERE, "hold sound blocks", f"{flaw}, in '{stream.path}'", remedy) from None
    return stream.state_count(full)


def _warn(path: Path, steps_done: int, steps: int) -> None:
    owner = owner_of(path)
    resume = f"Resume with nonholo.resume({str(path)!r}) (nonholo resume)."
    now = f"It is being written by {owner}." if owner else resume
    message = f"The run in '{path}' is not finished: its poses go up to step {steps_done} of {steps}. {now}"
    warnings.warn(message, RuntimeWarning, stacklevel=4)
