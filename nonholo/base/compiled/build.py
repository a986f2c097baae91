r"""The kernels compiled ahead: a library for a processor, for arguments of known kinds.

`ahead.txt` names them, a kernel and the kinds of its arguments a line, as `nonholo.base.compiled.spread` gives them.
numba types and lowers each as in a process that calls it. Or a line names a function that writes LLVM code, and
its purpose. llvmlite makes objects of this code, a linker a library.
Arithmetic is strict everywhere, so the numbers are the same to the last bit.

    python -m nonholo.base.compiled.build FOLDER [MACHINE...]

Machines are those of `MACHINES`, by default the one on which it runs.
"""

import concurrent.futures
import functools
import importlib
import itertools
import multiprocessing
import os
import pkgutil
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import numba
from llvmlite import ir
from numba import typeof, types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array

from nonholo.base import compiled
from nonholo.base.compiled import _kernel, wasm
from nonholo.base.compiled.emission import emit_object, for_any_machine, machine_for
from nonholo.base.compiled.library import name_of_library, name_of_module, this_machine

_KERNELS = Path(__file__).parents[2] / "kernels"
_WORD, _INT, _ADDRESS = ir.IntType(64), ir.IntType(32), types.CPointer(types.int64)
_KINDS: dict[str, Any] = {"d": types.float64, "q": types.int64, "?": types.boolean, "n": types.none}
_LETTERS = {kind: letter for letter, kind in _KINDS.items()}
_FUNCTION = compiled.FUNCTION(0)  # one of the kind that kernels call
_NAKED = ("-nostdlib",)  # whoever loads it has the few functions of C
MACHINES: dict[str, tuple[str, tuple[str, ...]]] = {
    "linux-x86_64": ("x86_64-unknown-linux-gnu", ("-target", "x86_64-linux-gnu.2.17", *_NAKED)),
    "linux-aarch64": ("aarch64-unknown-linux-gnu", ("-target", "aarch64-linux-gnu.2.17", *_NAKED)),
    "darwin-arm64": ("arm64-apple-macosx11.0", ("-target", "aarch64-macos.11.0")),
    "windows-amd64": ("x86_64-pc-windows-gnu", ("-target", "x86_64-windows-gnu")),
}
"""For each machine the target of LLVM, and the options of a linker that knows all targets, `ziglang`."""
_PROCESSORS = {
    "linux-x86_64": {"": "x86-64", "_v3": "x86-64-v3", "_v4": "x86-64-v4"},
    "windows-amd64": {"": "x86-64"},
}
_WORTH = {
    "": "",
    "_v3": "ensemble|taylor|advance(_many)? General|advance Secular",
    "_v4": "ensemble|taylor|run.advance Secular",
}
"""The lines that are worth a variant: runs with vectors of four numbers, and of eight."""
_RUNTIME = Path(__file__).with_name("runtime.ll")
_ENTRY = """
define void @{symbol}(ptr %words, ptr %room) {{
  %result = alloca ptr
  %raised = alloca ptr
  %status = call i32 @{own}(ptr %result, ptr %raised, ptr %words, ptr %room)
  %failed = icmp ne i32 %status, 0
  br i1 %failed, label %bad, label %good
bad:
  store i64 -1, ptr %room
  br label %good
good:
  ret void
}}

@{symbol}_returns = constant [{length} x i8] c"{returns}\\00"
"""


def kind_of(tokens: Iterator[str], classes: dict[str, Any]) -> list[Any]:
    """Return the types of numba for kinds, up to the bracket that ends a tuple or to their end."""
    kinds: list[Any] = []
    for each in tokens:
        if each == ")":
            break
        if each.endswith("("):
            parts = kind_of(tokens, classes)
            kinds.append(types.BaseTuple.from_types(parts, classes[each[:-1]] if each != "(" else None))
        elif each == "f":
            kinds.append(typeof(_FUNCTION))
        elif len(each) == 2:
            kinds.append(types.Array(_KINDS[each[0]], int(each[1]), "C"))
        else:
            kinds.append(_KINDS[each])
    return kinds


def letters(kind: Any) -> str:
    """Return the kinds of what a function returns."""
    if isinstance(kind, types.BaseTuple):
        own = getattr(kind, "instance_class", tuple)
        name = "" if own is tuple else f"{own.__name__}@{own.__module__}"
        return f"{name}({''.join(letters(each) for each in _parts(kind))})"
    return f"{_LETTERS[kind.dtype]}{kind.ndim}" if isinstance(kind, types.Array) else _LETTERS[kind]


def _parts(kind: Any) -> list[Any]:
    """Return the types in a tuple."""
    return list(kind)


def flat(kernel: compiled.Kernel, kinds: list[Any]) -> tuple[Any, list[str]]:
    """Return a kernel as a function of two addresses, for numba to compile, and a list for the kinds of its results."""
    returns: list[str] = []
    options: Any = {name: option for name, option in kernel.options.items() if name != "inline"}
    function: Any = numba.njit(**options)(kernel.py_func) if "inline" in kernel.options else kernel
    tuple_kind = types.BaseTuple.from_types(kinds)

    @intrinsic
    def fits(_typing: Any, words: Any) -> Any:
        def code(_context: Any, builder: Any, _signature: Any, values: Any) -> Any:
            return _fits(builder, tuple_kind, _words(builder, values[0]))

        return types.boolean(words), code

    @intrinsic
    def arguments(_typing: Any, words: Any) -> Any:
        def code(context: Any, builder: Any, _signature: Any, values: Any) -> Any:
            return _value(context, builder, tuple_kind, _words(builder, values[0]))

        return tuple_kind(words), code  # pyright: ignore

    @intrinsic
    def give(_typing: Any, room: Any, result: Any) -> Any:
        returns[:] = [letters(result)]

        def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            builder.store(_WORD(1), values[0])
            for place, word in enumerate(_results(context, builder, signature.args[1], values[1]), 1):
                target = builder.gep(values[0], [_WORD(place)])
                builder.store(word, builder.bitcast(target, word.type.as_pointer()))
            return context.get_dummy_value()

        return types.none(room, result), code

    def run(words: Any, room: Any) -> None:
        if fits(words):  # pyright: ignore
            give(room, function(*arguments(words)))  # pyright: ignore

    return run, returns


def _words(builder: Any, begin: Any) -> Callable[[], Any]:
    """Return a function that loads one word after another."""
    places = itertools.count()
    return lambda: builder.load(builder.gep(begin, [_WORD(next(places))]))


def _field(builder: Any, record: Any, at: int, kind: Any) -> Any:
    """Load a field of a record, the address of which is a word."""
    return builder.load(builder.inttoptr(builder.add(record, _WORD(at)), kind.as_pointer()))


def _fits(builder: Any, kind: Any, word: Callable[[], Any]) -> Any:
    """Return whether arrays have the axes, numbers and order that a kernel is compiled for."""
    if isinstance(kind, types.BaseTuple):
        each = [_fits(builder, part, word) for part in _parts(kind)]
        return functools.reduce(builder.and_, each, ir.IntType(1)(1))
    if kind == types.none:
        return ir.IntType(1)(1)
    array = word()
    if not isinstance(kind, types.Array):
        return ir.IntType(1)(1)
    flags = builder.and_(_field(builder, array, _kernel.FLAGS, _INT), _INT(_kernel.ORDERED))
    about, numbers = _field(builder, array, _kernel.ABOUT, _WORD), _kernel.DTYPES[_LETTERS[kind.dtype]]
    letter, order = (_field(builder, about, at, ir.IntType(8)) for at in (_kernel.LETTER, _kernel.ORDER))
    size = _field(builder, about, _kernel.SIZE, _WORD)
    axes = builder.icmp_unsigned("==", _field(builder, array, _kernel.AXES, _INT), _INT(kind.ndim))
    has_order = builder.icmp_unsigned("==", flags, _INT(_kernel.ORDERED))
    has_letter = builder.icmp_unsigned("==", letter, letter.type(ord(numbers.kind)))
    has_size = builder.icmp_unsigned("==", size, _WORD(numbers.itemsize))
    native = builder.icmp_unsigned("!=", order, order.type(ord(">")))
    return functools.reduce(builder.and_, [axes, has_order, has_letter, has_size, native])


def _value(context: Any, builder: Any, kind: Any, word: Callable[[], Any]) -> Any:
    """Return the value of an argument from its words."""
    if isinstance(kind, types.BaseTuple):
        return context.make_tuple(builder, kind, [_value(context, builder, each, word) for each in _parts(kind)])
    if isinstance(kind, types.Array):
        return _array_value(context, builder, kind, word())
    if kind == types.none:
        return context.get_dummy_value()
    if isinstance(kind, types.ExternalFunctionPointer):
        return builder.inttoptr(word(), context.get_value_type(kind))
    if kind == types.float64:
        return builder.bitcast(word(), ir.DoubleType())
    return builder.icmp_unsigned("!=", word(), _WORD(0)) if kind == types.boolean else word()


def _array_value(context: Any, builder: Any, kind: Any, record: Any) -> Any:
    """Return an array from the address of its record."""
    array = context.make_array(kind)(context, builder)
    data = builder.inttoptr(_field(builder, record, _kernel.DATA, _WORD), array.data.type)
    lengths = _field(builder, record, _kernel.SHAPE, _WORD)
    shape = [_field(builder, lengths, 8 * axis, _WORD) for axis in range(kind.ndim)]
    size = context.get_abi_sizeof(context.get_data_type(kind.dtype))
    strides = [_WORD(size)]
    for length in shape[:0:-1]:
        strides.insert(0, builder.mul(strides[0], length))
    populate_array(array, data, shape, strides[-kind.ndim :] if kind.ndim else [], _WORD(size), None)
    return array._getvalue()


def _results(context: Any, builder: Any, kind: Any, value: Any) -> Iterator[Any]:
    """Give the words of a result: of an array its block, which is kept, its address and its shape."""
    if isinstance(kind, types.BaseTuple):
        for each, part in zip(_parts(kind), cgutils.unpack_tuple(builder, value, len(_parts(kind))), strict=True):
            yield from _results(context, builder, each, part)
    elif isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value)
        context.nrt.incref(builder, kind, value)
        yield from (builder.ptrtoint(each, _WORD) for each in (array.meminfo, array.data))
        yield from cgutils.unpack_tuple(builder, array.shape, kind.ndim)
    elif kind != types.none:
        yield builder.zext(value, _WORD) if kind == types.boolean else value


def text_of(line: str) -> str:
    """Return the LLVM text of a line of the list."""
    name, key = line.split(" ")
    module, _, function = name.rpartition(".")
    kernel, symbol = getattr(importlib.import_module(module), function), compiled.symbol_of(name, key)
    if not isinstance(kernel, compiled.Kernel):
        return kernel(key, symbol)
    run, returns = flat(kernel, kind_of(iter(compiled.tokens(key)), _classes()))
    dispatcher: Any = numba.njit(nogil=True, error_model="numpy")(run)
    dispatcher.compile((_ADDRESS, _ADDRESS))
    (code,) = dispatcher.overloads.values()
    text = for_any_machine(code.library.get_llvm_str())
    names = {"symbol": symbol, "own": code.fndesc.llvm_func_name, "returns": returns[0], "length": len(returns[0]) + 1}
    return text + _ENTRY.format(**names)


def write_objects(line: str, folders: dict[str, Path]) -> None:
    """Compile a line of the list into objects, in the folder of each machine."""
    text, symbol = text_of(line), compiled.symbol_of(*line.split(" "))
    for name, folder in folders.items():
        for variant, processor in _processors(name).items():
            if re.search(_WORTH[variant], line):
                own = text.replace(symbol, symbol + variant)
                (folder / f"{symbol}{variant}.o").write_bytes(_object(own, name, processor, symbol))


def _processors(name: str) -> dict[str, str]:
    """Return the processors of a machine for which there is code, by the variant of its functions."""
    return _PROCESSORS.get(name, {"": "generic"})


def _object(text: str, name: str, processor: str, public: str) -> bytes:
    """Compile LLVM text for a machine; only names that begin as the public one are seen."""
    machine = machine_for(MACHINES[name][0] if name in MACHINES else llvm.get_process_triple(), processor, "pic")
    return emit_object(text, _RUNTIME, machine, str(machine.target_data), lambda name: name.startswith(public))


@functools.cache
def _classes() -> dict[str, Any]:
    """Return the named tuples of all kernels by their names."""
    classes: dict[str, Any] = {}
    abouts = pkgutil.walk_packages([str(_KERNELS)], "nonholo.kernels.")
    for module in (about.name for about in abouts if "-" not in about.name):  # a library of another text is none
        for name, each in vars(importlib.import_module(module)).items():
            if isinstance(each, type) and issubclass(each, tuple) and classes.setdefault(name, each) is not each:
                raise NameError(f"Two named tuples of kernels are called {name}.")
    return classes


def lines() -> list[str]:
    """Return the list of what is compiled."""
    return (_KERNELS / "ahead.txt").read_text(encoding="utf-8").split("\n")[:-1]


def linker(name: str) -> list[str]:
    """Return the command that links for a machine, by the package `ziglang` where that is not this Linux machine."""
    is_here = name == this_machine() and name.startswith("linux")
    own = next(filter(None, map(shutil.which, ("ld", "ld.lld"))), None) if is_here else None
    return [own] if own else [sys.executable, "-m", "ziglang", "cc", *MACHINES.get(name, ("", _NAKED))[1]]


def build(target: Path, *names: str) -> None:
    """Compile and link the libraries of machines, and the modules of pages, into a folder.

    Raises:
        ValueError: A machine is neither this one nor one of `MACHINES`.
    """
    if unknown := {*names}.difference(MACHINES, (this_machine(),)):
        raise ValueError(f"A machine must be one of {', '.join(MACHINES)}. Got {', '.join(unknown)}.")
    os.environ["NONHOLO_KERNELS"] = "numba"
    target.mkdir(parents=True, exist_ok=True)
    context, runs = multiprocessing.get_context("spawn"), importlib.import_module("nonholo.kernels").FLAT_RUNS
    with tempfile.TemporaryDirectory() as scratch, concurrent.futures.ProcessPoolExecutor(mp_context=context) as pool:
        for run, content in zip(runs, pool.map(wasm.module, runs), strict=True):
            (target / name_of_module(run)).write_bytes(content)
        folders = {name: Path(tempfile.mkdtemp(dir=scratch)) for name in names or (this_machine(),)}
        for count, _ in enumerate(pool.map(write_objects, lines(), itertools.repeat(folders)), 1):
            if sys.stderr.isatty():
                print(f"\rkernels compiled: {count} of {len(lines())}", end="", file=sys.stderr)  # noqa: T201
        for name, folder in folders.items():
            file = folder / "release.o"
            file.write_bytes(_object("", name, _processors(name)[""], "nonholo_release"))
            output, part = folder / "library", target / f".{os.getpid()}.part"
            objects = map(str, sorted(folder.glob("*.o")))
            subprocess.run([*linker(name), "-shared", "-s", "-o", str(output), *objects], check=True)  # noqa: S603
            shutil.copy(output, part)
            part.replace(target / name_of_library(name))  # in one go: runs from an old one continue


if __name__ == "__main__":
    build(Path(sys.argv[1]), *sys.argv[2:])
