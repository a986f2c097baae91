"""Orbits as labelled data and as stores on disk: complete or absent, checked when read, with full provenance."""

from nonholo.io._attributes import attributes_of_text, other_versions, restore_motion
from nonholo.io._dataset import orbit_to_dataset
from nonholo.io._descriptions import fields_of
from nonholo.io._load import load_last_block, load_orbit, read_attributes
from nonholo.io._lock import locked, owner_of
from nonholo.io._save import check_target, save_orbit
from nonholo.io._stream import Checkpoint, Plan, Standing, Stream, create_stream, open_stream, standing

__all__ = [
    "Checkpoint",
    "Plan",
    "Standing",
    "Stream",
    "attributes_of_text",
    "check_target",
    "create_stream",
    "fields_of",
    "load_last_block",
    "load_orbit",
    "locked",
    "open_stream",
    "orbit_to_dataset",
    "other_versions",
    "owner_of",
    "read_attributes",
    "restore_motion",
    "save_orbit",
    "standing",
]
