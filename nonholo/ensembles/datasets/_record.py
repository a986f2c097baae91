"""Files of a data set: tables, the record for programs, and the card for people."""

import hashlib
import json
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from nonholo import io
from nonholo.base.limits import within_disk
from nonholo.ensembles.datasets._definitions import DEFINITIONS, SPLITS, DatasetTask, system_of
from nonholo.ensembles.stores import Output, SweepStore, standing_of

_STARTS = (
    "First kinetic energies are uniform in the range of the definition. First momenta are p = s D u: u is uniform on "
    "the unit sphere, D is diagonal with the weights of the definition, s gives the energy; only their action along "
    "the constraint counts. First configurations are uniform in a box with the given center and half edges: "
    "coordinates, of a pose those of its logarithm; a body that moves alike from every pose starts at the identity."
)


def record_of(store: SweepStore, task: DatasetTask, file_format: str, license_name: str) -> dict[str, Any]:
    """Return the record of a data set whose store is finished."""
    definition = DEFINITIONS[task.dataset]
    kind, parameters = io.described_system(system_of(task.dataset))
    parts = zip(SPLITS, (0, *task.ends), task.ends, strict=False)
    return {
        "name": task.dataset,
        "title": definition.title,
        "definition": {name: value for name, value in definition._asdict().items() if name != "title"},
        "system": {"kind": kind, "parameters": parameters},
        "starts": _STARTS,
        "versions": json.loads(io.versions_text("scipy", "jax")),
        "command": _command(store, task, file_format, license_name),
        "rng": store.design.seed,
        "orbits": store.design.members,
        "steps": task.steps,
        "time_step": task.time_step,
        "noise": task.noise,
        "split": {part: [begin, end] for part, begin, end in parts},
        "outcomes": standing_of(store.path).outcomes,
        "license": license_name,
        "format": file_format,
        "fields": {name: _field(store, name) for name in sorted(store.outputs)},
    }


def _command(store: SweepStore, task: DatasetTask, file_format: str, license_name: str) -> str:
    """Return the command that writes it again."""
    ends, orbits = (0, *task.ends), store.design.members
    split = "/".join(repr((end - begin) / orbits) for begin, end in zip(ends, task.ends, strict=False))
    options = {
        "orbits": orbits,
        "steps": task.steps,
        "time-step": task.time_step,
        "rng": store.design.seed,
        "noise": task.noise,
        "split": split,
        "format": file_format,
        "license": license_name,
    }
    words = [str(word) for name, value in options.items() for word in (f"--{name}", value)]
    return shlex.join(["nonholo", "dataset", task.dataset, "-o", store.path.parent.name, *words])


def _field(store: SweepStore, name: str) -> dict[str, Any]:
    """Return what a field is, and the SHA-256 of its numbers: little-endian, orbit by orbit."""
    output, digest = store.outputs[name], hashlib.sha256()
    little = np.dtype(output.dtype).newbyteorder("<")
    for block in range(store.layout.blocks):
        digest.update(np.ascontiguousarray(store.rows(name, store.layout.piece(block)), little).tobytes())
    attributes = {key: value for key, value in output.attributes.items() if key != "coordinates"}
    shape = [store.design.members, *output.shape]
    dimensions = ["member", *output.dimensions]
    return {"dimensions": dimensions, "shape": shape, "dtype": output.dtype, **attributes, "sha256": digest.hexdigest()}


def card(record: dict[str, Any]) -> str:
    """Return the data card, in Markdown."""
    fields = "\n".join(f"| `{name}` | {_row(each)} |" for name, each in record["fields"].items())
    parts = ", ".join(f"{part} {begin} to {end - 1}" for part, (begin, end) in record["split"].items() if begin < end)
    last = record["split"]["train"][1]
    endings = ", ".join(f"{number} {outcome}" for outcome, number in record["outcomes"].items())
    definition = "\n".join(f"- {name}: {value}" for name, value in record["definition"].items() if value is not None)
    system = record["system"]
    parameters = "\n".join(f"- {name}: {value}" for name, value in system["parameters"].items())
    return f"""# {record["title"]}: {record["orbits"]} orbits of {record["steps"]} steps

Orbits of the data set `{record["name"]}`, version {record["definition"]["version"]}, computed by the discrete
map of nonholo {record["versions"]["nonholo"]} with time step {record["time_step"]:g}.
Row k of an orbit is a state, row k + 1 the next one. How they ended: {endings}; rows after an early end are NaN.

Parts (`split`): {parts}. Orbits are independent draws, so parts are.
Noise: {record["noise"]:g} (standard deviation of the fields `observed_...`; none if 0). License: {record["license"]}.

Written by

    {record["command"]}

{_LOADING[record["format"]].format(last)}

## System

`{system["kind"]}` with

{parameters}

## Starts

{record["starts"]}

{definition}

## Fields

| name | dimensions | shape | meaning | units |
|---|---|---|---|---|
{fields}

`metadata.json` has the SHA-256 of each field and the versions of what computed it; the same call with them gives the
same bits.
"""


def _row(field: dict[str, Any]) -> str:
    meaning = field.get("long_name", "") + "".join(
        f"; {word}" for word in [", ".join(field.get("components", []))] if word
    )
    return " | ".join(
        [", ".join(field["dimensions"]), "x".join(map(str, field["shape"])), meaning, field.get("units", "")]
    )


_LOADING = {
    "zarr": """Load it with

    import xarray
    orbits = xarray.open_zarr("orbits.zarr")
    train = orbits.isel(member=slice(0, {}))""",
    "csv": """Load it with

    import pandas
    train = pandas.read_csv("train.csv")  # a row for each state: orbit, time, fields""",
}


_BYTES = 24.0  # of a number as text


def write_tables(store: SweepStore, folder: Path, ends: tuple[int, ...]) -> None:
    """Write the orbits of a finished store, those of each part to a file: their number, the time, all that varies."""
    names = [name for name, each in store.outputs.items() if each.dimensions[:1] == ("step",)]
    names.sort(key=lambda name: name != "time")
    columns = ["orbit", *(column for name in names for column in _columns(name, store.outputs[name]))]
    states = store.outputs["time"].shape[0] * store.design.members
    within_disk("dataset(file_format='csv')", _BYTES * states * len(columns), folder, "Free space, then call it again.")
    for part, begin, end in zip(SPLITS, (0, *ends), ends, strict=False):
        if begin < end:
            with io.new_file(folder / f"{part}.csv", overwrite=True) as file:
                file.writelines(io.table_lines(columns, _rows(store, names, begin, end)))


def _columns(name: str, output: Output) -> Iterator[str]:
    """Give the names of the numbers of a field: those of coordinates alone, others with that of the field."""
    if len(output.shape) == 1:
        yield name
        return
    labels = output.attributes.get("components") or [str(i) for i in range(output.shape[1])]
    for place in np.ndindex(output.shape[1:]):
        own = [labels[place[0]], *map(str, place[1:])]
        yield "_".join(own if name == "configuration" else [name.replace("_configuration", ""), *own])


def _rows(store: SweepStore, names: list[str], begin: int, end: int) -> Iterator[np.ndarray]:
    """Give the states of some orbits, block by block; rows after the end of an orbit are left out."""
    for block in range(store.layout.blocks):
        piece = store.layout.piece(block)
        members = np.arange(piece.first, piece.first + piece.count)
        is_within = (members >= begin) & (members < end)
        if not is_within.any():
            continue
        fields = [store.rows(name, piece)[is_within] for name in names]
        states = np.concatenate([each.reshape(*each.shape[:2], -1) for each in fields], axis=2)
        rows = np.empty((*states.shape[:2], 1 + states.shape[2]), dtype=object)  # whole numbers are written as such
        rows[..., 0], rows[..., 1:] = members[is_within, None], states
        yield rows[np.isfinite(states[..., 0])]
