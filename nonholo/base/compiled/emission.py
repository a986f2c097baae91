"""Objects for processors, of the LLVM text that numba makes of kernels."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm

_OF_THIS_MACHINE = r'(?m)"(?:target-cpu|target-features|probe-stack)"="[^"]*"|^target (?:triple|datalayout) = .*$'
_COUNTS = r"(?ms)^define [^\n]*(@NRT_(?:in|de)cref)\(.*?^}$"  # of arrays, in instructions of this machine


def for_any_machine(text: str) -> str:
    """Return LLVM text without what it says of the processor that numba compiled it for."""
    return re.sub(_COUNTS, r"declare void \1(ptr)", re.sub(_OF_THIS_MACHINE, "", text))


def machine_for(triple: str, processor: str, reloc: str) -> llvm.TargetMachine:
    """Return what makes objects for a processor."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    return llvm.Target.from_triple(triple).create_target_machine(cpu=processor, opt=3, reloc=reloc)


def compile_text(text: str, name: str) -> int:
    """Return the address of a function of LLVM text, compiled for this processor."""
    return load_object(object_of(text), name)[0]


def object_of(text: str, *, search: int = 2, passes: int = 1) -> bytes:
    """Return the object of LLVM text for this processor, by levels of the search for better instructions and of passes.

    Nothing in it is reordered or fused: as with numba, arithmetic is strict. Passes of level 0 only copy functions into
    their callers where the text demands it.
    """
    machine, code = _this_machine(opt=search), llvm.parse_assembly(text)
    _optimize(code, machine, passes)
    return machine.emit_object(code)


def load_object(binary: bytes, *names: str) -> list[int]:
    """Return the addresses of functions of an object, which stay as long as the process."""
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _this_machine())
    engine.add_object_file(llvm.ObjectFileRef.from_data(binary))
    engine.finalize_object()
    _KEPT.append(engine)
    return [engine.get_function_address(name) for name in names]


def this_processor() -> dict[str, str]:
    """Return the name and the features of the processor, as LLVM knows them."""
    return {"cpu": llvm.get_host_cpu_name(), "features": llvm.get_host_cpu_features().flatten()}


def _this_machine(**options: Any) -> llvm.TargetMachine:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_triple(llvm.get_process_triple())
    return target.create_target_machine(**this_processor(), jit=True, **options)


_KEPT: list[Any] = []
"""The engines that own compiled functions."""


def _optimize(code: llvm.ModuleRef, machine: llvm.TargetMachine, level: int) -> None:
    passes = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=level))
    passes.getModulePassManager().run(code, passes)


def emit_object(
    text: str, runtime: Path, machine: llvm.TargetMachine, layout: str, is_public: Callable[[str], bool]
) -> bytes:
    """Return the object of LLVM text and the runtime that it asks; only public names are seen from outside."""
    code = llvm.parse_assembly(text)
    code.link_in(llvm.parse_assembly(runtime.read_text(encoding="utf-8")))
    code.triple, code.data_layout = machine.triple, layout
    for item in (*code.functions, *code.global_variables):
        if not item.is_declaration and not is_public(item.name):
            item.linkage = "internal"
    _optimize(code, machine, 2)
    return machine.emit_object(code)
