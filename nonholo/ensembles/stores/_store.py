"""The store of a sweep: one block is one chunk of each array, then its mark, a small file written after the data.

Writes are atomic, so whoever writes can be killed at any moment. What a block holds depends on nothing but the task and
the design, so two writers of one block write the same.
"""

import asyncio
import dataclasses
import functools
import json
import math
import uuid
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import xarray
import zarr
from pydantic import Field, TypeAdapter, ValidationError
from zarr.codecs import BloscCodec, Crc32cCodec
from zarr.core.sync import sync

from nonholo import io
from nonholo.base.checks import error, printable
from nonholo.ensembles._describe import design_from
from nonholo.ensembles.designs import Design, axis_dimensions
from nonholo.ensembles.stores._results import Output, Results


class Piece(NamedTuple):
    """A block: its number, where it lies in the arrays, its first member and how many it has."""

    number: int
    place: tuple[slice, ...]
    first: int
    count: int


class Layout(NamedTuple):
    """The lengths of the dimensions of a design and of a block.

    Example:
        >>> layout = layout_of((3, 5), block=2)
        >>> layout, layout.blocks
        (Layout(sizes=(3, 5), chunk=(1, 2)), 9)
        >>> layout.piece(5)
        Piece(number=5, place=(slice(1, 2, None), slice(4, 5, None)), first=9, count=1)
    """

    sizes: tuple[int, ...]
    chunk: tuple[int, ...]

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return math.prod(self.counts)

    @property
    def counts(self) -> tuple[int, ...]:
        """Numbers of blocks along each dimension."""
        return tuple(-(-size // chunk) for size, chunk in zip(self.sizes, self.chunk, strict=True))

    def index(self, block: int) -> tuple[int, ...]:
        """Return where a block stands among the blocks."""
        return tuple(int(at) for at in np.unravel_index(block, self.counts))

    def piece(self, block: int) -> Piece:
        """Return a block."""
        begins = [at * chunk for at, chunk in zip(self.index(block), self.chunk, strict=True)]
        ends = [min(begin + chunk, size) for begin, chunk, size in zip(begins, self.chunk, self.sizes, strict=True)]
        place = tuple(slice(begin, end) for begin, end in zip(begins, ends, strict=True))
        first = int(np.ravel_multi_index(begins, self.sizes))
        return Piece(block, place, first, math.prod(s.stop - s.start for s in place))


def layout_of(sizes: tuple[int, ...], block: int) -> Layout:
    """Cut a design in blocks of `block` members at most: whole last dimensions, a part of one, one of those before."""
    chunk, room = [], block
    for size in reversed(sizes):
        chunk.append(max(1, min(size, room)))
        room //= chunk[-1] if chunk[-1] == size else room
    return Layout(sizes, tuple(reversed(chunk)))


FORMAT = "nonholo.sweep"
SCHEMA = 4
"""Written by this version, and read. Those below 4 are of before 0.3.0, from which on later versions read stores."""
_AGAIN = "Run the sweep again."
_AXIS = {"long_name": "value of the design"}
_CODECS = BloscCodec(cname="lz4", clevel=5, shuffle="bitshuffle"), Crc32cCodec()
"""As fast as a sweep: the numbers of its members are too different from each other for a slower one to gain by it."""


class Mark(NamedTuple):
    """The mark of a finished block."""

    members: int
    outcomes: dict[str, int]
    seconds: float
    finished: float
    writer: str
    messages: list[Annotated[list[Any], Field(min_length=2, max_length=2)]]
    seal: int = 0


_MARK = TypeAdapter(Mark)


@dataclasses.dataclass(frozen=True)
class SweepStore:
    """A store that a sweep is written to.

    Attributes:
        path: Where it is, the same for all who write.
        made: Which one it is: another store at the same path has another number.
    """

    path: Path
    made: str

    def __reduce__(self) -> Any:
        return SweepStore, (self.path, self.made)

    @functools.cached_property
    def layout(self) -> Layout:
        """The cut of members into blocks."""
        return Layout(*(tuple(sizes) for sizes in self._content["layout"]))

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

    def write(self, piece: Piece, results: Results, mark: Mark) -> None:
        """Write the chunks of a block, then its mark."""
        io.require_identity(self.path, self.made)
        self._mark_file(piece.number).unlink(missing_ok=True)
        for name in results.arrays:
            self._chunk_file(name, piece.number).unlink(missing_ok=True)  # zarr would read a damaged one first
        sync(self._write_chunks(piece, results))
        text = json.dumps(mark._replace(seal=self._seal(piece.number))._asdict())
        io.write_whole(self._mark_file(piece.number), f"{zlib.crc32(text.encode()):08x} {text}")

    async def _write_chunks(self, piece: Piece, results: Results) -> None:
        """Write the chunks of a block side by side, which takes half of the time; a failure leaves no writer behind."""
        lengths = tuple(s.stop - s.start for s in piece.place)
        writes = [
            self._arrays[name].async_array.setitem(piece.place, rows.reshape(*lengths, *rows.shape[1:]))
            for name, rows in results.arrays.items()
        ]
        for failure in await asyncio.gather(*writes, return_exceptions=True):
            if isinstance(failure, BaseException):
                raise failure

    def mark(self, block: int) -> Mark | None:
        """Return the mark of a block, None if the block is not finished.

        Raises:
            DamagedError: The mark cannot be read, or is not the one that was written.
        """
        try:
            written = self._mark_file(block).read_text()
        except FileNotFoundError:
            return None
        except UnicodeDecodeError:
            raise io.DamagedError(f"the mark {self._mark_file(block).name} cannot be read") from None
        check, _, text = written.partition(" ")
        try:
            mark = _MARK.validate_json(text)
        except ValidationError:
            check, mark = "", None
        if mark is None or check != f"{zlib.crc32(text.encode()):08x}":
            raise io.DamagedError(f"the mark {self._mark_file(block).name} is damaged")
        return mark._replace(
            outcomes={printable(name): count for name, count in mark.outcomes.items()},
            writer=printable(mark.writer),
            messages=[[member, printable(str(message).replace("\n", " "))] for member, message in mark.messages],
        )

    def marks(self) -> Iterator[tuple[int, Mark]]:
        """Return the numbers of finished blocks in order with their marks, those that can be read."""
        files = (self.path / "run" / "blocks").glob("*.json")
        for block in sorted(int(file.stem) for file in files if file.stem.isdecimal()):
            try:
                mark = self.mark(block)
            except io.DamagedError:
                continue
            if mark is not None:
                yield block, mark

    def sound(self, block: int) -> Mark:
        """Return the mark of a finished block, of which every chunk is sound.

        Raises:
            DamagedError: One is not, or the mark is not; the message says which, and how.
        """
        for name, array in self._arrays.items():
            index = self._index(name, block)
            try:
                io.read_chunk(self.path, name, array, index, with_nan=True)
            except io.DamagedError as wrong:
                raise io.DamagedError(f"{wrong}, {io.chunk_name(name, array, index)}") from None
        mark = self.mark(block)
        if mark is None:
            raise io.DamagedError(f"no mark {self._mark_file(block).name}")
        if mark.seal != self._seal(block):
            flaw = f"a chunk of another place in block {block}, which {self._mark_file(block).name} seals"
            raise io.DamagedError(flaw)
        return mark

    def _seal(self, block: int) -> int:
        return io.seal_of(self.path, block, (self._chunk_file(name, block) for name in sorted(self._arrays)))

    def check(self, where: str, blocks: Iterable[int]) -> None:
        """Refuse a store of which one of these blocks, or an axis, is damaged."""
        _ = self.design
        try:
            for block in blocks:
                self.sound(block)
        except io.DamagedError as flaw:
            remedy = f"nonholo.resume({str(self.path)!r}) computes its block again."
            raise error(where, "be sound", f"'{self.path}', in which there is {flaw}", remedy) from None

    def rows(self, name: str, piece: Piece) -> np.ndarray:
        """Return an array of a block, one row for each member."""
        found = np.asarray(self._arrays[name][piece.place])
        return found.reshape(piece.count, *found.shape[len(piece.place) :])

    def prepare(self) -> None:
        """Remove what killed writers left and show that every array can be opened."""
        (self.path / "run" / "blocks").mkdir(exist_ok=True)  # what copies stores may leave out empty folders
        io.remove_partials(self.path)
        _ = self._arrays, self.design

    def finish(self) -> None:
        """Say that the sweep came to its end, and consolidate the metadata."""
        io.require_identity(self.path, self.made)
        io.edit_attributes(self.path, {"finished": True})
        io.consolidate(self.path)

    def _index(self, name: str, block: int) -> tuple[int, ...]:
        return (*self.layout.index(block), *(0,) * len(self.outputs[name].shape))

    def _chunk_file(self, name: str, block: int) -> Path:
        return io.chunk_path(self.path, name, self._arrays[name], self._index(name, block))

    def _mark_file(self, block: int) -> Path:
        return self.path / "run" / "blocks" / f"{block}.json"

    def _axis(self, name: str) -> np.ndarray:
        array = io.writable_array(self.path, name)
        try:
            found = io.read_chunk(self.path, name, array, (0,) * array.ndim)
        except io.DamagedError as flaw:
            got = f"{flaw}, in '{self.path}'"
            raise error("resume(store=...)", f"hold the axis {name}", got, _AGAIN) from None
        expected = list(axis_dimensions(name, found)), _AXIS
        if (list(array.metadata.dimension_names or ()), array.metadata.attributes) != expected:  # type: ignore[union-attr]
            raise error("resume(store=...)", f"hold the axis {name}", f"another one in '{self.path}'", _AGAIN)
        return found

    @functools.cached_property
    def _content(self) -> dict[str, Any]:
        return json.loads(attributes_of(self.path)["sweep"])

    @functools.cached_property
    def _arrays(self) -> dict[str, zarr.Array]:
        opened = {name: io.writable_array(self.path, name) for name in self.outputs}
        for name, array in opened.items():
            self._check_described(name, array)
        return {name: array.with_config({"write_empty_chunks": True}) for name, array in opened.items()}

    def _check_described(self, name: str, array: zarr.Array) -> None:
        """Refuse an array that is not the one of the description, of which the attributes have a checksum."""
        output, chunk = self.outputs[name], self.layout.chunk
        shape, chunks = (*self.layout.sizes, *output.shape), (*chunk, *(max(1, size) for size in output.shape))
        expected = [list(shape), list(chunks), output.dtype, json.dumps(output.attributes)]
        found = [list(array.shape), list(array.chunks), str(array.dtype), json.dumps(array.metadata.attributes)]
        dimensions = [*self.design.sizes, *output.dimensions]
        if [*found, list(array.metadata.dimension_names or ())] != [*expected, dimensions]:  # type: ignore[union-attr]
            got = f"another one in '{self.path}'"
            raise error("resume(store=...)", f"hold the array {name} of its description", got, _AGAIN)


@functools.lru_cache(maxsize=16)
def store_of(store: SweepStore) -> SweepStore:
    """Return the store of this process that stands for one that was sent: its arrays are opened once."""
    return store


def create_store(
    path: Path,
    description: dict[str, Any],
    design: Design,
    layout: Layout,
    outputs: dict[str, Output],
    extra: dict[str, Any],
) -> SweepStore:
    """Make a store without rows; it appears at the path only when it is complete."""
    target, made = path.resolve(), uuid.uuid4().hex
    if target.exists():
        raise _exists(path)
    content = description | {"layout": layout, "outputs": {name: dataclasses.astuple(o) for name, o in outputs.items()}}
    about = {"format": FORMAT, "schema": SCHEMA, "made": made, "finished": False, "sweep": json.dumps(content)}
    with io.new_beside(path) as part:
        group = io.new_group(part, about | {"versions": io.versions_text()} | extra, io.SweepMetadata)
        _create_arrays(group, design, layout, outputs)
        (part / "run" / "blocks").mkdir()
        try:
            io.put_in_place(part, target, overwrite=False)
        except FileExistsError:
            raise _exists(path) from None
    return SweepStore(target, made)


def _exists(path: Path) -> FileExistsError:
    remedy = "Choose another path, or resume it: nonholo.resume(store), sweep(..., resume=True)."
    return FileExistsError(f"`sweep(store=...)` must be new. Got '{path}', which exists. {remedy}")


def open_store(path: str | Path) -> SweepStore:
    """Return the store of a sweep."""
    stored = attributes_of(path)
    return SweepStore(Path(path).resolve(), stored["made"])


def attributes_of(path: str | Path) -> dict[str, Any]:
    """Return the attributes of the store of a sweep, after checking that it is one of the schema that is read."""
    return io.read_attributes(path, FORMAT, SCHEMA)


def _create_arrays(group: zarr.Group, design: Design, layout: Layout, outputs: dict[str, Output]) -> None:
    for name, values in design.axes.items():
        variable = xarray.Variable(axis_dimensions(name, values), values, _AXIS)
        io.create_array(group, name, variable, len(values), len(values))[:] = values
    for name, output in outputs.items():
        group.create_array(
            name,
            shape=(*layout.sizes, *output.shape),
            dtype=output.dtype,
            chunks=(*layout.chunk, *(max(1, size) for size in output.shape)),
            compressors=_CODECS,
            fill_value=output.fill,
            dimension_names=[*design.sizes, *output.dimensions],
            attributes=output.attributes,
        )
    group.create_group("run")  # or xarray would wonder what that folder is
