"""Numbers of the forces on a system, by names such as `gravity_force` and `friction`; the same forces with others."""

import dataclasses
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from nonholo.ensembles._names import component_of, with_components
from nonholo.systems import Forced, force_of


def force_numbers(system: Any) -> dict[str, Any]:
    """Return the numbers of the forces of the library that act on a system: none of two of one class.

    Example:
        >>> sleigh, heavy = nh.ChaplyginSleigh(1.0, 1.0, 0.5), nh.Gravity([0.0, -2.0], [0.5, 0.0])
        >>> forced = nh.Forced(sleigh, heavy, nh.Friction([1, 2, 3]))
        >>> list(force_numbers(forced))
        ['gravity_force', 'gravity_point', 'friction']
    """
    if not system.is_forced:
        return {}
    parts = [part for part in (*system.terms, *system.parts.values()) if dataclasses.is_dataclass(part)]
    kinds = [type(part) for part in parts]
    single = [part for part in parts if kinds.count(type(part)) == 1]
    return {name: getattr(part, field) for part in single for name, field in _names(part)}


def _names(part: Any) -> Iterator[tuple[str, str]]:
    word, fields = type(part).__name__.lower(), [field.name for field in dataclasses.fields(part) if field.init]
    for field in fields:
        yield word if len(fields) == 1 else f"{word}_{field}", field


def is_force_number(system: Any, name: str) -> bool:
    """Return whether a name is a number of a force, or a component of one that is a vector."""
    numbers, part = force_numbers(system), component_of(name)
    return name in numbers or (part is not None and np.ndim(numbers.get(part[0], 0.0)) == 1)


def with_force_numbers(system: Any, values: Mapping[str, Any]) -> Any:
    """Return a system under the same forces with other numbers."""
    numbers = force_numbers(system)
    own = {name: with_components(name, value, values) for name, value in numbers.items()}

    def change(part: Any) -> Any:
        fields = {field: own[name] for name, field in _names(part) if name in own}
        return dataclasses.replace(part, **fields)

    parts = {name: change(part) if dataclasses.is_dataclass(part) else part for name, part in system.parts.items()}
    terms = tuple(change(term) if dataclasses.is_dataclass(term) else term for term in system.terms)
    return Forced(system.system, terms or None, force_of(parts), system.scheme)
