"""Modules of this room that are imported when they are needed."""

import importlib
from typing import Any

import numpy as np


def room(name: str) -> Any:
    """Return a module that imports the caller's, or that loads slowly because of diffrax."""
    return importlib.import_module(f"nonholo.lagrange_dalembert.{name}")


def equations_of(system: Any) -> Any:
    """Return the module with the equations of a system; those of coordinates and of groups offer the same functions."""
    return room(system._equations)


def configurations(system: Any, places: Any) -> Any:
    """Return the configurations of places: those of driven systems have the time in a last column."""
    return places[:, :-1] if system.is_driven else places


def places(system: Any, configurations: Any, time: Any) -> Any:
    """Return the places of configurations at these times."""
    return np.column_stack([configurations, time]) if system.is_driven else configurations
