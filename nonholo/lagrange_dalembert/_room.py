"""Modules of this room that are imported when they are needed."""

import importlib
from typing import Any


def room(name: str) -> Any:
    """Return a module that imports the caller's, or that loads slowly because of diffrax."""
    return importlib.import_module(f"nonholo.lagrange_dalembert.{name}")
