"""The equations of a system as C functions, made of the definitions of this room."""

import functools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from nonholo.base.numerics import double_precision
from nonholo.base.types import Array
from nonholo.lagrange_dalembert import _newton
from nonholo.lagrange_dalembert._room import equations_of
from nonholo.lagrange_dalembert.compiled._machine import machine_code
from nonholo.lagrange_dalembert.compiled._scalars import Formulas, Scalar, UntranslatableError, needed
from nonholo.lagrange_dalembert.compiled._translation import translated
from nonholo.lagrange_dalembert.compiled._windows import array_of


class Program(NamedTuple):
    """Formulas of a JAX function.

    Attributes:
        inputs: Its arguments, one after another.
        results: Its values, one after another.
        doubt: Not zero where the formulas may not be trusted.
        shapes: Shapes of the values.
        formulas: What makes more of them.
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


class Programs(NamedTuple):
    """The functions of `CoordinateBody`, and how many numbers `settle` writes."""

    arrive: Any
    settle: Any
    correct: Any
    settled: int


def program(function: Callable[..., Any], *shapes: tuple[int, ...], varying: int = 0) -> Program:
    """Translate a function of arrays with these shapes, the last ones of which vary.

    Raises:
        UntranslatableError: It does what formulas cannot, or calls what this version of JAX calls otherwise.
    """
    f, first = Formulas(), len(shapes) - varying
    inputs = [[Scalar("input", varies=i >= first) for _ in range(math.prod(shape))] for i, shape in enumerate(shapes)]
    with double_precision():
        traced = jax.make_jaxpr(function)(*(jax.ShapeDtypeStruct(shape, float) for shape in shapes))
    try:
        arrays = translated(f, traced, list(map(array_of, inputs, shapes)))
    except (AttributeError, KeyError, TypeError, ValueError) as failure:
        raise UntranslatableError(repr(failure)) from failure
    doubts = sorted(f.doubts, key=lambda each: each.varies)
    doubt = functools.reduce(functools.partial(f, "add"), doubts, f.constant(0.0))
    results = [number for each in arrays for number in each.ravel()]
    return Program([x for each in inputs for x in each], results, doubt, [each.shape for each in arrays], f)


@functools.lru_cache(maxsize=64)  # a sweep makes a system for each member
def programs(system: Any, place: tuple[int, ...], n: int, *, at_node: bool = False) -> Programs | None:
    """Return the compiled equations of a step of a system, with places of a shape and n velocities.

    Or, at a node, those of the velocity that belongs to a momentum: then nothing moves on arrival.

    Returns:
        None if JAX must solve them.
    """
    equations, s = equations_of(system), system.constraints
    matrix_of = _newton.of_node if at_node else _newton.of_step

    def arrive(x: Array, v: Array, h: Array) -> tuple[Array, Array]:
        leaving, arriving = equations.momenta(system, x, v, h)
        return (x, leaving) if at_node else (equations.ahead(system, x, v, h), arriving)

    def correct(x: Array, p: Array, doubt: Array, near: Array, h: Array, v: Array, multipliers: Array) -> Any:
        matrix_at, rows = matrix_of(system, x, near, h), equations.forms(system, x)
        matrix, missed, units, size = _newton.equations(matrix_at, rows, p, v, multipliers, jnp.zeros(n + s))
        return matrix, missed, units.velocity, units.forms, size, doubt

    try:
        first = program(arrive, place, (n,), ())
        whole = program(correct, place, (n,), (), (n,), (), (n,), (s,), varying=2)
    except UntranslatableError:
        return None
    *results, doubt = whole.results
    outputs = [*results, whole.formulas("add", doubt, whole.doubt)]
    fixed, varying = ([each for each in whole.inputs if each.varies is kind] for kind in (False, True))
    kept = _border(outputs)
    settle, corrections = machine_code(fixed, kept), machine_code([*kept, *varying], outputs)
    return Programs(machine_code(first.inputs, [*first.results, first.doubt]), settle, corrections, len(kept))


@functools.lru_cache(maxsize=64)  # a sweep makes a system for each member
def values(function: Callable[..., Any], system: Any, *shapes: tuple[int, ...]) -> Values | None:
    """Return the compiled function(system, ...) of arrays with these shapes; None if JAX must do it."""
    try:
        whole = program(functools.partial(function, system), *shapes)
    except UntranslatableError:
        return None
    return Values(machine_code(whole.inputs, [*whole.results, whole.doubt]), whole.shapes)


def _border(results: list[Scalar]) -> list[Scalar]:
    """Return the numbers that stay the same and are used by such that vary, or are results."""
    used = [other for each in needed(results, ()) if each.varies for other in each.arguments]
    return list(dict.fromkeys(each for each in [*used, *results] if not each.varies and each.value is None))
