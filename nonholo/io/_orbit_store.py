"""The store of an orbit, written block by block: the mark of a block holds the state of the run where the block ends.

The mark before the first block is that of the start. What a mark says ends with what is needed to look for more events;
crossings that were found are the log of the store. While a store is unfinished it has no outcome among its attributes
and no consolidated metadata.
"""

import dataclasses
import functools
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import zarr

from nonholo.base.checks import error
from nonholo.io._attributes import attributes, attributes_of_text
from nonholo.io._beside import new_beside
from nonholo.io._chunks import DamagedError
from nonholo.io._load import plan_of, read_attributes
from nonholo.io._lock import owner_of
from nonholo.io._metadata import check_array
from nonholo.io._save import check_target, put_in_place
from nonholo.io._stored_events import EVENTS, Checkpoint, rows_of
from nonholo.io.blocks import (
    BEFORE,
    BlockStore,
    Layout,
    checkpoint_of,
    create_array,
    edit_attributes,
    new_blocks,
    said_of,
)
from nonholo.io.datasets import HEADED, Variable, stored_variables
from nonholo.orbit import Plan


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
    made: str

    @property
    def is_finished(self) -> bool:
        """Whether the run came to its end, or can go no further."""
        return "outcome" in read_attributes(self.path)

    def write(self, block: int, orbit: Any, reached: Checkpoint) -> None:
        """Write a block, and the state of the run at its end."""
        rows = self.columns(orbit, block * self.plan.rows) if len(orbit) else {}
        log = None if orbit.events is None else rows_of(orbit.events)
        self._blocks.write(block, rows, said_of(reached), log)

    def columns(self, orbit: Any, first: int) -> dict[str, np.ndarray]:
        """Return the arrays that the store has, of an orbit whose first state is a row of it."""
        variables = stored_variables(orbit, self._turn_before(first))
        return {name: variables[name].values for name in self._blocks.arrays}

    def checkpoint(self, block: int) -> Checkpoint:
        """Return the state at the begin of a block, unless the mark before it is damaged (`DamagedError`)."""
        mark = self._blocks.ended(BEFORE) if block == 0 else self._blocks.written(block - 1)
        return checkpoint_of(mark.about, self.events)

    def rows(self, name: str, first: int, count: int) -> np.ndarray:
        """Return some rows of an array of sound blocks."""
        return self._blocks.rows(name, (slice(first, first + count),))

    def marked(self) -> set[int]:
        """Return the blocks that are marked as finished, sound or not; the folder is read once."""
        return self._blocks.marked()

    def sound(self, block: int) -> Checkpoint:
        """Return the state at the end of a block that is marked as finished, of which every chunk is sound.

        Raises:
            DamagedError: One is not; the message says which, and how.
        """
        return checkpoint_of(self._blocks.sound(block).about, self.events)

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

    def finish(self, end: Checkpoint, block: int) -> None:
        """Cut the arrays to the good states of a run that ended in a block, and add the outcome."""
        shapes = self._blocks.resize(1 + end.done // self.plan.every)
        metadata: dict[str, Any] = {"outcome": end.outcome.name, "arrays": json.dumps(shapes)}
        if self.events is not None and end.seen is not None:
            self._blocks.cut_log(block)
            metadata["crossings"] = json.dumps(end.seen.counts.tolist())
            metadata["stopped_by"] = self.events[end.seen.stopped] if end.is_stopped else None
        self._blocks.finish(metadata)

    def _turn_before(self, row: int) -> np.ndarray | None:
        """Return the heading or the quaternion of the state before a row, on which what follows continues."""
        turned = [name for name in HEADED if name in self._blocks.arrays]
        return np.ravel(self._blocks.arrays[turned[0]][row - 1 : row])[None] if turned and row > 0 else None

    @functools.cached_property
    def events(self) -> tuple[str, ...] | None:
        """The names of the events that the run looks for; None if it looks for none."""
        stored = read_attributes(self.path).get("events")
        return None if stored is None else tuple(event["name"] for event in json.loads(stored))

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
        self._blocks.prepare()
        if not self.is_finished:
            self._blocks.resize(1 + self.plan.steps // self.plan.every)

    @functools.cached_property
    def _blocks(self) -> BlockStore:
        shapes = json.loads(read_attributes(self.path)["arrays"])
        arrays = {name: writable_array(self.path, name, shape) for name, shape in shapes.items()}
        log = None if self.events is None else writable_array(self.path, EVENTS)
        layout = Layout((1 + self.plan.steps // self.plan.every,), (self.plan.rows,))
        return BlockStore(self.path, self.made, layout, arrays, log)


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
    with new_beside(path) as part:
        made = _create(part, first, plan, opening, extra)
        put_in_place(part, target, overwrite=False)
    return Stream(target, plan, first.has_poses, made)


def open_stream(path: str | Path) -> Stream:
    """Return the stream of a store that a run was written to."""
    stored = read_attributes(path)
    if "run" not in stored:
        remedy = "Run it again with simulate(..., store=...) to be able to resume."
        raise error("resume(store=...)", "have checkpoints", f"'{path}', which was saved whole", remedy)
    run = json.loads(stored["run"])
    return Stream(Path(path).resolve(), plan_of(stored), run["reconstruct"], stored["made"])


def writable_array(path: Path, name: str, shape: Sequence[int] | None = None) -> zarr.Array:
    """Open an array of a store to continue, of a known shape but for the number of rows."""
    where = "resume(store=...)"
    try:
        array = zarr.open_array(path / name, mode="r+", zarr_format=3)
    except Exception as failure:
        got = f"'{path}', where its metadata cannot be read: {failure}"
        raise error(where, f"hold the array {name}", got, "Run it again.") from failure
    check_array(where, name, array)
    if shape is not None and array.shape[1:] != tuple(shape[1:]):
        raise error(where, f"hold the array {name} with rows of shape {shape[1:]}", f"'{path}'", "Run it again.")
    return array.with_config({"write_empty_chunks": True})  # of NaN alone too: an impulse that is not known


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


def _create(part: Path, first: Any, plan: Plan, opening: Checkpoint, extra: dict[str, str]) -> str:
    """Make the store with the mark of the start; return which one it is."""
    metadata = {name: value for name, value in attributes(first).items() if name != "outcome"}
    run = {"steps": plan.steps, "rows": plan.rows, "reconstruct": first.has_poses, "lead": plan.lead}
    metadata |= {"run": json.dumps(run), **extra}
    store = new_blocks(part, metadata, stored_variables(first), 1 + plan.steps // plan.every, plan.rows)
    if first.events is not None:
        create_log(zarr.open_group(part), rows_of(first.events))
    store.write(BEFORE, {}, said_of(opening))
    return store.made


_NUMBERS, _MOST = 1 << 16, 1 << 10  # at most in a chunk: numbers, rows


def create_log(group: zarr.Group, rows: np.ndarray) -> None:
    """Make the array, without rows yet, for crossings like these."""
    log = Variable(("crossing", "entry"), rows, {})
    create_array(group, EVENTS, log, 0, max(1, min(_MOST, _NUMBERS // rows.shape[1])))
