"""The store of an orbit, written block by block: the mark of a block holds the state of the run where the block ends.

The mark before the first block is that of the start. A mark ends with the data for the search for more events;
crossings that were found are the log of the store. While a store is unfinished it has no outcome among its attributes
and no consolidated metadata.

Writing a store: all of it or nothing, beside the old one until the new one is complete.
"""

import contextlib
import dataclasses
import errno
import functools
import json
import re
import shutil
import warnings
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import zarr

from nonholo.base.checks import error, flags, instance
from nonholo.base.checks import path as checked_path
from nonholo.io import _block_store as blocks
from nonholo.io._attributes import FORMAT, attributes, attributes_of_text, system_of
from nonholo.io._load import check_seals, format_of, plan_of, read_attributes, stored_names
from nonholo.io._metadata import check_array, check_assertions
from nonholo.io._places import new_beside, owner_of, remove_remains
from nonholo.io._stored_events import EVENTS, Checkpoint, rows_of
from nonholo.io.datasets import HEADED, Stretch, Variable, steps_apart, stored_variables
from nonholo.orbit import AbstractOrbit, Plan

_ROWS = 100_000  # states in one chunk
_NETCDF, _CSV = "use orbit.to_dataset().to_netcdf(path)", "use orbit.to_csv(path)"
_OTHER_FORMATS = {
    **dict.fromkeys((".nc", ".nc4", ".netcdf", ".h5", ".hdf5"), _NETCDF),
    **dict.fromkeys((".csv", ".txt"), _CSV),
    **dict.fromkeys((".parquet", ".feather", ".xlsx"), "use orbit.to_pandas()"),
    **dict.fromkeys((".png", ".svg", ".pdf"), "use orbit.plot(path)"),
    **dict.fromkeys((".gif", ".json", ".toml", ".npy", ".npz", ".mat", ".pkl", ".zip"), ""),
}
"""Suffixes that no store may have, and what writes such files."""
_OWN_RUN = r"run/(?:lock|lock\.json|blocks/(?:start|\d+)\.json)"
_OWN = re.compile(rf"(?:[^/]+/)*(?:zarr\.json|c(?:/\d+)*|\.[^/]+\.partial)|{_OWN_RUN}")
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


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

    def write(self, block: int, orbit: Any, checkpoint: Checkpoint) -> None:
        """Write a block, and the state of the run at its end."""
        rows = self.columns(orbit, block * self.plan.rows) if len(orbit) else {}
        log = None if orbit.events is None else rows_of(orbit.events)
        self._blocks.write(block, rows, blocks.said_of(checkpoint), log)

    def columns(self, orbit: Any, first: int) -> dict[str, np.ndarray]:
        """Return the arrays that the store has, of an orbit whose first state is a row of it."""
        turns = [array for name, array in self._blocks.arrays.items() if name in HEADED] if first > 0 else []
        before = np.ravel(turns[0][first - 1 : first])[None] if turns else None  # on which what follows continues
        variables = stored_variables(orbit, before)
        return {name: variables[name].values for name in self._blocks.arrays}

    def checkpoint(self, block: int) -> Checkpoint:
        """Return the state at the begin of a block, unless the mark before it is damaged (`DamagedError`)."""
        mark = self._blocks.checked_mark(blocks.BEFORE) if block == 0 else self._blocks.mark_of(block - 1)
        return blocks.checkpoint_of(mark.about, self.events)

    def rows(self, name: str, first: int, count: int) -> np.ndarray:
        """Return some rows of an array of sound blocks."""
        return self._blocks.rows(name, (slice(first, first + count),))

    def block_numbers(self) -> set[int]:
        """Return the blocks that are marked as finished, sound or not; the folder is read once."""
        return self._blocks.block_numbers()

    def sound(self, block: int) -> Checkpoint:
        """Return the state at the end of a block that is marked as finished, of which every chunk is sound.

        Raises:
            DamagedError: One is not; the message names it and the damage.
        """
        return blocks.checkpoint_of(self._blocks.sound(block).about, self.events)

    def steps_done(self) -> int:
        """Return the step up to which blocks are marked as finished."""
        block = self.finished_blocks()
        try:
            return self.checkpoint(block).done
        except blocks.DamagedError:
            return self.plan.begin(block)

    def full_blocks(self) -> int:
        """Return the number of blocks from the first one on with all their rows, unless the last one is damaged."""
        full = self.finished_blocks()
        last = self.checkpoint(full).done
        return full - (full > 0 and last != self.plan.stop(full - 1))  # it failed, or was extended

    def state_count(self, full: int) -> int:
        """Return the number of saved states in this many full blocks."""
        return min(full * self.plan.rows, 1 + self.plan.steps // self.plan.every)

    def finished_blocks(self) -> int:
        """Return the number of blocks, from the first one on, that are marked as finished."""
        numbers = self.block_numbers()
        return next(block for block in range(len(numbers) + 1) if block not in numbers)

    def finish(self, end: Checkpoint, block: int) -> None:
        """Cut the arrays to the good states of a run that ended in a block, and add the outcome."""
        shapes = self._blocks.resize(1 + end.done // self.plan.every)
        metadata: dict[str, Any] = {"outcome": end.outcome.name, "arrays": json.dumps(shapes)}
        if self.events is not None and end.of_events is not None:
            self._blocks.cut_log(block)
            metadata["crossings"] = json.dumps(end.of_events.counts.tolist())
            metadata["stopped_by"] = self.events[end.of_events.last_event] if end.is_stopped else None
        self._blocks.finish(metadata)

    @functools.cached_property
    def events(self) -> tuple[str, ...] | None:
        """The names of the events that the run looks for; None if it looks for none."""
        text = read_attributes(self.path).get("events")
        return None if text is None else tuple(event["name"] for event in json.loads(text))

    def longer(self, steps: int) -> "Stream":
        """Return the stream with this many more steps to go; a last block that was not full is computed again."""
        run = json.loads(read_attributes(self.path)["run"])
        if not self.is_finished and run.get("added") == steps:  # the same call again, which was stopped
            return self
        return dataclasses.replace(self, plan=self.plan._replace(steps=self.plan.steps + steps))

    def announce(self, more: int) -> None:
        """Write to the store how long the run is now, and how many steps it is to have."""
        run = json.loads(read_attributes(self.path)["run"]) | {"steps": self.plan.steps, "added": more}
        blocks.edit_attributes(self.path, {"run": json.dumps(run), "outcome": None, "crossings": None})

    def prepare(self) -> None:
        """Remove what a killed writer left and give the arrays their length; nothing here loses data."""
        self._blocks.prepare()
        if not self.is_finished:
            self._blocks.resize(1 + self.plan.steps // self.plan.every)

    @functools.cached_property
    def _blocks(self) -> blocks.BlockStore:
        shapes = json.loads(read_attributes(self.path)["arrays"])
        arrays = {name: writable_array(self.path, name, shape) for name, shape in shapes.items()}
        log = None if self.events is None else writable_array(self.path, EVENTS)
        layout = blocks.Layout((1 + self.plan.steps // self.plan.every,), (self.plan.rows,))
        return blocks.BlockStore(self.path, self.made, layout, arrays, log)


def create_stream(
    path: Path,
    first: Any,
    plan: Plan,
    opening: Checkpoint,
    events: list[dict[str, Any]] | None = None,
    scenario: str | None = None,
) -> Stream:
    """Make a store with the first checkpoint and no rows yet; it appears at the path only when it is complete."""
    target = path.resolve()
    check_target(target, new="simulate(store=...)")
    metadata = {name: value for name, value in attributes(first).items() if name != "outcome"}
    run = {"steps": plan.steps, "rows": plan.rows, "reconstruct": first.has_poses, "lead": plan.lead}
    metadata |= {"run": json.dumps(run)} | ({} if events is None else {"events": json.dumps(events)})
    metadata |= {} if scenario is None else attributes_of_text(scenario)
    with new_beside(path) as part:
        store = blocks.new_blocks(part, metadata, stored_variables(first), 1 + plan.steps // plan.every, plan.rows)
        if first.events is not None:
            create_log(zarr.open_group(part), rows_of(first.events))
        store.write(blocks.BEFORE, {}, blocks.said_of(opening))
        put_in_place(part, target, overwrite=False)
    return Stream(target, plan, first.has_poses, store.made)


def open_stream(path: str | Path) -> Stream:
    """Return the stream of a store that a run was written to."""
    attributes = read_attributes(path)
    if "run" not in attributes:
        remedy = "Run it again with simulate(..., store=...) to be able to resume."
        raise error("resume(store=...)", "have checkpoints", f"'{path}', which was saved whole", remedy)
    run = json.loads(attributes["run"])
    return Stream(Path(path).resolve(), plan_of(attributes), run["reconstruct"], attributes["made"])


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
    """Return the progress of the run of a store; None if it is finished."""
    attributes = read_attributes(path)
    if "run" not in attributes or "outcome" in attributes:
        return None
    stream = open_stream(path)
    return Standing(stream.steps_done(), stream.plan.steps, owner_of(stream.path))


_NUMBERS, _MOST = 1 << 16, 1 << 10  # at most in a chunk: numbers, rows


def create_log(group: zarr.Group, rows: np.ndarray) -> None:
    """Make the array, without rows yet, for crossings like these."""
    log = Variable(("crossing", "entry"), rows, {})
    blocks.create_array(group, EVENTS, log, 0, max(1, min(_MOST, _NUMBERS // rows.shape[1])))


def save_orbit(orbit: AbstractOrbit, path: str | Path, *, overwrite: bool = False, scenario: str | None = None) -> None:
    """Save an orbit as a Zarr store that `load_orbit` reads back bit for bit and `xarray.open_zarr` opens.

    The store appears at `path` only when it is complete; if writing fails, nothing is left behind and an old store
    stays as it was.

    Args:
        orbit: The orbit to save.
        path: A new directory, usually named `*.zarr`; suffixes of other formats, such as .nc and .csv, are refused.
        overwrite: Replace an older store of an orbit (nothing else is ever replaced).
        scenario: Text of the scenario that was run, kept with its SHA-256.

    Raises:
        ValueError: The path has the suffix of another format.
        FileExistsError: The path exists, and is not to be replaced.
        OSError: The store cannot be written, for example because the disk is full.

    Example:
        >>> save_orbit(orbit, "orbit.zarr")  # doctest: +SKIP
    """
    remedy = "Pass what `simulate` or `flow` returned."
    instance("save_orbit(orbit=...)", orbit, AbstractOrbit, "be an orbit", remedy)
    if orbit.is_discrete and orbit.has_impacts.any():
        got, remedy = "one with impacts, which its events tell", "Run with store=..., which keeps them, or save a part."
        raise error("save_orbit(orbit=...)", "be an orbit whose events are not needed", got, remedy)
    flags("save_orbit", overwrite=overwrite)
    path = checked_path("save_orbit(path=...)", path)
    target = path.resolve()
    check_target(target, overwrite=overwrite)
    with new_beside(path) as part:
        metadata = attributes(orbit) | ({} if scenario is None else attributes_of_text(scenario))
        variables = stored_variables(orbit) | steps_apart(orbit)
        store = blocks.new_blocks(part, metadata, variables, len(orbit), max(1, min(_ROWS, len(orbit))))
        for block in range(store.layout.blocks):
            (rows,) = store.layout.piece(block).place
            store.write(block, {name: variable.values[rows] for name, variable in variables.items()}, {})
        store.finish({})
        put_in_place(part, target, overwrite=overwrite)


@contextlib.contextmanager
def reporting_how_to_resume(store: Path, what: str, standing: Callable[[], object]) -> Iterator[None]:
    """Report, if the writing of a store is stopped or fails, its progress and how to resume."""
    again = f"nonholo.resume({str(store)!r})"
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"Stopped at {standing()}. Resume with {again} (nonholo resume).") from None
    except OSError as failure:
        remedy = "Free space" if failure.errno in _FULL else "Solve the problem"
        reason = f"{failure.strerror or failure}. {what} stands at {standing()}. {remedy}, then call {again}"
        raise OSError(failure.errno or errno.EIO, reason, str(store)) from failure


def check_suffix(path: str | Path, where: str = "save_orbit(path=...)") -> None:
    """Refuse, in the name of `where`, a path with the suffix of another format, and any where zarr does not work."""
    check_assertions(where)
    suffix = Path(path).suffix.lower()
    if suffix in _OTHER_FORMATS:
        store, how = f"Write a store: '{Path(path).with_suffix('.zarr')}'", _OTHER_FORMATS[suffix]
        remedy = f"{store}, or {how}." if how and where.startswith("save_orbit") else f"{store}."
        raise error(where, "be the path of a Zarr store, usually *.zarr", f"'{path}'", remedy)


def check_target(path: str | Path, *, overwrite: bool = False, new: str | None = None) -> None:
    """Refuse a path that exists, unless it is a store of an orbit that may be replaced, and one of another format.

    Args:
        path: Where the store shall be.
        overwrite: Whether the caller asked to replace one.
        new: In whose name, if it has no such argument.
    """
    check_suffix(path)
    if not Path(path).exists():
        remove_remains(Path(path).resolve())  # which may put back what a killed process was about to replace
    if not Path(path).exists():
        return
    if new:
        raise _exists(path, "Choose another path, or resume what is there: nonholo.resume(path).", new)
    if not overwrite:
        raise _exists(path, "Choose another path, or pass overwrite=True (--overwrite) to replace it.")
    if format_of(path) != FORMAT:
        raise _exists(path, "It is not a store of an orbit, so it is not replaced. Choose another path.")
    files = (file.relative_to(path).as_posix() for file in Path(path).rglob("*") if not file.is_dir())
    if foreign := next((name for name in files if not _OWN.fullmatch(name)), None):
        raise _exists(path, f"It holds '{foreign}', which is no part of a store, so it is not replaced.")
    if owner := owner_of(Path(path)):
        remedy = "so it is not replaced. Wait, or stop it."
        raise BlockingIOError(f"The store '{path}' is being written by {owner}, {remedy}")


def _exists(path: str | Path, remedy: str, where: str = "save_orbit(path=...)") -> FileExistsError:
    return FileExistsError(f"`{where}` must be new. Got '{path}', which exists. {remedy}")


def put_in_place(part: Path, target: Path, *, overwrite: bool) -> None:
    """Rename a complete store to its path; an older one there is replaced only if asked."""
    if not (overwrite and target.exists()):
        try:
            part.rename(target)
            return
        except OSError:
            check_target(target)
            raise
    check_target(target, overwrite=True)  # once more, after the time that writing took
    old = part.with_suffix(".old")  # which remove_remains knows
    target.rename(old)
    try:
        part.rename(target)
    except OSError:
        old.rename(target)
        raise
    shutil.rmtree(old, ignore_errors=True)


_WHERE = "store_to_csv(store=...)"
_COMPACT, _RECORDED = ("time", "canonical_pose", "turned"), ("time", "configuration")


class StoredPoses(NamedTuple):
    """The part of a store that holds the poses: its system, the number of saved states, their arrays and the names."""

    path: Path
    system: Any
    rows: int
    places: dict[str, str]
    arrays: dict[str, zarr.Array]

    def stretches(self) -> Iterator[Stretch]:
        """Return the states chunk after chunk; only one chunk is in memory."""
        chunk = self.arrays["time"].chunks[0]
        for number in range(-(-self.rows // chunk)):
            own_rows = slice(self.rows - number * chunk)
            columns: dict[str, np.ndarray] = {}
            for name, array in self.arrays.items():
                index = (number,) + (0,) * (array.ndim - 1)
                columns[name] = blocks.checked_block(self.path, self.places[name], array, index)[own_rows]
            time, places = columns.pop("time"), columns.get("canonical_pose", columns.get("configuration"))
            yield Stretch(time, np.asarray(places), columns.get("turned"))


def open_poses(path: Path) -> StoredPoses:
    """Open a store, finished or not; a warning gives the length of an unfinished one."""
    attributes = read_attributes(path)
    try:
        shapes = json.loads(attributes["arrays"])
        remedy = "Write the orbit of nonholo.load_orbit(path, discrete=...) with its to_csv."
        system = system_of(attributes, _WHERE, remedy)
        names = _RECORDED if "constraint_residual" in shapes else _COMPACT
        places = {name: array for name, array in stored_names(shapes, names).items() if array in shapes}
    except KeyError as failure:
        raise error(_WHERE, "hold complete attributes", f"'{path}' without {failure}", "Run it again.") from failure
    if names[1] not in places:
        remedy = "Run it again with reconstruct=True: poses cannot be added later."
        raise error(_WHERE, "hold poses", f"'{path}', which was run with reconstruct=False", remedy)
    if "outcome" in attributes:
        check_seals(path, attributes)
        arrays = {name: blocks.opened_array(path, array, tuple(shapes[array])) for name, array in places.items()}
        return StoredPoses(path, system, shapes["time"][0], places, arrays)
    stream = open_stream(path)
    rows = _state_count(stream)
    owner, steps_done = owner_of(path), max(0, rows - 1) * stream.plan.every
    resume = f"Resume with nonholo.resume({str(path)!r}) (nonholo resume)."
    now = f"It is being written by {owner}." if owner else resume
    message = f"The run in '{path}' is not finished: its poses go up to step {steps_done} of {stream.plan.steps}. {now}"
    warnings.warn(message, RuntimeWarning, stacklevel=3)
    arrays = {name: blocks.opened_array(path, array, None) for name, array in places.items()}
    return StoredPoses(path, system, rows, places, arrays)


def _state_count(stream: Stream) -> int:
    """Return the number of saved states in the full blocks of an unfinished run, refused if one is damaged."""
    try:
        full = stream.full_blocks()
        for block in range(full):
            stream.sound(block)
    except blocks.DamagedError as flaw:
        remedy = f"nonholo.resume({str(stream.path)!r}) computes its block again."
        raise error(_WHERE, "hold sound blocks", f"{flaw}, in '{stream.path}'", remedy) from None
    return stream.state_count(full)
