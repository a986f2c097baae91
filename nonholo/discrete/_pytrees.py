"""Systems, discretizations and routes as JAX pytrees: declared with their classes, registered when JAX is imported."""

import functools
from typing import Any, NamedTuple, TypeVar

import numpy as np

from nonholo.base.numerics import keep_programs
from nonholo.systems import SYSTEMS, Forced, Friction, Gravity, Linear, Slip, Spring, Widened

_Class = TypeVar("_Class", bound=type)
_TREES: list[Any] = [*SYSTEMS, Forced, Friction, Gravity, Linear, Slip, Spring, Widened]


class _FixedArray(NamedTuple):
    """An array that is compared and hashed by its entries."""

    entries: bytes
    shape: tuple[int, ...]


def pytree(kind: _Class) -> _Class:
    """Declare a class of this room, whose `leaves` are numbers and whose `structure` is static."""
    _TREES.append(kind)
    return kind


@functools.cache
def register() -> None:
    """Register all of them once; no check runs when a tree is rebuilt."""
    import jax

    keep_programs()
    for kind in _TREES:
        names = kind.leaves, kind.structure
        flatten, unflatten = functools.partial(_flatten, *names), functools.partial(_unflatten, kind, *names)
        jax.tree_util.register_pytree_node(kind, flatten, unflatten)


def _flatten(leaves: tuple[str, ...], static: tuple[str, ...], thing: Any) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    constants = (getattr(thing, name) for name in static)
    return tuple(getattr(thing, name) for name in leaves), tuple(_hashable(x) for x in constants)


def _hashable(value: Any) -> Any:
    return _FixedArray(value.tobytes(), value.shape) if isinstance(value, np.ndarray) else value


def _from_hashable(value: Any) -> Any:
    return np.frombuffer(value.entries).reshape(value.shape) if isinstance(value, _FixedArray) else value


def _unflatten(kind: type, leaves: tuple[str, ...], static: tuple[str, ...], constants: Any, children: Any) -> Any:
    thing = object.__new__(kind)
    for name, value in (*zip(leaves, children, strict=True), *zip(static, map(_from_hashable, constants), strict=True)):
        object.__setattr__(thing, name, value)
    return thing
