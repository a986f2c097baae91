"""The form of an example: a system in coordinates, a start, and what is known."""

import copy
import dataclasses
import functools
import importlib
import inspect
import json
from collections.abc import Callable, Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import array, scale
from nonholo.base.memo import Keeper
from nonholo.base.numerics import double_precision
from nonholo.base.types import Array, Float
from nonholo.discrete import discretize
from nonholo.lagrange_dalembert import GroupLagrangeDAlembert, LagrangeDAlembert
from nonholo.simulation import flow, simulate
from nonholo.systems import AbstractSystem

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
        facts: What is known, a sentence each.
        conserved: Functions (configuration, velocity) -> number, constant along the continuous motion. On a discrete
            orbit the velocity is that of a step: take the middle of the step, configuration + displacement / 2.
        exact: The configurations at given times, (K,) -> (K, n), from this start; None where no formula is known.
        time_step: A step that resolves the motion, of `simulate` by default.
        steps: How many of them show it, by default; the flow is as long.

    Example:
        >>> nh.examples.particle().coordinates
        ('x', 'y', 'z')
    """

    name: str
    system: LagrangeDAlembert | GroupLagrangeDAlembert | AbstractSystem
    configuration: Float[np.ndarray, "n"]
    body_velocity: Float[np.ndarray, "n"]
    facts: tuple[str, ...]
    conserved: Mapping[str, Callable[[Array, Array], Array]]
    exact: Callable[[Array], Array] | None = None
    time_step: float = 0.05
    steps: int = 400

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


def ready(*start: str) -> Callable[[Callable[..., Example]], Callable[..., Example]]:
    """Let the system of what a function makes tell stores the function and its arguments but for those of the start."""

    def decorated(make: Callable[..., Example]) -> Callable[..., Example]:
        defaults = {name: each.default for name, each in inspect.signature(make).parameters.items()}

        @functools.wraps(make)
        def made(**given: Any) -> Example:
            example = make(**given)
            if any(map(callable, given.values())):
                return example  # which no data describes
            body = {name: _plain(given.get(name, default), default) for name, default in defaults.items()}
            kept = {name: value for name, value in body.items() if name not in start}
            example = dataclasses.replace(example, system=_named(example.system, made, json.dumps(kept)))
            object.__setattr__(example, "recipe", (functools.partial(made, **given), ()))
            return example

        return made

    return decorated


def _plain(value: Any, default: Any) -> Any:
    """Return an argument as plain data, numbers of the kind of its default: 1 and 1.0 are one mass."""
    return value if value is None else np.asarray(value, dtype=np.asarray(default).dtype).tolist()


@functools.lru_cache(maxsize=64)  # one with a new function each time is another one
def _named(system: Any, make: Callable[..., Example], parameters: str) -> Any:
    """Return a system that can be described; changes of it, by `Forced` or `dataclasses.replace`, are not."""
    named = copy.copy(system)
    given = json.loads(parameters)
    object.__setattr__(named, "description", (f"examples.{make.__name__}", given))
    object.__setattr__(named, "recipe", (_system_of, (make, given)))
    return named


def _system_of(make: Callable[..., Example], given: dict[str, Any]) -> Any:
    return make(**given).system


def sized(make: Callable[[], LagrangeDAlembert], *numbers: float) -> LagrangeDAlembert:
    """Return a system that is made once, with these parameters in its order."""
    system = make()
    return system.with_parameters(**dict(zip(system.parameters, numbers, strict=True)))


def rate(index: int) -> Callable[[Array, Array], Array]:
    """Return the function (configuration, velocity) -> one component of the velocity."""

    def component(q: Array, v: Array) -> Array:
        del q
        return v[..., index]

    return component


def of_states(function: Callable[[Array, Array], Array]) -> Callable[[Array, Array], Array]:
    """Return a function of JAX of one configuration and velocity as one of many, in double precision."""
    many = jax.jit(jnp.vectorize(function, signature="(n),(m)->()"))

    def values(q: Array, v: Array) -> Array:
        with double_precision():
            return np.asarray(many(q, v))

    return values


def energy_of(lagrangian: Callable[[Array, Array], Array]) -> Callable[[Array, Array], Array]:
    r"""Return the energy $v\cdot\partial L/\partial v - L$ of many states."""

    def energy(q: Array, v: Array) -> Array:
        value, along = jax.jvp(lambda u: lagrangian(q, u), (v,), (v,))
        return along - value

    return of_states(energy)


def positives(owner: str, **values: Any) -> list[float]:
    """Return the parameters of a body, all positive."""
    remedy = "Pass a positive number."
    return [float(scale(f"examples.{owner}({name}=...)", value, remedy)) for name, value in values.items()]


def numbers(owner: str, name: str, value: Any, size: int, what: str) -> Float[np.ndarray, "size"]:
    """Return the numbers of a start."""
    return array(f"examples.{owner}({name}=...)", value, (size,), f"Pass {what}.")
