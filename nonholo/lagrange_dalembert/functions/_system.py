"""Systems whose functions take parameters, numbers by name, as their last argument.

Calls of JAX are compiled once for all of their numbers. Every call runs in a local 64-bit scope and gives NumPy arrays.
"""

import dataclasses
import difflib
import functools
from collections.abc import Callable, Iterator, Mapping
from typing import Any, ClassVar, Self

import jax
import numpy as np

from nonholo import systems
from nonholo.base.checks import array, assign, checked_name, error, instance, is_traced, number, shape_of, shown
from nonholo.base.numerics import double_precision
from nonholo.base.progress import compiling
from nonholo.base.traced import call_in_blocks
from nonholo.base.types import Array
from nonholo.lagrange_dalembert.functions import _traced as traced
from nonholo.systems.forces import force_of, parts_of, slips_of, with_later_force, without_slips


class Parameters(Mapping[str, Any]):
    """Numbers and arrays by name, in an order; equal where names, shapes and numbers are.

    Example:
        >>> Parameters({"mass": 1.0}) == Parameters({"mass": 1}), Parameters({"mass": 1.0})
        (True, {'mass': 1.0})
    """

    def __init__(self, numbers: Any, owner: str = "LagrangeDAlembert") -> None:
        where = f"{owner}(parameters=...)"
        instance(where, numbers, Mapping, "be a mapping of names to numbers", "Pass a dict.")
        names = [checked_name(where, key, ("time_step",)) for key in numbers]
        self._numbers = {key: _valid_number(where, key, numbers[key]) for key in names}
        keys = ((key, np.shape(x), id(x) if is_traced(x) else np.asarray(x).tobytes()) for key, x in self.items())
        self._key = tuple(keys)

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

    def replace(self, where: str, numbers: Mapping[str, Any]) -> "Parameters":
        """Return them with other numbers of the same names and shapes."""
        for key in numbers.keys() - self.keys():
            near = difflib.get_close_matches(key, self, n=1)
            remedy = f"It has {', '.join(self)}." if self else "It has none: make it with parameters=..."
            remedy = f"Did you mean {near[0]}?" if near else remedy
            raise error(where, "name parameters of the system", shown(key), remedy)
        changes = {key: _valid_number(where, key, value, np.shape(self[key])) for key, value in numbers.items()}
        return Parameters(self._numbers | changes)


def _brief(value: Any) -> str:
    return f"shape {np.shape(value)}" if is_traced(value) or np.ndim(value) else repr(float(value))


def _valid_number(where: str, key: str, value: Any, shape: tuple[int, ...] | None = None) -> Any:
    """Return a number, or an array of the given shape or any."""
    where, shape = where.replace("...", f"{{{key!r}: ...}}"), shape_of(value) if shape is None else shape
    return array(where, value, shape, "Pass real numbers.") if shape else number(where, value)


class AbstractParametricSystem(systems.AbstractCoordinateSystem[systems.DiscretizationT, systems.OrbitT]):
    """A system whose functions take its parameters last, where it has any, and whose forms may yield.

    Attributes:
        functions: The fields that are such functions.
        of_time: How many arguments those have that may be called with the time after them.
        parameters: The numbers.
        force: The parts of the force; forms may yield where contacts are among them.
    """

    functions: ClassVar[tuple[str, ...]]
    of_time: ClassVar[dict[str, int]] = {}
    parameters: Any
    force: Any

    @functools.cached_property
    def slips(self) -> tuple[Any, ...]:
        """The contacts whose forms may yield."""
        return slips_of(parts_of(self.force))

    @functools.cached_property
    def holding(self: Any) -> Any:
        """The system while the forms that may yield hold; itself if none may."""
        parts = without_slips(parts_of(self.force))
        return dataclasses.replace(self, force=force_of(parts)) if self.slips else self

    @functools.cached_property
    def free(self) -> Any:
        """The system without the forms that may yield; itself if none may."""
        return self.without(self.slips)

    def without(self: Any, contacts: Any) -> Any:
        """Return the system that holds, without the forms of some contacts."""
        if not contacts:
            return self.holding
        rows = np.flatnonzero(~np.concatenate([each.rows for each in contacts]).any(axis=0))
        forms = traced.rows_of(self.constraint_forms, rows) if len(rows) else None
        moves = self.constraint_velocities
        velocities = {"constraint_velocities": traced.rows_of(moves, rows)} if moves else {}  # of no rows: time stays
        return dataclasses.replace(self.holding, constraint_forms=forms, **velocities)

    @functools.cached_property
    def table(self) -> traced.ForceTable | None:
        """The forces of the steps, where they are given one by one."""
        return parts_of(self.force).get("table")

    @property
    def applied(self) -> Callable[[Array, Array, Array], Array] | None:
        """The force as a function, where there is one."""
        return parts_of(self.force).get("function")

    @functools.cached_property
    def is_driven(self: Any) -> bool:
        """Whether a force acts, or anything depends on time or moves by itself."""
        acts = self.holding.force is not None or self.constraint_velocities is not None or bool(self.prescribed)
        return acts or any(map(self.takes_time, self.of_time))

    def takes_time(self, function: str) -> bool:
        """Return whether the Lagrangian, the constraint forms or the holonomic constraints are called with the time."""
        count = self.of_time.get(function, np.inf) + len(self._shapes_given)
        return traced.takes_time(getattr(self, function), count)

    @functools.cached_property
    def constraints(self: Any) -> int:
        """The number s of constraints, the holonomic ones and those of prescribed coordinates with them."""
        return self.velocity_constraints + traced.count_of(self.holonomic) + len(self.prescribed)

    @functools.cached_property
    def velocity_constraints(self: Any) -> int:
        """The number of constraint forms."""
        return traced.count_of(self.constraint_forms)

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
            parts["function"] = traced.Resistance(parts.get("function"), friction.matrix)
        if "table" in parts and not isinstance(parts["table"], traced.ForceTable):
            remedy = "Pass a function of time, configuration and velocity, Friction, or one force a step."
            parts["table"] = traced.ForceTable.of(array(where, parts["table"], (None, n), remedy))
        if "function" in parts:
            arguments = (jax.ShapeDtypeStruct((), float), *shapes, *self._shapes_given)
            parts["function"] = traced.checked_value(where, parts["function"], of, arguments, (n,), of)
        assign(self, force=force_of(parts))

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

    def _with_force(self, force: Any) -> Any:
        """Return the force with another one, which may take parameters or do without; beside one a table alone."""
        if self.parameters and "function" in (parts := parts_of(force)):
            force = force_of(parts | {"function": traced.with_parameters(parts["function"], 3)})
        return with_later_force(self, force)

    @property
    def _shapes_given(self) -> tuple[dict[str, jax.ShapeDtypeStruct], ...]:
        """The last argument of all functions, the shapes of the parameters, if there are any."""
        return (self.parameters.structure,) if self.parameters else ()

    def _trace(self, name: str, of: str, arguments: tuple[Any, ...], check: Any, *demands: Any) -> None:
        """Put a function as JAX traces it now in its own place, where there is one; the first of all is needed."""
        if (function := getattr(self, name)) is not None or name == self.functions[0]:
            time = (jax.ShapeDtypeStruct((), float),) if self.takes_time(name) else ()
            arguments = (*arguments, *time, *self._shapes_given)
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
        zeros = Parameters({key: np.zeros(np.shape(value)) for key, value in self.parameters.items()})
        family = self._with_fields(parameters=zeros)
        vars(family)["family"] = family
        return family

    @functools.cached_property
    def form(self) -> Self:
        """The family without rows of a table, which stands for all `numbers`: what programs are made of."""
        if self.table is None:
            return self.family
        nothing = traced.ForceTable(np.zeros_like(self.table.rows[:1]))
        form = self.family._with_fields(force=force_of(parts_of(self.force) | {"table": nothing}))
        vars(form).update(family=form, form=form)
        return form

    def bound(self: Any, *numbers: Any) -> Any:
        """Return the system without parameters whose functions have these numbers within, and a table these rows."""
        self._refuse_slips()
        p, parts = dict(zip(self.parameters, numbers, strict=False)), parts_of(self.force)
        parts |= {"function": traced.Bound(parts["function"], p)} if "function" in parts else {}
        parts |= {"table": traced.ForceTable(*numbers[len(p) :])} if numbers[len(p) :] else {}
        motions = tuple((index, traced.Bound(motion, p)) for index, motion in self.prescribed)
        own = {name: getattr(self, name) for name in self.functions}
        functions = {name: each and traced.Bound(each, p) for name, each in own.items()}
        return self._with_fields(parameters=Parameters({}), force=force_of(parts), prescribed=motions, **functions)

    def discrete_map(self: Any, time_step: Any) -> systems.DiscretizationT:
        """Return the discretized system, see `nonholo.discretize`."""
        return traced.room("_discretization").MAPS[self.orbits](self, time_step)

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
    if plain is not system and vars(system).get("recipe"):
        vars(plain)["recipe"] = (_plain, (system,))
    return plain


SYSTEM = "a system in coordinates"


@functools.cache
def _compile(function: Callable[..., Any]) -> Callable[..., Any]:
    return jax.jit(lambda family, numbers, *arguments: function(family.bound(*numbers), *arguments), static_argnums=0)


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


@functools.cache
def _of_rows(function: Callable[..., Any]) -> Callable[..., Any]:
    def call(system: Any, *rows: Any) -> Any:
        return jax.vmap(functools.partial(function, system), [0 if np.ndim(each) else None for each in rows])(*rows)

    return call


def in_rows(function: Callable[..., Any], system: Any, *columns: np.ndarray | float) -> Any:
    """Call a JAX function of a system and a state with each row of the columns; a number is the same for all."""
    return in_double(_of_rows(function), system, *columns)


def in_blocks(function: Callable[..., Any], system: Any, *columns: np.ndarray) -> list[np.ndarray]:
    """Do the same with many rows, in blocks, for a function with several results."""
    return call_in_blocks(functools.partial(in_rows, function, system), traced.ROWS, *columns)
