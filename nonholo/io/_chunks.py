"""Chunks of a store: each must be there and intact; nothing missing is ever read as data."""

import contextlib
from pathlib import Path

import numpy as np
import zarr

from nonholo.base.checks import error, printable
from nonholo.io._metadata import check_array

WHERE = "load_orbit(path=...)"
AGAIN = "The store is damaged: copy it again from its source, or run it again."
_NAN = "NaN"


class DamagedError(Exception):
    """Damage of a part of a store; a reader reports it, or computes the part again."""


def opened_array(root: Path, name: str, shape: tuple[int, ...] | None) -> zarr.Array:
    """Open an array of a store, of a known shape unless the run is not finished."""
    try:
        array = zarr.open_array(root / name, mode="r")
    except Exception as failure:
        raise error(WHERE, f"hold the array {name}", f"{type(failure).__name__}: {failure}", AGAIN) from failure
    if array.shape != (shape or array.shape) or array.dtype != np.float64:
        got = f"{array.dtype} of shape {array.shape}"
        raise error(WHERE, f"hold the array {name} as float64 of shape {shape}", got, AGAIN)
    check_array(WHERE, name, array)
    return array


def checked_block(
    root: Path, name: str, array: zarr.Array, index: tuple[int, ...], *, with_nan: bool = False
) -> np.ndarray:
    """Return one chunk; refuse one that is missing or damaged, with its name."""
    try:
        return read_chunk(root, name, array, index, with_nan=with_nan)
    except DamagedError as wrong:
        requirement = f"hold {chunk_name(name, array, index)}" + (" free of NaN" if str(wrong) == _NAN else "")
        raise error(WHERE, requirement, str(wrong), AGAIN) from None


def checked_array(root: Path, name: str, array: zarr.Array) -> np.ndarray:
    """Return all chunks, read at once; refuse one that is missing or damaged, with its name."""
    indices = list(np.ndindex(array.cdata_shape))
    if all(chunk_path(root, name, array, index).is_file() for index in indices):
        with contextlib.suppress(Exception):  # which one it is appears when they are read one by one
            values = np.asarray(array[...])
            if not _lacks_numbers(name, values):
                return values
    return np.concatenate([checked_block(root, name, array, index) for index in indices])


def chunk_name(name: str, array: zarr.Array, index: tuple[int, ...]) -> str:
    """Return how messages call a chunk."""
    return f"chunk {array.metadata.encode_chunk_key(index)} of the array {name}"


def chunk_path(root: Path, name: str, array: zarr.Array, index: tuple[int, ...]) -> Path:
    """Return the file of a chunk."""
    return root / name / array.metadata.encode_chunk_key(index)


def read_chunk(
    root: Path, name: str, array: zarr.Array, index: tuple[int, ...], *, with_nan: bool = False
) -> np.ndarray:
    """Return one chunk; NaN is wrong, unless it may be a result.

    A missing one would be read as its fill value, NaN, so its file is looked for first.

    Raises:
        DamagedError: The chunk is missing or damaged.
    """
    if not chunk_path(root, name, array, index).is_file():
        raise DamagedError("no such chunk")
    try:
        block = np.asarray(array.blocks[index])
    except Exception as failure:
        raise DamagedError(f"a corrupt one ({printable(str(failure))})") from failure
    if not with_nan and _lacks_numbers(name, block):
        raise DamagedError(_NAN)
    return block


def _lacks_numbers(name: str, rows: np.ndarray) -> bool:
    """Return whether there are NaN; impulses lead from each state to the next, which the last state may not have."""
    return bool(np.isnan(rows[:-1] if name == "multipliers" else rows).any())
