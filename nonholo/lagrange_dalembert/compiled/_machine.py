"""Formulas as code of the processor, without a loop or a branch."""

import ctypes
from typing import Any

from llvmlite import ir
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target

from nonholo.lagrange_dalembert.compiled._operations import DOUBLE, OPERATIONS, TRUTH
from nonholo.lagrange_dalembert.compiled._scalars import Scalar, needed

_CALLED = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)


@global_compiler_lock
def machine_code(inputs: list[Scalar], results: list[Scalar]) -> Any:
    """Return a C function that reads inputs from its first array and writes results to its second one.

    Arithmetic is strict, as in all kernels. LLVM takes a tenth of a second for a system: nothing is kept on disk.
    """
    target: Any = cpu_target.target_context
    library = target.codegen().create_library("formulas")
    module = library.create_ir_module("formulas")
    kind = ir.FunctionType(ir.VoidType(), [DOUBLE.as_pointer()] * 2)
    function = ir.Function(module, kind, f"nonholo.formulas.{id(library)}")
    _write(ir.IRBuilder(function.append_basic_block()), function.args, inputs, results)
    library.add_ir_module(module)
    library.finalize()
    called: Any = _CALLED(library.get_pointer_to_function(function.name))
    called.memory = library  # which lives as long as the function
    return called


def _write(builder: ir.IRBuilder, arrays: Any, inputs: list[Scalar], results: list[Scalar]) -> None:
    source, target = arrays

    def at(array: Any, index: int) -> Any:
        return builder.gep(array, [ir.Constant(ir.IntType(64), index)])

    def value(each: Scalar) -> Any:
        if each.value is None:
            return values[each]
        return ir.Constant(TRUTH, int(each.value)) if each.is_truth else ir.Constant(DOUBLE, float(each.value))

    order = needed(results, inputs)
    used = {other for each in order for other in each.arguments}.union(results)
    values = {each: builder.load(at(source, i)) for i, each in enumerate(inputs) if each in used}
    for each in order:
        values[each] = OPERATIONS[each.operation].emit(builder, *map(value, each.arguments))
    for i, each in enumerate(results):
        builder.store(value(each), at(target, i))
    builder.ret_void()
