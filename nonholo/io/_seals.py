"""Seals: a checksum of a chunk does not know its place, so the record of a block holds one number of all its chunks.

Of a run it is the last entry of the checkpoint at the end of the block, of a sweep an entry of the mark of the block,
of an orbit saved whole an attribute.
"""

import contextlib
import hashlib
import itertools
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import zarr

from nonholo.io._chunks import DamagedError, chunk_name, chunk_path, read_chunk
from nonholo.io._plan import Checkpoint, Plan, unpacked_checkpoint
from nonholo.io._stored_events import EVENTS

CHECKPOINTS = "run/checkpoints"
WHOLE = "whole"
BEFORE = -1
"""The seal where there are no blocks, and the number of the block that ends where the first one begins."""
_CRC, _BITS = 4, 48  # bytes at the end of a chunk; bits of a seal, which a float64 holds


def seal_of(root: Path, record: int | str, chunks: Iterable[Path]) -> int:
    """Return one number of the places and the checksums of chunks, and of what they belong to."""
    seal = hashlib.sha256(f"{record}".encode())
    for chunk in chunks:
        seal.update(f"\n{chunk.relative_to(root).as_posix()} {_crc(chunk).hex()}".encode())
    return int.from_bytes(seal.digest()[: _BITS // 8])


def _crc(chunk: Path) -> bytes:
    """Return the CRC32C that a chunk ends with, of which reading a chunk checks that it is right."""
    with contextlib.suppress(OSError), chunk.open("rb") as file:
        file.seek(-_CRC, 2)
        return file.read()
    return b""  # there is none, or it is too short


def seal_of_whole(root: Path, arrays: Mapping[str, zarr.Array]) -> int:
    """Return the seal of all chunks of an orbit that was saved whole."""
    each = ((name, index) for name in sorted(arrays) for index in np.ndindex(arrays[name].cdata_shape))
    return seal_of(root, WHOLE, (chunk_path(root, name, arrays[name], index) for name, index in each))


class Blocks(NamedTuple):
    """The blocks of a stored run; what is wrong with them is a `DamagedError`.

    Attributes:
        path: The store.
        plan: How it is cut.
        arrays: All of its arrays by name, of states, checkpoints and crossings.
        events: How many events it looks for; None if it looks for none.
    """

    path: Path
    plan: Plan
    arrays: Mapping[str, zarr.Array]
    events: int | None

    def chunk(self, name: str, number: int, *, with_nan: bool = False) -> np.ndarray:
        """Return one chunk of an array."""
        array = self.arrays[name]
        index = (number,) + (0,) * (array.ndim - 1)
        try:
            return read_chunk(self.path, name, array, index, with_nan=with_nan)
        except DamagedError as wrong:
            raise DamagedError(f"{wrong}, {self._name(name, number)}") from None

    def file(self, name: str, number: int) -> Path:
        """Return the file of such a chunk."""
        array = self.arrays[name]
        return chunk_path(self.path, name, array, (number,) + (0,) * (array.ndim - 1))

    def names(self) -> list[str]:
        """Return the names of the arrays of states."""
        return [name for name in self.arrays if name not in (CHECKPOINTS, EVENTS)]

    def checkpoint(self, block: int) -> Checkpoint:
        """Return the state at the begin of a block."""
        return self._record(block)[0]

    def _record(self, block: int) -> tuple[Checkpoint, float]:
        """Return the state at the begin of a block and the seal of what comes before it."""
        row = self.chunk(CHECKPOINTS, block)
        entries, seal = row[0, :-1], float(row[0, -1])
        try:
            reached = unpacked_checkpoint(entries, self.events)
        except (ValueError, OverflowError):
            raise DamagedError(f"no checkpoint, {self._name(CHECKPOINTS, block)}") from None
        if block == 0 and seal != seal_of(self.path, BEFORE, []):
            raise DamagedError(f"another checkpoint, {self._name(CHECKPOINTS, block)}")
        return reached, seal

    def seal(self, block: int, reached: Checkpoint, chunks: int) -> int:
        """Return the seal of a block that ends at a checkpoint; this many chunks of crossings were there before."""
        return seal_of(self.path, block, itertools.starmap(self.file, self._chunks(block, reached, chunks)))

    def _chunks(self, block: int, reached: Checkpoint, chunks: int) -> list[tuple[str, int]]:
        names = sorted(self.names()) if self.plan.has_rows(block, reached.done) else []
        crossings = () if reached.seen is None else range(chunks, reached.seen.chunks)
        return [(name, block) for name in names] + [(EVENTS, chunk) for chunk in crossings]

    def ended(self, block: int) -> Checkpoint:
        """Return the state at the end of a block that holds the chunks that were written.

        That each chunk is sound is looked at where it is read.
        """
        reached, seal = self._record(block + 1)
        before = self.checkpoint(block).seen if reached.seen is not None else None
        chunks = 0 if before is None else before.chunks
        if seal != self.seal(block, reached, chunks):
            raise DamagedError(self._broken_seal(block, reached, chunks))
        return reached

    def _broken_seal(self, block: int, reached: Checkpoint, chunks: int) -> str:
        """Say which chunk of a block is missing, or that one is of another place."""
        for name, number in self._chunks(block, reached, chunks):
            if not self.file(name, number).is_file():
                return f"no such chunk, {self._name(name, number)}"
        return f"a chunk of another place in block {block}, which {self._name(CHECKPOINTS, block + 1)} seals"

    def check(self) -> None:
        """Check that every block of a finished run holds the chunks that were written."""
        for block in range(self.plan.blocks):
            if self.ended(block).is_last:
                break

    def _name(self, name: str, number: int) -> str:
        array = self.arrays[name]
        return chunk_name(name, array, (number,) + (0,) * (array.ndim - 1))
