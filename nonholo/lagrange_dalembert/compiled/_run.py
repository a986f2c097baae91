"""Runs by compiled equations; what these leave open goes to JAX, step by step.

The equations of a system become C functions, made of the definitions of this room, without a loop or a branch.
"""

import functools
import itertools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from llvmlite import ir

from nonholo.base.compiled import FUNCTION
from nonholo.base.numerics import double_precision
from nonholo.base.types import Array
from nonholo.kernels import CoordinateBody, advance_coordinates, each_root, each_row, set_out_coordinates
from nonholo.lagrange_dalembert import _equations as equations
from nonholo.lagrange_dalembert import _newton
from nonholo.lagrange_dalembert.compiled._machine import code_of, write_function
from nonholo.lagrange_dalembert.compiled._scalars import Formulas, Scalar, UntranslatableError, operations_between
from nonholo.lagrange_dalembert.compiled._translation import array_of, translate
from nonholo.lagrange_dalembert.functions import ROWS

State = tuple[Any, Any, Any]


class Program(NamedTuple):
    """Formulas of a JAX function.

    Attributes:
        inputs: Its arguments, one after another.
        results: Its values, one after another.
        doubt: Not zero where the formulas may not be trusted.
        shapes: Shapes of the values.
        formulas: The maker of more of them.
    """

    inputs: list[Scalar]
    results: list[Scalar]
    doubt: Scalar
    shapes: list[tuple[int, ...]]
    formulas: Formulas


class Values(NamedTuple):
    """A C function that writes values with these shapes, and their doubt."""

    function: Any
    shapes: list[tuple[int, ...]]


def program(function: Callable[..., Any], *shapes: tuple[int, ...], varying: int = 0) -> Program:
    """Translate a function of arrays with these shapes, the last ones of which vary.

    Raises:
        UntranslatableError: It does what formulas cannot, or calls what this version of JAX calls otherwise.
    """
    f, first = Formulas(), len(shapes) - varying
    inputs = [[Scalar("input", varies=i >= first) for _ in range(math.prod(shape))] for i, shape in enumerate(shapes)]
    with double_precision():
        jaxpr = jax.make_jaxpr(function)(*(jax.ShapeDtypeStruct(shape, float) for shape in shapes))
    try:
        arrays = translate(f, jaxpr, list(map(array_of, inputs, shapes)))
    except (AttributeError, KeyError, TypeError, ValueError) as failure:
        raise UntranslatableError(repr(failure)) from failure
    doubts = sorted(f.doubts, key=lambda each: each.varies)
    doubt = functools.reduce(functools.partial(f, "add"), doubts, f.constant(0.0))
    results = [number for each in arrays for number in each.ravel()]
    return Program([x for each in inputs for x in each], results, doubt, [each.shape for each in arrays], f)


@functools.lru_cache(maxsize=64)  # a sweep makes a system for each member
def programs(family: Any, place: tuple[int, ...], n: int, *, at_node: bool = False) -> tuple[Any, Any, Any, int] | None:
    """Return the compiled equations of a step of a family of systems, with places of a shape and n velocities.

    Or, at a node, those of the velocity that belongs to a momentum: then nothing moves on arrival.

    Returns:
        The functions of `CoordinateBody`, and how many numbers `settle` writes: the border, of those that stay the
        same and are used by such that vary, or are results. None if JAX must solve them.
    """
    s = family.constraints
    equations_of = _newton.of_node if at_node else _newton.of_step

    def arrive(x: Array, v: Array, h: Array, *numbers: Array) -> tuple[Array, Array]:
        system = family.bound(*numbers)
        leaving, arriving = equations.momenta(system, x, v, h)
        return (x, leaving) if at_node else (equations.ahead(system, x, v, h), arriving)

    def correct(x: Array, p: Array, doubt: Array, near: Array, h: Array, *rest: Array) -> Any:
        *numbers, v, multipliers = rest
        unknown = equations_of(family.bound(*numbers), x, p, near, h)
        matrix, residual, units, size = unknown.in_units(v, multipliers, jnp.zeros(n + s))
        return matrix, residual, units.velocity, units.forms, size, doubt

    def write(module: ir.Module) -> int:
        own = list(map(np.shape, family.numbers_of_formulas))
        first = program(arrive, place, (n,), (), *own)
        whole = program(correct, place, (n,), (), (n,), (), *own, (n,), (s,), varying=2)
        *results, doubt = whole.results
        outputs = [*results, whole.formulas("add", doubt, whole.doubt)]
        constants, varying = ([each for each in whole.inputs if each.varies is kind] for kind in (False, True))
        operands = [x for each in operations_between(outputs, ()) if each.varies for x in each.arguments]
        border = list(dict.fromkeys(x for x in [*operands, *outputs] if not x.varies and x.value is None))
        write_function(module, "arrive", first.inputs, [*first.results, first.doubt])
        write_function(module, "settle", constants, border)
        write_function(module, "correct", [*border, *varying], outputs)
        return len(border)

    try:
        code, border = code_of(family, ("step", at_node), write)
    except UntranslatableError:
        return None
    return FUNCTION(code["arrive"]), FUNCTION(code["settle"]), FUNCTION(code["correct"]), border


@functools.lru_cache(maxsize=64)  # a sweep makes a system for each member
def values(function: Callable[..., Any], family: Any, *shapes: tuple[int, ...], search: int = 1) -> Values | None:
    """Return the compiled function(system, ...) of parameters and arrays with these shapes; None if JAX must do it."""
    count = len(family.numbers)

    def of_numbers(*arguments: Array) -> Any:
        return function(family.bound(*arguments[:count]), *arguments[count:])

    def write(module: ir.Module) -> Any:
        whole = program(of_numbers, *shapes)
        write_function(module, "values", whole.inputs, [*whole.results, whole.doubt])
        return whole.shapes

    try:
        code, results = code_of(family, (function.__module__, function.__qualname__, shapes), write, search)
    except UntranslatableError:
        return None
    return Values(FUNCTION(code["values"]), list(map(tuple, results)))


def _body(system: Any, h: Any, q: Any, v: Any, *, at_node: bool = False) -> CoordinateBody | None:
    """Return a system at a time step, with room for its numbers; None if JAX must solve its equations."""
    code, place, n = programs(system.form, np.shape(q), len(v), at_node=at_node), np.size(q), len(v)
    if code is None:
        return None
    arrive, settle, correct, border = code
    size, constants = n + system.constraints, [np.ravel(x) for x in (float(h), *system.numbers_of_formulas)]
    departure, arrival = (np.concatenate([np.zeros(room), *constants]) for room in (place + n, place + 2 * n + 1))
    inputs, equations = np.zeros(border + size), np.zeros(size * size + 2 * size + 2)
    rows = equations[:-2].reshape(size + 2, size)
    parts = inputs[border:], equations, rows[:size], rows[size], rows[size + 1], np.zeros((size, size + 1))
    return CoordinateBody(arrive, settle, correct, departure, arrival, inputs, *parts, place, n)


def set_out(system: Any, h: Any, q: Any, v: Any, p: Any) -> Any:
    """Return the state, the orientation and the outcome of the root next to v with a momentum; None if JAX must."""
    body = _body(system, h, q, v)
    sign = set_out_coordinates(body, *map(np.array, (np.ravel(q), p, v))) if body else 0.0  # one type of arrays
    if body is None or sign == 0:
        return None
    first = body.root[: len(v)].copy()
    return (q, first, first), np.float64(sign), np.int64(0)


def advance(
    definition: Callable[..., Any], system: Any, h: Any, state: State, sign: Any, every: int, table: tuple[Any, ...]
) -> tuple[int, State, Any]:
    """Run `every` steps for each row of a table, into flat places, velocities and impulses.

    `definition(state, sign, steps)` takes some by JAX. A step that is not trusted here it takes alone, so that the
    bits of an orbit do not depend on the rows that are kept.

    Returns:
        The good steps, the state there and the outcome.
    """
    body, count, total, code = _body(system, h, *state[:2]), 0, len(table[0]) * every, 0
    while code == 0 and count < total:
        if body:
            flat = np.concatenate([x.ravel() for x in state])
            count = int(advance_coordinates(body, flat, float(sign), count, total, every, *table))
            ends = np.cumsum([body.place, body.velocity])
            state = flat[: ends[0]].reshape(state[0].shape), flat[ends[0] : ends[1]], flat[ends[1] :]
        if count < total:
            good, state, code, columns = definition(state, sign, np.int64(min(1 if body else ROWS, total - count)))
            marks = np.arange(-count % every, good, every)
            for column, entries in zip(table, columns, strict=True):
                column[(count + marks) // every] = entries[marks].reshape(len(marks), column.shape[1])
            count += int(good)
    return count, state, code


def decoded(function: Callable[..., Any], system: Any, h: Any, q: np.ndarray, v: np.ndarray) -> list[Any] | None:
    """Return function(system, h, q, v) of each state, of a driven system with the velocity at the node besides.

    Returns:
        None where there are no formulas, or doubts.
    """
    nodes = []
    if system.is_driven and len(q):  # velocities that belong to the momenta
        body, nodes = _body(system, h, q[0], v[0], at_node=True), [np.empty_like(v)]
        if not (body and each_root(body, q.reshape(len(q), -1), v, *nodes)):
            return None
    columns = [*(np.asarray(x)[None] for x in (*system.numbers_of_formulas, float(h))), q, v, *nodes]
    code = values(function, system.form, *(column.shape[1:] for column in columns))
    return code and evaluate(code, len(q), *columns)


def value(function: Callable[..., Any], system: Any, *arguments: Any) -> list[Any] | None:
    """Return function(system, ...), some arrays, of arrays; None where there are no formulas, or doubts."""
    columns = [np.asarray(x, dtype=float)[None] for x in (*system.numbers_of_formulas, *arguments)]
    code = values(function, system.form, *(column.shape[1:] for column in columns), search=0)
    results = code and evaluate(code, 1, *columns)
    return results and [each[0] for each in results]


def evaluate(code: Values, count: int, *columns: np.ndarray) -> list[Any] | None:
    """Return the values of `count` rows; None where they may not be trusted. A column of one row stands for all."""
    shapes = [x.shape[1:] for x in columns]
    inputs, table = (np.empty((count, sum(map(math.prod, each)))) for each in (shapes, [*code.shapes, ()]))
    for part, column in zip(_blocks(inputs, shapes), columns, strict=True):
        part[...] = column
    each_row(code.function, inputs, table)
    *results, doubt = _blocks(table, [*code.shapes, ()])
    return None if np.count_nonzero(doubt) else results


def _blocks(table: np.ndarray, shapes: list[tuple[int, ...]]) -> list[np.ndarray]:
    """Return arrays of these shapes, whose numbers stand side by side in each row of a table."""
    spans = itertools.pairwise(itertools.accumulate(map(math.prod, shapes), initial=0))
    return [table[:, begin:end].reshape(len(table), *shape) for (begin, end), shape in zip(spans, shapes, strict=True)]
