"""Functions that users pass, as JAX traces them in 64 bit: their checks, and those that are made of others.

Tables of forces: a row for each step, which JAX and formulas look up.
"""

import dataclasses
import functools
import importlib
import inspect
import operator
from collections.abc import Callable, Mapping
from typing import Any, ClassVar, Self

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error, shown, takes
from nonholo.base.memo import Keeper
from nonholo.base.numerics import double_precision
from nonholo.base.traced import TracedFunction, rows_above
from nonholo.base.types import Array, Float, Int

_END = 120  # letters of either end of a long message


@functools.cache
def room(name: str) -> Any:
    """Return a module that imports the caller's, or that loads slowly because of diffrax."""
    return importlib.import_module(f"nonholo.lagrange_dalembert.{name}")


def trace(where: str, function: Any, of: str, arguments: tuple[Any, ...]) -> TracedFunction:
    """Return a function as JAX traces it now; `of` says in words what it is called with."""
    if isinstance(function, TracedFunction) and function.arguments == arguments:
        return function
    if not callable(function):
        raise error(where, "be a function", shown(function), "Pass a function of jax.numpy arrays.")
    _check_parameters(where, function, arguments)
    result = _attempt(where, of, lambda: TracedFunction(function, arguments))
    if any(getattr(constant, "dtype", None) == jnp.float32 for constant in result.constants):
        remedy = "Keep parameters as Python numbers or NumPy arrays, not as jax.numpy arrays made outside."
        raise error(where, "use 64-bit numbers", "a captured 32-bit array", remedy)
    kind = result.program.out_avals[0].dtype.kind
    if kind in ("c" if result.shape else "biuc"):
        got = "complex numbers" if kind == "c" else "an integer"
        raise error(where, "return real numbers that it computes from its arguments", got, "Return a smooth formula.")
    return result


def _check_parameters(where: str, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    """Refuse a function that does not take the parameters of its system, last."""
    if isinstance(arguments[-1], dict) and not takes(function, count := len(arguments)):
        got, remedy = f"{inspect.signature(function)}", f"Let it take {count} arguments, the last a dict of parameters."
        raise error(where, "take the parameters of the system as its last argument", got, remedy)


def _attempt(where: str, of: str, trace: Callable[[], Any]) -> Any:
    """Return what JAX traces, refused where it cannot."""
    try:
        return trace()
    except Exception as failure:
        words = " ".join(str(failure).split()).rstrip(".")
        message = words if len(words) <= 2 * _END else f"{words[:_END]} ... {words[-_END:]}"
        got, columns = f"{type(failure).__name__}: {message}", "`.to_numpy()` of columns of pandas"
        remedy = f"Write it with jax.numpy, for arrays of {of}; use jnp.where, not `if`, and {columns}."
        raise error(where, f"be traceable by JAX on {of}", got, remedy) from failure


def checked_value(
    where: str, function: Any, of: str, arguments: tuple[Any, ...], shape: tuple[int, ...], arrays: str
) -> TracedFunction:
    """Return a traced function; refuse one of another shape, or a scalar that is to be differentiated and cannot be.

    `arrays` describes the arrays that it is called with.
    """
    result = trace(where, function, of, arguments)
    if result.shape != shape:
        demand = "a scalar" if shape == () else f"an array of shape {shape}"
        raise error(where, f"return {demand}", f"shape {result.shape}", f"It is called with arrays of {arrays}.")
    if shape == () and not result.primitives <= room("compiled._translation").DIFFERENTIABLE:
        numbers = tuple(i for i, each in enumerate(arguments) if hasattr(each, "shape"))
        with double_precision():
            _attempt(where, of, lambda: jax.make_jaxpr(jax.grad(result, numbers))(*arguments))
    return result


def checked_rows(
    where: str, function: Any, of: str, arguments: tuple[Any, ...], most: int, columns: tuple[int, ...], remedy: str
) -> TracedFunction:
    """Return a traced function of up to `most` rows of columns, of numbers without columns; refuse another one."""
    result = trace(where, function, of, arguments)
    if len(result.shape) != 1 + len(columns) or result.shape[1:] != columns or not 0 < result.shape[0] <= most:
        demand = f"(s, {most + 1}) with 0 < s < {most + 1}" if columns else f"(m,) with 0 < m <= {most}"
        raise error(where, f"return an array of shape {demand}", f"shape {result.shape}", remedy)
    return result


def count_of(function: Any) -> int:
    """Return the number of rows of what a traced function returns, none without one."""
    return 0 if function is None else function.shape[0]


def takes_time(function: Any, others: float) -> bool:
    """Return whether a function must be called with one argument more than the others."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):  # a builtin that does not tell
        return False
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return sum(each.kind in positional and each.default is each.empty for each in parameters) > others


@dataclasses.dataclass(frozen=True, eq=False)
class Resistance:
    """A force -C v beside a function, where there is one."""

    function: Callable[..., Any] | None
    friction: Float[np.ndarray, "n n"]

    def __call__(self, time: Array, q: Array, v: Array, *p: Any) -> Array:
        """Return the force."""
        return (0 if self.function is None else self.function(time, q, v, *p)) - self.friction @ v


@dataclasses.dataclass(frozen=True)
class TwoPoint:
    """A function of two configurations that was made for one time step."""

    function: Callable[[Array, Array], Array]
    is_of_one_step: ClassVar[bool] = True

    def __call__(self, q: Array, q_next: Array, time_step: Array, *parameters: Any) -> Array:
        """Return the value, which does not depend on the time step."""
        del time_step
        return self.function(q, q_next, *parameters)


def with_time_step(function: Any, others: int) -> Any:
    """Return a function of (q, q_next, time_step) and others: itself, or one without the time step wrapped."""
    is_shorter = callable(function) and takes(function, 2 + others) and not takes(function, 3 + others)
    return TwoPoint(function) if is_shorter else function


def with_parameters(function: Any, others: int) -> Any:
    """Return a function of others and parameters: itself, or one that does without them wrapped."""
    if not callable(function) or takes(function, others + 1):
        return function
    return lambda *arguments: function(*arguments[:-1])


@dataclasses.dataclass(frozen=True, eq=False)
class Bound:
    """A function with its last argument put in: parameters by name, where there are any."""

    function: Callable[..., Any]
    parameters: Mapping[str, Any]

    def __call__(self, *arguments: Any) -> Any:
        """Return the value."""
        return self.function(*arguments, *([self.parameters] if self.parameters else []))

    @property
    def __signature__(self) -> inspect.Signature:
        signature = inspect.signature(self.function)
        return signature.replace(parameters=[*signature.parameters.values()][: -1 if self.parameters else None])

    shape = property(operator.attrgetter("function.shape"))
    is_of_one_step = property(operator.attrgetter("function.is_of_one_step"))


def rows_of(function: Any, rows: Int[np.ndarray, "k"]) -> Any:
    """Return a function with some rows of what another one returns."""
    return functools.wraps(function)(lambda *arguments: function(*arguments)[rows])


ROWS = 1024
"""Saved states of one call of JAX: one size of table, one compilation."""


def _row_of_table(rows: Array, step: Array) -> Array:
    return rows[jnp.clip(jnp.rint(step).astype(int), -1, len(rows) - 1)]


LOOK_UP = "row of a table"  # no name of a function of the user's
_row_of_table.__name__ = LOOK_UP
_look_up = jax.jit(_row_of_table)


@dataclasses.dataclass(frozen=True, eq=False)
class ForceTable(Keeper):
    """Forces of the steps, one row a step; after the last one nothing acts.

    Attributes:
        rows: The forces with rows of zeros after them, so that few programs serve tables of all lengths.
    """

    rows: Float[np.ndarray, "rows n"]
    is_of_one_step: ClassVar[bool] = True

    @classmethod
    def of(cls, forces: Float[np.ndarray, "steps n"]) -> Self:
        """Return the table of forces."""
        return cls(np.pad(forces, ((0, max(ROWS, rows_above(len(forces) + 1)) - len(forces)), (0, 0))))

    def row(self, step: Array) -> Array:
        """Return the force of a step, whose number may carry rounding errors."""
        return _look_up(jnp.asarray(self.rows), step)

    def acting(self, steps: Int[np.ndarray, "K"]) -> Float[np.ndarray, "K n"]:
        """Return the forces of steps with these numbers."""
        return self.rows[np.clip(steps, -1, len(self.rows) - 1)]

    @property
    def address(self) -> Float[np.ndarray, "1 n"]:
        """Where formulas find the number of rows and the rows: each number is the place in memory, below 2^53."""
        return np.full((1, self.rows.shape[1]), float(self._memory.ctypes.data))

    @functools.cached_property
    def _memory(self) -> Float[np.ndarray, "size"]:
        return np.append(float(len(self.rows)), self.rows)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ForceTable) and np.array_equal(self.rows, other.rows)

    def __hash__(self) -> int:
        return hash(self.rows.shape)
