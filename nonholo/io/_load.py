"""Reading a store: every chunk must be there and intact; nothing missing is ever read as data."""

import dataclasses
import json
from collections.abc import Container
from pathlib import Path
from typing import Any

import numpy as np
import zarr

from nonholo._checks import error
from nonholo._checks import path as checked_path
from nonholo._results import Outcome
from nonholo._types import Float
from nonholo.discrete import Discretization
from nonholo.io._attributes import FORMAT, READABLE, SWEEP_FORMAT, restore_motion
from nonholo.io._dataset import CANONICAL
from nonholo.io._metadata import OrbitMetadata, SweepMetadata, check_chunk, check_metadata
from nonholo.io._plan import Plan
from nonholo.io._stored_events import EVENTS, known, log_of
from nonholo.orbit import STATES, EventLog, Orbit

_WHERE = "load_orbit(path=...)"
_NAN = "NaN"
_KINDS = {FORMAT: "an orbit", SWEEP_FORMAT: "a sweep", "nonholo.ensemble": "an ensemble"}
_AGAIN = "The store is damaged: copy it again from its source, or run it again."


def load_orbit(path: str | Path, *, discrete: Discretization | None = None) -> Orbit:
    """Load an orbit saved by `save_orbit`, bit for bit.

    Args:
        path: The store.
        discrete: The discretisation that made the store; needed only if its difference or its constraint is callable,
            or its system or group is of your own making, which a store cannot hold.

    Raises:
        FileNotFoundError: There is nothing at the path.
        ValueError: The path is no store of an orbit, has another schema, or is damaged; the message names the array
            and the chunk.

    Example:
        >>> orbit = load_orbit("orbit.zarr")  # doctest: +SKIP
    """
    return _loaded(checked_path(_WHERE, path), discrete, last=False)


def load_last_block(path: Path, discrete: Discretization) -> Orbit:
    """Load the states in the last chunk of a store."""
    return _loaded(path, discrete, last=True)


def _loaded(root: Path, discrete: Discretization | None, *, last: bool) -> Orbit:
    stored = read_attributes(root)
    if "run" in stored and "outcome" not in stored:
        remedy = f"Go on with nonholo.resume('{root}') (nonholo resume); `nonholo info` says how far it came."
        raise error(_WHERE, "be a finished run", f"'{root}', which is not", remedy)
    try:
        shapes = json.loads(stored["arrays"])
        motion, outcome, every = restore_motion(stored, discrete), Outcome[stored["outcome"]], stored["save_every"]
    except (KeyError, json.JSONDecodeError) as failure:
        raise error(_WHERE, "hold complete attributes", f"'{root}' without {failure}", _AGAIN) from failure
    arrays = {name: _read(root, name, tuple(shape), last) for name, shape in shapes.items()}
    compact = {name: arrays.get(array) for name, array in stored_names(shapes).items()}
    branch = stored.get("branch", "principal")  # stores of before branch rules have none
    orbit = Orbit(motion, outcome=outcome, save_every=every, branch=branch, **compact)  # type: ignore[arg-type]
    if "events" not in stored:
        return orbit
    begin = _begin_of_last(stored, shapes["time"][0]) if last else 0
    return dataclasses.replace(orbit, events=_events(root, stored, orbit, begin))


def stored_names(arrays: Container[str]) -> dict[str, str]:
    """Return the names of the arrays of a store that hold the states of an orbit; older stores have them on top."""
    names = {name: name.removeprefix("canonical_") for name in STATES}
    return {name: CANONICAL + array if CANONICAL + array in arrays else array for name, array in names.items()}


def _events(root: Path, stored: dict[str, Any], orbit: Orbit, begin: int) -> EventLog:
    """Return the crossings of a stored run after the state of a step."""
    array = opened_array(root, EVENTS, None)
    names, counts = [event["name"] for event in json.loads(stored["events"])], json.loads(stored["crossings"])
    parts = [np.empty((0, array.shape[1]))]
    for chunk in range(array.cdata_shape[0]):
        parts.append(known(checked_block(root, EVENTS, array, (chunk, 0), with_nan=True), begin))
    log = log_of(np.concatenate(parts), tuple(names), orbit, stored.get("stopped_by"))
    found = [len(crossings) for crossings in log.found]
    if begin == 0 and found != counts:
        raise error(_WHERE, f"hold {counts} crossings in {EVENTS}", str(found), _AGAIN)
    return log


def _begin_of_last(stored: dict[str, Any], states: int) -> int:
    """Return the step at which the last block of states begins."""
    run = json.loads(stored["run"])
    return Plan(run["steps"], stored["save_every"], run["rows"]).begin((states - 1) // run["rows"])


def read_attributes(path: str | Path, expected: str = FORMAT, readable: tuple[int, ...] = READABLE) -> dict[str, Any]:
    """Return the attributes of a store, after checking that it is one of that format and that its schema is known."""
    where = _WHERE if expected == FORMAT else "load_sweep(store=...)"
    kind = f"be a store of {_KINDS[expected]}"
    if not Path(path).exists():
        raise FileNotFoundError(f"`{where}` must exist. Got '{path}'. Check the path; runs are kept under 'runs/'.")
    try:
        stored = dict(zarr.open_group(Path(path), mode="r", use_consolidated=False).attrs)
    except Exception as failure:
        remedy = f"Its metadata cannot be read: {failure}"
        raise error(where, kind, f"'{path}'", remedy) from failure
    if stored.get("format") != expected:
        made = _KINDS.get(str(stored.get("format")))
        got = f"'{path}', " + (f"a store of {made}" if made else "made by another program")
        raise error(where, kind, got, "Pass a store of nonholo that is one.")
    if stored.get("schema") not in readable:
        remedy = (
            f"This version reads schemas up to {readable[-1]}: upgrade nonholo ({stored.get('versions')} wrote it)."
        )
        raise error(where, f"have a schema of {readable}", f"schema {stored.get('schema')}", remedy)
    check_metadata(where, str(path), stored, OrbitMetadata if expected == FORMAT else SweepMetadata)
    return stored


def format_of(path: str | Path) -> str | None:
    """Return the format that a store says it has; None if it says nothing that can be read."""
    try:
        return json.loads((Path(path) / "zarr.json").read_text())["attributes"]["format"]
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _read(root: Path, name: str, shape: tuple[int, ...], last: bool) -> Float[np.ndarray, "..."]:
    array = opened_array(root, name, shape)
    ends = tuple(count - 1 for count in array.cdata_shape)
    indices = (ends,) if last and min(ends, default=0) >= 0 else np.ndindex(array.cdata_shape)
    blocks = [checked_block(root, name, array, index) for index in indices]
    return np.concatenate(blocks) if blocks else np.empty(shape)


def opened_array(root: Path, name: str, shape: tuple[int, ...] | None) -> zarr.Array:
    """Open an array of a store, of a known shape unless the run is not finished."""
    try:
        array = zarr.open_array(root / name, mode="r")
    except Exception as failure:
        raise error(_WHERE, f"hold the array {name}", f"{type(failure).__name__}: {failure}", _AGAIN) from failure
    if array.shape != (shape or array.shape) or array.dtype != np.float64:
        got = f"{array.dtype} of shape {array.shape}"
        raise error(_WHERE, f"hold the array {name} as float64 of shape {shape}", got, _AGAIN)
    check_chunk(_WHERE, name, array.chunks)
    return array


def checked_block(
    root: Path, name: str, array: zarr.Array, index: tuple[int, ...], *, with_nan: bool = False
) -> np.ndarray:
    """Return one chunk; refuse one that is missing or damaged, with its name."""
    found = read_chunk(root, name, array, index, with_nan=with_nan)
    if isinstance(found, str):
        requirement = f"hold {chunk_name(name, array, index)}" + (" free of NaN" if found == _NAN else "")
        raise error(_WHERE, requirement, found, _AGAIN)
    return found


def chunk_name(name: str, array: zarr.Array, index: tuple[int, ...]) -> str:
    """Return how messages call a chunk."""
    return f"chunk {array.metadata.encode_chunk_key(index)} of the array {name}"


def chunk_path(root: Path, name: str, array: zarr.Array, index: tuple[int, ...]) -> Path:
    """Return the file of a chunk."""
    return root / name / array.metadata.encode_chunk_key(index)


def read_chunk(
    root: Path, name: str, array: zarr.Array, index: tuple[int, ...], *, with_nan: bool = False
) -> np.ndarray | str:
    """Return one chunk, or what is wrong with it; NaN is wrong too, unless it may be a result.

    A missing one would be read as its fill value, NaN, so its file is looked for first.
    """
    if not chunk_path(root, name, array, index).is_file():
        return "no such chunk"
    try:
        block = np.asarray(array.blocks[index])
    except Exception as failure:
        return f"a corrupt one ({failure})"
    return _NAN if not with_nan and np.isnan(block).any() else block
