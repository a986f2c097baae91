"""Names of arrays, dimensions, components and functions in the store of a sweep; numbers of forces by their names.

Results of tasks and reductions by name: what may be among them, and those of parts of a block in one.
"""

import contextlib
import dataclasses
import importlib
import json
import operator
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np

from nonholo.base.calls import call
from nonholo.base.checks import checked_name, error, shown
from nonholo.io.datasets import Variable
from nonholo.io.metadata import TAKEN
from nonholo.systems import Forced, force_of

NO_NAME = "a function without an importable name"
"""The mark in a description for a function that no other process can import."""
OUTCOME = "outcome"
STARTS = ("body_velocity", "restricted_velocity", "momentum")
_BRACKETS = re.compile(r"\[(\d+)\]")
_LAST = re.compile(r"(\w+)_(\d+)")
_MEMBER = re.compile(r"This is member (\d+)\.")


Axes: TypeAlias = tuple[tuple[str, ...], tuple[int, ...]]
"""The dimensions of an array and their lengths."""


def component_name(name: str) -> str:
    """Return the name of a component as Python and xarray take names.

    Example:
        >>> component_name("restricted_velocity[0]"), component_name("mass_tensor[0][1]"), component_name("a")
        ('restricted_velocity_0', 'mass_tensor_0_1', 'a')
    """
    return _BRACKETS.sub(r"_\1", name)


def component_of(name: str) -> tuple[str, int] | None:
    """Return what a name is a component of, and which one; None if it looks like none.

    Example:
        >>> component_of("momentum_12"), component_of("momentum[2]"), component_of("momentum")
        (('momentum', 12), ('momentum', 2), None)
    """
    part = _LAST.fullmatch(component_name(name))
    return (part[1], int(part[2])) if part else None


def start_component(name: str) -> tuple[str, int] | None:
    """Return which component of which start a name means; None if it means something else."""
    part = component_of(name)
    return part if part and part[0] in STARTS else None


def with_components(name: str, value: Any, own: Mapping[str, Any]) -> Any:
    """Return the value of a member: its own, or the common one with its own components.

    Example:
        >>> with_components("a", [1.0, 2.0], {"a_1": 5.0, "b": 3.0})
        array([1., 5.])
    """
    value = own.get(name, value)
    parts = [(key, part[1]) for key in own if (part := component_of(key)) and part[0] == name]
    if not parts:
        return value
    value = np.array(value, dtype=np.float64)
    for key, component in parts:
        if value.ndim != 1 or component >= len(value):
            raise no_component(f"{key} of {len(value) if value.ndim == 1 else f'shape {value.shape}'}")
        value[component] = own[key]
    return value


def no_component(got: str) -> ValueError:
    """Return the refusal of a component that a value does not have."""
    return error("sweep(design=...)", "vary existing components", got, "They are counted from 0.")


def check_dimensions(arrays: Mapping[str, Axes], coordinates: Mapping[str, Axes]) -> None:
    """Refuse a name that would mean two things, as xarray does when it opens the result."""
    lengths: dict[str, int] = {}
    for name, (dimensions, shape) in [*coordinates.items(), *arrays.items()]:
        where = f"task(...)[{name!r}]"
        for dimension in dimensions:
            checked_name(where, dimension, TAKEN)
        if len(set(dimensions)) < len(dimensions):
            raise error(where, "have a different name for each axis", shown(dimensions), "Rename one.")
        for dimension, length in zip(dimensions, shape, strict=True):
            if lengths.setdefault(dimension, length) != length:
                got = f"{length} where it was {lengths[dimension]}"
                raise error(where, f"have one length along {dimension!r}", got, "Name the two axes apart.")
    for name in arrays:
        if name in lengths or name in coordinates:
            where = f"task(...)[{name!r}]"
            raise error(where, "have a name that the design and dimensions do not have", shown(name), "Rename it.")


@contextlib.contextmanager
def numbering(number: Callable[[int], int]) -> Iterator[None]:
    """Let refusals call the members of a block by their numbers in the sweep."""
    try:
        yield
    except ValueError as failure:
        message = _MEMBER.sub(lambda member: f"This is member {number(int(member[1]))}.", str(failure))
        raise ValueError(message) from failure


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
    own = {name: with_components(name, value, values) for name, value in force_numbers(system).items()}

    def change(part: Any) -> Any:
        return dataclasses.replace(part, **{field: own[name] for name, field in _names(part) if name in own})

    parts = {name: change(part) if dataclasses.is_dataclass(part) else part for name, part in system.parts.items()}
    terms = tuple(change(term) if dataclasses.is_dataclass(term) else term for term in system.terms)
    return Forced(system.system, terms or None, force_of(parts), system.scheme)


def function_name(function: Callable[..., Any]) -> str:
    """Return the name under which any process can import a function, or that there is none."""
    module, name = getattr(function, "__module__", None), getattr(function, "__qualname__", None)
    return NO_NAME if module in (None, "__main__") or name is None or "<" in name else f"{module}:{name}"


def is_own(name: str) -> bool:
    """Return whether a name is that of a function of a user; no other name is imported."""
    return ":" in name or name == NO_NAME


def function_from(name: str) -> Callable[..., Any]:
    """Import a function, which runs its module: only for who trusts the origin of the name."""
    module, colon, path = name.partition(":")
    if not colon:
        raise ImportError(name)
    own = importlib.import_module(module)
    try:
        return operator.attrgetter(path)(own)
    except AttributeError as failure:
        raise ImportError(str(failure)) from failure


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


ABSENT = -128
"""The outcome of a member that is not computed yet."""

Entries: TypeAlias = dict[str, Variable]
"""Arrays by name, whose first axis, that of the members, is not among their dimensions."""


def entries_of(result: Any, count: int) -> Entries:
    """Return what a task or a reduction returned by name, refused without one row for each of this many members."""
    several = _by_name(result).items()
    return {checked_name("task(...)", name, TAKEN): _entry(name, value, count) for name, value in several}


def _by_name(result: Any) -> Mapping[Any, Any]:
    return result if isinstance(result, Mapping) else {"result": result}


def _entry(name: str, value: Any, count: int) -> Variable:
    where = f"task(...)[{name!r}]"
    if isinstance(value, tuple) and len(value) not in (2, 3):
        remedy = "Return an array, (dimensions, array) or (dimensions, array, attributes)."
        raise error(where, "be an array, or one with the names of its axes", f"a tuple of {len(value)}", remedy)
    dimensions, own, *rest = value if isinstance(value, tuple) else (None, value)
    rows = _rows(where, own, count)
    rows = _codes(where, rows) if name == OUTCOME else rows
    if dimensions is None:
        dimensions = [f"{name}_{axis}" for axis in range(1, rows.ndim)]
    if len(dimensions) != rows.ndim - 1:
        got = f"{len(dimensions)} dimensions for shape {rows.shape}"
        raise error(where, "name each axis but the first", got, "Name them.")
    return Variable(tuple(dimensions), rows, _attributes(where, *rest))


def _rows(where: str, values: Any, count: int) -> np.ndarray:
    """Return one row for each member."""
    try:
        rows = np.asarray(values)
    except ValueError as failure:
        raise error(where, "be an array of numbers", str(failure).rstrip("."), "Pad it with NaN.") from failure
    if rows.dtype.kind not in "biufc":
        raise error(where, "be an array of numbers", f"dtype {rows.dtype}", "Return numbers.")
    if rows.ndim == 0 or len(rows) != count:
        raise error(where, "have a leading member axis", f"shape {rows.shape} for {count} members", "Keep that axis.")
    if 0 in rows.shape[1:]:
        raise error(where, "hold numbers", f"shape {rows.shape}", "Leave it out.")
    return rows


def _codes(where: str, rows: np.ndarray) -> np.ndarray:
    """Return the outcomes that a task gives its members."""
    if rows.ndim != 1 or rows.dtype.kind not in "biu" or not ((rows > ABSENT) & (rows < -ABSENT)).all():
        got = f"{rows.dtype} of shape {rows.shape}, such as {rows.flat[0]}"
        raise error(where, "be a number from -127 to 127 of each member", got, "Number them so.")
    return rows.astype(np.int8)


def _attributes(where: str, pairs: Any = None) -> dict[str, Any]:
    """Return the attributes of an array, which a store has as JSON."""
    try:
        attributes = dict(pairs or {})
        json.dumps(attributes)
    except (TypeError, ValueError):
        remedy = "Return a dictionary of texts, numbers and lists."
        raise error(where, "have attributes that JSON has", shown(pairs), remedy) from None
    return attributes


def checked_reductions(where: str, reductions: Any, names: Collection[str], remedy: str) -> tuple[Any, ...]:
    """Return reductions as a tuple; refuse what is neither a function nor one of the known names."""
    several = tuple(reductions) if isinstance(reductions, list | tuple) else (reductions,)
    for reduction in several:
        if not (callable(reduction) or (isinstance(reduction, str) and reduction in names)):
            raise error(where, "be names or functions", shown(reduction), remedy)
    return several


def reduced(
    where: str, batch: Any, reductions: Sequence[Any], ours: Mapping[str, Callable[[Any], Any]]
) -> dict[str, Any]:
    """Return the outcomes of an ensemble and what reductions make of it; refuse a name that two of them return."""
    results: dict[str, Any] = {OUTCOME: batch.outcome}
    for reduction in reductions:
        more = _by_name(call(where, reduction, batch) if callable(reduction) else ours[reduction](batch))
        for name in filter(results.__contains__, more):
            raise error(where, "return each name once", shown(name), "Rename one.")
        results |= more
    return results


def join_results(parts: Sequence[tuple[Sequence[int], dict[str, Any]]]) -> dict[str, Any]:
    """Return the results of parts of a block, which come with the places of their members, in the order of these."""
    if len(parts) == 1:
        return parts[0][1]
    order = np.argsort(np.concatenate([members for members, _ in parts]))
    entries = [entries_of(results, len(members)) for members, results in parts]
    whole: Entries = {}
    for name, first in entries[0].items():
        whole[name] = first._replace(values=np.concatenate([each[name].values for each in entries])[order])
    return whole
