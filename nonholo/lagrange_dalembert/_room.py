"""Parts that all files of this room share: modules imported when they are needed, places, and calls of JAX.

Every call of JAX is compiled, runs in a local 64-bit scope and gives NumPy arrays.
"""

import contextlib
import functools
import importlib
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any

import jax
import numpy as np

from nonholo.base.numerics import double_precision

_PATIENCE = 1.0  # seconds of silence
_calls: set[tuple[Any, Any]] = set()
_announcements: set[Any] = set()


@functools.cache
def _compile(function: Callable[..., Any]) -> Callable[..., Any]:
    def call(family: Any, numbers: tuple[Any, ...], *arguments: Any) -> Any:
        return function(family.bound(*numbers), *arguments)

    return jax.jit(call, static_argnums=0)


def room(name: str) -> Any:
    """Return a module that imports the caller's, or that loads slowly because of diffrax."""
    return importlib.import_module(f"nonholo.lagrange_dalembert.{name}")


def places_of(system: Any) -> Any:
    """Return where a system moves; one of a store, which has no functions, raises the error that says so."""
    return system.places


def configurations(system: Any, places: Any) -> Any:
    """Return the configurations of places: those of driven systems have the time in a last column."""
    return places[:, :-1] if system.is_driven else places


def places(system: Any, configurations: Any, time: Any) -> Any:
    """Return the places of configurations at these times."""
    return np.column_stack([configurations, time]) if system.is_driven else configurations


def place(system: Any, q: Any, time: Any) -> Any:
    """Return where a system is: its configuration, of a driven one with the time."""
    return np.append(q, time) if system.is_driven else q


def in_double(function: Callable[..., Any], system: Any, *arguments: Any) -> Any:
    """Call a JAX function of a system, compiled once for all of its numbers, in 64 bits; return NumPy arrays."""
    family, numbers = system.family, tuple(system.parameters.values())
    with double_precision(), contextlib.nullcontext() if (function, family) in _calls else compiling(family):
        result = jax.tree.map(np.asarray, _compile(function)(family, numbers, *arguments))
    _calls.add((function, family))
    return result


@contextlib.contextmanager
def compiling(system: Any) -> Iterator[None]:
    """Say on standard error what is waited for, once for a system: JAX compiles at the first call of each function."""

    def say() -> None:
        if system not in _announcements:
            _announcements.add(system)
            sys.stderr.write("compiling a system in coordinates, once ...\n")

    timer = threading.Timer(_PATIENCE, say)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
