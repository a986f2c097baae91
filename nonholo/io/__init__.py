"""Orbits as labelled data and as stores on disk: complete or absent, checked when read, with full provenance.

Names load on first use: what makes datasets and stores loads xarray and zarr, which a run without them does not need.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nonholo.io._attributes import SWEEP_FORMAT as SWEEP_FORMAT
    from nonholo.io._attributes import attributes as attributes
    from nonholo.io._attributes import attributes_of_text as attributes_of_text
    from nonholo.io._attributes import identity_of as identity_of
    from nonholo.io._attributes import other_versions as other_versions
    from nonholo.io._attributes import restore_motion as restore_motion
    from nonholo.io._attributes import versions_text as versions_text
    from nonholo.io._beside import new_beside as new_beside
    from nonholo.io._csv import check_file as check_file
    from nonholo.io._csv import new_file as new_file
    from nonholo.io._csv import orbit_to_csv as orbit_to_csv
    from nonholo.io._csv import store_to_csv as store_to_csv
    from nonholo.io._csv import table_lines as table_lines
    from nonholo.io._dataset import is_known as is_known
    from nonholo.io._dataset import labels_of as labels_of
    from nonholo.io._dataset import orbit_to_dataset as orbit_to_dataset
    from nonholo.io._descriptions import fields_of as fields_of
    from nonholo.io._load import chunk_name as chunk_name
    from nonholo.io._load import chunk_path as chunk_path
    from nonholo.io._load import format_of as format_of
    from nonholo.io._load import load_last_block as load_last_block
    from nonholo.io._load import load_orbit as load_orbit
    from nonholo.io._load import read_attributes as read_attributes
    from nonholo.io._load import read_chunk as read_chunk
    from nonholo.io._lock import locked as locked
    from nonholo.io._lock import owner_of as owner_of
    from nonholo.io._metadata import TAKEN as TAKEN
    from nonholo.io._metadata import checksum as checksum
    from nonholo.io._metadata import is_array_name as is_array_name
    from nonholo.io._metadata import require_identity as require_identity
    from nonholo.io._pandas import orbit_to_pandas as orbit_to_pandas
    from nonholo.io._plan import Checkpoint as Checkpoint
    from nonholo.io._plan import Plan as Plan
    from nonholo.io._pose_columns import column_names as column_names
    from nonholo.io._pose_columns import separate_rows as separate_rows
    from nonholo.io._pose_variables import separate_variables as separate_variables
    from nonholo.io._save import check_suffix as check_suffix
    from nonholo.io._save import check_target as check_target
    from nonholo.io._save import consolidate as consolidate
    from nonholo.io._save import create_array as create_array
    from nonholo.io._save import edit_attributes as edit_attributes
    from nonholo.io._save import put_in_place as put_in_place
    from nonholo.io._save import save_orbit as save_orbit
    from nonholo.io._save import telling_how_to_go_on as telling_how_to_go_on
    from nonholo.io._save import write_whole as write_whole
    from nonholo.io._stored_events import Seen as Seen
    from nonholo.io._stored_events import described as described
    from nonholo.io._stream import Standing as Standing
    from nonholo.io._stream import Stream as Stream
    from nonholo.io._stream import create_stream as create_stream
    from nonholo.io._stream import open_stream as open_stream
    from nonholo.io._stream import standing as standing
    from nonholo.io._stream import writable_array as writable_array

_HOMES = {
    "Checkpoint": "_plan",
    "Plan": "_plan",
    "SWEEP_FORMAT": "_attributes",
    "Seen": "_stored_events",
    "Standing": "_stream",
    "Stream": "_stream",
    "TAKEN": "_metadata",
    "attributes": "_attributes",
    "attributes_of_text": "_attributes",
    "check_file": "_csv",
    "check_suffix": "_save",
    "check_target": "_save",
    "checksum": "_metadata",
    "chunk_name": "_load",
    "chunk_path": "_load",
    "column_names": "_pose_columns",
    "consolidate": "_save",
    "create_array": "_save",
    "create_stream": "_stream",
    "described": "_stored_events",
    "edit_attributes": "_save",
    "fields_of": "_descriptions",
    "format_of": "_load",
    "identity_of": "_attributes",
    "is_array_name": "_metadata",
    "is_known": "_dataset",
    "labels_of": "_dataset",
    "load_last_block": "_load",
    "load_orbit": "_load",
    "locked": "_lock",
    "new_beside": "_beside",
    "new_file": "_csv",
    "open_stream": "_stream",
    "orbit_to_csv": "_csv",
    "orbit_to_dataset": "_dataset",
    "orbit_to_pandas": "_pandas",
    "other_versions": "_attributes",
    "owner_of": "_lock",
    "put_in_place": "_save",
    "read_attributes": "_load",
    "read_chunk": "_load",
    "require_identity": "_metadata",
    "restore_motion": "_attributes",
    "save_orbit": "_save",
    "separate_rows": "_pose_columns",
    "separate_variables": "_pose_variables",
    "standing": "_stream",
    "store_to_csv": "_csv",
    "table_lines": "_csv",
    "telling_how_to_go_on": "_save",
    "versions_text": "_attributes",
    "writable_array": "_stream",
    "write_whole": "_save",
}

__all__ = list(_HOMES)  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'nonholo.io' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"nonholo.io.{_HOMES[name]}"), name)
    globals()[name] = value
    return value
