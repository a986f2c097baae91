"""Checks of arguments: each failure names the owner, the requirement, what was got and the remedy.

Concrete values are checked and copied into read-only float64 arrays; traced values (inside `jax.jit` or `jax.grad`)
are checked for shape alone, since their values are not known yet.
"""

import contextlib
import functools
import inspect
import math
import numbers
import os
import re
import shutil
import sys
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from typing import Any, TypeAlias, TypeVar, cast

import numpy as np

from nonholo.base import limits
from nonholo.base.types import Array

Kind = TypeVar("Kind")
Owner: TypeAlias = str | Callable[[], str]
"""The argument that an error names, or what names it once there is one."""
_vdot = inspect.unwrap(np.vdot)  # of NumPy's own arrays: it asks no other library
Function = TypeVar("Function", bound=Callable[..., Any])
_LEAST_RTOL = 1e-14
LARGEST = 1e150  # what a number may be; squares of larger ones overflow
_LARGEST_SUM = LARGEST**2  # of squares
_SMALLEST = 1 / LARGEST  # mass, inertia and time step, so that squares do not underflow
_MOST = 2**53  # the integers up to it are floats too
_MOST_INDEX = 2**63 - 1
_MOST_AXES = 16  # NumPy broadcasts 32
_OTHER_REMEDIES = {  # of a list with a tracer in it
    "TracerArrayConversionError": "JAX traces some of these numbers: put them together with jax.numpy.array([...])."
}
_FEW = 1 << 13  # numbers that are looked at by one sum: BLAS wakes no other thread for them
_LONGEST_NAME = 255  # bytes; more is more than any file system has
_LONGEST_WORD = 100  # letters of a name, to which suffixes are added
COLUMNS = frozenset({"constraint_residual", "energy", "t", "time"})
"""Columns of tables of orbits, beside which those of coordinates stand under their own names."""


def error(where: Owner, requirement: str, got: str, remedy: str) -> ValueError:
    """Build the error every check raises: owner and argument, requirement, fact, remedy.

    Example:
        >>> str(error("simulate(steps=...)", "be a positive integer", "0", "Pass steps=1 or more."))
        '`simulate(steps=...)` must be a positive integer. Got 0. Pass steps=1 or more.'
    """
    message = f"`{where if isinstance(where, str) else where()}` must {requirement}. Got {got}. {remedy}"
    return ValueError("\n".join(map(printable, message.split("\n"))))


def assign(thing: Any, /, **values: Any) -> None:
    """Assign fields of a frozen object, such as arguments that were checked."""
    for name, value in values.items():
        object.__setattr__(thing, name, value)


def printable(text: str) -> str:
    r"""Return a text from elsewhere as one line that a terminal only shows: what controls it is replaced.

    Example:
        >>> printable("a title\x1b]0;gone\x07")
        'a title?]0;gone?'
    """
    return "".join(letter if letter.isprintable() else "?" for letter in text)


def is_traced(value: Any) -> bool:
    """Return whether a value is a JAX tracer, without importing JAX."""
    jax = sys.modules.get("jax")
    return jax is not None and isinstance(value, jax.core.Tracer)


def array(where: str, value: Any, shape: tuple[int | None, ...], remedy: str = "Check the argument.") -> Array:
    """Return `value` as a read-only float64 array of the given shape (None: any length), finite and real."""
    raw = value if is_traced(value) else real_or_complex(where, value, remedy)
    if raw.shape != shape and not _fits(raw.shape, shape):
        raise error(where, f"have shape {_shape_text(shape)}", f"shape {raw.shape}", remedy)
    if is_traced(raw):
        return raw
    if raw.dtype.kind == "c":
        raise error(where, "be real", "complex numbers", remedy)
    try:
        result = (raw if raw.dtype.char == "d" else _as_floats(raw)).astype(np.float64)
        if not is_moderate(result):
            _refuse_large(where, result, remedy)
    except MemoryError:
        raise error(where, "fit into memory", f"shape {raw.shape}", remedy) from None
    result.setflags(write=False)
    return result


def real_or_complex(where: Owner, value: Any, remedy: str) -> np.ndarray:
    """Return an array of integers, floats or complex numbers; refuse all else that NumPy would turn into some.

    Texts, dates, truth values, structures, None, and masked arrays, whose hidden numbers NumPy would use.
    """
    try:
        raw = np.asarray(value)
        if raw.dtype.kind == "O" and not any(isinstance(x, str | bytes | bool | np.generic) for x in raw.flat):
            raw = np.array([float(entry) for entry in raw.flat]).reshape(raw.shape)
    except OverflowError:
        raise error(where, "be finite", f"an integer beyond {sys.float_info.max:.2g}", remedy) from None
    except (TypeError, ValueError, ArithmeticError, RecursionError) as reason:
        raw, remedy = np.array(None), _OTHER_REMEDIES.get(type(reason).__name__, remedy)
    if raw.dtype.kind not in "iufc" or np.ma.is_masked(value):
        raise error(where, "be an array of real numbers", shown(value), remedy)
    if raw.ndim > _MOST_AXES:
        raise error(where, f"have at most {_MOST_AXES} axes", f"{raw.ndim}", remedy)
    return raw


def shown(value: Any) -> str:
    """Return any value as a line of limited length."""
    try:
        text = re.sub(r"\s*\n\s*", " ", repr(value))
    except Exception:  # an integer of thousands of digits, nested lists, whatever it is made of
        text = f"a {type(value).__name__} that cannot be shown"
    return text if len(text) <= 200 else f"{text[:200]}..."


def is_moderate(value: np.ndarray, most: float = LARGEST) -> bool:
    """Return whether every number is finite and at most as large: without copies, if sums of squares show it."""
    if value.size <= _FEW:
        if float(_vdot(value, value).real) <= _LARGEST_SUM:
            return True
    elif value.flags.c_contiguous:  # other arrays may repeat one number without end
        numbers = value.reshape(-1)
        return all(is_moderate(numbers[begin : begin + _FEW], most) for begin in range(0, value.size, _FEW))
    return bool((np.isfinite(value) & (np.abs(value) <= most)).all())


def _check_finite(where: Owner, value: np.ndarray, remedy: str) -> None:
    finite = np.isfinite(value)
    if not finite.all():
        position = tuple(int(i) for i in np.argwhere(~finite)[0])
        place = f" at index {position}" if position else ""
        raise error(where, "be finite", f"{value[position]}{place}", remedy)


def _refuse_large(where: Owner, value: np.ndarray, remedy: str) -> None:
    """Refuse numbers that are not finite, or whose squares overflow."""
    if not (most := float(np.abs(value).max(initial=0.0))) <= LARGEST:
        _check_finite(where, value, remedy)
        raise error(where, f"have no number beyond {LARGEST:g}", f"{most:g}", "Use other units.")


def _fits(actual: tuple[int, ...], demand: tuple[int | None, ...]) -> bool:
    return len(actual) == len(demand) and not [a for a, w in zip(actual, demand, strict=True) if w not in (None, a)]


def _shape_text(shape: tuple[int | None, ...]) -> str:
    sizes = ", ".join("any" if size is None else str(size) for size in shape)
    return f"({sizes},)" if len(shape) == 1 else f"({sizes})"


def number(where: str, value: Any, remedy: str = "Pass one real number.") -> Array:
    """Return a finite real scalar as float64 (or the tracer)."""
    if type(value) in (float, np.float64) and abs(value) <= LARGEST:
        return np.float64(value)
    result = array(where, value, (), remedy)
    return result if is_traced(result) else np.float64(result)


def _as_floats(result: Array) -> Array:
    """Return an array as it is, integers and longer floats as float64."""
    if result.dtype.kind not in "biu" and result.dtype.char not in "egG":  # half and long floats, long complex ones
        return result
    with np.errstate(over="ignore"):
        return result.astype(np.complex128 if result.dtype.kind == "c" else np.float64)


def trailing(
    where: Owner, value: Any, shape: tuple[int, ...], remedy: str, *, real: bool = False, moderate: bool = False
) -> Array:
    """Return an array (a sequence becomes float64) whose last axes have the given shape; leading axes are free.

    One element has to be finite. In a stack NaN stays NaN: it marks what has no value, such as a member that has ended.
    Of functions that compute without warnings, numbers have to be `moderate`.
    """
    if _is_as_wanted(value, shape):
        return value
    raw = value if is_traced(value) else real_or_complex(where, value, remedy)
    if raw.shape[max(0, raw.ndim - len(shape)) :] != shape:
        raise error(where, f"end in shape {_shape_text(shape)}", f"shape {raw.shape}", remedy)
    if is_traced(raw):
        return _as_floats(raw)
    if real and raw.dtype.kind == "c":
        raise error(where, "be real", "complex numbers", remedy)
    try:
        result = _as_floats(raw)
        if not is_moderate(result):
            rows = result if result.ndim == len(shape) else np.where(np.isnan(result), 0, result)
            (_refuse_large if moderate else _check_finite)(where, rows, remedy)
    except MemoryError:
        raise error(where, "fit into memory", f"shape {raw.shape}", remedy) from None
    return result


def _is_as_wanted(value: Any, shape: tuple[int, ...]) -> bool:
    """Return whether nothing is left to look at: moderate floats in an array that ends in this shape."""
    is_plain = type(value) is np.ndarray and value.dtype.char == "d" and 0 < len(shape) <= value.ndim <= _MOST_AXES
    is_plain = is_plain and (value.size <= _FEW or value.flags.c_contiguous)
    return is_plain and value.shape[-len(shape) :] == shape and is_moderate(value)


def shape_of(value: Any) -> tuple[int, ...]:
    """Return the shape of an argument that is not checked yet; of what is no array that of one number."""
    if is_traced(value):
        return value.shape
    try:
        return np.asarray(value).shape
    except Exception:  # NumPy runs whatever code the argument brings; the check that follows refuses it
        return ()


def refuse_given(owner: str, requirement: str, remedy: str, **arguments: tuple[Any, Any]) -> None:
    """Refuse arguments that this call does not have: each comes with its default.

    Example:
        >>> refuse_given("discretize", "be left out", "It has none.", order=(2, 2))
    """
    for name, (value, default) in arguments.items():
        if value is not default and not (isinstance(value, type(default)) and value == default):
            raise error(f"{owner}({name}=...)", requirement, shown(value), remedy)


def positive(where: str, value: Any, remedy: str) -> Array:
    """Return a strictly positive scalar."""
    result = number(where, value, remedy)
    if not is_traced(result) and not result > 0:
        raise error(where, "be positive", f"{float(result)!r}", remedy)
    return result


def scale(where: str, value: Any, remedy: str) -> Array:
    """Return a positive scalar that sets a scale, such as a mass, a length or a time."""
    result = positive(where, value, remedy)
    check_scale(where, result)
    return result


def check_scale(where: str, value: Array) -> None:
    """Refuse what sets a scale if its squares underflow; zeros set none."""
    if not is_traced(value) and 0 < (most := np.abs(value).max()) < _SMALLEST:
        raise error(where, f"not lie below {_SMALLEST:g}", f"{most:g}", "Use other units.")


def count(where: str, value: Any, remedy: str) -> int:
    """Return a strictly positive Python integer."""
    return _integer(where, value, (1, _MOST), "be a positive integer", remedy)


def dimension(where: str, value: Any) -> int:
    """Return the dimension of a space in which bodies turn."""
    remedy = "Pass the dimension of the space, 2 or more."
    n = count(where, value, remedy)
    if n < 2:
        raise error(where, "be at least 2", str(n), remedy)
    return n


def natural(where: str, value: Any, remedy: str) -> int:
    """Return a Python integer that is not negative."""
    return _integer(where, value, (0, _MOST_INDEX), "be a natural number", remedy)


def is_integer(value: Any) -> bool:
    """Return whether a value is an integer; truth values are none, nor spans of time, which NumPy takes for some."""
    return isinstance(value, numbers.Integral) and not isinstance(value, bool | np.timedelta64)


def _integer(where: str, value: Any, bounds: tuple[int, int], requirement: str, remedy: str) -> int:
    """Return an integer between two bounds."""
    if type(value) is int and bounds[0] <= value <= bounds[1]:
        return value
    if not is_integer(value) or (number := int(value)) < bounds[0]:
        raise error(where, requirement, shown(value), remedy)
    if number > bounds[1]:
        raise error(where, f"be at most {bounds[1]}", shown(value), remedy)
    return number


def step_counts(owner: str, steps: Any, save_every: Any) -> tuple[int, int]:
    """Return the numbers of steps of a run, in total and between saved states."""
    steps = count(f"{owner}(steps=...)", steps, "Pass the number of steps.")
    return steps, count(f"{owner}(save_every=...)", save_every, "Pass the number of steps between saved states.")


def choice(where: str, value: Any, choices: tuple[Any, ...], remedy: str = "Choose one of them.") -> Any:
    """Return the one of the allowed values that `value` is; integers may be those of NumPy."""
    for each in choices:
        is_alike = is_integer(value) if isinstance(each, int) else isinstance(value, type(each))
        if is_alike and (value is each or value == each):
            return each
    raise error(where, "be one of " + ", ".join(map(repr, choices)), shown(value), remedy)


def flag(where: str, value: Any) -> bool:
    """Return True or False; what Python only takes for one of them, a text among it, is refused."""
    if not isinstance(value, bool | np.bool_):
        raise error(where, "be True or False", shown(value), "Pass one of them.")
    return bool(value)


def instance(where: str, value: Any, kind: type[Kind], requirement: str, remedy: str) -> Kind:
    """Return a value of a class; what is none of it is refused."""
    if not isinstance(value, kind):
        raise error(where, requirement, shown(value), remedy)
    return value


def function(where: str, value: Any, *arguments: str) -> None:
    """Refuse what cannot be called, or does not take the arguments that are named.

    Example:
        >>> function("Forced(force=...)", lambda t, g: g, "time", "configuration", "body_velocity")
        Traceback (most recent call last):
        ...
        ValueError: `Forced(force=...)` must take (time, configuration, body_velocity). Got `<lambda>(t, g)`. ...
    """
    if not callable(value):
        raise error(where, "be a function", shown(value), "Pass a function.")
    if arguments and not takes(value, len(arguments)):
        got = f"`{getattr(value, '__name__', type(value).__name__)}{inspect.signature(value)}`"
        raise error(where, f"take ({', '.join(arguments)})", got, "Write it with these arguments.")


def takes(function: Callable[..., Any], count: int) -> bool:
    """Return whether a function takes this many arguments; a builtin need not tell, and takes all."""
    own = function.__call__  # which is read wrongly of an object where it is static
    return _binds(function, count) or (inspect.isfunction(own) and _binds(own, count))


def _binds(function: Callable[..., Any], count: int) -> bool:
    try:
        inspect.signature(function).bind(*range(count))
    except TypeError:
        return False
    except ValueError:
        return True
    return True


def text(where: str, value: Any) -> str:
    """Return a text."""
    instance(where, value, str, "be a text", "Pass a text.")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise error(where, "be a text that files can hold", shown(value), "Leave lone surrogates out.") from None
    return value


def is_name(value: Any) -> bool:
    """Return whether a text can name a column, a dimension, a file or a variable, wherever it comes from.

    It begins with a letter, continues with letters, digits and underscores, all ASCII, and is not long.

    Example:
        >>> is_name("theta_1"), is_name("=1+1"), is_name("a,b"), is_name("_x")
        (True, False, False, False)
    """
    fits = isinstance(value, str) and len(value) <= _LONGEST_WORD and value.isascii()
    return fits and value.isidentifier() and not value.startswith("_")


def checked_name(where: str, value: Any, others: Collection[str] = ()) -> str:
    """Return a name (`is_name`), refused if it is a reserved one."""
    if not is_name(value) or value in others:
        remedy = f"Rename it; taken: {', '.join(sorted(others))}." if others else "Rename it."
        raise error(where, "be a name: a letter, then letters, digits and underscores, all ASCII", shown(value), remedy)
    return value


def names(where: str, values: Any, count: int | None = None, others: Collection[str] = COLUMNS) -> tuple[str, ...]:
    """Return different names as a tuple: the required number, or at least one."""
    entries = values if isinstance(values, tuple | list) else ()
    words = {value for value in entries if is_name(value) and value not in others}
    if not entries or len(words) < len(entries) or len(entries) != (count or len(entries)):
        requirement = f"be {'' if count is None else f'{count} '}different names"
        remedy = f'Pass words such as ("x", "y", "theta"), none of them {", ".join(sorted(others))}.'
        raise error(where, requirement, shown(values), remedy)
    return tuple(entries)


def pair(where: str, value: Any) -> tuple[Any, Any]:
    """Return the two parts of a pair."""
    if not isinstance(value, tuple | list | np.ndarray) or len(value) != 2:
        raise error(where, "be a pair", shown(value), "Pass two of them.")
    return value[0], value[1]


def flags(owner: str, **values: Any) -> None:
    """Refuse arguments of an owner that are neither True nor False."""
    for name, value in values.items():
        if value is not True and value is not False:
            flag(f"{owner}({name}=...)", value)


def checked_path(where: str, value: Any) -> Path:
    """Return a path that a file system can have.

    Example:
        >>> checked_path("load_orbit(path=...)", 5)
        Traceback (most recent call last):
        ...
        ValueError: `load_orbit(path=...)` must be a path. Got 5. Pass a text or a pathlib.Path.
    """
    if not isinstance(value, str | os.PathLike) or not isinstance(text := os.fspath(value), str):
        raise error(where, "be a path", shown(value), "Pass a text or a pathlib.Path.")
    longest = max((len(part.encode(errors="surrogatepass")) for part in Path(text).parts), default=0)
    if "\0" in text or longest > _LONGEST_NAME:
        raise error(where, "be a name that files can have", shown(value), "Pass a shorter one, without the letter NUL.")
    return Path(text)


def selection(where: str, value: Any, count: int) -> slice | np.ndarray:
    """Return which of this many rows are meant: a slice, a mask, or numbers of rows."""
    if isinstance(value, slice):
        return value
    rows = value if isinstance(value, np.ndarray) and value.ndim == 1 else np.array([None])
    kind = rows.dtype.kind
    if not (kind == "i" and ((-count <= rows) & (rows < count)).all()) and not (kind == "b" and len(rows) == count):
        requirement = f"be a slice, a mask or an array of integers, of {count} rows"
        raise error(where, requirement, shown(value), "Pass one of them.")
    return rows


def generator(where: str, rng: Any) -> np.random.Generator:
    """Return a generator of random numbers: the one that is passed, or that of an integer."""
    return rng if isinstance(rng, np.random.Generator) else np.random.default_rng(seed(where, rng))


def seed(where: str, rng: Any) -> int:
    """Return an integer that random numbers are made of: the one that is passed, or one that a generator draws.

    Example:
        >>> seed("Grid(rng=...)", 7), seed("Grid(rng=...)", np.random.default_rng(7)) < 2**63
        (7, True)
    """
    if isinstance(rng, np.random.Generator):
        return int(rng.integers(_MOST_INDEX, endpoint=True))
    requirement, remedy = "be a natural number or a numpy.random.Generator", "Pass 0, 1, 2, ..., or a generator."
    return _integer(where, rng, (0, _MOST_INDEX), requirement, remedy)


def refuse_former_names(owner: str, **names: str) -> Callable[[Function], Function]:
    """Return a decorator that refuses the former names of keywords, each with its name of today.

    Example:
        >>> turn = refuse_former_names("turn", a="angle")(lambda angle: angle)
        >>> turn(a=1.0)
        Traceback (most recent call last):
        ValueError: `turn(a=...)` must be called `angle`. Got 'a'. Pass angle=...; see docs/project/migration.md.
    """

    def decorate(function: Function) -> Function:
        @functools.wraps(function)
        def call(*arguments: Any, **keywords: Any) -> Any:
            for former in names.keys() & keywords.keys():
                remedy = f"Pass {names[former]}=...; see docs/project/migration.md."
                raise error(f"{owner}({former}=...)", f"be called `{names[former]}`", repr(former), remedy)
            return function(*arguments, **keywords)

        return cast(Function, call)

    return decorate


def symmetric(where: str, value: Array, remedy: str) -> Array:
    """Return a tensor of inertia, refused with the worst pair of entries if it is not symmetric to rounding."""
    if is_traced(value):
        return value
    check_scale(where, value)
    gap = value - value.T
    if np.count_nonzero(gap) and np.abs(gap).max() > 8 * np.finfo(np.float64).eps * np.abs(value).max():
        i, j = (int(k) for k in np.unravel_index(np.abs(gap).argmax(), gap.shape))
        got = f"entries {float(value[i, j])!r} and {float(value[j, i])!r} at {(i, j)} and {(j, i)}"
        raise error(where, "be symmetric", got, remedy)
    return value


def positive_definite(where: str, matrix: Array, what: str, remedy: str) -> None:
    """Refuse a symmetric matrix with an eigenvalue that is not clearly positive, and name the eigenvalue."""
    if is_traced(matrix):
        return
    if not np.isfinite(matrix).all():
        raise error(where, f"make {what} finite", "an overflow", "Pass smaller numbers, in other units.")
    units = np.array([math.sqrt(x) if x > 0 else 1.0 for x in matrix.diagonal().tolist()])  # lengths and angles mix
    eigenvalues = np.linalg.eigvalsh(matrix / units / units[:, None])
    if not eigenvalues[0] > 4 * np.finfo(np.float64).eps * max(abs(eigenvalues[-1]), math.ulp(0.0)):
        got = f"an eigenvalue {np.linalg.eigvalsh(matrix)[0]:.6g}"
        raise error(where, f"make {what} positive definite", got, remedy)


def checked_energies(where: str, value: Any) -> Array:
    """Return positive energies, at least one."""
    remedy = "Pass a list of positive energies."
    levels = array(where, value, (None,), remedy)
    if not levels.size or not np.all(levels > 0):
        raise error(where, "be positive", f"{levels.min():g}" if levels.size else "none", remedy)
    return levels


def flow_times(value: Any) -> Array:
    """Return the times of a flow: at least one, in strict order, in either direction."""
    where, remedy = "flow(times=...)", "Sort the times. The motion starts at the first one."
    times = array(where, value, (None,), "Pass a sequence of times.")
    if times.size == 0:
        raise error(where, "hold at least one time", "none", "Pass the time of the start first.")
    rising = np.count_nonzero(times[1:] > times[:-1])
    if rising < len(times) - 1 and (rising or np.count_nonzero(times[1:] < times[:-1]) < len(times) - 1):
        gaps = times[1:] - times[:-1]
        at = int(np.argmin(gaps * np.sign(gaps[0])))
        got = f"{times[at + 1]} after {times[at]}"
        raise error(where, "be strictly increasing or strictly decreasing", got, remedy)
    return times


def flow_tolerances(rtol: Any, atol: Any) -> tuple[float, float]:
    """Return the relative and absolute tolerances of a flow."""
    relative = float(number("flow(rtol=...)", rtol))
    if relative < _LEAST_RTOL:
        raise error("flow(rtol=...)", "be at least 1e-14", f"{relative:g}", "Rounding errors are as large as that.")
    return relative, float(positive("flow(atol=...)", atol, "Pass a positive absolute error."))


def within_memory(where: str, size: float, remedy: str) -> None:
    """Refuse what needs more bytes than this process can have.

    Example:
        >>> within_memory("f(n=...)", 1e30, "Pass a smaller n.")
        Traceback (most recent call last):
        ...
        ValueError: `f(n=...)` must fit into memory. Got about 1e+12 EB of ... GB. Pass a smaller n.
    """
    if size > (limit := limits.memory_limit()):
        raise error(where, "fit into memory", f"about {limits.size_text(size)} of {limits.size_text(limit)}", remedy)


def within_disk(where: str, size: float, folder: Path, remedy: str) -> None:
    """Refuse what needs more bytes than are free on the disk of a folder, or of the one that it would be made in."""
    there = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    if size > (free := shutil.disk_usage(there).free):
        need, rest = limits.size_text(size), limits.size_text(free)
        got = f"about {need} before compression, of which {rest} are free in '{there}'"
        raise error(where, "fit on the disk", got, remedy)


def bounded_count(where: str, value: Any, each: float, remedy: str) -> int:
    """Return a positive integer, refused if this many things of `each` bytes do not fit into memory."""
    number = count(where, value, remedy)
    within_memory(where, number * each, remedy)
    return number


class MissingExtraError(ModuleNotFoundError, ValueError):
    """A call needs an extra that is not installed."""


@contextlib.contextmanager
def needs(extra: str, where: str) -> Iterator[None]:
    """Import in its body what an extra holds; where that is missing, name the command that installs it.

    Raises:
        MissingExtraError: If a library of the extra is not installed.

    Example:
        >>> with needs("certify", "branches"):
        ...     raise ModuleNotFoundError("No module named 'flint'", name="flint")
        Traceback (most recent call last):
        nonholo.base.checks.MissingExtraError: `branches` must have the extra `certify`. Got no module 'flint'.
        Install the extra `certify`: pip install 'nonholo[certify]'.
    """
    try:
        yield
    except ModuleNotFoundError as missing:
        if str(missing.name).startswith("nonholo."):
            raise
        remedy = f"Install the extra `{extra}`: pip install 'nonholo[{extra}]'."
        message = str(error(where, f"have the extra `{extra}`", f"no module {missing.name!r}", remedy))
        raise MissingExtraError(message, name=missing.name) from None
