"""JAX programs as formulas: arrays become arrays of single numbers, and each primitive acts on these.

Gather and scatter with constant indices select the numbers of an array that windows hold. The meaning of their
dimension numbers: https://openxla.org/xla/operation_semantics, "Gather" and "Scatter".
"""

import functools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from jax.lax import GatherScatterMode, RoundingMethod

from nonholo.lagrange_dalembert.compiled._scalars import LOGIC, OPERATIONS, TRUTHS, Formulas, UntranslatableError
from nonholo.lagrange_dalembert.functions import LOOK_UP

_CALLS = {"jit", "pjit", "closed_call", "remat", "checkpoint", "custom_jvp_call", "custom_vjp_call"}
_KINDS = {
    "f": set(OPERATIONS),
    "b": {*LOGIC, "eq", "ne"},
    "i": {"add", "sub", "mul", "neg", "max", "min", *TRUTHS} - LOGIC,
}

Rule = Callable[..., Any]
"""Maps formulas, arrays of numbers and the parameters of a primitive, by name, to its result."""


def translate(f: Formulas, program: Any, arguments: list[np.ndarray]) -> list[np.ndarray]:
    """Return the results of a JAX program of arrays of numbers."""
    jaxpr = getattr(program, "jaxpr", program)
    values = dict(zip(jaxpr.invars, arguments, strict=True))
    for variable, constant in zip(jaxpr.constvars, getattr(program, "consts", ()), strict=True):
        values[variable] = _constants(f, constant)

    def read(atom: Any) -> np.ndarray:
        return _constants(f, atom.val) if hasattr(atom, "val") else values[atom]

    for step in jaxpr.eqns:
        values |= dict(zip(step.outvars, _applied(f, step, [read(atom) for atom in step.invars]), strict=True))
    return [read(atom) for atom in jaxpr.outvars]


def _applied(f: Formulas, step: Any, arguments: list[np.ndarray]) -> list[np.ndarray]:
    name, parameters = step.primitive.name, step.params
    if name in _CALLS:
        return _results_of_call(f, arguments, **parameters)
    if name == "cond":
        return translate(f, parameters["branches"][constants_of(arguments[0]).item()], arguments[1:])
    if name not in _TABLE or (name in OPERATIONS and name not in _KINDS.get(step.invars[0].aval.dtype.kind, ())):
        raise UntranslatableError(name)
    kind = {"old": step.invars[0].aval.dtype.kind} if name == "convert_element_type" else {}
    result = _TABLE[name](f, *arguments, **parameters, **kind)
    return [np.asarray(each, dtype=object) for each in (result if step.primitive.multiple_results else [result])]


def _results_of_call(f: Formulas, arguments: list[np.ndarray], name: str = "", **parameters: Any) -> list[np.ndarray]:
    """Return the results of a program that is called; rows of tables are looked up where these stand."""
    if name == LOOK_UP:
        return [_look_up(f, *arguments)]
    inner = next(parameters[key] for key in ("jaxpr", "call_jaxpr", "fun_jaxpr") if key in parameters)
    return translate(f, inner, arguments)


def _look_up(f: Formulas, table: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Return the row of a step of a table, whose first number is its address."""
    place, length = (table.item(0), step.item()), table.shape[1]
    columns = (f.constant(float(column)) for column in range(length))
    return array_of([f("look", *place, column, f.constant(float(length))) for column in columns], (length,))


def _constants(f: Formulas, value: Any) -> np.ndarray:
    return array_of([f.constant(each) for each in np.ravel(value)], np.shape(value))


def _each(operation: Callable[..., Any], *arrays: np.ndarray) -> np.ndarray:
    return np.frompyfunc(operation, len(arrays), 1)(*arrays)


def _numberwise(formula: Callable[..., Any]) -> Rule:
    """Return the rule of a formula(f, *numbers) that acts on each number of arrays."""
    return lambda f, *arrays, **_: _each(functools.partial(formula, f), *arrays)


def _sign(f: Formulas, x: Any) -> Any:
    zero = f.constant(0.0)
    not_positive = f("select", f("lt", x, zero), x, f.constant(-1.0))  # zeros and NaN stay what they are
    return f("select", f("gt", x, zero), not_positive, f.constant(1.0))


def _power(f: Formulas, x: np.ndarray, *, y: int, **_: Any) -> np.ndarray:
    """Return integer powers by repeated squaring."""

    def power(base: Any, exponent: int) -> Any:
        if exponent < 0:
            return f("div", f.constant(1.0), power(base, -exponent))
        square = power(f("mul", base, base), exponent // 2) if exponent > 1 else f.constant(1.0)
        return f("mul", square, base) if exponent % 2 else square

    return _each(lambda number: power(number, y), x)


def _round(f: Formulas, x: np.ndarray, *, rounding_method: Any) -> np.ndarray:
    if rounding_method != RoundingMethod.TO_NEAREST_EVEN:
        raise UntranslatableError("round half away from zero")
    return _each(functools.partial(f, "rint"), x)


def _convert(f: Formulas, x: np.ndarray, *, old: str, new_dtype: Any, **_: Any) -> np.ndarray:
    name = np.dtype(new_dtype).name
    if name == "float64":
        return _each(lambda x: f("float", x) if x.is_truth or x.value is not None else x, x)
    if old in "bi" and old == np.dtype(new_dtype).kind:
        return x
    if name not in ("bool", "int32", "int64"):
        raise UntranslatableError(name)
    return _constants(f, constants_of(x).astype(name))


def _choose(f: Formulas, which: Any, *cases: Any) -> np.ndarray:
    if len(cases) != 2:
        raise UntranslatableError("a choice of many")
    return _each(functools.partial(f, "select"), which, *cases)


def _reduction(name: str, of_none: float) -> Rule:
    """Take the numbers along axes one after another, in rising order; `of_none` is the value of none."""

    def reduce(f: Formulas, x: np.ndarray, *, axes: Any, **_: Any) -> np.ndarray:
        arrange = np.moveaxis(x, axes, range(-len(axes), 0))
        shape = arrange.shape[: x.ndim - len(axes)]
        rows = arrange.reshape(math.prod(shape), math.prod(arrange.shape[len(shape) :]))
        none = [] if rows.shape[1] else [f.constant(of_none)]
        return array_of([functools.reduce(functools.partial(f, name), row, *none) for row in rows], shape)

    return reduce


_sum = _reduction("add", 0.0)


def _cumulate(f: Formulas, x: np.ndarray, *, axis: int, reverse: bool) -> np.ndarray:
    forward = np.flip(x, axis) if reverse else x
    sums = np.frompyfunc(functools.partial(f, "add"), 2, 1).accumulate(forward, axis=axis)
    return np.flip(sums, axis) if reverse else sums


def _product(f: Formulas, x: np.ndarray, y: np.ndarray, *, dimension_numbers: Any, **_: Any) -> np.ndarray:
    (along_x, along_y), (batch_x, batch_y) = dimension_numbers

    def columns(array: np.ndarray, batch: Any, along: Any) -> tuple[np.ndarray, list[tuple[int, ...]]]:
        free = [axis for axis in range(array.ndim) if axis not in (*batch, *along)]
        shapes = [tuple(array.shape[axis] for axis in axes) for axes in (batch, free, along)]
        return array.transpose([*batch, *free, *along]).reshape(list(map(math.prod, shapes))), shapes

    (a, shapes), (b, others) = columns(x, batch_x, along_x), columns(y, batch_y, along_y)
    terms = _each(functools.partial(f, "mul"), a[:, :, None], b[:, None])
    return _sum(f, terms, axes=(3,)).reshape(shapes[0] + shapes[1] + others[1])


def _broadcast(_f: Formulas, x: np.ndarray, *, shape: Any, broadcast_dimensions: Any, **_: Any) -> np.ndarray:
    sizes = dict(zip(broadcast_dimensions, x.shape, strict=True))
    return np.broadcast_to(x.reshape([sizes.get(axis, 1) for axis in range(len(shape))]), shape)


def _pad(_f: Formulas, x: np.ndarray, value: np.ndarray, *, padding_config: Any) -> np.ndarray:
    """Return an array between copies of a value; where there are less than none of them, it is cut."""
    low, high, inner = np.reshape(padding_config, (-1, 3)).astype(int).T
    begin = np.maximum(low, 0)
    end = begin + np.maximum(np.array(x.shape) + (np.array(x.shape) - 1) * inner, 0)
    result = np.full(end + np.maximum(high, 0), value.item(), dtype=object)
    result[tuple(map(slice, begin, end, inner + 1))] = x
    return result[tuple(map(slice, begin - low, np.array(result.shape) + np.minimum(high, 0)))]


def _platform(f: Formulas, *, platforms: Any) -> np.ndarray:
    return _constants(f, next(i for i, names in enumerate(platforms) if names is None or "cpu" in names))


def _window(x: np.ndarray, starts: Any, sizes: Any) -> tuple[slice, ...]:
    corner = np.clip([int(constants_of(each)) for each in starts], 0, np.subtract(x.shape, sizes))
    return tuple(map(slice, corner, corner + sizes))


def _paste(_f: Formulas, x: np.ndarray, part: np.ndarray, *starts: np.ndarray) -> np.ndarray:
    result = x.copy()
    result[_window(x, starts, part.shape)] = part
    return result


def array_of(numbers: list[Any], shape: tuple[int, ...]) -> np.ndarray:
    """Return numbers in an array with a shape."""
    result = np.empty(len(numbers), dtype=object)
    result[:] = numbers
    return result.reshape(shape)


def constants_of(array: np.ndarray) -> Any:
    """Return the values of an array of constants."""
    values = [each.value for each in array.ravel()]
    if None in values:
        raise UntranslatableError("an index that is computed")
    return np.array(values).reshape(array.shape)


def _greatest(f: Formulas, x: np.ndarray, *, axes: Any, **_: Any) -> np.ndarray:
    """Return the indices of the first of the greatest numbers along an axis."""
    best, *others = np.moveaxis(x, axes[0], 0)
    result = np.full_like(best, f.constant(0))
    for index, row in enumerate(others, 1):
        above = _each(functools.partial(f, "gt"), row, best)
        best, result = (_choose(f, above, *pair) for pair in ((best, row), (result, f.constant(index))))
    return result


def gather(
    f: Formulas, x: np.ndarray, indices: np.ndarray, *, dimension_numbers: Any, slice_sizes: Any, mode: Any, **_: Any
) -> np.ndarray:
    """Return the numbers of windows of an array; an index that is computed chooses among those of all its values."""
    d, batch = dimension_numbers, indices.ndim - 1
    at = next((at for at in np.ndindex(indices.shape) if indices.item(at).value is None), None)
    if at and mode == GatherScatterMode.PROMISE_IN_BOUNDS:
        rest, axis = {"dimension_numbers": d, "slice_sizes": slice_sizes, "mode": mode}, d.start_index_map[at[-1]]
        cases = []
        for value in map(f.constant, range(x.shape[axis] - slice_sizes[axis] + 1)):
            constants = indices.copy()
            constants[at] = value
            cases.append((f("eq", indices.item(at), value), gather(f, x, constants, **rest)))
        return functools.reduce(lambda result, case: _choose(f, case[0], result, case[1]), cases, cases[0][1])
    batching = d.operand_batching_dims, d.start_indices_batching_dims
    places = _places(x.shape, constants_of(indices), d.start_index_map, batching, slice_sizes, mode)
    unit_axes = (*d.collapsed_slice_dims, *d.operand_batching_dims)
    result = np.squeeze(x.ravel()[places], tuple(batch + axis for axis in unit_axes))
    return np.moveaxis(result, range(batch, result.ndim), d.offset_dims)


def scatter(
    f: Formulas,
    x: np.ndarray,
    indices: np.ndarray,
    updates: np.ndarray,
    *,
    dimension_numbers: Any,
    mode: Any,
    adds: bool = False,
    **_: Any,
) -> np.ndarray:
    """Return an array with windows replaced, or with numbers added to them."""
    d, batch, numbers = dimension_numbers, indices.ndim - 1, x.ravel().tolist()
    unit_axes, windows = (*d.inserted_window_dims, *d.operand_batching_dims), iter(d.update_window_dims)
    sizes = [1 if axis in unit_axes else updates.shape[next(windows)] for axis in range(x.ndim)]
    batching = d.operand_batching_dims, d.scatter_indices_batching_dims
    places = _places(x.shape, constants_of(indices), d.scatter_dims_to_operand_dims, batching, sizes, mode)
    rows = np.moveaxis(updates, d.update_window_dims, range(batch, updates.ndim))
    for place, number in zip(places.ravel().tolist(), rows.ravel().tolist(), strict=True):
        numbers[place] = f("add", numbers[place], number) if adds else number
    return array_of(numbers, x.shape)


def _places(
    shape: tuple[int, ...], indices: np.ndarray, axes: Any, batching: tuple[Any, Any], sizes: Any, mode: Any
) -> np.ndarray:
    """Return the flat places of windows of these sizes, whose corners have the indices along axes."""
    batch = indices.shape[:-1]
    corners = np.zeros((*batch, len(shape)), dtype=int)
    corners[..., list(axes)] = indices
    for axis, along in zip(*batching, strict=True):
        corners[..., axis] = np.indices(batch)[along]
    inside = np.clip(corners, 0, np.array(shape) - sizes)
    if mode != GatherScatterMode.CLIP and not np.array_equal(inside, corners):
        raise UntranslatableError("an index out of bounds")
    offsets = np.moveaxis(np.indices(tuple(sizes)), 0, -1)
    windows = inside.reshape(*batch, *(1 for _ in shape), len(shape)) + offsets
    return np.asarray(np.ravel_multi_index(tuple(np.moveaxis(windows, -1, 0)), shape))


_TABLE: dict[str, Rule] = {
    **{name: _numberwise(lambda f, *numbers, name=name: f(name, *numbers)) for name in OPERATIONS},
    "add_any": _numberwise(lambda f, x, y: f("add", x, y)),
    "square": _numberwise(lambda f, x: f("mul", x, x)),
    "rsqrt": _numberwise(lambda f, x: f("div", f.constant(1.0), f("sqrt", x))),
    "clamp": _numberwise(lambda f, least, x, most: f("min", f("max", x, least), most)),
    "is_finite": _numberwise(lambda f, x: f("eq", f("sub", x, x), f.constant(0.0))),
    "sign": _numberwise(_sign),
    "logistic": _numberwise(lambda f, x: f("div", f.constant(1.0), f("add", f.constant(1.0), f("exp", f("neg", x))))),
    **dict.fromkeys(("copy", "stop_gradient"), _numberwise(lambda _f, x: x)),
    "integer_pow": _power,
    "round": _round,
    "select_n": _choose,
    "convert_element_type": _convert,
    "reduce_sum": _sum,
    "reduce_prod": _reduction("mul", 1.0),
    "reduce_max": _reduction("max", -math.inf),
    "reduce_min": _reduction("min", math.inf),
    "argmax": _greatest,
    "cumsum": _cumulate,
    "dot_general": _product,
    "iota": lambda f, *, dtype, shape, dimension, **_: _constants(f, np.indices(shape, dtype)[dimension]),
    "platform_index": _platform,
    "broadcast_in_dim": _broadcast,
    "pad": _pad,
    "gather": gather,
    "scatter": scatter,
    "scatter-add": functools.partial(scatter, adds=True),
    "dynamic_update_slice": _paste,
    "dynamic_slice": lambda _f, x, *starts, slice_sizes: x[_window(x, starts, slice_sizes)],
    "slice": lambda _f, x, *, start_indices, limit_indices, strides: x[
        tuple(map(slice, start_indices, limit_indices, strides or (1,) * x.ndim))
    ],
    "split": lambda _f, x, *, sizes, axis: np.split(x, np.cumsum(sizes)[:-1], axis),
    "reshape": lambda _f, x, *, new_sizes, **_: x.reshape(new_sizes),
    "squeeze": lambda _f, x, *, dimensions: np.squeeze(x, dimensions),
    "expand_dims": lambda _f, x, *, dimensions: np.expand_dims(x, dimensions),
    "transpose": lambda _f, x, *, permutation: x.transpose(permutation),
    "rev": lambda _f, x, *, dimensions: np.flip(x, dimensions),
    "concatenate": lambda _f, *arrays, dimension: np.concatenate(arrays, dimension),
    "unstack": lambda _f, x, *, axis: list(np.moveaxis(x, axis, 0)),
    "stack": lambda _f, *arrays, axis: np.stack(arrays, axis),
}
DIFFERENTIABLE = {*_TABLE, "jit", "pjit"} - {"scatter", "platform_index"}
"""Operations that JAX differentiates wherever they stand; of others it depends on their arguments."""
