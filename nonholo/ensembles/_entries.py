"""Results of tasks and reductions by name: what may be among them, and those of parts of a block in one."""

import json
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np

from nonholo.base.calls import call
from nonholo.base.checks import error, shown
from nonholo.ensembles._names import OUTCOME, array_name
from nonholo.io.datasets import Variable

ABSENT = -128
"""The outcome of a member that is not computed yet."""

Entries: TypeAlias = dict[str, Variable]
"""Arrays by name, whose first axis, that of the members, is not among their dimensions."""


def entries_of(result: Any, count: int) -> Entries:
    """Return what a task or a reduction returned by name, refused without one row for each of this many members."""
    several = _by_name(result).items()
    return {array_name("task(...)", name): _entry(name, value, count) for name, value in several}


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
