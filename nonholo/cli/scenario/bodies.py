"""What a scenario can let move: systems of the library, its ready examples, what a module of the user's own makes."""

import functools
import importlib.util
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nonholo
from nonholo.base.checks import needs
from nonholo.cli.scenario.makers import MadeTable, Maker, table_of

SHORT = {
    "suslov": "SuslovTop",
    "sleigh": "ChaplyginSleigh",
    "multidimensional_sleigh": "MultidimensionalSleigh",
    "rigid_body": "RigidBody",
    "veselova": "VeselovaTop",
    "left_invariant": "LLSystem",
    "right_invariant": "LRSystem",
}
"""Kinds that are called by another word than their class."""
_OWN: dict[str, Maker] = {}


def kinds() -> list[str]:
    """Return every kind of body that there is; those of the examples load JAX."""
    return [*_OWN, *SHORT, *_systems(), *examples()]


def own_kinds() -> list[str]:
    """Return the kinds of a module of the user's own, and those of systems: a class by one word."""
    return [*_OWN, *SHORT, *(name for name in _systems() if name not in SHORT.values())]


def body_table(kind: str) -> type[MadeTable]:
    """Return the table of a kind of body.

    Raises:
        KeyError: There is none of this name.
    """
    if kind in _OWN:
        return table_of(kind, _OWN[kind], kind=True, plain=False)
    return _library_table(kind)


@functools.cache
def _library_table(kind: str) -> type[MadeTable]:
    systems = _systems()
    name = SHORT.get(kind, kind)
    return table_of(kind, systems[name] if name in systems else examples()[kind], kind=True)


@functools.cache
def _systems() -> dict[str, Maker]:
    from nonholo.systems import SYSTEMS

    return {each.__name__: each for each in SYSTEMS}


@functools.cache
def examples() -> dict[str, Maker]:
    """Return the functions of the ready examples by name."""
    with needs("jax", "nonholo.examples"):
        ready = nonholo.examples
        return {name: getattr(ready, name) for name in ready.__all__ if name.islower()}


def is_example(name: str) -> bool:
    """Tell whether a kind starts by itself: an example, or what a user's own function makes."""
    return name in _OWN or name not in (*SHORT, *_systems())


def import_own(path: Path | None) -> None:
    """Run a module of the user's own, asked for by its path: each public function and class in it is a kind of body."""
    _OWN.clear()
    if path is None:
        return
    _OWN.update(_public(_module_at(path)))


def _module_at(path: Path) -> Any:
    name = path.stem
    if not (path.suffix == ".py" and name.isidentifier() and path.is_file()):
        raise ValueError(f"`--module` must be the path of a Python file. Got '{path}'. Pass one such as my_robot.py.")
    known = importlib.util.find_spec(name)
    if known is None:
        sys.path.insert(0, str(path.resolve().parent))  # where other processes find it too
    elif known.origin != str(path.resolve()):
        got = f"'{path}', but there is a module {name} at {known.origin}"
        raise ValueError(f"`--module` must have a name of its own. Got {got}. Rename it.")
    return importlib.import_module(name)


def _public(module: Any) -> Iterator[tuple[str, Maker]]:
    for name, value in vars(module).items():
        if callable(value) and not name.startswith("_") and value.__module__ == module.__name__:
            yield name, value
