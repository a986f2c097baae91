"""Modules of this room that are imported when they are needed."""

import importlib
from typing import Any


def room(name: str) -> Any:
    """Return a module that imports the caller's, or that loads slowly because of diffrax."""
    return importlib.import_module(f"nonholo.lagrange_dalembert.{name}")


def equations_of(system: Any) -> Any:
    """Return the module with the equations of a system; those of coordinates and of groups offer the same functions."""
    return room(system._equations)


def configurations(system: Any, places: Any) -> Any:
    """Return the configurations of places: those of driven systems have the time in a last column."""
    return places[:, :-1] if getattr(system, "is_driven", False) else places
