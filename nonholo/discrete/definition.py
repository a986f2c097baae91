"""The door of other rooms to the definition route. Imported on first use, since JAX loads slowly."""

from nonholo.discrete._composition_definition import run_composed_by_definition
from nonholo.discrete._definition import (
    displaced,
    momentum_of,
    principal_displacement,
    restricted,
    run_by_definition,
)
from nonholo.discrete._precision import in_double

__all__ = [
    "displaced",
    "in_double",
    "momentum_of",
    "principal_displacement",
    "restricted",
    "run_by_definition",
    "run_composed_by_definition",
]
