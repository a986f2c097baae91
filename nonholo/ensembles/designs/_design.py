"""Designs: which members a sweep has, as a grid or as random draws; values of any members, without the others.

Random numbers of a member depend on the seed, the stream and its index, and on nothing else.
"""

import abc
import dataclasses
import math
import zlib
from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np

from nonholo.base.checks import count, error, natural, refuse_former_names, seed, shown
from nonholo.base.checks import name as checked_name
from nonholo.base.types import Float
from nonholo.ensembles._names import OUTCOME, component_name
from nonholo.ensembles.designs._distributions import AbstractDistribution, checked_list
from nonholo.io import TAKEN

_COLUMNS = TAKEN | {"member", OUTCOME, "t", "time"}  # which tables of results have of their own
_WORDS = 4  # numbers for each value of Philox's counter


def uniform_numbers(seed: int, stream: str, first: int, count: int, width: int) -> Float[np.ndarray, "count width"]:
    """Return numbers in [0, 1) of the members `first` to `first + count - 1`, this many of each.

    The generator is Philox, whose counter is set to the first member, so nothing before it is drawn.

    Example:
        >>> several = uniform_numbers(7, "a", first=0, count=10, width=3)
        >>> bool((several[4:6] == uniform_numbers(7, "a", first=4, count=2, width=3)).all())
        True
    """
    rounds = -(-width // _WORDS)
    key = np.array([seed, zlib.crc32(stream.encode())], dtype=np.uint64)
    bits = np.random.Philox(key=key, counter=first * rounds)
    return np.random.Generator(bits).random((count, _WORDS * rounds))[:, :width]


_REMEDY = "Pass a dictionary of names to"
Values = dict[str, np.ndarray]


@dataclasses.dataclass(frozen=True, eq=False)
class AbstractDesign(abc.ABC):
    """The members of a sweep.

    Attributes:
        seed: The integer that random numbers are made of, those of tasks too.
    """

    seed: int

    @property
    @abc.abstractmethod
    def sizes(self) -> dict[str, int]:
        """Dimensions and their lengths; members are numbered along the last one first."""

    @property
    @abc.abstractmethod
    def axes(self) -> dict[str, np.ndarray]:
        """Values along one dimension, the first axis of each, by name."""

    @property
    @abc.abstractmethod
    def drawn(self) -> dict[str, tuple[int, ...]]:
        """Names and shapes of the values that vary from member to member."""

    @abc.abstractmethod
    def values(self, first: int, count: int) -> Values:
        """Return the values of some members in order, by name."""

    @property
    def members(self) -> int:
        """Number of members."""
        return math.prod(self.sizes.values())


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Grid(AbstractDesign):
    """Every combination of values along axes.

    Names are parameters of the system ("a", "mass", "mass_tensor", ...), "time_step", a start ("body_velocity",
    "restricted_velocity", "momentum") or one component of it ("restricted_velocity_0"); for a custom function
    the names that it reads. A component may be written "restricted_velocity[0]"; the result calls it as Python and
    xarray can. Values are numbers, or along the first axis vectors or matrices. The result has a dimension for each
    axis. Random numbers of a task are made of `rng`, as those of a `RandomDesign`.

    Example:
        >>> design = Grid({"a": [0.1, 0.2], "time_step": np.linspace(0.1, 0.5, 5)})
        >>> design.members, design.values(first=4, count=2)
        (10, {'a': array([0.1, 0.2]), 'time_step': array([0.5, 0.1])})
    """

    values_along: dict[str, np.ndarray]

    @refuse_former_names("Grid", seed="rng")
    def __init__(self, axes: Any, rng: int | np.random.Generator = 0) -> None:
        if not isinstance(axes, Mapping) or not axes:
            raise error("Grid(axes=...)", "be a mapping of names to values", shown(axes), f"{_REMEDY} values.")
        axes_by_name = {
            name: checked_list(f"Grid({{{name!r}: ...}})", axes[name_given])
            for name, name_given in _own_names("Grid(axes=...)", axes).items()
        }
        if len({axis_dimension(name, values) for name, values in axes_by_name.items()}) < len(axes_by_name):
            requirement = "have other names than its vectors and matrices"
            raise error("Grid(axes=...)", requirement, ", ".join(axes_by_name), "Rename one.")
        object.__setattr__(self, "values_along", axes_by_name)
        object.__setattr__(self, "seed", seed("Grid(rng=...)", rng))

    def __repr__(self) -> str:
        sizes = " x ".join(f"{size} {name}" for name, size in self.sizes.items())
        return f"<Grid of {self.members} members: {sizes}>"

    @property
    def sizes(self) -> dict[str, int]:
        return {axis_dimension(name, values): len(values) for name, values in self.values_along.items()}

    @property
    def axes(self) -> dict[str, np.ndarray]:
        return self.values_along

    @property
    def drawn(self) -> dict[str, tuple[int, ...]]:
        return {}

    def values(self, first: int, count: int) -> Values:
        """Return the values of some members in order, by name."""
        first, count = _some("Grid", first, count)
        places = np.unravel_index(np.arange(first, first + count), tuple(self.sizes.values()))
        return {name: values[at] for (name, values), at in zip(self.values_along.items(), places, strict=True)}


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class RandomDesign(AbstractDesign):
    """Members drawn from distributions: member i is the same in every design with this `rng`, however many there are.

    Names are those of a `Grid`. All random numbers are made of one integer: `rng`, or one that this generator draws.

    Example:
        >>> design = RandomDesign(1_000_000, {"a": Uniform(0.1, 1.0), "restricted_velocity": Direction(2)}, rng=3)
        >>> design.values(first=999_998, count=2)["a"].shape
        (2,)
    """

    count: int
    distributions: dict[str, AbstractDistribution]

    @refuse_former_names("RandomDesign", seed="rng")
    def __init__(self, members: int, distributions: Any, rng: int | np.random.Generator = 0) -> None:
        if not isinstance(distributions, Mapping) or not distributions:
            got = shown(distributions)
            raise error("RandomDesign(distributions=...)", "be a mapping", got, f"{_REMEDY} distributions.")
        names = _own_names("RandomDesign(distributions=...)", distributions)
        for name, value in distributions.items():
            if not isinstance(value, AbstractDistribution):
                remedy = "Pass nh.Uniform(low, high), ...; what all members share belongs to the task."
                raise error(f"RandomDesign({{{name!r}: ...}})", "be a distribution", shown(value), remedy)
        object.__setattr__(self, "count", count("RandomDesign(members=...)", members, "Pass how many."))
        object.__setattr__(
            self, "distributions", {name: distributions[name_given] for name, name_given in names.items()}
        )
        object.__setattr__(self, "seed", seed("RandomDesign(rng=...)", rng))

    def __repr__(self) -> str:
        draws = ", ".join(f"{name} {value!r}" for name, value in self.distributions.items())
        return f"<RandomDesign of {self.members} members, seed {self.seed}: {draws}>"

    @property
    def sizes(self) -> dict[str, int]:
        return {"member": self.count}

    @property
    def axes(self) -> dict[str, np.ndarray]:
        return {}

    @property
    def drawn(self) -> dict[str, tuple[int, ...]]:
        return {name: value.shape for name, value in self.distributions.items()}

    def values(self, first: int, count: int) -> Values:
        """Return the values of some members in order, by name."""
        first, count = _some("RandomDesign", first, count)
        return {
            name: value.draw(uniform_numbers(self.seed, f"design {name}", first, count, value.width))
            for name, value in self.distributions.items()
        }


def _some(owner: str, first: Any, count: Any) -> tuple[int, int]:
    """Return which members are meant."""
    first = natural(f"{owner}.values(first=...)", first, "Pass the number of the first member, from 0.")
    return first, natural(f"{owner}.values(count=...)", count, "Pass how many members.")


Design: TypeAlias = Grid | RandomDesign


def axis_dimension(name: str, values: Float[np.ndarray, "count ..."]) -> str:
    """Return the dimension of an axis: its name or, for vectors and matrices, which label no points, another one."""
    return name if values.ndim == 1 else f"{name}_number"


def axis_dimensions(name: str, values: Float[np.ndarray, "count ..."]) -> tuple[str, ...]:
    """Return the dimension of an axis and those of the vectors or matrices along it."""
    return (axis_dimension(name, values), *(f"{name}_{axis}" for axis in range(1, values.ndim)))


def _own_names(where: str, names: Mapping[Any, Any]) -> dict[str, str]:
    """Return the given names by those of the result, refused if two are one."""
    plain = {name: component_name(name) if isinstance(name, str) else name for name in names}
    own_by_name = {checked_name(where, own, _COLUMNS): name for name, own in plain.items()}
    if len(own_by_name) < len(names):
        raise error(where, "name each value once", ", ".join(names), "Leave one out.")
    return own_by_name
