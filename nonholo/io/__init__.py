"""Orbits as labelled data and as stores on disk: complete or absent, checked when read, with full provenance."""

from nonholo.io._attributes import attributes_of_text
from nonholo.io._dataset import orbit_to_dataset
from nonholo.io._descriptions import fields_of
from nonholo.io._load import load_orbit, read_attributes
from nonholo.io._save import check_target, save_orbit

__all__ = [
    "attributes_of_text",
    "check_target",
    "fields_of",
    "load_orbit",
    "orbit_to_dataset",
    "read_attributes",
    "save_orbit",
]
