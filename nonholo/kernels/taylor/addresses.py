"""How numba compiles calls of expansions, which are addresses."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload

from nonholo.kernels._scalar import INLINED
from nonholo.kernels.taylor._compiled import call


@intrinsic
def _call(_: Any, address: Any, arrays: Any, order: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        parts = enumerate(signature.args[1].types)
        arrays = (
            context.make_array(kind)(context, builder, builder.extract_value(arguments[1], n)) for n, kind in parts
        )
        data = [*(array.data for array in arrays), arguments[2]]
        function = ir.FunctionType(ir.VoidType(), [each.type for each in data]).as_pointer()
        builder.call(builder.inttoptr(arguments[0], function), data)
        return context.get_dummy_value()

    return types.void(address, arrays, order), code


@overload(call, jit_options=INLINED, strict=False)
def _compiled_call(address: Any, arrays: Any, order: Any) -> Any:
    return lambda address, arrays, order: _call(address, arrays, order)  # pyright: ignore
