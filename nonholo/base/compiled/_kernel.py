"""The kernels' decorator: a kernel runs from the library that was compiled ahead, else by numba, else as it is.

Declarations for numba wait until numba is needed: a process that the library serves never loads it.
"""

import contextlib
import ctypes
import functools
import hashlib
import importlib
import itertools
import logging
import operator
import os
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from nonholo.base.compiled import library

FUNCTION = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)
"""A compiled function that kernels call, of two addresses."""
_SCALARS = {
    float: "d",
    np.float64: "d",
    int: "q",
    np.int64: "q",
    bool: "?",
    np.bool_: "?",
    type(None): "n",
    FUNCTION: "f",
}
_ARRAY, _NUMBERS = np.ndarray, frozenset(kind for kind, letter in _SCALARS.items() if letter in "dq?")
_FORMATS = {"f": "q", "d": "d", "q": "q", "?": "?7x", "n": ""}
_REFUSED = object()
_SLOW = (
    "Kernels that are not compiled ahead run as Python, about a hundred times slower. "
    "Install the extra `compile`: pip install 'nonholo[compile]'."
)
_OTHER = "o"  # what the library takes no argument of
DTYPES = {letter: np.dtype(kind) for letter, kind in {"d": np.float64, "q": np.int64, "?": np.bool_}.items()}
"""The numbers of arrays, by the letter of a key."""
_LETTERS = {numbers.str: letter for letter, numbers in DTYPES.items()}
_WAYS = ("library", "numba", "python")
_FAILED = "The kernel {} failed: the memory is full, or a size is too large. NONHOLO_KERNELS=python shows the line."
DATA, AXES, SHAPE, ABOUT, FLAGS = 16, 24, 32, 56, 64
"""Places of the fields of an array and of its type of numbers: part of NumPy's binary interface."""
LETTER, ORDER, SIZE = 24, 26, 40
ORDERED = 0x101  # in C order, and aligned


def njit(**options: Any) -> "Callable[[Callable[..., Any]], Kernel]":
    """Make a function a kernel, with the options of `numba.njit`.

    Example:
        >>> @njit(error_model="numpy")
        ... def inverse(x: float) -> float:
        ...     return 1 / x
        >>> inverse(4.0)
        0.25
    """
    return functools.partial(Kernel, options)


class Kernel:
    """A function of numbers, arrays and tuples of them.

    Where the library has it for arguments of these kinds it runs from there. Else numba compiles it, and keeps the code
    on disk; without numba it runs as it is. Its bits are the same by all three ways.

    Raises:
        RuntimeError: The library has no memory for its arrays, or another error in compiled code.
    """

    def __init__(self, options: dict[str, Any], function: Callable[..., Any]) -> None:
        functools.update_wrapper(self, function)
        self.py_func, self.options = function, options
        self._entries: dict[Any, Callable[[list[Any]], Any] | None] = {}
        self._body: tuple[Any, Any, list[Any]] = (), None, []

    def __call__(self, *arguments: Any) -> Any:
        """Run it by the first available way."""
        code = library_of_kernels()
        if code is None:
            return self.dispatcher(*arguments)
        classes, words = self._spread(arguments)
        entry = self._entries.get(classes)
        result = _REFUSED if entry is None else entry(words)
        if result is not _REFUSED:
            return result
        key = key_of(arguments)
        if key not in self._entries:
            self._entries[key] = code.entry(self, key)
        entry = self._entries[classes] = self._entries[key]
        return self.dispatcher(*arguments) if entry is None else entry(words)

    def _spread(self, arguments: tuple[Any, ...]) -> tuple[Any, list[Any]]:
        """Return the classes and words of arguments; those of a body that comes first are kept for the next call."""
        words: list[Any] = []
        if not arguments or not isinstance(arguments[0], tuple):
            return spread(arguments, words), words
        body, kinds, numbers = self._body
        if body is not arguments[0]:
            body, numbers = arguments[0], []
            kinds = type(body), spread(body, numbers)
            self._body = body, kinds, numbers
        words += numbers
        return (kinds, spread(arguments[1:], words)), words

    @functools.cached_property
    def dispatcher(self) -> Any:
        """The same function by numba; without numba the function as it is."""
        by_numba = _by_numba()
        return by_numba.dispatcher_of(self.py_func, self.options) if by_numba else self.py_func

    def __getattr__(self, name: str) -> Any:
        """Answer numba as its own dispatchers do."""
        if name.startswith("__") or name == "dispatcher":
            raise AttributeError(name)
        return getattr(self.dispatcher, name)

    def __reduce__(self) -> str:
        return self.__qualname__


@functools.cache
def say_once(text: str) -> None:
    """Log a warning once in a process."""
    logging.getLogger("nonholo").warning(text)


def spread(values: tuple[Any, ...], words: list[Any]) -> Any:
    """Append the words of arguments that a compiled function takes, numbers and arrays; return their classes."""
    classes: list[Any] = []
    for value in values:
        kind = type(value)
        if kind is _ARRAY:
            words.append(id(value))
        elif kind in _NUMBERS:
            words.append(value)
        elif isinstance(value, tuple):
            kind = kind, spread(value, words)
        elif kind is FUNCTION:
            words.append(ctypes.cast(value, ctypes.c_void_p).value)
        classes.append(kind)
    return tuple(classes)


def key_of(values: tuple[Any, ...]) -> str:
    """Return the kinds of arguments, letter by letter: see `tokens`.

    Example:
        >>> key_of((1.0, (2, None), np.zeros((3, 3)), np.zeros((3, 3)).T))
        'd(qn)d2o2'
    """
    return "".join(map(_kind_of, values))


def _kind_of(value: Any) -> str:
    kind = type(value)
    if kind is np.ndarray:
        return (_LETTERS.get(value.dtype.str, _OTHER) if _is_readable(value) else _OTHER) + str(value.ndim)
    if isinstance(value, tuple):
        return ("(" if kind is tuple else f"{kind.__name__}(") + key_of(value) + ")"
    return _SCALARS.get(kind, _OTHER)


def _is_readable(value: np.ndarray) -> bool:
    return value.flags.c_contiguous and value.flags.aligned


def _entry_of(function: Any, name: str, key: str, returns: str, release: Any) -> Callable[[list[Any]], Any]:
    """Return what runs a function of the library on the words of arguments of one kind.

    The function takes two addresses: of the words, and of a word that becomes 1 with what it returns after it, -1 where
    it fails. Where arrays are of another kind `_REFUSED` is returned in place of that.
    """
    function.restype, function.argtypes = None, (ctypes.c_char_p, ctypes.c_void_p)
    shape = tokens(returns)
    arguments = struct.Struct("".join(_FORMATS.get(each, "q" * _is_array(each)) for each in tokens(key)))
    results = struct.Struct("q" + "".join(map(_result_format, shape)))
    pack, unpack, make_room = arguments.pack, results.unpack, ctypes.c_char * results.size
    result_of = _result_of(shape, release)

    def run(words: list[Any]) -> Any:
        room = make_room()
        function(pack(*words), room)
        values = unpack(room)
        if values[0] < 0:
            raise RuntimeError(_FAILED.format(name))
        return result_of(values) if values[0] else _REFUSED

    return run


def _result_of(shape: list[str], release: Any) -> Callable[[tuple[Any, ...]], Any]:
    """Return what makes a result of the words behind the first one."""
    if shape == ["n"]:
        return lambda _: None
    if shape[0] in _FORMATS:
        return operator.itemgetter(1)
    if shape[0] == "(" and all(each in _FORMATS and each != "n" for each in shape[1:-1]):
        return operator.itemgetter(slice(1, None))
    return lambda values: _nest(iter(shape), iter(values[1:]), release)[0]


def _nest(kinds: Iterator[str], words: Iterator[Any], release: Any) -> list[Any]:
    """Return numbers, arrays and tuples up to the bracket that ends a tuple, or to the end."""
    values: list[Any] = []
    for kind in kinds:
        if kind == ")":
            break
        if kind.endswith("("):
            parts = _nest(kinds, words, release)
            values.append(tuple(parts) if kind == "(" else _class_of(kind[:-1])(*parts))
        elif kind == "n":
            values.append(None)
        else:
            values.append(next(words) if kind in _FORMATS else _array(kind, words, release))
    return values


def _class_of(name: str) -> Any:
    """Return the named tuple of a name and its module."""
    own, module = name.split("@")
    return getattr(importlib.import_module(module), own)


def _array(kind: str, words: Iterator[Any], release: Any) -> np.ndarray:
    """Return an array that a function made, copied out of its block."""
    block, address, *shape = itertools.islice(words, 2 + int(kind[1]))
    array = np.empty(shape, DTYPES[kind[0]])
    ctypes.memmove(array.ctypes.data, address, array.nbytes)
    release(block)
    return array


def _is_array(token: str) -> bool:
    return token[1:].isdigit()


def _result_format(token: str) -> str:
    return "q" * (2 + int(token[1])) if _is_array(token) else _FORMATS.get(token, "")


def tokens(key: str) -> list[str]:
    """Return the kinds of a key one by one: numbers, arrays with how many axes, and tuples by their brackets.

    Example:
        >>> tokens("Body(dd)d2q(?n)")
        ['Body(', 'd', 'd', ')', 'd2', 'q', '(', '?', 'n', ')']
    """
    kinds: list[str] = []
    at = 0
    while at < len(key):
        end = at + 1
        if key[at].isupper() or key[at] == "_":
            end = key.index("(", at) + 1
        elif end < len(key) and key[end].isdigit():
            end += 1
        kinds.append(key[at:end])
        at = end
    return kinds


class Library:
    """The functions that were compiled ahead for this processor."""

    def __init__(self, path: Path) -> None:
        self.path, self._code = path, ctypes.CDLL(str(path))
        self._release = self._code.nonholo_release
        self._release.restype, self._release.argtypes = None, (ctypes.c_void_p,)
        flags = _flags_of_processor()
        self._variants = [name for name, demand in _VARIANTS.items() if flags.issuperset(demand.split())]

    def entry(self, kernel: Kernel, key: str) -> Callable[[list[Any]], Any] | None:
        """Return what runs a kernel for arguments of a kind; None if the library does not have it."""
        name = f"{kernel.__module__}.{kernel.__qualname__}"
        symbol = symbol_of(name, key)
        function = self._function(symbol)
        if function is None:
            return None
        returns = ctypes.string_at(ctypes.addressof(ctypes.c_char.in_dll(self._code, f"{symbol}_returns")))
        return _entry_of(function, name, key, returns.decode(), self._release)

    def address(self, name: str, key: str) -> int:
        """Return the address of what an emitter, named by its place, wrote for a key; 0 if the library has it not."""
        return ctypes.cast(self._function(symbol_of(name, key)), ctypes.c_void_p).value or 0

    def _function(self, symbol: str) -> Any:
        """Return the variant of a function that is best here, if any."""
        return next(filter(None, (getattr(self._code, symbol + variant, None) for variant in self._variants)), None)


def symbol_of(name: str, key: str) -> str:
    """Return the name that a function has in the library for arguments of a kind."""
    return "nonholo_" + hashlib.sha256(f"{name} {key}".encode()).hexdigest()[:24]


_V3 = "abm avx2 bmi1 bmi2 f16c fma movbe"
_VARIANTS = {"_v4": f"{_V3} avx512bw avx512cd avx512dq avx512f avx512vl", "_v3": _V3, "": ""}
"""The abilities of a processor that variants of functions demand; the best variant is the first."""


def _flags_of_processor() -> set[str]:
    """Return the abilities of the processor by their names in Linux; none elsewhere."""
    with contextlib.suppress(OSError):
        return set(Path("/proc/cpuinfo").read_text(encoding="utf-8").split())
    return set()


@functools.cache
def first_way() -> str:
    """Return the first way to try, "library", "numba" or "python", as `NONHOLO_KERNELS` says.

    Settings of numba that ask for other code than that of the library leave the library out.

    Raises:
        ValueError: It says something else.
    """
    way = os.environ.get("NONHOLO_KERNELS", "library")
    if way not in _WAYS:
        raise ValueError(
            f"The variable NONHOLO_KERNELS must be one of {', '.join(_WAYS)}. Got {way!r}. Set or unset it."
        )
    if os.environ.get("NUMBA_DISABLE_JIT", "0") != "0":
        return "python"
    return "numba" if way == "library" and os.environ.get("NUMBA_BOUNDSCHECK", "0") != "0" else way


def way_of_kernels() -> str:
    """Return the way by which kernels run here: "library", "numba" or "python".

    Kernels of other kinds than those of the library run by numba, or as Python without it.
    """
    return "library" if library_of_kernels() else "numba" if _by_numba() else "python"


@functools.cache
def library_of_kernels() -> Library | None:
    """Return the library of the kernels of this text, beside them or in the user's cache; None if there is none."""
    file = library.place() if first_way() == "library" else None
    file = file if file and _has_known_arrays() else None  # which reads memory
    way = f"from {file}" if file else "by numba" if _by_numba() else "as Python"
    logging.getLogger("nonholo").info("Kernels run %s.", way)
    return Library(file) if file else None


@functools.cache
def _by_numba() -> Any:
    """Return the module of kernels by numba; None where they run as they are."""
    if first_way() == "python":
        return None
    try:
        return importlib.import_module("nonholo.base.compiled.by_numba")
    except ModuleNotFoundError:
        say_once(_SLOW)
        return None


def _has_known_arrays() -> bool:
    """Return whether arrays have their fields where the library looks for them; another Python may not."""
    array = np.zeros((2, 3))
    fields = ctypes.cast(id(array), ctypes.POINTER(ctypes.c_int64))
    axes, flags = (ctypes.c_int32.from_address(id(array) + place).value for place in (AXES, FLAGS))
    about = fields[ABOUT // 8] == id(array.dtype)
    shape = ctypes.cast(fields[SHAPE // 8], ctypes.POINTER(ctypes.c_int64))
    letter = ctypes.c_char.from_address(id(array.dtype) + LETTER).value
    size = ctypes.c_int64.from_address(id(array.dtype) + SIZE).value
    same = (fields[DATA // 8], axes, flags & ORDERED, letter, size) == (array.ctypes.data, 2, ORDERED, b"f", 8)
    return about and same and (shape[0], shape[1]) == array.shape


_waiting: list[Callable[[], Any]] = []
_numba_is_here = False


def for_numba(tell: Callable[[], Any]) -> None:
    """Tell numba something about kernels: once it is needed, or now if it is there."""
    if _numba_is_here:
        tell()
    else:
        _waiting.append(tell)


def tell_numba() -> None:
    """Tell numba all that waits."""
    global _numba_is_here  # the state of the process
    _numba_is_here = True
    while _waiting:
        _waiting.pop(0)()


def overload(function: Callable[..., Any], **options: Any) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Let what is decorated choose, for numba, what compiled code calls in place of a function."""

    def decorate(choose: Callable[..., Any]) -> Callable[..., Any]:
        def tell() -> None:
            from numba.extending import overload

            overload(function, **options)(choose)

        for_numba(tell)
        return choose

    return decorate


def jitable(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Mark a function that compiled code calls, with the options of `numba.njit`, plain Python elsewhere."""

    def decorate(function: Callable[..., Any]) -> Any:
        def choose(*_: Any, **__: Any) -> Any:
            return function

        overload(function, jit_options=options, strict=False)(choose)
        return function

    return decorate


def compiled_in(module: str) -> None:
    """Name the module that tells numba how it compiles the functions of another one."""
    for_numba(lambda: importlib.import_module(module))
