"""Orbits as labelled data and as stores on disk: complete or absent, checked when read, with full provenance."""

from nonholo.io._attributes import (
    SWEEP_FORMAT,
    attributes,
    attributes_of_text,
    identity_of,
    motion_text,
    on_route_of,
    other_versions,
    restore_motion,
    versions_text,
)
from nonholo.io._chunks import chunk_name, chunk_path, read_chunk
from nonholo.io._csv import check_file, new_file, orbit_to_csv, store_to_csv, table_lines
from nonholo.io._dataset import is_known, labels_of, orbit_to_dataset
from nonholo.io._descriptions import fields_of
from nonholo.io._load import format_of, load_last_block, load_orbit, read_attributes
from nonholo.io._lock import locked, owner_of
from nonholo.io._metadata import TAKEN, SweepMetadata, checksum, is_array_name, require_identity
from nonholo.io._pandas import orbit_to_pandas
from nonholo.io._plan import Checkpoint, Plan
from nonholo.io._pose_columns import column_names, separate_rows
from nonholo.io._pose_variables import separate_variables
from nonholo.io._save import (
    check_suffix,
    check_target,
    consolidate,
    create_array,
    edit_attributes,
    new_beside,
    new_group,
    put_in_place,
    remove_partials,
    save_orbit,
    telling_how_to_go_on,
    write_whole,
)
from nonholo.io._seals import seal_of
from nonholo.io._stored_events import Seen, described
from nonholo.io._stream import Standing, Stream, create_stream, open_stream, standing, writable_array

__all__ = [
    "SWEEP_FORMAT",
    "TAKEN",
    "Checkpoint",
    "Plan",
    "Seen",
    "Standing",
    "Stream",
    "SweepMetadata",
    "attributes",
    "attributes_of_text",
    "check_file",
    "check_suffix",
    "check_target",
    "checksum",
    "chunk_name",
    "chunk_path",
    "column_names",
    "consolidate",
    "create_array",
    "create_stream",
    "described",
    "edit_attributes",
    "fields_of",
    "format_of",
    "identity_of",
    "is_array_name",
    "is_known",
    "labels_of",
    "load_last_block",
    "load_orbit",
    "locked",
    "motion_text",
    "new_beside",
    "new_file",
    "new_group",
    "on_route_of",
    "open_stream",
    "orbit_to_csv",
    "orbit_to_dataset",
    "orbit_to_pandas",
    "other_versions",
    "owner_of",
    "put_in_place",
    "read_attributes",
    "read_chunk",
    "remove_partials",
    "require_identity",
    "restore_motion",
    "save_orbit",
    "seal_of",
    "separate_rows",
    "separate_variables",
    "standing",
    "store_to_csv",
    "table_lines",
    "telling_how_to_go_on",
    "versions_text",
    "writable_array",
    "write_whole",
]
