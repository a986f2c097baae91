"""The array of crossings of a stored run: the rows of a block are in chunks of their own, so each is written whole."""

from collections.abc import Sequence

import numpy as np
import xarray
import zarr

from nonholo.base.types import Float
from nonholo.io._chunks import DamagedError
from nonholo.io._save import create_array
from nonholo.io._stored_events import EVENTS, Seen, known, rows_of
from nonholo.orbit import EventLog

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
