"""The one door to functions of users: read-only copies go in, checked numbers come out, errors name the function.

A function that JAX traces cannot write to its arguments. A function that numba compiled gets copies, compared
afterwards.
"""

import contextlib
import copy
import dataclasses
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from nonholo.base.checks import error, real_or_complex, shown
from nonholo.base.types import Array, read_only

_FEW = 8  # numbers that are shown together


class FunctionError(ValueError):
    """A function of a user does what it must not."""


class UndefinedError(FunctionError):
    """It has returned a number that is not finite."""


class KindError(TypeError, FunctionError):
    """It has returned something else than real numbers."""


@contextlib.contextmanager
def note_fault(faults: dict[str, str], part: str) -> Iterator[None]:
    """Note what a part says whose numbers are not finite, where a run ends by itself then; forget it where they are."""
    faults.pop(part, None)
    try:
        yield
    except UndefinedError as failure:
        faults[part] = str(failure)


def name_of(function: Any) -> str:
    """Return how errors call a function."""
    return f"`{getattr(function, '__name__', None) or type(function).__name__}`"


def call(where: str, function: Callable[..., Any], *arguments: Any) -> Any:
    """Return what a function of a user returns, of arguments that it may keep but not change.

    Example:
        >>> def half(v):
        ...     v *= 0.5
        ...     return v
        >>> call("Forced(force=...)", half, np.ones(3))
        Traceback (most recent call last):
        ...
        nonholo.base.calls.FunctionError: `Forced(force=...)` must not write to its arguments. Got `half`...
    """
    # numba would compile it once more for arrays that are read-only
    is_compiled = hasattr(function, "py_func")
    copies = [_protect(argument, is_compiled) for argument in arguments]
    try:
        result = function(*copies)
    except ValueError as failure:
        if "read-only" in str(failure):
            raise _writing_error(where, function) from failure
        raise
    if is_compiled and any(_bytes(new) != _bytes(old) for new, old in zip(copies, arguments, strict=True)):
        raise _writing_error(where, function)
    return result


def number_of(where: str, function: Callable[..., Any], remedy: str, *arguments: Any) -> np.float64:
    """Return the finite real number that a function of a user returns."""
    return np.float64(numbers_of(where, function, (), remedy, *arguments))


def numbers_of(where: str, function: Callable[..., Any], shape: tuple[int, ...], remedy: str, *arguments: Any) -> Array:
    """Return the finite real numbers that a function of a user returns, in float64.

    Raises:
        KindError: It returns values that are no real numbers.
        UndefinedError: A number is not finite.
        FunctionError: They have another shape, or it writes to its arguments.
    """
    result, what = call(where, function, *arguments), f"{shape[0]} real numbers" if shape else "one real number"
    return check_result(where, function, result, shape, (what, remedy), lambda _: _place(arguments[0]))


def _place(first: Any) -> str:
    return f"time {first:.17g}" if isinstance(first, float) else shown(np.asarray(first).tolist())


def check_result(
    where: str,
    function: Callable[..., Any],
    result: Any,
    shape: tuple[int, ...],
    words: tuple[str, str],
    place: Callable[[int], str],
) -> Array:
    """Return what a function has returned as finite numbers of a shape; words name the demand and a remedy.

    The first number that is not finite is read by its index.
    """
    (what, remedy), name = words, name_of(function)
    try:
        plain = type(result) is np.ndarray and result.dtype.char == "d"
        raw = result if plain else real_or_complex(where, result, remedy)
    except ValueError:
        raw = np.array(None)
    if raw.dtype.kind not in "iuf":
        is_array = isinstance(result, np.ndarray) and not np.ma.is_masked(result)
        got = f"{result.dtype} of shape {result.shape}" if is_array else shown(result)
        raise KindError(*error(where, f"return {what}", f"{got} from {name}", remedy).args)
    if raw.shape != shape:
        got = f"{raw.dtype} of shape {raw.shape} from {name}"
        raise FunctionError(*error(where, f"return {what}", got, remedy).args)
    values = raw.astype(np.float64)
    if not np.isfinite(values).all():
        at = int(np.argmin(np.isfinite(values)))
        got = f"{shown(values.tolist() if values.size <= _FEW else values[at].tolist())} from {name} at {place(at)}"
        raise UndefinedError(*error(where, "be finite", got, remedy).args)
    return values


def _protect(argument: Any, is_writeable: bool) -> Any:
    """Return a copy of an array, or what looks at the arrays of an object, such as an orbit, without changing them."""
    if isinstance(argument, np.ndarray):
        argument = argument.copy()
        argument.flags.writeable = is_writeable
        return argument
    if not dataclasses.is_dataclass(argument) or isinstance(argument, type):
        return argument
    argument = copy.copy(argument)
    for field in dataclasses.fields(argument):
        object.__setattr__(argument, field.name, read_only(getattr(argument, field.name)))
    return argument


def _bytes(argument: Any) -> Any:
    return argument.tobytes() if isinstance(argument, np.ndarray) else None


def _writing_error(where: str, function: Any) -> FunctionError:
    got = f"{name_of(function)}, which does"
    return FunctionError(*error(where, "not write to its arguments", got, "Let it work on copies.").args)
