"""What an argument of a public call is: its kind, a value that works, and which other values are legal."""

import dataclasses
import decimal
import numbers
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np


@dataclasses.dataclass(frozen=True)
class Argument:
    """An argument of a call.

    Attributes:
        kind: "number", "positive", "count", "integer", "array", "path", "text", "flag", "function", "rule" (the name of
            a rule, or a function), "thing" (an object of the library, or one of a few names) or "anything".
        value: One that works.
        none: Whether None is legal.
        shape: For arrays, which shapes are legal: the "same", a "batch" before it, any number of "rows", or "any"; a
            "stack" is of any shape too. In a batch and a stack NaN marks what has no value.
        complex: Whether complex numbers are legal.
    """

    kind: str
    value: Any
    none: bool = False
    shape: str = "same"
    complex: bool = False


number, positive, integer, count = (partial(Argument, kind) for kind in ("number", "positive", "integer", "count"))
path, text, flag, function = (partial(Argument, kind) for kind in ("path", "text", "flag", "function"))
rule, thing = (partial(Argument, kind) for kind in ("rule", "thing"))
anything = partial(Argument, "anything", none=True)
"""These make arguments of the kinds above from values that work; trials have a folder of their own for paths."""


def array(value: Any, shape: str = "same", none: bool = False, complex: bool = False) -> Argument:  # noqa: A002
    """Return an array of finite numbers."""
    return Argument("array", np.asarray(value, dtype=np.float64), none, shape, complex)


def legal(argument: Argument, value: Any) -> bool:
    """Tell whether a value may be accepted; whatever may not, has to be refused."""
    if value is None or value is argument.value:
        return argument.none or value is argument.value
    return _LEGAL[argument.kind](argument, value)


def real_array(value: Any, nan: bool = False) -> np.ndarray | None:
    """Return finite real numbers as float64, None for what is something else, masks and truth values included."""
    try:
        raw = np.asarray(value)
        if raw.dtype.kind == "O":
            allowed = (
                isinstance(x, numbers.Real | decimal.Decimal) and not isinstance(x, bool | np.generic) for x in raw.flat
            )
            if not all(allowed):
                return None
            raw = np.array([float(x) for x in raw.flat]).reshape(raw.shape)
    except (TypeError, ValueError, OverflowError, RecursionError, MemoryError):
        return None
    if raw.dtype.kind not in "iuf" or raw.size > 10**7 or np.ma.is_masked(value):
        return None
    with np.errstate(over="ignore"):
        result = raw.astype(np.float64)
    return result if np.isfinite(result[~np.isnan(result)] if nan else result).all() else None


def _is_number(argument: Argument, value: Any) -> bool:
    result = real_array(value)
    return result is not None and result.shape == () and (argument.kind == "number" or bool(result > 0))


def _is_integer(argument: Argument, value: Any) -> bool:
    integral = isinstance(value, numbers.Integral) and not isinstance(value, bool | np.timedelta64)
    return integral and (argument.kind == "integer" or bool(value > 0))


def _is_array(argument: Argument, value: Any) -> bool:
    wanted = argument.value.shape
    if argument.complex and isinstance(value, np.ndarray) and value.dtype.kind == "c":
        value = value.view(type=np.ndarray).real + value.imag
    result = real_array(value, nan=argument.shape in ("batch", "stack"))
    if result is None or (result.ndim == len(wanted) and np.isnan(result).any()):
        return False
    if argument.shape == "batch":
        return result.shape[max(0, result.ndim - len(wanted)) :] == wanted
    if argument.shape == "rows":
        return result.shape == (0,) or (result.ndim == len(wanted) and result.shape[1:] == wanted[1:])
    return argument.shape in ("any", "stack") or result.shape == wanted


_LEGAL: dict[str, Callable[[Argument, Any], bool]] = {
    "number": _is_number,
    "positive": _is_number,
    "count": _is_integer,
    "integer": _is_integer,
    "array": _is_array,
    "path": lambda _, value: isinstance(value, str | Path),
    "text": lambda _, value: isinstance(value, str),
    "flag": lambda _, value: isinstance(value, bool | np.bool_),
    "function": lambda _, value: callable(value),
    "rule": lambda argument, value: callable(value) or (isinstance(value, str) and value == argument.value),
    "thing": lambda _argument, _value: False,
    "anything": lambda _argument, _value: True,
}
