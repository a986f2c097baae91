r"""The compiled loops of kernels as WebAssembly: the same functions for another processor.

numba types and lowers them as it does for this one; llvmlite, which numba brings, turns the intermediate code into an
object for wasm32, and `module_of` makes that a module that can be instantiated. Arithmetic is strict on both sides,
and a module may import no function, so its numbers are those of Python to the last bit. Arrays are made in the first
48 KiB of the memory (`webassembly.ll`).

An export section is all that an object with one global function lacks. Its indices already belong to the object's
tables; what a linker would change are addresses of data and of functions in tables, and calls of functions elsewhere.
An object that has any of these is refused.

Reference: the binary format of WebAssembly, and "tool-conventions/Linking.md" for the custom section "linking".
"""

import importlib
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numba
from numba import types

from nonholo.base.compiled.by_numba import kept_bytes
from nonholo.base.compiled.emission import emit_object, for_any_machine, machine_for

_RUNTIME = Path(__file__).with_name("webassembly.ll")
_OPTIONS: Any = {"nopython": True, "error_model": "numpy"}
_ADDRESS = types.CPointer(types.float64)
_SIGNATURE = types.int64(_ADDRESS, _ADDRESS, types.int64, _ADDRESS, _ADDRESS, _ADDRESS)
# numba optimizes for the processor of this machine, so that stores of exceptions are merged on some, not on others
_CHOICE = r"(?ms)^( *(%\S+) = phi ptr (?:\[ @\.const\.picklebuf\.\S+, \S+ \],? ?)+\n(?:(?!^\}).)*?)^ *store ptr \2,.*?$"
_RAISES = r"(?m)^ *(?:store ptr @\.const\.picklebuf\.|call void @numba_gil_ensure\().*$"


def module(run: str) -> bytes:
    """Return the module of one of `nonholo.kernels.FLAT_RUNS`, compiled once and then kept on disk."""
    function = importlib.import_module("nonholo.kernels").FLAT_RUNS[run]()
    return kept_bytes(function, f"wasm32 {run}", lambda: module_of(_object(function)))


def _object(function: Any) -> bytes:
    """Return a relocatable object with one global function."""
    code = numba.cfunc(_SIGNATURE, **_OPTIONS)(function)
    text = re.sub(_CHOICE, r"\1  call void @raise()", for_any_machine(code.inspect_llvm()))
    text = re.sub(_RAISES, "  call void @raise()", text)
    machine = machine_for("wasm32-unknown-unknown", "generic", "static")
    # places in structures are numbers already, and those of 64 bits: addresses stand where they would there
    layout = str(machine.target_data).replace("p:32:32", "p:32:64")
    text = f"{text}\ndeclare void @raise() noreturn\n"
    return emit_object(text, _RUNTIME, machine, layout, lambda name: name == code.native_name)


_CUSTOM, _IMPORT, _EXPORT, _ELEMENT, _DATA = 0, 2, 7, 9, 11
_FUNCTION, _DATA_SYMBOL, _SECTION_SYMBOL = 0, 1, 3
_LOCAL, _UNDEFINED, _EXPLICIT_NAME = 0x2, 0x10, 0x40
_SYMBOL_TABLE = 8
_HEAD = 8  # bytes: the magic number and the version
_HOST = (b"__linear_memory", b"__stack_pointer", b"__indirect_function_table")


class _Reader:
    """Bytes that are read one after another."""

    def __init__(self, content: bytes) -> None:
        self.content, self.place = content, 0

    def number(self) -> int:
        """Return the next unsigned number in LEB128."""
        value = shift = 0
        while True:
            byte = self.content[self.place]
            self.place += 1
            value |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                return value

    def block(self) -> bytes:
        """Return the next bytes, whose number comes before them."""
        size = self.number()
        self.place += size
        return self.content[self.place - size : self.place]

    @property
    def is_at_end(self) -> bool:
        """Whether nothing is left."""
        return self.place >= len(self.content)


def module_of(content: bytes, name: bytes = b"run") -> bytes:
    """Return the module of an object, which exports its one global function under a name.

    Raises:
        ValueError: The object has data, tables of functions, calls of functions elsewhere, or not one global function.
    """
    sections = list(_sections(content))
    export = _encode(1) + _encode(len(name)) + name + bytes([_FUNCTION]) + _encode(_only_function(sections))
    parts = [(kind, block) for kind, block in sections if kind != _CUSTOM]
    parts.insert(sum(kind < _EXPORT for kind, _ in parts), (_EXPORT, export))
    return content[:_HEAD] + b"".join(bytes([kind]) + _encode(len(block)) + block for kind, block in parts)


def _only_function(sections: list[tuple[int, bytes]]) -> int:
    """Return the index of the one function that others may call, of an object that needs nothing else."""
    functions = [index for kind, block in sections if kind == _CUSTOM for index in _global_functions(block)]
    elsewhere = {name for kind, block in sections if kind == _IMPORT for name in _imports(block)}
    missing = elsewhere.difference(_HOST).union(kind for kind, _ in sections if kind in (_ELEMENT, _DATA))
    if len(functions) != 1 or missing:
        raise ValueError(f"The object needs a linker. Got {functions=}, {missing=}.")
    return functions[0]


def _sections(content: bytes) -> Iterator[tuple[int, bytes]]:
    reader = _Reader(content)
    reader.place = _HEAD
    while not reader.is_at_end:
        kind = reader.number()
        yield kind, reader.block()


def _imports(block: bytes) -> Iterator[bytes]:
    """Yield the names of what is imported."""
    reader = _Reader(block)
    for _ in range(reader.number()):
        reader.block()
        yield reader.block()
        kind = reader.number()
        if kind == 0:
            reader.number()
        elif kind == 3:  # a global: its type, and whether it changes
            reader.place += 2
        else:
            reader.place += kind == 1  # the type of a table's elements
            has_bound = reader.number()
            for _ in range(1 + has_bound % 2):
                reader.number()


def _global_functions(block: bytes) -> Iterator[int]:
    """Yield the indices of the functions that others may call, where a custom section has a symbol table."""
    reader = _Reader(block)
    if reader.block() != b"linking":
        return
    reader.number()
    while not reader.is_at_end:
        kind = reader.number()
        table = _Reader(reader.block())
        if kind == _SYMBOL_TABLE:
            for _ in range(table.number()):
                index, flags = _symbol(table)
                if index is not None and not flags & (_UNDEFINED | _LOCAL):
                    yield index


def _symbol(table: _Reader) -> tuple[int | None, int]:
    """Return the index of a function, None for another symbol, and the flags."""
    kind, flags = table.number(), table.number()
    if kind == _DATA_SYMBOL:
        table.block()
        for _ in range(0 if flags & _UNDEFINED else 3):
            table.number()
        return None, flags
    index = table.number()
    if kind != _SECTION_SYMBOL and (not flags & _UNDEFINED or flags & _EXPLICIT_NAME):
        table.block()
    return (index if kind == _FUNCTION else None), flags


def _encode(value: int) -> bytes:
    """Return a number in LEB128."""
    out = bytearray()
    while value >= 0x80:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*out, value])
