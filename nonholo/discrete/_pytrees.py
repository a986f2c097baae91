"""Registration of systems and discretisations as JAX pytrees, when the JAX route is first imported."""

import functools
from typing import Any, NamedTuple

import jax
import numpy as np

from nonholo.discrete._discretization import Discretization
from nonholo.systems import SYSTEMS

_Names = tuple[str, ...]
_LEAVES: dict[type, tuple[_Names, _Names]] = {kind: (kind.leaves, kind.structure) for kind in SYSTEMS}
_LEAVES[Discretization] = (("system", "time_step"), ("difference", "constraint", "order"))


class _FixedArray(NamedTuple):
    """An array that is compared and hashed by its entries."""

    entries: bytes
    shape: tuple[int, ...]


@functools.cache
def register() -> None:
    """Register once: the numbers are leaves, the structure is static; no check runs when a tree is rebuilt."""
    for kind, (leaves, static) in _LEAVES.items():
        jax.tree_util.register_pytree_node(
            kind, functools.partial(_flatten, leaves, static), functools.partial(_unflatten, kind, leaves, static)
        )


def _flatten(leaves: tuple[str, ...], static: tuple[str, ...], thing: Any) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    fixed = (getattr(thing, name) for name in static)
    return tuple(getattr(thing, name) for name in leaves), tuple(_hashable(x) for x in fixed)


def _hashable(value: Any) -> Any:
    return _FixedArray(value.tobytes(), value.shape) if isinstance(value, np.ndarray) else value


def _restored(value: Any) -> Any:
    return np.frombuffer(value.entries).reshape(value.shape) if isinstance(value, _FixedArray) else value


def _unflatten(kind: type, leaves: tuple[str, ...], static: tuple[str, ...], fixed: Any, children: Any) -> Any:
    thing = object.__new__(kind)
    for name, value in (*zip(leaves, children, strict=True), *zip(static, map(_restored, fixed), strict=True)):
        object.__setattr__(thing, name, value)
    return thing
