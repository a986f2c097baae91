"""Functions that users pass, with or without the time step, such that JAX can trace them, in 64 bit; and parameters.

Parameters are numbers of a system by name, which all of its functions take last. Every call of JAX is compiled, runs in
a local 64-bit scope and gives NumPy arrays.
"""

import dataclasses
import difflib
import functools
import importlib
import inspect
import operator
from collections.abc import Callable, Iterator, Mapping
from typing import Any, ClassVar, Self

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import array, assign, checked_name, error, instance, is_traced, number, shape_of, shown
from nonholo.base.memo import Keeper
from nonholo.base.numerics import double_precision
from nonholo.base.progress import compiling
from nonholo.base.traced import TracedFunction, call_in_blocks, rows_above
from nonholo.base.types import Array, Float, Int
from nonholo.systems import (
    AbstractCoordinateSystem,
    DiscretizationT,
    OrbitT,
    force_of,
    parts_of,
    slips_of,
    without_slips,
)

ROWS = 1024
"""Saved states of one call of JAX: one size of table, one compilation."""
_END = 120  # letters of either end of a long message


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
    if isinstance(arguments[-1], dict) and not _binds(function, count := len(arguments)):
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
    if shape == ():
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
    def nothing(self) -> Self:
        """The table of no forces, which stands for all."""
        return type(self)(np.zeros((1, self.rows.shape[1])))

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
    is_shorter = callable(function) and _binds(function, 2 + others) and not _binds(function, 3 + others)
    return TwoPoint(function) if is_shorter else function


def with_parameters(function: Any, others: int) -> Any:
    """Return a function of others and parameters: itself, or one that does without them wrapped."""
    if not callable(function) or _binds(function, others + 1):
        return function
    return lambda *arguments: function(*arguments[:-1])


def _binds(function: Callable[..., Any], count: int) -> bool:
    """Return whether a function takes this many arguments; a builtin need not tell, and takes all."""
    try:
        inspect.signature(function).bind(*range(count))
    except TypeError:
        return False
    except ValueError:
        return True
    return True


class Parameters(Mapping[str, Any]):
    """Numbers and arrays by name, in an order; equal where names, shapes and numbers are.

    Example:
        >>> Parameters({"mass": 1.0}) == Parameters({"mass": 1}), Parameters({"mass": 1.0})
        (True, {'mass': 1.0})
    """

    def __init__(self, numbers: Any, owner: str = "LagrangeDAlembert") -> None:
        where = f"{owner}(parameters=...)"
        instance(where, numbers, Mapping, "be a mapping of names to numbers", "Pass a dict.")
        self._hold(
            {checked_name(where, key, ("time_step",)): _valid_number(where, key, x) for key, x in numbers.items()}
        )

    def _hold(self, numbers: dict[str, Any]) -> None:
        self._numbers = numbers
        self._key = tuple(
            (key, np.shape(value), id(value) if is_traced(value) else np.asarray(value).tobytes())
            for key, value in numbers.items()
        )

    def __getitem__(self, name: str) -> Any:
        return self._numbers[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._numbers)

    def __len__(self) -> int:
        return len(self._numbers)

    def __repr__(self) -> str:
        return f"{{{', '.join(f'{key!r}: {_brief(value)}' for key, value in self.items())}}}"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Parameters) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    @property
    def structure(self) -> dict[str, jax.ShapeDtypeStruct]:
        """Their shapes."""
        return {key: jax.ShapeDtypeStruct(np.shape(value), float) for key, value in self.items()}

    @property
    def nothing(self) -> "Parameters":
        """Zeros of the same names and shapes."""
        return Parameters({key: np.zeros(np.shape(value)) for key, value in self.items()})

    def replace(self, where: str, numbers: Mapping[str, Any]) -> "Parameters":
        """Return them with other numbers of the same names and shapes."""
        for key in numbers.keys() - self.keys():
            near = difflib.get_close_matches(key, self, n=1)
            remedy = f"It has {', '.join(self)}." if self else "It has none: make it with parameters=..."
            raise error(
                where, "name parameters of the system", shown(key), f"Did you mean {near[0]}?" if near else remedy
            )
        other, own = object.__new__(Parameters), self._numbers
        changes = {key: _valid_number(where, key, value, np.shape(own[key])) for key, value in numbers.items()}
        other._hold(own | changes)
        return other


def _brief(value: Any) -> str:
    return f"shape {np.shape(value)}" if is_traced(value) or np.ndim(value) else repr(float(value))


def _valid_number(where: str, key: str, value: Any, shape: tuple[int, ...] | None = None) -> Any:
    """Return a number, or an array of the given shape or any."""
    where, shape = where.replace("...", f"{{{key!r}: ...}}"), shape_of(value) if shape is None else shape
    return array(where, value, shape, "Pass real numbers.") if shape else number(where, value)


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


class AbstractParametricSystem(AbstractCoordinateSystem[DiscretizationT, OrbitT]):
    """A system whose functions take its parameters last, where it has any."""

    functions: ClassVar[tuple[str, ...]]
    """The fields that are such functions."""
    of_time: ClassVar[dict[str, int]] = {}
    """How many arguments those have that may be called with the time after them."""
    parameters: Any
    force: Any

    @functools.cached_property
    def table(self) -> ForceTable | None:
        """The forces of the steps, where they are given one by one."""
        return parts_of(self.force).get("table")

    @property
    def applied(self) -> Callable[[Array, Array, Array], Array] | None:
        """The force as a function, where there is one."""
        return parts_of(self.force).get("function")

    @functools.cached_property
    def slips(self) -> tuple[Any, ...]:
        """The contacts whose forms may yield."""
        return slips_of(parts_of(self.force))

    @functools.cached_property
    def holding(self: Any) -> Any:
        """The system while the forms that may yield hold; itself if none may."""
        return dataclasses.replace(self, force=force_of(without_slips(parts_of(self.force)))) if self.slips else self

    @functools.cached_property
    def free(self) -> Any:
        """The system without the forms that may yield; itself if none may."""
        return self.without(self.slips)

    def without(self: Any, contacts: Any) -> Any:
        """Return the system that holds, without the forms of some contacts."""
        if not contacts:
            return self.holding
        rows = np.flatnonzero(~np.concatenate([each.rows for each in contacts]).any(axis=0))
        forms = rows_of(self.constraint_forms, rows) if len(rows) else None
        moves = self.constraint_velocities
        velocities = {"constraint_velocities": rows_of(moves, rows)} if moves else {}  # of no rows: time stays
        return dataclasses.replace(self.holding, constraint_forms=forms, **velocities)

    def _check_slips(self: Any, *others: Any) -> None:
        """Refuse slips beside own discrete functions, of rows that mix forms, and of one form for two contacts."""
        where, forms = f"{type(self).__name__}(force=...)", self.velocity_constraints
        rows = [each.rows for each in self.slips]
        have = [{*np.flatnonzero(each.any(axis=0))} for each in rows]
        fits = [each.shape[1] == forms and len(each) == len(own) for each, own in zip(rows, have, strict=True)]
        if not all(fits) or len(set().union(*have)) < sum(map(len, have)):
            demand = f"have Slips with rows of {forms} numbers, one for each form that may yield, each form in one Slip"
            got, remedy = f"{[each.tolist() for each in rows]}", "Pass rows=[[0.0, 1.0]] for the second of two forms."
            raise error(where, demand, got, remedy)
        if rows and any(others):
            raise error(where, "have no Slip beside own discrete functions", "both", "Leave the functions out.")

    def _refuse_slips(self) -> None:
        if self.slips:
            remedy = "Run it by `simulate` or `iterate` of what `discretize` returned, or leave the slip out."
            raise error(f"{type(self).__name__}(force=...)", "have forms that never yield", "a Slip", remedy)

    @property
    def has_parts(self: Any) -> bool:
        """Whether parts of a step are defined: functions and tables that were made for one time step have none."""
        functions = (self.discrete_lagrangian, self.discrete_constraints, self.table)
        return not any(getattr(each, "is_of_one_step", False) for each in functions)

    @property
    def place_shape(self: Any) -> tuple[int, ...]:
        """Shape of a place: a configuration, of a driven system with the time in one more row."""
        first, *others = self.shapes[0]
        return first + self.is_driven, *others

    def _check_force(self: Any, of: str, *shapes: Any) -> None:
        """Put the force in its place: a function as JAX traces it, with that of `Friction`; a table; others."""
        where, parts, n = f"{type(self).__name__}(force=...)", parts_of(self.force), self.dimension
        if (friction := parts.pop("friction", None)) is not None:
            friction.check(n)
            parts["function"] = Resistance(parts.get("function"), friction.matrix)
        if "table" in parts and not isinstance(parts["table"], ForceTable):
            remedy = "Pass a function of time, configuration and velocity, Friction, or one force a step."
            parts["table"] = ForceTable.of(array(where, parts["table"], (None, n), remedy))
        if "function" in parts:
            arguments = (jax.ShapeDtypeStruct((), float), *shapes, *self._shapes_given)
            parts["function"] = checked_value(where, parts["function"], of, arguments, (n,), of)
        assign(self, force=force_of(parts))

    def _with_force(self, force: Any) -> Any:
        """Return the force with another one, which may take parameters or do without; beside one a table alone."""
        own, parts = parts_of(self.force), parts_of(force)
        if own and parts and (parts.keys() != {"table"} or "table" in own):
            remedy = "Pass all forces at once; a table alone may come later."
            raise error("Forced(system=...)", "have no force yet", repr(self), remedy)
        if self.parameters and "function" in parts:
            parts["function"] = with_parameters(parts["function"], 3)
        return force_of(own | parts)

    @property
    def _shapes_given(self) -> tuple[dict[str, jax.ShapeDtypeStruct], ...]:
        """The last argument of all functions, the shapes of the parameters, if there are any."""
        return (self.parameters.structure,) if self.parameters else ()

    def _time(self, name: str) -> tuple[Any, ...]:
        """Return the shape of the time if a function is called with it."""
        count = self.of_time.get(name, np.inf) + len(self._shapes_given)
        return (jax.ShapeDtypeStruct((), float),) if takes_time(getattr(self, name), count) else ()

    def _trace(self, name: str, of: str, arguments: tuple[Any, ...], check: Any, *demands: Any) -> None:
        """Put a function as JAX traces it now in its own place, where there is one; the first of all is needed."""
        if (function := getattr(self, name)) is not None or name == self.functions[0]:
            arguments = (*arguments, *self._time(name), *self._shapes_given)
            where = f"{type(self).__name__}({name}=...)"
            assign(self, **{name: check(where, function, of, arguments, *demands)})

    def with_parameters(self, **numbers: Any) -> Self:
        r"""Return the same system with other numbers of some of its parameters; nothing is compiled again.

        Args:
            numbers: Numbers or arrays by name, as in `parameters`; JAX may trace them (`nonholo.rollout`).

        Raises:
            ValueError: A name that is none of its parameters, another shape, a value that is not finite.

        Example:
            >>> def energy(q, v, p):
            ...     return (p["mass"] * v @ v - p["stiffness"] * q @ q) / 2
            >>> spring = nh.LagrangeDAlembert(energy, None, dimension=1, parameters={"mass": 1.0, "stiffness": 4.0})
            >>> heavy = spring.with_parameters(mass=4.0)
            >>> heavy.parameters, heavy == spring
            ({'mass': 4.0, 'stiffness': 4.0}, False)
            >>> orbit = nh.flow(heavy, configuration=[1], body_velocity=[0], times=[0, np.pi])
            >>> print(orbit.configuration[-1].round(9))
            [-1.]
        """
        return _of_numbers(self, self.parameters.replace("with_parameters(...)", numbers), family=self.family)

    @property
    def numbers(self) -> tuple[Any, ...]:
        """The numbers that its functions take: parameters, then the rows of a table where it has one."""
        return *self.parameters.values(), *(() if self.table is None else (self.table.rows,))

    @property
    def numbers_of_formulas(self) -> tuple[Any, ...]:
        """The same for formulas, which look up rows of a table at its address."""
        return *self.parameters.values(), *(() if self.table is None else (self.table.address,))

    @functools.cached_property
    def family(self) -> Self:
        """The system with zeros as parameters, which stands for all their numbers."""
        if not self.parameters:
            return self
        family = self._with_fields(parameters=self.parameters.nothing)
        vars(family)["family"] = family
        return family

    @functools.cached_property
    def form(self) -> Self:
        """The family without rows of a table, which stands for all `numbers`: what programs are made of."""
        if self.table is None:
            return self.family
        form = self.family._with_fields(force=force_of(parts_of(self.force) | {"table": self.table.nothing}))
        vars(form).update(family=form, form=form)
        return form

    def bound(self, *numbers: Any) -> Self:
        """Return the system without parameters whose functions have these numbers within, and a table these rows."""
        self._refuse_slips()
        p = dict(zip(self.parameters, numbers, strict=False))
        return self._with_fields(parameters=Parameters({}), **self._bound_fields(p, *numbers[len(p) :]))

    def _bound_fields(self, p: Mapping[str, Any], *rows: Any) -> dict[str, Any]:
        """Return the fields that are functions, with parameters within, and the force with rows of its table."""
        own, parts = {name: getattr(self, name) for name in self.functions}, parts_of(self.force)
        parts |= {"function": Bound(parts["function"], p)} if "function" in parts else {}
        parts |= {"table": ForceTable(*rows)} if rows else {}
        return {name: each and Bound(each, p) for name, each in own.items()} | {"force": force_of(parts)}

    @functools.cached_property
    def plain(self) -> Self:
        """The same system without parameters: its functions have them within."""
        return _plain(self)


def _of_numbers(system: Any, parameters: Parameters, **fields: Any) -> Any:
    """Return a system with other numbers, which is pickled as such where it is made by a call that has a name."""
    other, recipe = system._with_fields(parameters=parameters, **fields), vars(system).get("recipe")
    if recipe:
        origin = recipe[1][0] if recipe[0] is _of_numbers else system
        vars(other)["recipe"] = (_of_numbers, (origin, parameters))
    return other


def _plain(system: Any) -> Any:
    """Return a system whose numbers stand within its functions, pickled as such."""
    plain = system.bound(*system.parameters.values()) if system.parameters else system
    recipe = vars(system).get("recipe")
    if recipe and plain is not system:
        vars(plain)["recipe"] = (_plain, (system,))
    return plain


def rows_of(function: Any, rows: Int[np.ndarray, "k"]) -> Any:
    """Return a function with some rows of what another one returns."""
    return functools.wraps(function)(lambda *arguments: function(*arguments)[rows])


SYSTEM = "a system in coordinates"


@functools.cache
def _compile(function: Callable[..., Any]) -> Callable[..., Any]:
    def call(family: Any, numbers: tuple[Any, ...], *arguments: Any) -> Any:
        return function(family.bound(*numbers), *arguments)

    return jax.jit(call, static_argnums=0)


def room(name: str) -> Any:
    """Return a module that imports the caller's, or that loads slowly because of diffrax."""
    return importlib.import_module(f"nonholo.lagrange_dalembert.{name}")


def configurations(system: Any, places: Any) -> Any:
    """Return the configurations of places: those of driven systems have the time in a last column."""
    return places[:, :-1] if system.is_driven else places


def places(system: Any, configurations: Any, time: Any) -> Any:
    """Return the places of configurations at these times, with one more row of a driven system."""
    if not system.is_driven:
        return configurations
    xp, (count, _, *row) = configurations.__array_namespace__(), configurations.shape
    times = xp.reshape(xp.asarray(time, dtype=float), (-1, 1, *(1 for _ in row)))
    return xp.concatenate([configurations, xp.broadcast_to(times, (count, 1, *row))], axis=1)


def place(system: Any, q: Any, time: Any) -> Any:
    """Return where a system is: its configuration, of a driven one with the time."""
    return places(system, q[None], time)[0]


def in_double(function: Callable[..., Any], system: Any, *arguments: Any) -> Any:
    """Call a JAX function of a system, compiled once for all of its numbers, in 64 bits; return NumPy arrays."""
    family, numbers = system.form, system.numbers
    with double_precision(), compiling(SYSTEM, family, (function, family)):
        return jax.tree.map(np.asarray, _compile(function)(family, numbers, *arguments))


def in_blocks(function: Callable[..., Any], system: Any, *columns: np.ndarray) -> list[np.ndarray]:
    """Call a JAX function of a system and many states in blocks."""
    return call_in_blocks(functools.partial(in_double, function, system), ROWS, *columns)
