"""The store of a sweep, its blocks and their marks, and the results of tasks, checked and named.

A task that raises is called again with each half of its members, until the failing ones are known.
"""

import collections
import contextlib
import dataclasses
import functools
import json
import math
import uuid
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any, NamedTuple, TypeAlias

import numpy as np
import xarray
import zarr
from pydantic import AfterValidator, TypeAdapter
from zarr.codecs import BloscCodec, Crc32cCodec

from nonholo import io
from nonholo.base.checks import error, printable
from nonholo.base.compiled import way_of_kernels
from nonholo.base.memo import Keeper
from nonholo.base.results import Outcome
from nonholo.ensembles._names import ABSENT, OUTCOME, Entries, entries_of
from nonholo.ensembles.designs import Design, MemberBlock, axis_dimensions, design_from

RAISED = 100
"""The outcome of members for which the task raised; the others are those of `Outcome`."""
OUTCOMES = {ABSENT: "absent", **{int(code): code.name for code in Outcome}, RAISED: "raised"}
_MOST_MESSAGES = 20  # failures of a block whose messages are kept
_PROBES = 8

Task: TypeAlias = Callable[[MemberBlock], Any]
Data: TypeAlias = dict[str, Any]


@dataclasses.dataclass(frozen=True)
class Output:
    """One array of the result.

    Attributes:
        dimensions: Names of its axes but for those of the members.
        shape: Their lengths.
        dtype: Type of the numbers on disk.
        attributes: Its attributes in the store.
    """

    dimensions: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: str
    attributes: dict[str, Any]

    @property
    def fill(self) -> Any:
        """The entry where there is no number."""
        kind = np.dtype(self.dtype)
        return np.nan if kind.kind in "fc" else np.iinfo(kind).min if kind.kind == "i" else np.iinfo(kind).max

    def options(self, design: Design, layout: io.blocks.Layout) -> dict[str, Any]:
        """Return what an array on disk is made by."""
        return {
            "shape": (*layout.sizes, *self.shape),
            "chunks": (*layout.chunk, *self.shape),
            "dtype": self.dtype,
            "dimension_names": (*design.sizes, *self.dimensions),
            "attributes": self.attributes,
        }


Results: TypeAlias = tuple[dict[str, np.ndarray], list[tuple[Any, str]]]
"""Arrays of a block by name, and the first few members for which the task raised, with the messages."""


def attempt(task: Task, block: MemberBlock, outputs: dict[str, Output]) -> Results:
    """Run a task; members for which it raises have no numbers and the outcome `RAISED`."""
    try:
        return _check(entries_of(task(block), block.count), outputs, block.count), []
    except Exception as failure:
        if block.count == 1:
            arrays = {name: np.full((1, *each.shape), each.fill, each.dtype) for name, each in outputs.items()}
            arrays[OUTCOME][:] = RAISED
            return arrays, [(block.first, f"{type(failure).__name__}: {failure}")]
    middle = block.count // 2
    first, messages = attempt(task, block.part(0, middle), outputs)
    second, others = attempt(task, block.part(middle, block.count), outputs)
    arrays = {name: np.concatenate([first[name], second[name]]) for name in outputs}
    return arrays, (messages + others)[:_MOST_MESSAGES]


def probe_outputs(task: Task, block_at: Callable[[int, int], MemberBlock], members: int) -> dict[str, Output]:
    """Return what a task returns, from a few members spread over the design: the first for which it does not raise.

    A task that takes two members and returns something else than two rows is refused.
    """
    first_failure = None
    for member in dict.fromkeys((members - 1) * probe // (_PROBES - 1) for probe in range(_PROBES)):
        try:
            outputs = _outputs(entries_of(task(block_at(member, 1)), 1))
        except Exception as failure:
            first_failure = first_failure or failure
            continue
        _check_two(task, block_at(0, min(2, members)), outputs)
        return outputs
    got = f"{type(first_failure).__name__} for the first: {str(first_failure).rstrip('.')}"
    requirement, remedy = "run for at least one tested member", "Correct the design, or the task."
    raise error("sweep(task=...)", requirement, got, remedy) from first_failure


def _check_two(task: Task, block: MemberBlock, outputs: dict[str, Output]) -> None:
    """Refuse a task that is wrong for blocks, which would be done member by member and take long."""
    try:
        own = task(block)
    except Exception:  # of some members: these are found when it runs
        return
    _check(entries_of(own, block.count), outputs, block.count)


def _outputs(entries: Entries) -> dict[str, Output]:
    """Return what a task returns, with outcomes as CF conventions write flags."""
    labels = {"long_name": "how the member ended", "flag_values": list(OUTCOMES)}
    labels |= {"flag_meanings": " ".join(OUTCOMES.values())}
    outputs = {name: Output(axes, x.shape[1:], _type_on_disk(x), about) for name, (axes, x, about) in entries.items()}
    return {**outputs, OUTCOME: Output((), (), "int8", labels)}


def _type_on_disk(rows: np.ndarray) -> str:
    return {"b": "int8", "i": "int64", "u": "uint64", "c": "complex128"}.get(rows.dtype.kind, "float64")


def _check(entries: Entries, outputs: dict[str, Output], count: int) -> dict[str, np.ndarray]:
    """Return the rows of a block as they are written, refused if they are not what the first members had."""
    rows_by_name = {name: entry.values for name, entry in entries.items()}
    rows_by_name.setdefault(OUTCOME, np.zeros(count, dtype=np.int8))
    if rows_by_name.keys() != outputs.keys():
        got = f"{sorted(rows_by_name)} instead of {sorted(outputs)}"
        raise error("task(...)", "return the same names for all members", got, "Return them always.")
    for name, rows in rows_by_name.items():
        if rows.shape[1:] != outputs[name].shape:
            got = f"{rows.shape[1:]} instead of {outputs[name].shape}"
            raise error(f"task(...)[{name!r}]", "have one shape for all members", got, "Pad it with NaN.")
        if not (name == OUTCOME or np.can_cast(_type_on_disk(rows), outputs[name].dtype)):
            got = f"{rows.dtype} after {outputs[name].dtype}"
            raise error(f"task(...)[{name!r}]", "have one type for all members", got, "Return floats always.")
    return {name: rows_by_name[name].astype(output.dtype) for name, output in outputs.items()}


def layout_of(sizes: tuple[int, ...], block: int) -> io.blocks.Layout:
    """Cut a design in blocks of `block` members at most: whole last dimensions, a part of one, one of those before.

    Example:
        >>> layout_of((3, 5), block=2)
        Layout(sizes=(3, 5), chunk=(1, 2))
    """
    chunk, room = [], block
    for size in reversed(sizes):
        chunk.append(max(1, min(size, room)))
        room //= chunk[-1] if chunk[-1] == size else room
    return io.blocks.Layout(sizes, tuple(reversed(chunk)))


_AGAIN = "Run the sweep again."
AXIS = {"long_name": "value of the design"}
_CODECS = BloscCodec(cname="lz4", clevel=5, shuffle="bitshuffle"), Crc32cCodec()
"""As fast as a sweep: the numbers of its members are too different from each other for a slower one to gain by it."""


Line = Annotated[str, AfterValidator(lambda text: printable(text.replace("\n", " ")))]  # that controls no terminal


class Mark(NamedTuple):
    """The mark of a finished block."""

    members: int
    outcomes: dict[Line, int]
    seconds: float
    finished: float
    writer: Line
    messages: list[tuple[Any, Line]]


_MARK = TypeAdapter(Mark)


@dataclasses.dataclass(frozen=True)
class SweepStore(Keeper):
    """A store that a sweep is written to.

    Attributes:
        path: Where it is, the same for all who write.
        made: Which one it is: another store at the same path has another number.
    """

    path: Path
    made: str

    @functools.cached_property
    def layout(self) -> io.blocks.Layout:
        """The cut of members into blocks."""
        return io.blocks.Layout(*(tuple(sizes) for sizes in self._content["layout"]))

    @functools.cached_property
    def outputs(self) -> dict[str, Output]:
        """The contents of each array."""
        return {name: Output(tuple(d), tuple(s), t, a) for name, (d, s, t, a) in self._content["outputs"].items()}

    @functools.cached_property
    def design(self) -> Design:
        """The design; values along axes are read from their arrays."""
        return design_from(self._content["design"], self._axis)

    @property
    def description(self) -> dict[str, Any]:
        """The task and the design as plain data."""
        return {"task": self._content["task"], "design": self._content["design"]}

    @property
    def is_finished(self) -> bool:
        """Whether the sweep came to its end; its metadata are consolidated then, which is done last."""
        document = json.loads((self.path / "zarr.json").read_text())
        return document["attributes"]["finished"] and "consolidated_metadata" in document

    def marks(self) -> Iterator[tuple[int, Mark]]:
        """Return the numbers of finished blocks in order with their marks, those that can be read."""
        for block in sorted(self.blocks.block_numbers()):
            with contextlib.suppress(io.blocks.DamagedError):
                yield block, self.blocks.mark_of(block).about

    def check(self, where: str, blocks: Iterable[int]) -> None:
        """Refuse a store of which one of these blocks, or an axis, is damaged."""
        _ = self.design
        remedy = f"nonholo.resume({str(self.path)!r}) computes its block again."
        with io.blocks.refusing_damage(where, "be sound", self.path, remedy):
            for block in blocks:
                self.blocks.sound(block)

    def rows(self, name: str, piece: io.blocks.Piece) -> np.ndarray:
        """Return an array of a block, one row for each member."""
        rows_of_block = self.blocks.rows(name, piece.place)
        return rows_of_block.reshape(piece.count, *rows_of_block.shape[len(piece.place) :])

    def prepare(self) -> None:
        """Remove what killed writers left and show that every array can be opened."""
        self.blocks.prepare()
        _ = self.design

    def grow(self, members: int) -> "SweepStore":
        """Return the store with more members to do; a last block that was not full is computed again."""
        _ = self.blocks  # whose arrays have the length of an earlier growth
        content, before = self._content, list(self.layout.sizes)
        changes = {"design": content["design"] | {"members": members}, "before": before}
        changes["layout"] = [[members], list(self.layout.chunk)]
        origin = self.made[: io.blocks.ORIGIN]  # which the seals hold
        identity = origin + uuid.uuid4().hex[len(origin) :]  # whoever still writes the smaller one is refused
        attributes = {"made": identity, "sweep": json.dumps(content | changes), "finished": False}
        io.blocks.edit_attributes(self.path, attributes)
        return SweepStore(self.path, identity)

    def _axis(self, name: str) -> np.ndarray:
        array = io.blocks.opened_array("resume(store=...)", self.path, name, is_writable=True)
        with io.blocks.refusing_damage("resume(store=...)", f"hold the axis {name}", self.path, _AGAIN):
            values = io.blocks.Chunk(self.path, name, array, (0,) * array.ndim).read()
        description = list(axis_dimensions(name, values)), AXIS
        if (list(array.metadata.dimension_names or ()), array.metadata.attributes) != description:  # type: ignore[union-attr]
            raise error("resume(store=...)", f"hold the axis {name}", f"another one in '{self.path}'", _AGAIN)
        return values

    @functools.cached_property
    def _content(self) -> dict[str, Any]:
        return json.loads(attributes_of(self.path)["sweep"])

    @functools.cached_property
    def blocks(self) -> io.blocks.BlockStore:
        """The blocks, which the metadata describe."""
        array_of = functools.partial(io.blocks.opened_array, "resume(store=...)", self.path, is_writable=True)
        arrays = {name: array_of(name) for name in self.outputs}
        for name, array in arrays.items():
            if [*array.shape[:1]] == self._content.get("before"):  # a sweep that has grown since it was made
                array.resize((*self.layout.sizes, *array.shape[1:]))
            self._check_described(name, array)
        return io.blocks.BlockStore(self.path, self.made, self.layout, arrays, holds_nan=True, kind=_MARK)

    def _check_described(self, name: str, array: zarr.Array) -> None:
        """Refuse an array that is not the one of the description, of which the attributes have a checksum."""
        metadata: Any = array.metadata
        there = array.shape, array.chunks, str(array.dtype), metadata.dimension_names or (), metadata.attributes
        if json.dumps(there) != json.dumps(list(self.outputs[name].options(self.design, self.layout).values())):
            got = f"another one in '{self.path}'"
            raise error("resume(store=...)", f"hold the array {name} of its description", got, _AGAIN)


@functools.lru_cache(maxsize=16)
def store_of(store: SweepStore) -> SweepStore:
    """Return the store of this process that stands for one that was sent: its arrays are opened once."""
    return store


def create_store(
    path: Path, description: Data, design: Design, layout: io.blocks.Layout, outputs: dict[str, Output], extra: Data
) -> SweepStore:
    """Make a store without rows; it appears at the path only when it is complete."""
    identity = uuid.uuid4().hex
    content = description | {"layout": layout, "outputs": {name: dataclasses.astuple(o) for name, o in outputs.items()}}
    about: Data = {"format": io.places.SWEEP_FORMAT, "schema": io.places.SCHEMAS[io.places.SWEEP_FORMAT]}
    about |= {"made": identity, "finished": False, "sweep": json.dumps(content)} | extra
    about |= {"versions": io.provenance.versions_text(), "kernels": way_of_kernels()}
    with io.places.new_store(path, new="sweep(store=...)") as part:
        group = io.blocks.new_group(part, about, io.metadata.SweepMetadata)
        _create_arrays(group, design, layout, outputs)
        io.blocks.make_marks(group, part)
    return SweepStore(path.resolve(), identity)


def open_store(path: str | Path, where: str | None = None) -> SweepStore:
    """Return the store of a sweep."""
    return SweepStore(Path(path).resolve(), attributes_of(path, where)["made"])


def attributes_of(path: str | Path, where: str | None = None) -> dict[str, Any]:
    """Return the attributes of the store of a sweep, after checking that it is one of the schema that is read."""
    return io.metadata.read_attributes(path, io.places.SWEEP_FORMAT, where)


def _create_arrays(group: zarr.Group, design: Design, layout: io.blocks.Layout, outputs: dict[str, Output]) -> None:
    for name, values in design.axes.items():
        variable = io.datasets.Variable(axis_dimensions(name, values), values, dict(AXIS))
        io.blocks.create_array(group, name, variable, len(values), len(values))[:] = values
    for name, output in outputs.items():
        group.create_array(name, compressors=_CODECS, fill_value=output.fill, **output.options(design, layout))


class SweepStanding(NamedTuple):
    """The progress of a sweep.

    Attributes:
        done: Members of finished blocks.
        members: Members in total.
        outcomes: How many ended how, by name.
        rate: Members in a second of work of one worker; NaN before the first block.
        messages: Some of those for which the task raised, with what it said.
        owner: Who is writing the store, if anybody.
        finished: Whether the sweep came to its end.
    """

    done: int
    members: int
    outcomes: dict[str, int]
    rate: float
    messages: list[tuple[Any, str]]
    owner: str | None
    finished: bool

    @property
    def state(self) -> str:
        """Whether it is finished, or who works at it."""
        return "finished" if self.finished else f"written by {self.owner}" if self.owner else "stopped"

    @property
    def failure_count(self) -> int:
        """Members that did not succeed."""
        return self.done - self.outcomes.get("successful", 0)

    def __str__(self) -> str:
        return f"{self.done} of {self.members} members, {self.failure_count} of them failed"


def standing_of(path: str | Path) -> SweepStanding:
    """Return the progress of the sweep of a store."""
    store = open_store(path)
    marks = [mark for _, mark in store.marks()]
    outcomes = sum((collections.Counter(mark.outcomes) for mark in marks), collections.Counter())
    count, seconds = sum(mark.members for mark in marks), sum(mark.seconds for mark in marks)
    messages = [message for mark in marks for message in mark.messages]
    rate, members = count / seconds if seconds else math.nan, math.prod(store.layout.sizes)
    end = io.places.owner_of(store.path), store.is_finished
    return SweepStanding(count, members, dict(outcomes), rate, messages, *end)


def opened_result(store: SweepStore) -> xarray.Dataset:
    """Return the result as a dataset that is loaded lazily, by the metadata of its arrays, which were checked."""
    try:
        dataset = xarray.open_zarr(store.path, chunks=None, consolidated=False)
    except Exception as failure:
        got = f"'{store.path}', where xarray cannot read them: {failure}"
        raise error("load_sweep(store=...)", "hold sound metadata", got, "Copy it again from its source.") from failure
    return _with_labels(dataset[sorted(map(str, dataset.data_vars))])  # a disk lists files in any order


def _with_labels(dataset: xarray.Dataset) -> xarray.Dataset:
    """Return a result whose components have names along their dimension, where all of a dimension have the same."""
    names: dict[str, set[tuple[str, ...]]] = {}
    for variable in dataset.data_vars.values():
        if components := variable.attrs.get("components"):
            names.setdefault(str(variable.dims[-1]), set()).add(tuple(components))
    own = {dim: list(*each) for dim, each in names.items() if len(each) == 1 and len(*each) == dataset.sizes[dim]}
    return dataset.assign_coords(own)
