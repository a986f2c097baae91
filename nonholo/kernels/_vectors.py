"""How numba compiles numbers side by side: as vectors of the processor."""

import operator
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils, config
from numba.extending import lower_builtin, models, register_model, type_callable

from nonholo.kernels.lanes import load, spread, store


class _Row(types.Type):
    def __init__(self, lanes: int) -> None:
        self.lanes = lanes
        super().__init__(name=f"Row({lanes})")


@register_model(_Row)
class _RowModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Any) -> None:
        super().__init__(dmm, fe_type, ir.VectorType(ir.DoubleType(), fe_type.lanes))


def _kind(lanes: Any) -> Any:
    return types.float64 if lanes.count == 1 else _Row(lanes.count)


@type_callable(load)
def _type_load(_: Any) -> Any:
    return lambda _array, _row, _at, lanes: _kind(lanes)


@type_callable(store)
def _type_store(_: Any) -> Any:
    return lambda _array, _row, _at, _lanes, _value: types.none


@type_callable(spread)
def _type_spread(_: Any) -> Any:
    return lambda _value, lanes: _kind(lanes)


def _address(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    lanes, kinds = signature.args[3].count, signature.args[1:3]
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    row, at = (context.cast(builder, x, kind, types.intp) for x, kind in zip(arguments[1:3], kinds, strict=True))
    rows, length = cgutils.unpack_tuple(builder, array.shape, 2)
    first = builder.mul(at, context.get_constant(types.intp, lanes))
    if config.BOUNDSCHECK:  # pyright: ignore
        last = builder.add(first, context.get_constant(types.intp, lanes - 1))
        for axis, index, end in ((0, row, rows), (1, first, length), (1, last, length)):
            cgutils.do_boundscheck(context, builder, index, end, axis)
    place = builder.gep(array.data, [builder.add(builder.mul(row, length), first)])
    return builder.bitcast(place, context.get_value_type(_kind(signature.args[3])).as_pointer())


@lower_builtin(load, types.Array, types.Integer, types.Integer, types.UniTuple)
def _lower_load(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return builder.load(_address(context, builder, signature, arguments), align=8)


@lower_builtin(store, types.Array, types.Integer, types.Integer, types.UniTuple, types.Any)
def _lower_store(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    builder.store(arguments[4], _address(context, builder, signature, arguments), align=8)
    return context.get_dummy_value()


@lower_builtin(spread, types.Float, types.UniTuple)
@lower_builtin(spread, _Row, types.UniTuple)
def _lower_spread(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    lanes = signature.args[1].count
    if lanes == 1 or isinstance(signature.args[0], _Row):
        return arguments[0]
    nothing = ir.Constant(context.get_value_type(_Row(lanes)), ir.Undefined)
    one = builder.insert_element(nothing, arguments[0], ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(one, nothing, ir.Constant(ir.VectorType(ir.IntType(32), lanes), [0] * lanes))


def _compile(operation: Any, instruction: Any) -> None:
    """Let compiled code apply an operation to rows."""

    @type_callable(operation)
    def _type(_: Any) -> Any:
        return lambda x, y: x if isinstance(x, _Row) and x == y else None

    @lower_builtin(operation, _Row, _Row)
    def _lower(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return instruction(builder, *arguments)


for _operation, _name in ((operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul")):
    _compile(_operation, getattr(ir.IRBuilder, _name))
_compile(operator.truediv, ir.IRBuilder.fdiv)


@type_callable(abs)
def _type_abs(_: Any) -> Any:
    return lambda x: x if isinstance(x, _Row) else None


@lower_builtin(abs, _Row)
def _lower_abs(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    lanes, kind = signature.args[0].lanes, context.get_value_type(signature.args[0])
    integers = ir.VectorType(ir.IntType(64), lanes)
    no_signs = ir.Constant(integers, [(1 << 63) - 1] * lanes)
    return builder.bitcast(builder.and_(builder.bitcast(arguments[0], integers), no_signs), kind)
