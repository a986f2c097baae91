"""Values that no argument expects, or that are at the border of what it expects; each has a name."""

import datetime
import decimal
import fractions
import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np


class Unwilling:
    """Something that NumPy asks for an array and that gives none."""

    def __array__(self, *_: Any, **__: Any) -> np.ndarray:
        raise TypeError("no array")


def _in_itself() -> list[Any]:
    result: list[Any] = [1.0]
    result.append(result)
    return result


INTEGERS = ("10**400", "-10**400", "10**5000", "10**30", "2**63", "2**53", "10**12", "-1", "0")
EXPRESSIONS = (*INTEGERS, "-0.0", "0.5", "2.0", "1j", "None", "True", "False", "np.True_")
FLOATS = ("nan", "inf", "-inf", "1e308", "-1e308", "1e160", "1e-160", "5e-324")
CONSTANT: dict[str, Callable[[], Any]] = {
    **{text: functools.partial(eval, text) for text in EXPRESSIONS},
    **{text: functools.partial(float, text) for text in FLOATS},
    "text": lambda: "abc",
    "text of a number": lambda: "1.5",
    "empty text": lambda: "",
    "long text": lambda: "x" * 100_000,
    "text with NUL": lambda: "a\0b",
    "text out of the folder": lambda: "../../abc",
    "bytes": lambda: b"1.5",
    "bytearray": lambda: bytearray(8),
    "datetime64": lambda: np.datetime64("2020-01-01"),
    "timedelta64": lambda: np.timedelta64(3, "s"),
    "date": lambda: datetime.date(2020, 1, 1),
    "nan of 16 bits": lambda: np.float16("nan"),
    "complex without imaginary part": lambda: np.complex128(1.0),
    "np.int8": lambda: np.int8(3),
    "np.uint64": lambda: np.uint64(2**64 - 1),
    "longdouble": lambda: np.longdouble("1e4000"),
    "fraction": lambda: fractions.Fraction(1, 3),
    "decimal": lambda: decimal.Decimal("0.1"),
    "decimal nan": lambda: decimal.Decimal("nan"),
    "object": object,
    "class": lambda: int,
    "class of the library": lambda: Unwilling,
    "unwilling": Unwilling,
    "lambda": lambda: lambda *_, **__: None,
    "lambda of a number": lambda: lambda *_, **__: 0.5,
    "lambda of nothing": lambda: lambda: 0.5,
    "raising lambda": lambda: lambda *_: 1 / 0,
    "module": lambda: np,
    "exception": lambda: ValueError("x"),
    "path": lambda: Path("abc"),
    "path of a folder": lambda: Path(),
    "path of a file": lambda: "some.txt",
    "root": lambda: "/",
    "device": lambda: "/dev/null",
    "empty list": list,
    "empty array": lambda: np.array([]),
    "empty matrix": lambda: np.zeros((0, 0)),
    "list of text": lambda: ["a", "b"],
    "list of None": lambda: [None, None, None],
    "list of one": lambda: [0.3],
    "ragged": lambda: [[1.0, 2.0], [3.0]],
    "ragged arrays": lambda: [np.zeros(2), np.zeros(3)],
    **{f"nested {n}": lambda n=n: functools.reduce(lambda inner, _: [inner], range(n), [1.0]) for n in (50, 2000)},
    "in itself": _in_itself,
    "dict": lambda: {"a": 1.0},
    "empty dict": dict,
    "dict of arrays": lambda: {"mass": np.ones(3)},
    "set": lambda: {1.0, 2.0},
    "range": lambda: range(3),
    "generator": lambda: (x for x in (1.0, 2.0, 3.0)),
    "slice": lambda: slice(3),
    "ellipsis": lambda: ...,
    "structured": lambda: np.zeros(3, dtype=[("a", float), ("b", int)]),
    "masked": lambda: np.ma.array([1.0, 2.0, 3.0], mask=[True, False, False]),
    "array of objects": lambda: np.array([object(), None, 1.0], dtype=object),
    "array of texts": lambda: np.array(["1", "2", "3"]),
    "vector": lambda: np.array([0.1, 0.2, 0.3]),
    "matrix": lambda: np.eye(3),
    "nan matrix": lambda: np.full((3, 3), np.nan),
    "huge vector": lambda: np.broadcast_to(1.0, 10**12),
    "huge matrix": lambda: np.broadcast_to(1.0, (10**6, 10**6)),
    "many axes": lambda: np.ones((1,) * 40),
}


def _entry(value: np.ndarray, entry: Any) -> np.ndarray:
    changed = np.array(value, dtype=np.float64)
    if changed.size == 0:
        return np.array([entry])
    changed.flat[changed.size // 2] = entry
    return changed


def _with_none(value: np.ndarray) -> np.ndarray:
    changed = value.astype(object)
    changed.flat[: min(1, changed.size)] = None
    return changed


TYPES = {"float32": np.float32, "float16": np.float16, "longdouble": np.longdouble, "big endian": ">f8"}
TYPES |= {"integers": int, "complex": complex, "truth values": bool, "texts": str, "bytes": "S", "objects": object}
TYPES |= {"dates": "datetime64[s]", "times": "timedelta64[s]"}
ENTRIES = {"nan": np.nan, "inf": np.inf, "1e308": 1e308, "zero": 0.0}
FACTORS = ("1e308", "1e160", "1e20", "1e-20", "1e-160", "5e-324")
DERIVED: dict[str, Callable[[np.ndarray], Any]] = {
    **{f"as {name}": lambda v, kind=kind: v.astype(kind) for name, kind in TYPES.items()},
    **{f"one {name}": lambda v, entry=entry: _entry(v, entry) for name, entry in ENTRIES.items()},
    **{f"times {factor}": lambda v, factor=float(factor): v * factor for factor in FACTORS},
    "as complex, not real": lambda v: v * (1 + 1e-3j),
    "as fractions": lambda v: [fractions.Fraction(float(x)) for x in v.flat] if v.ndim == 1 else v,
    "as a list": lambda v: v.tolist(),
    "as a tuple": lambda v: tuple(v) if v.ndim else (v,),
    "as a memory view": lambda v: memoryview(v),
    "as a matrix": lambda v: v.view(np.matrix) if v.ndim == 2 else v,
    "masked in part": lambda v: np.ma.array(v, mask=np.arange(v.size).reshape(v.shape) == 0),
    "masked nowhere": lambda v: np.ma.array(v),
    "as a structure": lambda v: np.array([(x,) for x in v.flat], dtype=[("a", float)]).reshape(v.shape),
    "read-only": lambda v: np.broadcast_to(v.copy(), v.shape),
    "strided": lambda v: np.repeat(v, 2, axis=-1)[..., ::2] if v.ndim else v,
    "by columns": np.asfortranarray,
    "reversed": lambda v: v[::-1] if v.ndim else v,
    "transposed": lambda v: v.T,
    "one None": _with_none,
    "zeros": np.zeros_like,
    "negative": np.negative,
    "one axis more": lambda v: v[None],
    "two axes more": lambda v: v[None, None],
    "one axis less": lambda v: v[0] if v.ndim and len(v) else v,
    "three of them": lambda v: np.stack([v, v, v]),
    "one entry less": lambda v: v[..., :-1] if v.ndim else v,
    "one entry more": lambda v: np.concatenate([v, v[..., :1]], axis=-1) if v.ndim else v,
    "one row less": lambda v: v[:-1] if v.ndim else v,
    "none of them": lambda v: v[:0] if v.ndim else v,
    "very many of them": lambda v: np.broadcast_to(v, (10**12, *v.shape)),
}


def names(value: Any) -> list[str]:
    """Return the names of the values that may stand in place of one that works."""
    return [*CONSTANT, *(DERIVED if isinstance(value, np.ndarray | float) else ())]


def bad_value(name: str, value: Any) -> Any:
    """Return the value of a name in place of one that works."""
    if name in CONSTANT:
        return CONSTANT[name]()
    with np.errstate(all="ignore"):
        return DERIVED[name](np.asarray(value, dtype=np.float64))
