"""Functions of users that numba compiled, as addresses that compiled code calls."""

import functools
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload
from numba.np.numpy_support import carray

from nonholo.kernels._scalar import INLINED
from nonholo.kernels.forced._driven import function_at

_ROW = types.CPointer(types.float64)
_SIGNATURE = types.void(types.float64, _ROW, _ROW, _ROW)


@intrinsic
def _call(typing: Any, address: Any, time: Any, g: Any, w: Any, out: Any) -> Any:
    """Call the function at an address, with pointers to arrays."""
    del typing

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        number = ir.DoubleType()
        kind = ir.FunctionType(ir.VoidType(), [number] + 3 * [number.as_pointer()])
        data = (
            context.make_array(each)(context, builder, array).data
            for each, array in zip(signature.args[2:], arguments[2:], strict=True)
        )
        builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), [arguments[1], *data])
        return context.get_dummy_value()

    return types.void(address, time, g, w, out), code


@overload(function_at, jit_options=INLINED, strict=False)
def _compiled_function_at(address: Any, time: Any, g: Any, w: Any, out: Any) -> Any:
    return lambda address, time, g, w, out: _call(address, time, g, w, out)  # pyright: ignore


@functools.cache
def function_of(function: Any, shape: tuple[int, int], arguments: int) -> int:
    """Return the address of a function that numba compiled, of time, pose and velocity or of a pose alone.

    Where it raises, or returns another number of numbers, what it writes is NaN. It is kept as long as the process.
    """
    size, dim = shape

    if arguments == 1:

        @numba.cfunc(_SIGNATURE)
        def call(time: Any, g: Any, w: Any, out: Any) -> None:  # pyright: ignore
            found = carray(out, dim)
            found[0] = np.nan
            found[0] = function(carray(g, (size, size)))

    else:

        @numba.cfunc(_SIGNATURE)
        def call(time: Any, g: Any, w: Any, out: Any) -> None:
            found = carray(out, dim)
            found[:] = np.nan
            value = function(time, carray(g, (size, size)), carray(w, dim))
            if len(value) == dim:
                for i in range(dim):
                    found[i] = value[i]

    _KEPT.append(call)
    return int(call.address or 0)


_KEPT: list[Any] = []
"""Functions whose addresses are known."""
