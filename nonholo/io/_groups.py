"""Groups, arrays and attributes of a store, and small files in it, all written at once."""

import contextlib
import json
import os
import threading
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import zarr
from pydantic import BaseModel
from zarr.codecs import BloscCodec, Crc32cCodec

from nonholo.io._metadata import check_metadata, checksum
from nonholo.io._places import sibling
from nonholo.io.datasets import CANONICAL, Variable

_FILTERS = threading.Lock()  # warning filters belong to the whole process


def new_group(path: Path, metadata: dict[str, Any], kind: type[BaseModel]) -> zarr.Group:
    """Make a store with attributes, refused if they could not be read again, and their checksum."""
    metadata |= {"checksum": checksum(metadata)}
    check_metadata("store=...", str(path), json.loads(json.dumps(metadata)), kind)
    return zarr.create_group(path, zarr_format=3, attributes=metadata)


def create_groups(group: zarr.Group, names: Iterable[str]) -> None:
    """Make the group of compact states, where arrays lie in it."""
    if any(name.startswith(CANONICAL) for name in names):
        group.create_group(CANONICAL.rstrip("/"))


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


def remove_partials(store: Path) -> None:
    """Remove what killed writers left in a store."""
    for folder, _, files in os.walk(store):
        for file in files:
            if file.endswith(".partial"):
                Path(folder, file).unlink(missing_ok=True)


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
    together = document["attributes"] | changes
    attributes = {name: value for name, value in together.items() if value is not None}
    document["attributes"] = attributes | {"checksum": checksum(attributes)}
    document.pop("consolidated_metadata", None)
    write_whole(path / "zarr.json", json.dumps(document), is_settled=True)
    settle(path)
