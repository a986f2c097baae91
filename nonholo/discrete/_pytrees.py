"""Registration of systems and discretisations as JAX pytrees, when the JAX route is first imported."""

import functools
from typing import Any

import jax
import numpy as np

from nonholo.discrete._discretization import Discretization
from nonholo.systems import ChaplyginSleigh, SuslovTop

_LEAVES = {
    SuslovTop: (("mass_tensor",), ("axis",)),
    ChaplyginSleigh: (("mass", "inertia", "a", "b"), ()),
    Discretization: (("system", "time_step"), ("difference", "constraint", "order")),
}


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
    return tuple(value.tolist()) if isinstance(value, np.ndarray) else value


def _unflatten(kind: type, leaves: tuple[str, ...], static: tuple[str, ...], fixed: Any, children: Any) -> Any:
    thing = object.__new__(kind)
    for name, value in (*zip(leaves, children, strict=True), *zip(static, fixed, strict=True)):
        object.__setattr__(thing, name, np.array(value) if isinstance(value, tuple) else value)
    return thing
