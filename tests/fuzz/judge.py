"""Classes of what comes of a trial: what may be, and what may not."""

import dataclasses
import traceback
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

GOOD = ("refused", "accepted", "warned")
BROKEN = ("raw", "silent", "memory", "hang", "abort")
_OWN_FILES = "/nonholo/"
_DEPTH = 4


@dataclasses.dataclass(frozen=True)
class Verdict:
    """The class of a trial, and what was said."""

    kind: str
    message: str = ""
    named: bool = False


def of_exception(failure: BaseException, names: list[str]) -> Verdict:
    """Tell an error that our checks raise from what slipped through them; `named`: it names a changed argument."""
    message = f"{type(failure).__name__}: {failure}"[:300]
    if isinstance(failure, MemoryError):
        return Verdict("memory", message)
    frames = traceback.extract_tb(failure.__traceback__)
    ours = [frame for frame in frames if _OWN_FILES in frame.filename]
    raised_by_us = bool(ours) and ours[-1] is frames[-1] and (frames[-1].line or "").startswith("raise")
    # our errors name their owner between backticks; those of files and of outcomes are raised by name in our files
    is_named = isinstance(failure, ValueError | TypeError) and str(failure).startswith("`")
    if is_named or (raised_by_us and isinstance(failure, OSError | RuntimeError | ImportError)):
        return Verdict("refused", message, any(f"{name}=" in str(failure) for name in names))
    place = f"{ours[-1].filename.rpartition(_OWN_FILES)[2]}:{ours[-1].lineno}" if ours else ""
    return Verdict("raw", f"{message} [{place}]")


def nonfinite(result: Any, *, infinite: bool = False) -> set[str]:
    """Return the names of numbers of a result that are not finite, or are NaN if `infinite` ones are answers.

    Of nothing if it says itself that it failed.
    """
    outcome = getattr(result, "outcome", 0)
    if np.any(np.asarray(outcome) != 0):
        return set()
    return set(_strange("", result, 0, np.isinf if infinite else np.zeros_like))


def _strange(name: str, value: Any, depth: int, answer: Callable[[np.ndarray], np.ndarray]) -> Iterator[str]:
    if isinstance(value, float | complex | np.ndarray | np.inexact):
        array = np.asarray(value)
        if array.dtype.kind in "fc" and not (np.isfinite(array) | answer(array).astype(bool)).all():
            yield name
    elif depth < _DEPTH:
        for key, part in _parts(value):
            yield from _strange(f"{name}.{key}", part, depth + 1, answer)


def _parts(value: Any) -> Iterator[tuple[str, Any]]:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        yield from ((field.name, getattr(value, field.name)) for field in dataclasses.fields(value))
    elif isinstance(value, dict):
        yield from ((str(key), part) for key, part in value.items())
    elif isinstance(value, list | tuple):
        yield from (("*", part) for part in value)
    elif hasattr(value, "data_vars"):
        yield from ((str(key), part.values) for key, part in value.data_vars.items())
