"""A store of blocks of named arrays: one block is one chunk of each array, then its mark, which is written last.

A mark is a small file under `run/blocks`: a checksum, and as JSON the attributes of the block and its seal. A checksum
of a chunk does not know its place, so the seal is one number of the store, the places and the checksums of all chunks
of the block. Rows of which a block has any number, such as crossings, are in whole chunks of a log, an array that
grows. All writes are atomic, so a writer can be killed at any moment.
"""

import asyncio
import contextlib
import dataclasses
import hashlib
import json
import math
import os
import threading
import uuid
import warnings
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import zarr
from pydantic import BaseModel, NonNegativeInt, TypeAdapter
from zarr.codecs import BloscCodec, Crc32cCodec
from zarr.core.sync import sync

from nonholo.base.checks import error, printable
from nonholo.io.checkpoints import EVENTS, DamagedError
from nonholo.io.datasets import CANONICAL, Variable
from nonholo.io.metadata import OrbitMetadata, check_array, check_metadata, checksum, require_identity
from nonholo.io.places import WHERE, sibling

Shape: TypeAlias = tuple[int, ...]  # of an array, or the place of a chunk in it
Rows: TypeAlias = Mapping[str, np.ndarray]
_FILTERS = threading.Lock()  # warning filters belong to the whole process


def new_group(path: Path, metadata: dict[str, Any], kind: type[BaseModel]) -> zarr.Group:
    """Make a store with attributes, refused if they could not be read again, and their checksum."""
    metadata |= {"checksum": checksum(metadata)}
    check_metadata("store=...", str(path), json.loads(json.dumps(metadata)), kind)
    return zarr.create_group(path, zarr_format=3, attributes=metadata)


def consolidate(path: Path) -> None:
    """Gather the metadata of a complete store in one file, and wait until all of them are on the disk.

    Metadata of inner groups carry no information, and are written again.
    """
    for inner in filter(Path.is_dir, (path / "canonical", path / "run")):
        write_whole(inner / "zarr.json", json.dumps({"attributes": {}, "zarr_format": 3, "node_type": "group"}))
    with _FILTERS, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # zarr: consolidated metadata are not in the specification yet
        zarr.consolidate_metadata(path)
    for files in map(path.glob, ("zarr.json", "*/zarr.json", "*/*/zarr.json")):
        for file in files:
            settle(file)
            settle(file.parent)
    settle(path.parent)


def create_array(group: zarr.Group, name: str, variable: Variable, rows: int, chunk: int) -> zarr.Array:
    """Make the array of a variable for this many rows, this many in a chunk; rows that are not written are NaN.

    Chunks are compressed, then get a checksum of what is on disk.
    """
    with zarr.config.set({"array.write_empty_chunks": True}):
        return group.create_array(
            name,
            shape=(rows, *variable.shape[1:]),
            dtype="float64",
            chunks=(chunk, *(max(1, size) for size in variable.shape[1:])),
            compressors=(BloscCodec(cname="zstd", clevel=3, shuffle="shuffle"), Crc32cCodec()),
            fill_value=float("nan"),
            dimension_names=list(variable.dims),
            attributes=variable.attrs,
        )


def settle(path: Path) -> None:
    """Wait until a file, or the names in a folder, are on the disk: a power cut does not take them back."""
    with contextlib.suppress(PermissionError):  # Windows opens no folders
        descriptor = os.open(path, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def write_whole(path: Path, text: str, *, is_settled: bool = False) -> None:
    """Write a small file at once: a reader sees the old one or the new one, and a killed writer leaves a `.partial`."""
    part = sibling(path, "partial")
    try:
        part.write_text(text)
        if is_settled:
            settle(part)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def edit_attributes(path: Path, changes: dict[str, Any]) -> None:
    """Change attributes (None removes one) and drop the consolidated metadata, in one atomic write."""
    document = json.loads((path / "zarr.json").read_text())
    attributes = {name: x for name, x in (document["attributes"] | changes).items() if x is not None}
    document["attributes"] = attributes | {"checksum": checksum(attributes)}
    document.pop("consolidated_metadata", None)
    write_whole(path / "zarr.json", json.dumps(document), is_settled=True)
    settle(path)


AGAIN = "The store is damaged: copy it again from its source, or run it again."


def opened_array(where: str, root: Path, name: str, shape: Any = None, *, is_writable: bool = False) -> zarr.Array:
    """Open an array of a store, of a known shape; the number of rows is that of the array where it is to be written."""
    try:
        array = zarr.open_array(root / name, mode="r+" if is_writable else "r", zarr_format=3)
    except Exception as failure:
        got = f"'{root}', where its metadata cannot be read: {type(failure).__name__}: {failure}"
        raise error(where, f"hold the array {name}", got, AGAIN) from failure
    first = 1 if is_writable else 0
    if shape is not None and (array.shape[first:] != tuple(shape[first:]) or array.dtype != np.float64):
        got = f"{array.dtype} of shape {array.shape} in '{root}'"
        raise error(where, f"hold the array {name} as float64 of shape {tuple(shape)}", got, AGAIN)
    check_array(where, name, array)
    return array.with_config({"write_empty_chunks": True})  # of NaN alone too: an impulse that is not known


class Chunk(NamedTuple):
    """One chunk of an array of a store: the store, the name of the array, the array, and the place of the chunk."""

    root: Path
    name: str
    array: zarr.Array
    index: Shape

    def __str__(self) -> str:
        return f"chunk {self.array.metadata.encode_chunk_key(self.index)} of the array {self.name}"

    @property
    def file(self) -> Path:
        """The file that holds it."""
        return self.root / self.name / self.array.metadata.encode_chunk_key(self.index)

    @property
    def crc(self) -> bytes:
        """The CRC32C that it ends with, of which reading it checks that it is right; empty where there is none."""
        with contextlib.suppress(OSError), self.file.open("rb") as file:
            file.seek(-_CRC, 2)
            return file.read()
        return b""  # the file is not there, or too short

    def read(self, *, with_nan: bool = False) -> np.ndarray:
        """Return its numbers; NaN is wrong, unless it may be a result.

        A missing one would be read as its fill value, NaN, so the existence of its file is checked first.

        Raises:
            DamagedError: The chunk is missing or damaged.
        """
        if not self.file.is_file():
            raise DamagedError(f"no such chunk, {self}")
        try:
            block = np.asarray(self.array.blocks[self.index])
        except Exception as failure:
            raise DamagedError(f"a corrupt one ({printable(str(failure))}), {self}") from failure
        if not with_nan and _lacks_numbers(self.name, block):
            raise DamagedError(f"NaN, {self}")
        return block


@contextlib.contextmanager
def refusing_damage(where: str, requirement: str, path: Path, remedy: str = AGAIN) -> Iterator[None]:
    """Refuse a store in which damage is found."""
    try:
        yield
    except DamagedError as flaw:
        raise error(where, requirement, f"{flaw}, in '{path}'", remedy) from None


def checked_block(store: "BlockStore", name: str, chunk: int, *, with_nan: bool = False) -> np.ndarray:
    """Return one chunk of rows; refuse one that is missing or damaged, with its name."""
    with refusing_damage(WHERE, "hold sound chunks", store.path):
        return store.chunk(name, (chunk,)).read(with_nan=with_nan)


def checked_array(store: "BlockStore", name: str, *, last: bool) -> np.ndarray:
    """Return all chunks, read at once, or the last one; refuse one that is missing or damaged, with its name."""
    array = store.array(name)
    indices = list(np.ndindex(array.cdata_shape))
    if last and indices:
        return checked_block(store, name, len(indices) - 1)
    if all(store.chunk(name, index).file.is_file() for index in indices):
        with contextlib.suppress(Exception):  # which one it is appears when they are read one by one
            if not _lacks_numbers(name, values := np.asarray(array[...])):
                return values
    return np.concatenate([checked_block(store, name, chunk) for chunk in range(len(indices))])


def _lacks_numbers(name: str, rows: np.ndarray) -> bool:
    """Return whether there are NaN; impulses may be, of a last state and of steps with impacts."""
    return name != "multipliers" and bool(np.isnan(rows).any())


BEFORE = -1
"""The number of the mark of what the first block begins with."""
Variables: TypeAlias = Mapping[str, Variable]
_MARKS = Path("run", "blocks")
_CRC, _BITS = 4, 48  # bytes at the end of a chunk; bits of a seal
ORIGIN = 16  # digits at the beginning of what identifies a store, which it keeps when it grows


class Piece(NamedTuple):
    """A block: where it lies in the arrays, its first member and how many it has."""

    place: tuple[slice, ...]
    first: int
    count: int


class Layout(NamedTuple):
    """The lengths of the dimensions that are cut into blocks, and of a block.

    Example:
        >>> layout = Layout(sizes=(3, 5), chunk=(1, 2))
        >>> layout.blocks, layout.piece(5)
        (9, Piece(place=(slice(1, 2, None), slice(4, 5, None)), first=9, count=1))
    """

    sizes: Shape
    chunk: Shape

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return math.prod(self.counts)

    @property
    def counts(self) -> Shape:
        """Numbers of blocks along each dimension."""
        return tuple(-(-size // chunk) for size, chunk in zip(self.sizes, self.chunk, strict=True))

    def index(self, block: int) -> Shape:
        """Return where a block stands among the blocks."""
        return tuple(int(at) for at in np.unravel_index(block, self.counts))

    def piece(self, block: int) -> Piece:
        """Return a block."""
        begins = [at * chunk for at, chunk in zip(self.index(block), self.chunk, strict=True)]
        ends = [min(begin + chunk, size) for begin, chunk, size in zip(begins, self.chunk, self.sizes, strict=True)]
        place = tuple(slice(begin, end) for begin, end in zip(begins, ends, strict=True))
        first = int(np.ravel_multi_index(begins, self.sizes))
        return Piece(place, first, math.prod(s.stop - s.start for s in place))


class BlockMark(NamedTuple):
    """The mark of a finished block.

    Attributes:
        about: Attributes of the block.
        has_rows: Whether it has a chunk of each array.
        log: The first chunk of the log that is its own, and the first one after those.
        seal: The number of its chunks.
    """

    about: Any
    has_rows: bool
    log: tuple[NonNegativeInt, NonNegativeInt]
    seal: int


_MARK, _ANY = TypeAdapter(BlockMark), TypeAdapter(dict[str, Any])


@dataclasses.dataclass(frozen=True)
class BlockStore:
    """The blocks of a store; what is wrong with them is a `DamagedError`.

    Attributes:
        path: Where it is.
        made: Which one it is: another store at the same path has another number.
        layout: How the arrays are cut.
        arrays: The arrays by name, those that the metadata name.
        log: The array that grows, if there is one.
        holds_nan: Whether NaN may be a result.
        kind: The type of the attributes of its blocks.
    """

    path: Path
    made: str
    layout: Layout
    arrays: Mapping[str, zarr.Array]
    log: zarr.Array | None = None
    holds_nan: bool = False
    kind: TypeAdapter[Any] = _ANY

    def write(self, block: int, rows: Rows, about: dict[str, Any], log: np.ndarray | None = None) -> None:
        """Write the chunks of a block, of none if there are no rows, and its rows of the log; then its mark."""
        require_identity(self.path, self.made)
        before = self.mark(block - 1) if self.log is not None and block > BEFORE else None
        begin = 0 if before is None else before.log[1]
        self._mark_file(block).unlink(missing_ok=True)
        for name in self.arrays if rows else ():
            self.chunk(name, self.layout.index(block)).file.unlink(missing_ok=True)  # zarr would read a damaged one
        end = begin if log is None or not len(log) else self._write_log(begin, log)
        if rows:
            sync(self._write_chunks(block, rows))
        mark = BlockMark(about, bool(rows), (begin, end), 0)
        text = json.dumps(mark._replace(seal=self._seal(block, mark))._asdict())
        write_whole(self._mark_file(block), f"{zlib.crc32(text.encode()):08x} {text}")

    async def _write_chunks(self, block: int, rows: Rows) -> None:
        """Write the chunks of a block side by side, which takes half of the time; a failure leaves no writer behind."""
        place = self.layout.piece(block).place
        if len(place) == 1:  # a block that ended early has fewer rows
            place = (slice(place[0].start, place[0].start + len(next(iter(rows.values())))),)
        lengths = tuple(part.stop - part.start for part in place)
        writes = [
            array.async_array.setitem(place, np.ascontiguousarray(rows[name]).reshape(*lengths, *rows[name].shape[1:]))
            for name, array in self.arrays.items()
        ]
        for failure in await asyncio.gather(*writes, return_exceptions=True):
            if isinstance(failure, BaseException):
                raise failure

    def _write_log(self, begin: int, rows: np.ndarray) -> int:
        """Write rows into whole chunks of the log from one on; return the number of the first one after them."""
        log = self.array(EVENTS)
        size, width = log.chunks
        end = begin - (-len(rows) // size)
        full = np.full(((end - begin) * size, width), np.nan)
        full[: len(rows)] = rows
        if log.shape[0] < end * size:
            log.resize((end * size, width))
        log[begin * size : end * size] = full
        return end

    def mark(self, block: int) -> BlockMark | None:
        """Return the mark of a block, None if the block is not finished.

        Raises:
            DamagedError: The mark cannot be read, or is not the one that was written.
        """
        file = self._mark_file(block)
        try:
            check, _, text = file.read_text().partition(" ")
            mark = _MARK.validate_python(json.loads(text))
            mark = mark._replace(about=self.kind.validate_python(mark.about))
            chunks = 0 if self.log is None else self.log.cdata_shape[0]
            if check != f"{zlib.crc32(text.encode()):08x}" or mark.log[1] > chunks:
                raise ValueError
        except FileNotFoundError:
            return None
        except (ValueError, RecursionError):
            raise DamagedError(f"the mark {file.name} is damaged") from None
        return mark

    def block_numbers(self) -> set[int]:
        """Return the blocks that have a mark, sound or not; the folder is read once."""
        folder = self.path / _MARKS
        stems = (name.removesuffix(".json") for name in os.listdir(folder)) if folder.is_dir() else ()
        return {int(stem) for stem in stems if stem.isdecimal()}

    def mark_of(self, block: int) -> BlockMark:
        """Return the mark of a block, which must be there."""
        if (mark := self.mark(block)) is None:
            raise DamagedError(f"no mark {self._mark_file(block).name}")
        return mark

    def checked_mark(self, block: int) -> BlockMark:
        """Return the mark of a block that holds the chunks that were written.

        Each chunk is checked when it is read.
        """
        mark = self.mark_of(block)
        self._check_seal(block, mark)
        return mark

    def sound(self, block: int) -> BlockMark:
        """Return the mark of a finished block, of which every chunk is sound.

        Raises:
            DamagedError: One is not, or the mark is not; the message names it and the damage.
        """
        mark = self.mark_of(block)
        for chunk in self._chunks(block, mark):
            chunk.read(with_nan=self.holds_nan or chunk.name == EVENTS)
        self._check_seal(block, mark)
        return mark

    def rows(self, name: str, place: tuple[slice, ...]) -> np.ndarray:
        """Return a part of an array of sound blocks."""
        return np.asarray(self.arrays[name][place])

    def resize(self, rows: int) -> dict[str, Shape]:
        """Give all arrays but the log this many rows; return their shapes."""
        require_identity(self.path, self.made)
        shapes = {name: (rows, *array.shape[1:]) for name, array in self.arrays.items()}
        for name, array in self.arrays.items():
            if array.shape != shapes[name]:
                array.resize(shapes[name])
        return shapes

    def cut_log(self, block: int) -> None:
        """Cut the log to its chunks up to the end of a block."""
        if self.log is not None:
            self.log.resize((self.mark_of(block).log[1] * self.log.chunks[0], self.log.shape[1]))

    def prepare(self) -> None:
        """Remove what killed writers left; nothing here loses data."""
        (self.path / _MARKS).mkdir(exist_ok=True)  # what copies stores may leave out empty folders
        for partial in self.path.rglob("*.partial"):
            partial.unlink(missing_ok=True)

    def finish(self, changes: dict[str, Any]) -> None:
        """Add attributes that say that it came to its end, and consolidate the metadata."""
        require_identity(self.path, self.made)
        edit_attributes(self.path, changes)
        consolidate(self.path)

    def _seal(self, block: int, mark: BlockMark) -> int:
        """Return one number of the store, the block's number, and the places and checksums of its chunks."""
        seal = hashlib.sha256(f"{self.made[:ORIGIN]} {block}".encode())
        for chunk in self._chunks(block, mark):
            seal.update(f"\n{chunk.file.relative_to(self.path).as_posix()} {chunk.crc.hex()}".encode())
        return int.from_bytes(seal.digest()[: _BITS // 8])

    def _check_seal(self, block: int, mark: BlockMark) -> None:
        """Refuse a block of which a chunk is missing, or of another place or store."""
        if mark.seal == self._seal(block, mark):
            return
        for chunk in self._chunks(block, mark):
            if not chunk.file.is_file():
                raise DamagedError(f"no such chunk, {chunk}")
        mark_name = self._mark_file(block).name
        raise DamagedError(f"a chunk of another place or store in block {block}, which {mark_name} seals")

    def _chunks(self, block: int, mark: BlockMark) -> Iterator[Chunk]:
        """Return the chunks of a block."""
        if mark.has_rows and 0 <= block < self.layout.blocks:  # a mark may be that of another block
            yield from (self.chunk(name, self.layout.index(block)) for name in sorted(self.arrays))
        yield from (self.chunk(EVENTS, (number,)) for number in range(*mark.log))

    def array(self, name: str) -> zarr.Array:
        """Return an array of rows, or the log."""
        return self.log if name == EVENTS and self.log is not None else self.arrays[name]

    def chunk(self, name: str, index: Shape) -> Chunk:
        """Return a chunk of an array by its place along the dimensions that are cut."""
        array = self.array(name)
        return Chunk(self.path, name, array, index + (0,) * (array.ndim - len(index)))

    def _mark_file(self, block: int) -> Path:
        return self.path / _MARKS / ("start.json" if block == BEFORE else f"{block}.json")


def new_blocks(path: Path, metadata: dict[str, Any], variables: Variables, rows: int, chunk: int) -> BlockStore:
    """Make the store of an orbit, whose arrays have this many rows, this many in a block; none is written yet."""
    identity, shapes = uuid.uuid4().hex, {name: (rows, *variable.shape[1:]) for name, variable in variables.items()}
    group = new_group(path, metadata | {"made": identity, "arrays": json.dumps(shapes)}, OrbitMetadata)
    if any(name.startswith(CANONICAL) for name in variables):
        group.create_group(CANONICAL.rstrip("/"))  # of compact states
    arrays = {name: create_array(group, name, variable, rows, chunk) for name, variable in variables.items()}
    make_marks(group, path)
    return BlockStore(path, identity, Layout((rows,), (chunk,)), arrays)


def make_marks(group: zarr.Group, path: Path) -> None:
    """Make the place of the marks of a new store."""
    group.create_group("run")  # or xarray would wonder what that folder is
    (path / _MARKS).mkdir()
