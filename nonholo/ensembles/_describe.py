"""Designs and functions as plain data and back, and where two descriptions differ."""

import hashlib
import importlib
import json
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from nonholo.base.checks import error
from nonholo.ensembles.designs import Design, Grid, RandomDesign
from nonholo.ensembles.distributions import DISTRIBUTIONS
from nonholo.io import fields_of

NO_NAME = "a function without an importable name"
"""The mark in a description for a function that no other process can import."""


def design_text(design: Design) -> dict[str, Any]:
    """Return a design as plain data; values along axes are named by their hash and have their own arrays."""
    if isinstance(design, Grid):
        hashes = {name: _hash(values) for name, values in design.axes.items()}
        return {"kind": "Grid", "seed": design.seed, "axes": hashes}
    distributions = {name: {"kind": type(d).__name__, **fields_of(d)} for name, d in design.distributions.items()}
    return {"kind": "RandomDesign", "seed": design.seed, "members": design.members, "distributions": distributions}


def design_from(text: dict[str, Any], axis: Callable[[str], np.ndarray]) -> Design:
    """Return the design of a description."""
    if text["kind"] == "Grid":
        along = {name: axis(name) for name in text["axes"]}
        for name, digest in text["axes"].items():
            if _hash(along[name]) != digest:
                remedy = "The store is damaged: copy it again from its source, or run it again."
                raise error("load_sweep(store=...)", f"hold the axis {name} of its design", "another one", remedy)
        return Grid(along, rng=text["seed"])
    entries = {name: dict(entry) for name, entry in text["distributions"].items()}
    distributions = {name: DISTRIBUTIONS[entry.pop("kind")](**entry) for name, entry in entries.items()}
    return RandomDesign(text["members"], distributions, rng=text["seed"])


def function_name(function: Callable[..., Any]) -> str:
    """Return the name under which any process can import a function, or that there is none."""
    module, name = getattr(function, "__module__", None), getattr(function, "__qualname__", None)
    if module in (None, "__main__") or name is None or "<" in name:
        return NO_NAME
    return f"{module}:{name}"


def function_from(name: str) -> Callable[..., Any]:
    """Import a function, which runs its module: only for who trusts the origin of the name."""
    if name == NO_NAME:
        raise ImportError(name)
    module, _, path = name.partition(":")
    member: Any = importlib.import_module(module)
    try:
        for part in path.split("."):
            member = getattr(member, part)
    except AttributeError as failure:
        raise ImportError(str(failure)) from failure
    return member


def differences(ours: Any, theirs: Any, where: str = "") -> Iterator[str]:
    """Name, one after the other, the entries in which two descriptions differ.

    Example:
        >>> list(differences({"task": {"steps": 5}, "seed": 0}, {"task": {"steps": 6}, "seed": 0}))
        ['task.steps is 5 instead of 6']
    """
    if isinstance(ours, dict) and isinstance(theirs, dict):
        for name in dict.fromkeys([*ours, *theirs]):
            inner = f"{where}.{name}" if where else str(name)
            if name not in theirs:
                yield f"{inner} is not in the store"
            elif name not in ours:
                yield f"{inner} is only in the store"
            else:
                yield from differences(ours[name], theirs[name], inner)
    elif ours != theirs:
        yield f"{where} is {_short(ours)} instead of {_short(theirs)}"


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 200 else f"{text[:200]}..."


def _hash(values: np.ndarray) -> str:
    return hashlib.sha256(np.ascontiguousarray(values).tobytes() + repr(values.shape).encode()).hexdigest()
