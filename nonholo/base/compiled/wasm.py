r"""The compiled loops of kernels as WebAssembly: the same functions for another processor.

numba types and lowers them as it does for this one; llvmlite, which numba brings, turns the intermediate code into an
object for wasm32, and `module_of` makes that a module that can be instantiated. Arithmetic is strict on both sides,
and a module may import no function, so its numbers are those of Python to the last bit. Arrays are made in the first
48 KiB of the memory (`webassembly.ll`).
"""

import importlib
import re
from pathlib import Path
from typing import Any

import numba
from numba import types

from nonholo.base.compiled.by_numba import kept_bytes
from nonholo.base.compiled.emission import emitted, for_any_machine, machine_for
from nonholo.base.compiled.webassembly import module_of

_RUNTIME = Path(__file__).with_name("webassembly.ll")
_OPTIONS: Any = {"nopython": True, "error_model": "numpy"}
_ADDRESS = types.CPointer(types.float64)
_SIGNATURE = types.int64(_ADDRESS, _ADDRESS, types.int64, _ADDRESS, _ADDRESS, _ADDRESS)
_RAISES = r"(?m)^ *store ptr @\.const\.picklebuf\..*$"


def module(run: str) -> bytes:
    """Return the module of one of `nonholo.kernels.FLAT_RUNS`, compiled once and then kept on disk."""
    function = importlib.import_module("nonholo.kernels").FLAT_RUNS[run]()
    return kept_bytes(function, f"wasm32 {run}", lambda: module_of(_object(function)))


def _object(function: Any) -> bytes:
    """Return a relocatable object with one global function."""
    made = numba.cfunc(_SIGNATURE, **_OPTIONS)(function)
    text = re.sub(_RAISES, "  call void @raise()", for_any_machine(made.inspect_llvm()))
    machine = machine_for("wasm32-unknown-unknown", "generic", "static")
    # places in structures are numbers already, and those of 64 bits: addresses stand where they would there
    layout = str(machine.target_data).replace("p:32:32", "p:32:64")
    text = f"{text}\ndeclare void @raise() noreturn\n"
    return emitted(text, _RUNTIME, machine, layout, lambda name: name == made.native_name)
