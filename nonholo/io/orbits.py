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
import warnings
from collections.abc import Callable, Container, Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import zarr

from nonholo.base.checks import checked_path, error, flags
from nonholo.base.progress import go_on
from nonholo.base.results import Outcome
from nonholo.io import blocks
from nonholo.io.checkpoints import EVENTS, Checkpoint, checkpoint_of, log_of, rows_of, said_of
from nonholo.io.datasets import CANONICAL, HEADED, STEP, Stretch, Variable, stored_variables
from nonholo.io.metadata import read_attributes, require_identity
from nonholo.io.places import WHERE, new_store, owner_of
from nonholo.io.provenance import attributes, attributes_of_text, restore_motion, system_of
from nonholo.orbit import STATES, AbstractOrbit, EventLog, Orbit, Plan, any_orbit

_ROWS = 100_000  # states in one chunk
_NUMBERS, _MOST = 1 << 16, 1 << 10  # at most in a chunk of crossings: numbers, rows
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
        self.store.write(block, rows, said_of(checkpoint), None if orbit.events is None else rows_of(orbit.events))

    def columns(self, orbit: Any, first: int) -> dict[str, np.ndarray]:
        """Return the arrays that the store has, of an orbit whose first state is a row of it."""
        turns = [array for name, array in self.store.arrays.items() if name in HEADED] if first > 0 else []
        before = np.ravel(turns[0][first - 1 : first])[None] if turns else None  # on which what follows continues
        variables = stored_variables(orbit, before)
        return {name: variables[name].values for name in self.store.arrays}

    def checkpoint(self, block: int) -> Checkpoint:
        """Return the state at the begin of a block, unless the mark before it is damaged (`DamagedError`)."""
        mark = self.store.checked_mark(blocks.BEFORE) if block == 0 else self.store.mark_of(block - 1)
        return checkpoint_of(mark.about, self.events)

    def sound(self, block: int) -> Checkpoint:
        """Return the state at the end of a block that is marked as finished, of which every chunk is sound.

        Raises:
            DamagedError: One is not; the message names it and the damage.
        """
        return checkpoint_of(self.store.sound(block).about, self.events)

    def steps_done(self) -> int:
        """Return the step up to which blocks are marked as finished."""
        block = self.finished_blocks()
        try:
            return self.checkpoint(block).done
        except blocks.DamagedError:
            return self.plan.begin(block)

    def finished_blocks(self) -> int:
        """Return the number of blocks, from the first one on, that are marked as finished."""
        numbers = self.store.block_numbers()
        return next(block for block in range(len(numbers) + 1) if block not in numbers)

    def finish(self, end: Checkpoint, block: int) -> None:
        """Cut the arrays to the good states of a run that ended in a block, and add the outcome."""
        shapes = self.store.resize(1 + end.done // self.plan.every)
        metadata: dict[str, Any] = {"outcome": end.outcome.name, "arrays": json.dumps(shapes)}
        if self.events is not None and end.of_events is not None:
            self.store.cut_log(block)
            metadata["crossings"] = json.dumps(end.of_events.counts.tolist())
            metadata["stopped_by"] = self.events[end.of_events.last_event] if end.is_stopped else None
        self.store.finish(metadata)

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
        self.store.prepare()
        if not self.is_finished:
            self.store.resize(1 + self.plan.steps // self.plan.every)

    @functools.cached_property
    def store(self) -> blocks.BlockStore:
        """Its blocks, to be written."""
        require_identity(self.path, self.made)
        rows = 1 + self.plan.steps // self.plan.every
        return _blocks_of(self.path, read_attributes(self.path), rows, where="resume(store=...)", is_writable=True)


def _blocks_of(
    path: Path, attributes: dict[str, Any], rows: int, *, where: str = WHERE, is_writable: bool = False
) -> blocks.BlockStore:
    """Return the blocks of a store, of this many rows."""

    def array_of(name: str, shape: list[int] | None = None) -> zarr.Array:
        return blocks.opened_array(where, path, name, shape, is_writable=is_writable)

    arrays = {name: array_of(name, shape) for name, shape in json.loads(attributes["arrays"]).items()}
    log = array_of(EVENTS) if "events" in attributes else None
    return blocks.BlockStore(path, attributes["made"], blocks.Layout((rows,), arrays["time"].chunks), arrays, log)


def create_stream(
    path: Path,
    first: Any,
    plan: Plan,
    opening: Checkpoint,
    events: list[dict[str, Any]] | None = None,
    scenario: str | None = None,
) -> Stream:
    """Make a store with the first checkpoint and no rows yet; it appears at the path only when it is complete."""
    metadata = {name: value for name, value in attributes(first).items() if name != "outcome"}
    run = {"steps": plan.steps, "rows": plan.rows, "reconstruct": first.has_poses, "lead": plan.lead}
    metadata |= {"run": json.dumps(run)} | ({} if events is None else {"events": json.dumps(events)})
    metadata |= {} if scenario is None else attributes_of_text(scenario)
    with new_store(path, new="simulate(store=...)") as part:
        store = blocks.new_blocks(part, metadata, stored_variables(first), 1 + plan.steps // plan.every, plan.rows)
        if first.events is not None:
            rows = rows_of(first.events)
            size = max(1, min(_MOST, _NUMBERS // rows.shape[1]))
            blocks.create_array(zarr.open_group(part), EVENTS, Variable(("crossing", "entry"), rows, {}), 0, size)
        store.write(blocks.BEFORE, {}, said_of(opening))
    return Stream(path.resolve(), plan, first.has_poses, store.made)


def open_stream(path: str | Path, where: str = "resume(store=...)") -> Stream:
    """Return the stream of a store that a run was written to."""
    if "run" not in (attributes := read_attributes(path, where=where)):
        remedy = "Run it again with simulate(..., store=...) to be able to resume."
        raise error(where, "have checkpoints", f"'{path}', which was saved whole", remedy)
    run = json.loads(attributes["run"])
    return Stream(Path(path).resolve(), plan_of(attributes), run["reconstruct"], attributes["made"])


class Standing(NamedTuple):
    """Progress of an unfinished run: good steps that are kept, steps in total, and who is writing it, if anybody."""

    done: int
    steps: int
    owner: str | None


def standing(path: str | Path) -> Standing | None:
    """Return the progress of the run of a store; None if it is finished."""
    if "run" not in (attributes := read_attributes(path)) or "outcome" in attributes:
        return None
    stream = open_stream(path)
    return Standing(stream.steps_done(), stream.plan.steps, owner_of(stream.path))


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
    any_orbit("save_orbit(orbit=...)", orbit)
    if orbit.is_discrete and orbit.has_impacts.any():
        remedy = "Run with store=..., which saves them, or save a part of the orbit."
        raise error("save_orbit(orbit=...)", "have no impacts, which only its events record", "some", remedy)
    flags("save_orbit", overwrite=overwrite)
    path = checked_path("save_orbit(path=...)", path)
    with new_store(path, overwrite=overwrite) as part:
        metadata = attributes(orbit) | ({} if scenario is None else attributes_of_text(scenario))
        variables = stored_variables(orbit)
        if not np.array_equal(orbit.step, orbit.save_every * np.arange(len(orbit))):  # not a whole run
            variables[STEP] = Variable(("step",), orbit.step, {"long_name": "number of the step"})
        store = blocks.new_blocks(part, metadata, variables, len(orbit), max(1, min(_ROWS, len(orbit))))
        for block in range(store.layout.blocks):
            (rows,) = store.layout.piece(block).place
            store.write(block, {name: variable.values[rows] for name, variable in variables.items()}, {})
        store.finish({})


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


def load_orbit(path: str | Path, *, discrete: Any = None) -> Any:
    """Load an orbit saved by `save_orbit`, bit for bit.

    Nothing in a store is ever run. In coordinates it names a system of `nonholo.examples` with its parameters, which is
    made again; of a custom Lagrangian it holds everything that the orbit tells, for pictures and tables, and what
    asks for the functions (`restricted_momentum`, another run) says to pass `discrete`.

    Args:
        path: The store.
        discrete: The discretization that made the store; needed only if its difference or its constraint is callable,
            or its system or group is custom, which a store cannot hold.

    Returns:
        An `Orbit`, or a `CoordinateOrbit` or `GroupOrbit` of `nonholo.lagrange_dalembert`.

    Raises:
        FileNotFoundError: There is nothing at the path.
        ValueError: The path is no store of an orbit, has another schema, or is damaged; the message names the array
            and the chunk.

    Example:
        >>> orbit = load_orbit("orbit.zarr")  # doctest: +SKIP
    """
    return load_states(checked_path(WHERE, path), discrete)


def load_states(root: Path, discrete: Any, *, last: bool = False) -> Any:
    """Load the states in all chunks of a store, or in the last one."""
    if "run" in (attributes := read_attributes(root)) and "outcome" not in attributes:
        remedy = f"Resume with nonholo.resume('{root}') (nonholo resume); `nonholo info` shows its progress."
        raise error(WHERE, "be a finished run", f"'{root}', which is not", remedy)
    motion, every = restore_motion(attributes, discrete), attributes["save_every"]
    outcome, total = Outcome[attributes["outcome"]], json.loads(attributes["arrays"])["time"][0]
    store = _blocks_of(root, attributes, total)
    arrays = {name: blocks.checked_array(store, name, last=last) for name in store.arrays}
    if not last:  # whoever asks for the last block has looked at the others
        _check_seals(store, attributes)
    rows = {name: arrays.get(array) for name, array in _stored_names(arrays, motion.columns).items()}
    step = arrays[STEP].astype(np.int64) if STEP in arrays else every * np.arange(total - len(arrays["time"]), total)
    orbit = motion.orbit(outcome=outcome, save_every=every, branch=attributes["branch"], step=step, **rows)
    if "events" not in attributes:
        return orbit
    plan = plan_of(attributes)
    begin = plan.begin((total - 1) // plan.rows) if last else 0
    return dataclasses.replace(orbit, events=_events(store, attributes, orbit, begin))


def _check_seals(store: blocks.BlockStore, attributes: dict[str, Any]) -> None:
    """Refuse the store of a finished run, or of an orbit saved whole, where a chunk lies at the path of another."""
    events = [event["name"] for event in json.loads(attributes["events"])] if "events" in attributes else None
    with blocks.refusing_damage(WHERE, "hold each chunk in its place", store.path):
        for block in range(plan_of(attributes).blocks if "run" in attributes else store.layout.blocks):
            about = store.checked_mark(block).about
            if "run" in attributes and checkpoint_of(about, events).is_last:
                break


def plan_of(attributes: dict[str, Any]) -> Plan:
    """Return the plan of a store with these attributes."""
    run = json.loads(attributes["run"])
    return Plan(run["steps"], attributes["save_every"], run["rows"], run["lead"])


def _stored_names(arrays: Container[str], columns: Iterable[str] = STATES) -> dict[str, str]:
    """Return the names of the arrays of a store that hold the columns of an orbit: compact ones lie in a group."""
    names = {name: name.removeprefix("canonical_") for name in columns}
    return {name: CANONICAL + array if CANONICAL + array in arrays else array for name, array in names.items()}


def _events(store: blocks.BlockStore, attributes: dict[str, Any], orbit: Orbit, begin: int) -> EventLog:
    """Return the crossings of a stored run after the state of a step."""
    array: Any = store.log
    events, counts = json.loads(attributes["events"]), json.loads(attributes["crossings"])
    chunks = (blocks.checked_block(store, EVENTS, chunk, with_nan=True) for chunk in range(array.cdata_shape[0]))
    rows = np.concatenate([np.empty((0, array.shape[1])), *chunks])
    step, fraction = rows[:, 1], rows[:, 2]
    rows = rows[(step > begin) | ((step == begin) & (fraction > 0))]  # without what fills chunks, NaN
    log = log_of(rows, events, orbit, attributes.get("stopped_by"))
    lengths = [len(crossings) for crossings in log.found]
    if begin == 0 and lengths != counts:
        raise error(WHERE, f"hold {counts} crossings in {EVENTS}", str(lengths), blocks.AGAIN)
    return log


_WHERE = "store_to_csv(store=...)"


class StoredPoses(NamedTuple):
    """The part of a store that holds the poses: its system, the number of saved states, and the names of the arrays."""

    store: blocks.BlockStore
    system: Any
    rows: int
    places: dict[str, str]

    def stretches(self, report: Callable[[float, float], object] = go_on) -> Iterator[Stretch]:
        """Return the states chunk after chunk, and report how many; only one chunk is in memory."""
        (chunk,) = self.store.layout.chunk
        for number in range(-(-self.rows // chunk)):
            own_rows = slice(self.rows - number * chunk)
            arrays = self.places.items()
            columns = {name: blocks.checked_block(self.store, array, number)[own_rows] for name, array in arrays}
            time, places = columns.pop("time"), columns.get("canonical_pose", columns.get("configuration"))
            yield Stretch(time, np.asarray(places), columns.get("turned"))
            report(min(self.rows, (number + 1) * chunk), self.rows)


def open_poses(path: Path) -> StoredPoses:
    """Open a store, finished or not; a warning gives the length of an unfinished one."""
    attributes = read_attributes(path, where=_WHERE)
    shapes = json.loads(attributes["arrays"])
    remedy = "Write the orbit of nonholo.load_orbit(path, discrete=...) with its to_csv."
    system = system_of(attributes, _WHERE, remedy)
    names = ("time", "configuration") if "constraint_residual" in shapes else ("time", "canonical_pose", "turned")
    places = {name: array for name, array in _stored_names(shapes, names).items() if array in shapes}
    if names[1] not in places:
        remedy = "Run it again with reconstruct=True: poses cannot be added later."
        raise error(_WHERE, "hold poses", f"'{path}', which was run with reconstruct=False", remedy)
    if "outcome" in attributes:
        store = _blocks_of(path, attributes, shapes["time"][0])
        _check_seals(store, attributes)
        return StoredPoses(store, system, shapes["time"][0], places)
    stream = open_stream(path)
    rows = _state_count(stream)
    owner, steps_done = owner_of(path), max(0, rows - 1) * stream.plan.every
    resume = f"Resume with nonholo.resume({str(path)!r}) (nonholo resume)."
    now = f"It is being written by {owner}." if owner else resume
    message = f"The run in '{path}' is not finished: its poses go up to step {steps_done} of {stream.plan.steps}. {now}"
    warnings.warn(message, RuntimeWarning, stacklevel=3)
    return StoredPoses(stream.store, system, rows, places)


def _state_count(stream: Stream) -> int:
    """Return the number of saved states in the full blocks of an unfinished run, refused if one is damaged."""
    plan, full = stream.plan, stream.finished_blocks()
    remedy = f"nonholo.resume({str(stream.path)!r}) computes its block again."
    with blocks.refusing_damage(_WHERE, "hold sound blocks", stream.path, remedy):
        last = stream.checkpoint(full).done
        full -= full > 0 and last != plan.stop(full - 1)  # it failed, or was extended
        for block in range(full):
            stream.sound(block)
    return min(full * plan.rows, 1 + plan.steps // plan.every)
