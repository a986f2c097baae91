"""Reading a store: every chunk must be there and intact; nothing missing is ever read as data."""

import dataclasses
import json
from collections.abc import Container, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import zarr

from nonholo.base.checks import error
from nonholo.base.checks import path as checked_path
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.io import _block_store as blocks
from nonholo.io._attributes import FORMAT, SCHEMA, SWEEP_FORMAT, restore_motion
from nonholo.io._metadata import OrbitMetadata, SweepMetadata, check_assertions, check_metadata
from nonholo.io._stored_events import EVENTS, log_of, without_padding
from nonholo.io.datasets import CANONICAL, STEP
from nonholo.orbit import STATES, EventLog, Orbit, Plan

_KINDS = {FORMAT: "an orbit", SWEEP_FORMAT: "a sweep", "nonholo.ensemble": "an ensemble"}


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
    return _load(checked_path(blocks.WHERE, path), discrete, last=False)


def load_last_block(path: Path, discrete: Any) -> Any:
    """Load the states in the last chunk of a store."""
    return _load(path, discrete, last=True)


def _load(root: Path, discrete: Any, *, last: bool) -> Any:
    attributes = read_attributes(root)
    if "run" in attributes and "outcome" not in attributes:
        remedy = f"Resume with nonholo.resume('{root}') (nonholo resume); `nonholo info` shows its progress."
        raise error(blocks.WHERE, "be a finished run", f"'{root}', which is not", remedy)
    try:
        shapes = json.loads(attributes["arrays"])
        motion, every = restore_motion(attributes, discrete), attributes["save_every"]
        outcome = Outcome[attributes["outcome"]]
    except (KeyError, json.JSONDecodeError) as failure:
        raise error(blocks.WHERE, "hold complete attributes", f"'{root}' without {failure}", blocks.AGAIN) from failure
    arrays = {name: _read(root, name, tuple(shape), last) for name, shape in shapes.items()}
    if not last:  # whoever asks for the last block has looked at the others
        check_seals(root, attributes)
    rows = {name: arrays.get(array) for name, array in stored_names(shapes, motion.columns).items()}
    total, rows_kept = shapes["time"][0], len(arrays["time"])
    step = arrays[STEP].astype(np.int64) if STEP in arrays else every * np.arange(total - rows_kept, total)
    orbit = motion.orbit(outcome=outcome, save_every=every, branch=attributes["branch"], step=step, **rows)
    if "events" not in attributes:
        return orbit
    plan = plan_of(attributes)
    begin = plan.begin((total - 1) // plan.rows) if last else 0
    return dataclasses.replace(orbit, events=_events(root, attributes, orbit, begin))


def check_seals(root: Path, attributes: dict[str, Any]) -> None:
    """Refuse the store of a finished run, or of an orbit saved whole, where a chunk lies at the path of another."""
    shapes = json.loads(attributes["arrays"]).items()
    arrays = {name: blocks.opened_array(root, name, tuple(shape)) for name, shape in shapes}
    events = [event["name"] for event in json.loads(attributes["events"])] if "events" in attributes else None
    log = None if events is None else blocks.opened_array(root, EVENTS, None)
    layout = blocks.Layout(arrays["time"].shape, arrays["time"].chunks)
    store = blocks.BlockStore(root, attributes["made"], layout, arrays, log)
    try:
        for block in range(plan_of(attributes).blocks if "run" in attributes else layout.blocks):
            about = store.checked_mark(block).about
            if "run" in attributes and blocks.checkpoint_of(about, events).is_last:
                break
    except blocks.DamagedError as flaw:
        raise error(blocks.WHERE, "hold each chunk in its place", f"{flaw}, in '{root}'", blocks.AGAIN) from None


def plan_of(attributes: dict[str, Any]) -> Plan:
    """Return the plan of a store with these attributes."""
    run = json.loads(attributes["run"])
    return Plan(run["steps"], attributes["save_every"], run["rows"], run["lead"])


def stored_names(arrays: Container[str], columns: Iterable[str] = STATES) -> dict[str, str]:
    """Return the names of the arrays of a store that hold the columns of an orbit: compact ones lie in a group."""
    names = {name: name.removeprefix("canonical_") for name in columns}
    return {name: CANONICAL + array if CANONICAL + array in arrays else array for name, array in names.items()}


def _events(root: Path, attributes: dict[str, Any], orbit: Orbit, begin: int) -> EventLog:
    """Return the crossings of a stored run after the state of a step."""
    array = blocks.opened_array(root, EVENTS, None)
    events, counts = json.loads(attributes["events"]), json.loads(attributes["crossings"])
    chunks = (blocks.checked_block(root, EVENTS, array, (k, 0), with_nan=True) for k in range(array.cdata_shape[0]))
    rows = np.concatenate([np.empty((0, array.shape[1])), *(without_padding(chunk, begin) for chunk in chunks)])
    log = log_of(rows, events, orbit, attributes.get("stopped_by"))
    lengths = [len(crossings) for crossings in log.found]
    if begin == 0 and lengths != counts:
        raise error(blocks.WHERE, f"hold {counts} crossings in {EVENTS}", str(lengths), blocks.AGAIN)
    return log


def read_attributes(path: str | Path, format_name: str = FORMAT, schema: int = SCHEMA) -> dict[str, Any]:
    """Return the attributes of a store, after checking that they are of that format and schema."""
    where = blocks.WHERE if format_name == FORMAT else "load_sweep(store=...)"
    check_assertions(where)
    kind = f"be a store of {_KINDS[format_name]}"
    if not Path(path).exists():
        raise FileNotFoundError(f"`{where}` must exist. Got '{path}'. Check the path; runs are kept under 'runs/'.")
    try:
        attributes = dict(zarr.open_group(Path(path), mode="r", use_consolidated=False).attrs)
    except Exception as failure:
        raise error(where, kind, f"'{path}'", f"Its metadata cannot be read: {failure}") from failure
    if attributes.get("format") != format_name:
        kind_of_store = _KINDS.get(str(attributes.get("format")))
        got = f"'{path}', " + (f"a store of {kind_of_store}" if kind_of_store else "made by another program")
        raise error(where, kind, got, "Pass a store of nonholo that is one.")
    if attributes.get("schema") != schema:
        number, versions = attributes.get("schema"), attributes.get("versions")
        got, remedy = f"schema {number}", f"Upgrade nonholo: {versions} wrote it."
        if isinstance(number, int) and number < schema:
            got += ", of before 0.3.0, from which on later versions read stores"
            remedy = f"Read it with the version that wrote it, {versions}, and save it as CSV, or repeat the run."
        raise error(where, f"have schema {schema}, the one that this version reads", got, remedy)
    check_metadata(where, str(path), attributes, OrbitMetadata if format_name == FORMAT else SweepMetadata)
    return attributes


def format_of(path: str | Path) -> str | None:
    """Return the format that a store claims to have; None if it has no readable one."""
    try:
        return json.loads((Path(path) / "zarr.json").read_text())["attributes"]["format"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def _read(root: Path, name: str, shape: tuple[int, ...], last: bool) -> Float[np.ndarray, "..."]:
    array = blocks.opened_array(root, name, shape)
    ends = tuple(count - 1 for count in array.cdata_shape)
    if last and min(ends) >= 0:
        return blocks.checked_block(root, name, array, ends)
    return blocks.checked_array(root, name, array)
