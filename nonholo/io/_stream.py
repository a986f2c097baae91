"""Stores written block by block: one block is one chunk of each array, then its checkpoint, which marks it finished.

Row b of `run/checkpoints` is the state of the run where block b begins: the step, the outcome, the vector of the run.
Row b + 1 is written after the chunks of block b, also those of the crossings that events found in it (`run/events`),
and ends with what is needed to look for more. All writes are atomic, so a run can be killed at any moment. While a
store is unfinished it has no outcome among its attributes and no consolidated metadata.
"""

import dataclasses
import functools
import json
import os
import uuid
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray
import zarr

from nonholo.base.checks import error
from nonholo.base.types import Float
from nonholo.io._attributes import attributes, attributes_of_text
from nonholo.io._beside import new_beside
from nonholo.io._chunks import DamagedError
from nonholo.io._load import read_attributes
from nonholo.io._lock import owner_of
from nonholo.io._metadata import OrbitMetadata, check_array, require_identity
from nonholo.io._plan import Checkpoint, Plan, packed_checkpoint
from nonholo.io._save import (
    check_target,
    consolidate,
    create_array,
    create_groups,
    edit_attributes,
    new_group,
    put_in_place,
    remove_partials,
)
from nonholo.io._seals import BEFORE, CHECKPOINTS, Blocks, seal_of
from nonholo.io._stored_events import EVENTS, Seen, known, rows_of, seen_nothing
from nonholo.io.datasets import HEADED, stored_variables
from nonholo.orbit import EventLog


@dataclasses.dataclass(frozen=True)
class Stream:
    """A store that a run is written to.

    Attributes:
        path: Where it is.
        plan: How the run is cut.
        reconstruct: Whether poses are kept.
        made: Which one it is: another store at the same path has another number.
    """

    path: Path
    plan: Plan
    reconstruct: bool
    made: str | None

    @property
    def is_finished(self) -> bool:
        """Whether the run came to its end, or can go no further."""
        return "outcome" in read_attributes(self.path)

    def write(self, block: int, orbit: Any, reached: Checkpoint) -> None:
        """Write the chunks of a block, then the checkpoint at its end, which seals them."""
        require_identity(self.path, self.made)
        self._remove(block)
        chunks = 0
        if orbit.events is not None and reached.seen is not None:
            write_crossings(self._arrays[EVENTS], orbit.events, reached.seen.chunks)
            chunks = reached.seen.chunks - chunks_of(self._arrays[EVENTS], orbit.events)
        first = block * self.plan.rows
        variables = stored_variables(orbit, self._turn_before(first)) if len(orbit) else {}
        for name, variable in variables.items():
            self._arrays[name][first : first + len(orbit)] = np.ascontiguousarray(variable.values)
        seal = self._blocks.seal(block, reached, chunks)
        self._arrays[CHECKPOINTS][block + 1] = np.append(packed_checkpoint(reached), seal)

    def checkpoint(self, block: int) -> Checkpoint:
        """Return the state at the begin of a block, unless its chunk is damaged (`DamagedError`)."""
        return self._blocks.checkpoint(block)

    def rows(self, name: str, first: int, count: int) -> np.ndarray:
        """Return some rows of an array of sound blocks."""
        return np.asarray(self._arrays[name][first : first + count])

    def marked(self) -> set[int]:
        """Return the blocks at whose end there is a checkpoint, sound or not; the folder is read once."""
        first = self._blocks.file(CHECKPOINTS, 0)
        folder = first.parent.parent
        numbers = (int(name) for name in os.listdir(folder) if name.isdecimal()) if folder.is_dir() else ()
        return {number - 1 for number in numbers if os.path.isfile(f"{folder}/{number}/{first.name}")} - {-1}

    def sound(self, block: int) -> Checkpoint:
        """Return the state at the end of a block that is marked as finished, of which every chunk is sound.

        Raises:
            DamagedError: One is not; the message says which, and how.
        """
        reached = self.checkpoint(block + 1)
        if reached.seen is not None:
            self._check_crossings(block, reached.seen)
        for name in self._blocks.names() if self.plan.has_rows(block, reached.done) else ():
            self._blocks.chunk(name, block)
        return self._blocks.ended(block)

    def reached(self) -> int:
        """Return the step up to which blocks are marked as finished."""
        marked = self.finished_blocks()
        try:
            return self.checkpoint(marked).done
        except DamagedError:
            return self.plan.begin(marked)

    def full_blocks(self) -> int:
        """Return the number of blocks from the first one on with all their rows, unless the last one is damaged."""
        full = self.finished_blocks()
        done = self.checkpoint(full).done
        return full - (full > 0 and done != self.plan.stop(full - 1))  # it failed, or was extended

    def saved(self, full: int) -> int:
        """Return the number of saved states in this many full blocks."""
        return min(full * self.plan.rows, 1 + self.plan.steps // self.plan.every)

    def finished_blocks(self) -> int:
        """Return the number of blocks, from the first one on, that are marked as finished."""
        marked = self.marked()
        return next(block for block in range(len(marked) + 1) if block not in marked)

    def finish(self, end: Checkpoint) -> None:
        """Cut the arrays to the good states, add the outcome and consolidate the metadata."""
        require_identity(self.path, self.made)
        shapes = self._fit(1 + end.done // self.plan.every)
        metadata: dict[str, Any] = {"outcome": end.outcome.name, "arrays": json.dumps(shapes)}
        if self.events is not None and end.seen is not None:
            cut_crossings(self._arrays[EVENTS], end.seen.chunks)
            metadata["crossings"] = json.dumps(end.seen.counts.tolist())
            metadata["stopped_by"] = self.events[end.seen.stopped] if end.is_stopped else None
        edit_attributes(self.path, metadata)
        consolidate(self.path)

    def _turn_before(self, row: int) -> np.ndarray | None:
        """Return the heading or the quaternion of the state before a row, on which what follows continues."""
        turned = [name for name in HEADED if name in self._arrays]
        return np.ravel(self._arrays[turned[0]][row - 1 : row])[None] if turned and row > 0 else None

    @functools.cached_property
    def events(self) -> tuple[str, ...] | None:
        """The names of the events that the run looks for; None if it looks for none."""
        stored = read_attributes(self.path).get("events")
        return None if stored is None else tuple(event["name"] for event in json.loads(stored))

    def chunks_after(self, chunks: int, log: EventLog) -> int:
        """Return the number of chunks of crossings with those of another block."""
        return chunks + chunks_of(self._arrays[EVENTS], log)

    def _check_crossings(self, block: int, seen: Seen) -> None:
        before = self.checkpoint(block).seen if block > 0 else None
        begin = seen_nothing(len(seen.counts)) if before is None else before
        chunks = [self._blocks.chunk(EVENTS, chunk, with_nan=True) for chunk in range(begin.chunks, seen.chunks)]
        check_rows(chunks, begin, seen, self.plan.begin(block))

    def lengthened(self, steps: int) -> "Stream":
        """Return the stream with this many more steps to go; a last block that was not full is computed again."""
        run = json.loads(read_attributes(self.path)["run"])
        if not self.is_finished and run.get("added") == steps:  # the same call again, which was stopped
            return self
        return dataclasses.replace(self, plan=self.plan._replace(steps=self.plan.steps + steps))

    def announce(self, added: int) -> None:
        """Say in the store how long the run is now, and how many steps were asked for."""
        run = json.loads(read_attributes(self.path)["run"]) | {"steps": self.plan.steps, "added": added}
        edit_attributes(self.path, {"run": json.dumps(run), "outcome": None, "crossings": None})

    def prepare(self) -> None:
        """Remove what a killed writer left and give the arrays their length; nothing here loses data."""
        remove_partials(self.path)
        if not self.is_finished:
            self._fit(1 + self.plan.steps // self.plan.every)
            checkpoints = self._arrays[CHECKPOINTS]
            if checkpoints.shape[0] != self.plan.blocks + 1:
                checkpoints.resize((self.plan.blocks + 1, checkpoints.shape[1]))

    def _fit(self, rows: int) -> dict[str, tuple[int, ...]]:
        shapes = {}
        for name in self._blocks.names():
            array = self._arrays[name]
            shapes[name] = (rows, *array.shape[1:])
            if array.shape != shapes[name]:
                array.resize(shapes[name])
        return shapes

    def _remove(self, block: int) -> None:
        """Remove a block, its checkpoint first: zarr would read a damaged chunk before it writes a part of it."""
        self._blocks.file(CHECKPOINTS, block + 1).unlink(missing_ok=True)
        for name in self._blocks.names():
            self._blocks.file(name, block).unlink(missing_ok=True)

    @functools.cached_property
    def _blocks(self) -> Blocks:
        events = None if self.events is None else len(self.events)
        return Blocks(self.path, self.plan, self._arrays, events)

    @functools.cached_property
    def _arrays(self) -> dict[str, zarr.Array]:
        shapes = json.loads(read_attributes(self.path)["arrays"])
        names = [*shapes, CHECKPOINTS]
        names += [EVENTS] if self.events is not None else []
        return {name: writable_array(self.path, name, shapes.get(name)) for name in names}


def create_stream(
    path: Path,
    first: Any,
    plan: Plan,
    opening: Checkpoint,
    events: list[dict[str, Any]] | None = None,
    scenario: str | None = None,
) -> Stream:
    """Make a store with the first checkpoint and no rows yet; it appears at the path only when it is complete."""
    extra = {} if events is None else {"events": json.dumps(events)}
    extra |= {} if scenario is None else attributes_of_text(scenario)
    target = path.resolve()
    check_target(target, new="simulate(store=...)")
    extra["made"] = uuid.uuid4().hex
    with new_beside(path) as part:
        _create(part, first, plan, opening, extra)
        put_in_place(part, target, overwrite=False)
    return Stream(target, plan, first.has_poses, extra["made"])


def open_stream(path: str | Path) -> Stream:
    """Return the stream of a store that a run was written to."""
    stored = read_attributes(path)
    if "run" not in stored:
        remedy = "Run it again with simulate(..., store=...) to be able to resume."
        raise error("resume(store=...)", "have checkpoints", f"'{path}', which was saved whole", remedy)
    run = json.loads(stored["run"])
    return Stream(Path(path).resolve(), Plan.of(stored), run["reconstruct"], stored.get("made"))


def writable_array(path: Path, name: str, shape: Sequence[int] | None = None) -> zarr.Array:
    """Open an array of a store to continue, of a known shape but for the number of rows."""
    where = "resume(store=...)"
    try:
        with zarr.config.set({"array.write_empty_chunks": True}):  # of NaN alone too: an impulse that is not known
            array = zarr.open_array(path / name, mode="r+", zarr_format=3)
    except Exception as failure:
        got = f"'{path}', where its metadata cannot be read: {failure}"
        raise error(where, f"hold the array {name}", got, "Run it again.") from failure
    check_array(where, name, array)
    if shape is not None and array.shape[1:] != tuple(shape[1:]):
        raise error(where, f"hold the array {name} with rows of shape {shape[1:]}", f"'{path}'", "Run it again.")
    return array


class Standing(NamedTuple):
    """Progress of an unfinished run: good steps that are kept, steps in total, and who is writing it, if anybody."""

    done: int
    steps: int
    owner: str | None


def standing(path: str | Path) -> Standing | None:
    """Say how far the run of a store came; None if it is finished."""
    stored = read_attributes(path)
    if "run" not in stored or "outcome" in stored:
        return None
    stream = open_stream(path)
    return Standing(stream.reached(), stream.plan.steps, owner_of(stream.path))


def _create(part: Path, first: Any, plan: Plan, opening: Checkpoint, extra: dict[str, str]) -> None:
    variables, rows = stored_variables(first), 1 + plan.steps // plan.every
    metadata = {name: value for name, value in attributes(first).items() if name != "outcome"}
    run = {"steps": plan.steps, "rows": plan.rows, "reconstruct": first.has_poses, "lead": plan.lead}
    shapes = {name: (rows, *variable.shape[1:]) for name, variable in variables.items()}
    metadata |= {"run": json.dumps(run), "arrays": json.dumps(shapes), **extra}
    group = new_group(part, metadata, OrbitMetadata)
    create_groups(group, variables)
    for name, variable in variables.items():
        create_array(group, name, variable, rows, plan.rows)
    row = np.append(packed_checkpoint(opening), seal_of(part, BEFORE, []))
    group.create_group("run")
    labeled = xarray.Variable(("block", "entry"), row[None])
    checkpoints = create_array(group, CHECKPOINTS, labeled, plan.blocks + 1, 1)
    checkpoints[0] = row
    if first.events is not None:
        create_crossings(group, first.events)


_NUMBERS, _MOST = 1 << 16, 1 << 10  # at most in a chunk: numbers, rows


def create_crossings(group: zarr.Group, log: EventLog) -> None:
    """Make the array, without rows yet, for crossings like those of a log."""
    rows = xarray.Variable(("crossing", "entry"), rows_of(log))
    create_array(group, EVENTS, rows, 0, max(1, min(_MOST, _NUMBERS // rows.shape[1])))


def chunks_of(array: zarr.Array, log: EventLog) -> int:
    """Return how many chunks the crossings of a block fill."""
    return -(-sum(map(len, log.found)) // array.chunks[0])


def write_crossings(array: zarr.Array, log: EventLog, after: int) -> None:
    """Write the crossings of a block into whole chunks, the last of them the one before a number."""
    size, width = array.chunks
    full = np.full((chunks_of(array, log) * size, width), np.nan)
    if not len(full):
        return
    rows = rows_of(log)
    full[: len(rows)] = rows
    if array.shape[0] < after * size:
        array.resize((after * size, width))
    array[after * size - len(full) : after * size] = full


def cut_crossings(array: zarr.Array, chunks: int) -> None:
    """Cut the array to the chunks of a finished run."""
    array.resize((chunks * array.chunks[0], array.shape[1]))


def check_rows(chunks: Sequence[Float[np.ndarray, "D width"]], begin: Seen, end: Seen, step: int) -> None:
    """Check that chunks hold the crossings that two checkpoints count, the first one at a step."""
    rows = known(np.concatenate(chunks)) if chunks else np.empty((0, 2))
    counts = np.bincount(rows[:, 0].astype(np.int64), minlength=len(end.counts))
    if not np.array_equal(counts, end.counts - begin.counts) or np.any(rows[:, 1] < step):
        place = f"chunks {begin.chunks} to {end.chunks - 1} of the array {EVENTS}"
        raise DamagedError(f"other crossings than its checkpoint says, {place}")
