"""How numba compiles calls of expansions, which are addresses."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload

from nonholo.kernels._scalar import INLINED
from nonholo.kernels.taylor._compiled import call


@intrinsic
def _call(_: Any, address: Any, velocities: Any, factors: Any, series: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pairs = zip(signature.args[1:], arguments[1:], strict=True)
        arrays = [context.make_array(kind)(context, builder, array) for kind, array in pairs]
        rows, order = builder.extract_value(arrays[2].shape, 0), ir.IntType(64)
        function = ir.FunctionType(ir.VoidType(), [arrays[0].data.type] * 3 + [order]).as_pointer()
        data = [*(array.data for array in arrays), builder.sub(rows, ir.Constant(order, 1))]
        builder.call(builder.inttoptr(arguments[0], function), data)
        return context.get_dummy_value()

    return types.void(address, velocities, factors, series), code


@overload(call, jit_options=INLINED, strict=False)
def _compiled_call(address: Any, velocities: Any, factors: Any, series: Any) -> Any:
    return lambda address, velocities, factors, series: _call(address, velocities, factors, series)  # pyright: ignore
