"""The flow of formulas by Taylor series, in the loop of all series of the kernels, and what its states say."""

import functools
import itertools
import math
from collections.abc import Iterable
from typing import Any, NamedTuple, cast

import jax
import numpy as np
from llvmlite import ir

from nonholo.base.compiled import FUNCTION
from nonholo.base.types import Array, Float
from nonholo.kernels import Columns, Quadratic, revisit_series, solve_series
from nonholo.lagrange_dalembert import _equations as equations
from nonholo.lagrange_dalembert.compiled._expansion import Expansion, bordered_elimination
from nonholo.lagrange_dalembert.compiled._machine import code_of, write_function
from nonholo.lagrange_dalembert.compiled._run import Values, evaluate, program
from nonholo.lagrange_dalembert.compiled._scalars import Formulas, Scalar, UntranslatableError
from nonholo.lagrange_dalembert.compiled._translation import array_of
from nonholo.orbit import looked_at

_MOST = 100_000  # steps; what needs more is stiff
_GUARD = 1 / 64  # the error of a step as a share of what was asked for
_SMALLEST = 1e-12  # of a pivot beside its diagonal
_SIDE = 8  # numbers of a row of series come in eights
_SPAN = 32  # binary digits of times and masses that need no other unit


class Formulation(NamedTuple):
    """The equations of a system as formulas that are compiled.

    Attributes:
        expansion: The address of what writes Taylor coefficients.
        room: How many numbers that needs.
        settle: Maps places and velocities to the admissible ones next to them in the kinetic energy.
        decode: Maps them to momentum, forces of constraint, energy and residual; pivots and diagonal of the mass.
    """

    expansion: int
    room: int
    settle: Values
    decode: Values


@functools.lru_cache(maxsize=64)  # as the programs of steps
def formulation(family: Any, place: tuple[int, ...], n: int) -> Formulation | None:
    """Return the continuous equations of a family of systems; None if they are no formulas, or none that are smooth.

    Parameters and a unit of time are numbers of the state that stay as they are. A place moves with the velocity that
    keeps holonomic constraints, so that what rounding takes from the velocity does not gather in the place.
    """
    size = math.prod(place)

    def at(x: Array, v: Array, *numbers: Array) -> tuple[Array, ...]:
        system = family.bound(*numbers[:-1])
        rate = system.places.rate(x, v)
        residual, constraint_rate = jax.jvp(lambda y: equations.constraint(system, y, v), (x,), (rate,))
        away = jax.jvp(lambda y: equations.holonomic_residual(system, y), (x,), (rate,))
        columns = equations.momentum(system, x, v), equations.energy(system, x, v), residual, *away
        matrices = equations.mass_matrix(system, x, v), equations.forms(system, x)
        return *matrices, equations.force(system, x, v), -constraint_rate, rate, *columns

    def write(module: ir.Module) -> int:
        whole = program(at, place, (n,), *map(np.shape, family.parameters.values()), ())
        f, parts = whole.formulas, iter(whole.results)
        arrays = (array_of(list(itertools.islice(parts, math.prod(shape))), shape) for shape in whole.shapes)
        mass, A, force, off, rate, momentum, energy, residual, away, leaving = arrays
        matrix = bordered_elimination(f, mass, A)
        zero, acceleration = f.constant(0.0), matrix.solution([*force, *off])
        across, back, drift = (matrix.solution([*[zero] * n, *rows])[:n] for rows in (residual, away, leaving))
        still = [zero] * (len(whole.inputs) - size - n)
        expansion = Expansion(f, whole.inputs, [*_less(f, rate.ravel(), drift), *acceleration[:n], *still])
        expansion.write(module, "expansion", -(-len(whole.inputs) // _SIDE) * _SIDE)
        admissible = [*_less(f, whole.inputs[:size], back), *_less(f, whole.inputs[size : size + n], across)]
        forces, pivots = (f("neg", each) for each in acceleration[n:]), matrix.pivots[:n]
        columns = [*momentum, *forces, energy.item(), *residual, *pivots, *np.diagonal(mass)]
        doubt = functools.reduce(functools.partial(f, "add"), f.doubts, zero)
        write_function(module, "settle", whole.inputs[:-1], [*admissible, doubt])
        write_function(module, "decode", whole.inputs[:-1], [*columns, doubt])
        return expansion.room

    try:
        code, room = code_of(family, ("flow",), write)
    except UntranslatableError:
        return None
    rows, settle, decode = (family.constraints,), FUNCTION(code["settle"]), FUNCTION(code["decode"])
    shapes = [(n,), rows, (), rows, (n,), (n,)]
    return Formulation(code["expansion"], room, Values(settle, [place, (n,)]), Values(decode, shapes))


def _less(f: Formulas, numbers: Iterable[Scalar], others: list[Scalar]) -> list[Scalar]:
    """Return numbers less others, the last of which may be left out."""
    return [f("sub", *each) for each in itertools.zip_longest(numbers, others, fillvalue=f.constant(0.0))]


class Series(NamedTuple):
    """A solved motion: its equations, and from where their series can be expanded again.

    Attributes:
        system: The system.
        shapes: Of a place and of a velocity.
        blocks: The block of each number of a state.
        nodes: Beginnings of steps, whose times are in the unit of time.
        end: The last of the given times.
        tolerance: Of a step.
        unit: The unit of time, a power of two, in which no coefficient over- or underflows.
    """

    system: Any
    shapes: tuple[tuple[int, ...], tuple[int, ...]]
    blocks: tuple[int, ...]
    nodes: np.ndarray
    end: float
    tolerance: float
    unit: float

    @property
    def code(self) -> Formulation:
        """The equations."""
        place, (n,) = self.shapes
        return cast(Formulation, formulation(self.system.family, place, n))

    def __call__(self, times: np.ndarray) -> list[np.ndarray]:
        """Return places and velocities at times in the order in which the motion was solved."""
        (place, (n,)), size, code = self.shapes, self.nodes.shape[2] - 1, self.code
        widths = math.prod(place), n, size - math.prod(place) - n
        f, limits = _equations(code, self.blocks), (self.end / self.unit, self.tolerance)
        return self.settle(revisit_series(f, self.nodes, widths, times / self.unit, *limits, code.expansion))

    def settle(self, columns: Columns) -> list[np.ndarray]:
        """Return places and admissible velocities of states of the series."""
        x = self.system.places.normalize(columns[0].reshape(-1, *self.shapes[0]))
        return cast(Any, _values(self.code.settle, self.system, x, columns[1]))

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last time."""
        return float(self.nodes[0, 0, -1]) * self.unit, self.end

    def looks(self) -> np.ndarray:
        """Return times at which events are evaluated."""
        return looked_at([*self.nodes[:, 0, -1], self.end / self.unit], 1 / self.unit)


def flow(system: Any, first: tuple[Any, Any], times: np.ndarray, rtol: float) -> tuple[list[np.ndarray], Series] | None:
    """Return places and velocities at times, and the motion between; None if series do not reach them all."""
    x, v = map(np.asarray, first)
    code = formulation(system.family, x.shape, len(v))
    start = code and _values(code.decode, system, x[None], v[None])
    if not code or start is None or not np.all(start[-2] > _SMALLEST * start[-1]):
        return None
    shapes, tolerance = (x.shape, v.shape), rtol * _GUARD
    unit = np.ldexp(1.0, _SPAN * round(np.log2(abs(times[-1] - times[0]) or 1.0) / _SPAN))
    still = np.array([*itertools.chain(*map(np.ravel, system.parameters.values())), unit])
    blocks = _blocks(system, x, start[-1][0], len(still))
    f = _equations(code, blocks)
    columns, nodes = solve_series(f, (x.ravel(), v, still), times / unit, tolerance, _MOST, code.expansion)
    if len(columns[0]) < len(times):
        return None
    series = Series(system, shapes, blocks, nodes, float(times[-1]), tolerance, float(unit))
    return series.settle(columns), series


def _blocks(system: Any, x: np.ndarray, masses: Float[np.ndarray, "n"], still: int) -> tuple[int, ...]:
    """Return which numbers are measured together: places apart from times, rates and constants.

    Coordinates with masses of very different sizes, as in micrometers and radians, are apart, too.
    """
    order, times = np.argsort(masses), (x.shape[1] if x.ndim > 1 else 1) * system.is_driven
    kinds = np.zeros(len(masses), dtype=np.int64)
    kinds[order[1:]] = np.cumsum(np.diff(np.log2(masses[order])) > _SPAN)
    count, places = kinds.max() + 1, kinds if x.ndim == 1 else np.zeros(x.size - times, dtype=np.int64)
    return *map(int, places), *(2 * int(count),) * times, *map(int, count + kinds), *(2 * int(count),) * still


def _equations(code: Formulation, blocks: tuple[int, ...]) -> Quadratic:
    """Return equations without quadratic terms, whose numbers are the room of the code."""
    size, none = len(blocks), np.zeros((2, 0), dtype=np.int64)
    sparse = none, np.zeros(size + 1, dtype=np.int64), none[0], np.zeros((1, code.room))
    measures = np.arange(size), np.array(blocks), np.zeros(1 + max(blocks), dtype=np.bool_)
    return Quadratic(np.zeros((0, 0)), *sparse, *measures, np.zeros(0), np.zeros((0, 0)), np.zeros(0))


def flow_rows(system: Any, x: np.ndarray, v: np.ndarray) -> list[np.ndarray] | None:
    """Return momenta, forces of constraint, energies and residuals of states; None if JAX must compute them."""
    code = formulation(system.family, x.shape[1:], v.shape[1])
    columns = _values(code.decode, system, x, v) if code else None
    if columns is None:
        return None
    momentum, force, energy, residual, *_ = columns
    return [momentum, force, energy, np.abs(residual).max(axis=1, initial=0.0)]


def _values(code: Values, system: Any, x: np.ndarray, v: np.ndarray) -> list[np.ndarray] | None:
    return evaluate(code, len(x), x, v, *(np.asarray(number)[None] for number in system.parameters.values()))
