"""How numba compiles calls of addresses: of functions of users that it compiled, and of expansions of series."""

import functools
from collections.abc import Iterable
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload
from numba.np.numpy_support import carray

from nonholo.kernels._scalar import INLINED, expand_at, function_at

_ROW = types.CPointer(types.float64)
_SIGNATURE = types.void(types.float64, _ROW, _ROW, _ROW)


def _run(context: Any, builder: Any, address: Any, values: list[Any], arrays: Iterable[tuple[Any, Any]]) -> Any:
    """Write the call of the code at an address, of values where None stands for the data of the next array."""
    data = (context.make_array(kind)(context, builder, array).data for kind, array in arrays)
    values = [next(data) if value is None else value for value in values]
    kind = ir.FunctionType(ir.VoidType(), [value.type for value in values])
    builder.call(builder.inttoptr(address, kind.as_pointer()), values)
    return context.get_dummy_value()


@intrinsic
def _call_function(_: Any, address: Any, time: Any, g: Any, w: Any, out: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        arrays = zip(signature.args[2:], arguments[2:], strict=True)
        return _run(context, builder, arguments[0], [arguments[1], None, None, None], arrays)

    return types.void(address, time, g, w, out), code


@overload(function_at, jit_options=INLINED, strict=False)
def _compiled_function_at(address: Any, time: Any, g: Any, w: Any, out: Any) -> Any:
    return lambda address, time, g, w, out: _call_function(address, time, g, w, out)  # pyright: ignore


@intrinsic
def _call_expansion(_: Any, address: Any, arrays: Any, order: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kinds = signature.args[1].types
        each = ((kind, builder.extract_value(arguments[1], n)) for n, kind in enumerate(kinds))
        return _run(context, builder, arguments[0], [*[None] * len(kinds), arguments[2]], each)

    return types.void(address, arrays, order), code


@overload(expand_at, jit_options=INLINED, strict=False)
def _compiled_expand_at(address: Any, arrays: Any, order: Any) -> Any:
    return lambda address, arrays, order: _call_expansion(address, arrays, order)  # pyright: ignore


@functools.cache
def function_of(function: Any, shape: tuple[int, int], arguments: int) -> int:
    """Return the address of a function that numba compiled, of time, pose and velocity or of a pose alone.

    Where it raises, or returns another number of numbers, what it writes is NaN. It is kept as long as the process.
    """
    size, dim = shape

    if arguments == 1:

        @numba.cfunc(_SIGNATURE)
        def call(time: Any, g: Any, w: Any, out: Any) -> None:  # pyright: ignore
            target = carray(out, dim)
            target[0] = np.nan
            target[0] = function(carray(g, (size, size)))

    else:

        @numba.cfunc(_SIGNATURE)
        def call(time: Any, g: Any, w: Any, out: Any) -> None:
            target = carray(out, dim)
            target[:] = np.nan
            value = function(time, carray(g, (size, size)), carray(w, dim))
            if len(value) == dim:
                for i in range(dim):
                    target[i] = value[i]

    _KEPT.append(call)
    return int(call.address or 0)


_KEPT: list[Any] = []
"""Functions whose addresses are known."""
