"""The form of an example: a system, a start, and what is known."""

import copy
import dataclasses
import functools
import importlib
import inspect
import json
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from nonholo.base.checks import array, assign, number, scale
from nonholo.base.memo import Keeper
from nonholo.base.types import Array, Float
from nonholo.discrete import discretize
from nonholo.lagrange_dalembert import LagrangeDAlembert
from nonholo.simulation import flow, simulate

_POSITIVE = "Pass a positive number."
Numbers = Mapping[str, Any]
"""Parameters of a system by name."""


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Example(Keeper):
    """A system of the literature with a start and with known facts.

    Attributes:
        name: The name of the function that makes it.
        system: The system.
        configuration: Where it starts.
        body_velocity: How it starts; it satisfies the constraint.
        conserved: Functions (configuration, velocity) -> number, constant along the continuous motion. On a discrete
            orbit the velocity is that of a step: take the middle of the step, configuration + displacement / 2.
        exact: The configurations at given times, (K,) -> (K, n), from this start; None where no formula is known.
        time_step: A step that resolves the motion, of `simulate` by default.
        steps: How many of them show it, by default; the flow is as long.
        facts: Known facts, a sentence each: by default the lines of the section "Facts" of the function's docstring.

    Example:
        >>> nh.examples.particle().coordinates
        ('x', 'y', 'z')
    """

    name: str
    system: Any
    configuration: Float[np.ndarray, "n"]
    body_velocity: Float[np.ndarray, "n"]
    conserved: Mapping[str, Callable[[Array, Array], Array]]
    exact: Callable[[Array], Array] | None = None
    time_step: float = 0.05
    steps: int = 400
    facts: tuple[str, ...] = ()

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates; on a group ("pose",)."""
        return getattr(self.system, "coordinates", ()) or ("pose",)

    def discretize(self, time_step: float | None = None) -> Any:
        """Return the discretized system, `nh.discretize(example.system, time_step)`."""
        return discretize(self.system, self.time_step if time_step is None else time_step)

    def simulate(self, *, steps: int | None = None, time_step: float | None = None, **options: Any) -> Any:
        """Run the discrete map from the start of the example; options are those of `nh.simulate`.

        Example:
            >>> orbit = nh.examples.rolling_disk().simulate(steps=100)
            >>> len(orbit), str(orbit.outcome)
            (101, 'successful')
        """
        steps = self.steps if steps is None else steps
        return simulate(self.discretize(time_step), **(self._start | options), steps=steps)

    def flow(self, *, times: Any = None, **options: Any) -> Any:
        """Solve for the continuous motion from the start of the example; options are those of `nh.flow`."""
        times = self.time_step * self.steps * np.linspace(0.0, 1.0, 401) if times is None else times
        return flow(self.system, **(self._start | options), times=times)

    def explore(self) -> Any:
        """Return the live page of the motion, see `nh.explore`."""
        return importlib.import_module("nonholo.explorer").explore(self.simulate())

    def plot(self, path: str | None = None, *, overwrite: bool = False) -> Any:
        """Draw the overview picture of the motion; return the figure, saved to a new `path` if given."""
        return self.simulate().plot(path, overwrite=overwrite)

    @property
    def _start(self) -> dict[str, Any]:
        return {"body_velocity": self.body_velocity, "configuration": self.configuration}

    def __repr__(self) -> str:
        return f"<Example {self.name}: {', '.join(self.coordinates)}>"


Maker = Callable[..., Example]


def ready(start: str = "", *, reals: str = "", positive: str = "", **arrays: str) -> Callable[[Maker], Maker]:
    """Let the system of what a function makes tell stores the function and its arguments but for those of the start.

    Args:
        start: The arguments of the start, in words, which may be any numbers.
        reals: Others that may be; all others with a number as default are positive.
        positive: Arrays of positive numbers.
        **arrays: What arrays are, for messages; they are as long as their defaults.
    """

    def decorator(make: Maker) -> Maker:
        defaults = {name: each.default for name, each in inspect.signature(make).parameters.items()}
        _, _, words = inspect.cleandoc(make.__doc__ or "").partition("Facts:\n")
        facts = tuple(map(str.strip, words.partition("\n\n")[0].splitlines()))

        def valid_value(name: str, value: Any) -> Any:
            where = f"examples.{make.__name__}({name}=...)"
            if name in arrays:
                rows = array(where, value, np.shape(defaults[name]), f"Pass {arrays[name]}.")
                return scales(where, rows) if name in positive.split() else tuple(rows.tolist())
            return _number(where, value, make.__annotations__.get(name), name in f"{start} {reals}".split())

        @functools.wraps(make)
        def make_ready(**arguments: Any) -> Example:
            example = make(**{name: valid_value(name, value) for name, value in (defaults | arguments).items()})
            example = dataclasses.replace(example, facts=example.facts or facts)
            if any(map(callable, arguments.values())):
                return example  # which no data describes
            body = {name: _plain(arguments.get(name, default), default) for name, default in defaults.items()}
            parameters = {name: value for name, value in body.items() if name not in start.split()}
            system = _with_recipe(example.system, make_ready, json.dumps(parameters))
            example = dataclasses.replace(example, system=system)
            assign(example, recipe=(functools.partial(make_ready, **arguments), ()))
            return example

        return make_ready

    return decorator


def _number(where: str, value: Any, kind: Any, real: bool) -> Any:
    """Return a checked number; an argument that is no number, or may be none, is left to its function."""
    if kind not in (float, float | None) or (value is None and kind is not float):
        return value
    return float(number(where, value) if real else scale(where, value, _POSITIVE))


def _plain(value: Any, default: Any) -> Any:
    """Return an argument as plain data, numbers of the kind of its default: 1 and 1.0 are one mass."""
    return value if value is None else np.asarray(value, dtype=np.asarray(default).dtype).tolist()


@functools.lru_cache(maxsize=64)  # one with a new function each time is another one
def _with_recipe(system: Any, make: Maker, parameters: str) -> Any:
    """Return a system that can be described; changes of it, by `Forced` or `dataclasses.replace`, are not."""
    own = copy.copy(system)
    arguments = json.loads(parameters)
    description, recipe = (f"examples.{make.__name__}", arguments), (_system_of, (make, arguments))
    assign(own, description=description, recipe=recipe)
    return own


def _system_of(make: Maker, arguments: dict[str, Any]) -> Any:
    return make(**arguments).system


def system_in(coordinates: str, name: str, numbers: Any, *functions: Any, **options: Any) -> LagrangeDAlembert:
    """Return the system of a Lagrangian and constraint forms, its coordinates named by words.

    `numbers` are its parameters, or the names of parameters that are single numbers.
    """
    names, own = tuple(coordinates.split()), numbers if isinstance(numbers, dict) else dict.fromkeys(numbers, 1.0)
    return LagrangeDAlembert(*functions, dimension=len(names), coordinates=names, name=name, parameters=own, **options)


def family(make: Callable[..., Any]) -> Callable[..., Any]:
    """Let a function that makes a system, once for its keywords, take the numbers of the parameters before them."""
    plain = functools.cache(make)

    @functools.wraps(make)
    def with_numbers(*numbers: Any, **structure: Any) -> Any:
        system: Any = plain(**structure)
        return system.with_parameters(**dict(zip(system.parameters, numbers, strict=True)))

    return with_numbers


def scales(where: str, rows: Any) -> tuple[float, ...]:
    """Return positive numbers."""
    return tuple(float(scale(where.replace("=", f"[{i}]=", 1), value, _POSITIVE)) for i, value in enumerate(rows))
