"""Designs: which members a sweep has, as a grid or as random draws; values of any members, without the others.

Random numbers of a member depend on the seed, the stream and its index, and on nothing else.
"""

import abc
import dataclasses
import hashlib
import math
import zlib
from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeAlias

import numpy as np

from nonholo.base import checks
from nonholo.base.checks import bounded_count, checked_name, count, error, natural, refuse_former_names, shown, text
from nonholo.base.types import Float
from nonholo.ensembles._names import OUTCOME, component_name
from nonholo.ensembles.distributions import DISTRIBUTIONS, AbstractDistribution, checked_list
from nonholo.io.metadata import TAKEN
from nonholo.io.provenance import fields_of, refusing_other_data

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
    bits = np.random.Philox(key=np.array([seed, zlib.crc32(stream.encode())], dtype=np.uint64), counter=first * rounds)
    return np.random.Generator(bits).random((count, _WORDS * rounds))[:, :width]


Values = dict[str, np.ndarray]


@dataclasses.dataclass(frozen=True, eq=False)
class AbstractDesign(abc.ABC):
    """The members of a sweep.

    Attributes:
        seed: The integer that random numbers are made of, those of tasks too.
        axes: Values along one dimension, the first axis of each, by name.
        drawn: Names and shapes of the values that vary from member to member.
        sizes: Dimensions and their lengths; members are numbered along the last one first.
    """

    seed: int
    axes: dict[str, np.ndarray]
    drawn: dict[str, tuple[int, ...]]
    sizes: dict[str, int]

    @abc.abstractmethod
    def values(self, first: int, count: int) -> Values:
        """Return the values of some members in order, by name."""

    @abc.abstractmethod
    def describe(self) -> dict[str, Any]:
        """Return the design as plain data; values along axes are named by their hash and have their own arrays."""

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

    @refuse_former_names("Grid", seed="rng")
    def __init__(self, axes: Any, rng: int | np.random.Generator = 0) -> None:
        names = _own_names("Grid(axes=...)", axes, "values").items()
        axes_by_name = {name: checked_list(f"Grid({{{name!r}: ...}})", axes[key]) for name, key in names}
        sizes = {axis_dimension(name, values): len(values) for name, values in axes_by_name.items()}
        if len(sizes) < len(axes_by_name):
            requirement = "have other names than its vectors and matrices"
            raise error("Grid(axes=...)", requirement, ", ".join(axes_by_name), "Rename one.")
        vars(self).update(axes=axes_by_name, sizes=sizes, drawn={}, seed=checks.seed("Grid(rng=...)", rng))

    def __repr__(self) -> str:
        sizes = " x ".join(f"{size} {name}" for name, size in self.sizes.items())
        return f"<Grid of {self.members} members: {sizes}>"

    def values(self, first: int, count: int) -> Values:
        """Return the values of some members in order, by name."""
        first, count = _some(self, first, count)
        places = np.unravel_index(np.arange(first, first + count), tuple(self.sizes.values()))
        return {name: values[at] for (name, values), at in zip(self.axes.items(), places, strict=True)}

    def describe(self) -> dict[str, Any]:
        """Return the design as plain data; values along axes are named by their hash and have their own arrays."""
        return {"kind": "Grid", "seed": self.seed, "axes": {name: _hash(values) for name, values in self.axes.items()}}


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class RandomDesign(AbstractDesign):
    """Members drawn from distributions: member i is the same in every design with this `rng`, however many there are.

    Names are those of a `Grid`. All random numbers are made of one integer: `rng`, or one that this generator draws.

    Example:
        >>> design = RandomDesign(1_000_000, {"a": Uniform(0.1, 1.0), "restricted_velocity": Direction(2)}, rng=3)
        >>> design.values(first=999_998, count=2)["a"].shape
        (2,)
    """

    distributions: dict[str, AbstractDistribution]

    @refuse_former_names("RandomDesign", seed="rng")
    def __init__(self, members: int, distributions: Any, rng: int | np.random.Generator = 0) -> None:
        names = _own_names("RandomDesign(distributions=...)", distributions, "distributions")
        for name, value in distributions.items():
            if not isinstance(value, AbstractDistribution):
                remedy = "Pass nh.Uniform(low, high), ...; what all members share belongs to the task."
                raise error(f"RandomDesign({{{name!r}: ...}})", "be a distribution", shown(value), remedy)
        own = {name: distributions[name_given] for name, name_given in names.items()}
        sizes = {"member": count("RandomDesign(members=...)", members, "Pass how many.")}
        shapes = {name: value.shape for name, value in own.items()}
        number = checks.seed("RandomDesign(rng=...)", rng)
        vars(self).update(distributions=own, sizes=sizes, drawn=shapes, axes={}, seed=number)

    def __repr__(self) -> str:
        draws = ", ".join(f"{name} {value!r}" for name, value in self.distributions.items())
        return f"<RandomDesign of {self.members} members, seed {self.seed}: {draws}>"

    def values(self, first: int, count: int) -> Values:
        """Return the values of some members in order, by name."""
        first, count = _some(self, first, count)
        own = self.distributions.items()
        return {name: d.draw(uniform_numbers(self.seed, f"design {name}", first, count, d.width)) for name, d in own}

    def describe(self) -> dict[str, Any]:
        """Return the design as plain data."""
        each = {name: {"kind": type(d).__name__, **fields_of(d)} for name, d in self.distributions.items()}
        return {"kind": "RandomDesign", "seed": self.seed, "members": self.members, "distributions": each}


def _some(design: AbstractDesign, first: Any, count: Any) -> tuple[int, int]:
    """Return which members are meant."""
    where = f"{type(design).__name__}.values"
    first = natural(f"{where}(first=...)", first, "Pass the number of the first member, from 0.")
    count = natural(f"{where}(count=...)", count, "Pass how many members.")
    if first + count > design.members:
        got = f"{first} + {count} of {design.members}"
        raise error(f"{where}(count=...)", "not lead beyond the last member", got, "Ask for fewer.")
    return first, count


Design: TypeAlias = Grid | RandomDesign


@refusing_other_data("load_sweep(store=...)", "a design of this version")
def design_from(text: dict[str, Any], axis: Callable[[str], np.ndarray]) -> Design:
    """Return the design of a description."""
    if text["kind"] == "Grid":
        along = {name: axis(name) for name in text["axes"]}
        for name, digest in text["axes"].items():
            if _hash(along[name]) != digest:
                remedy = "The store is damaged: copy it again from its source, or run it again."
                raise error("load_sweep(store=...)", f"hold the axis {name} of its design", "another one", remedy)
        return Grid(along, rng=text["seed"])
    entries = {name: {**entry} for name, entry in text["distributions"].items()}
    distributions = {name: DISTRIBUTIONS[entry.pop("kind")](**entry) for name, entry in entries.items()}
    return RandomDesign(text["members"], distributions, rng=text["seed"])


def _hash(values: np.ndarray) -> str:
    return hashlib.sha256(np.ascontiguousarray(values).tobytes() + repr(values.shape).encode()).hexdigest()


def axis_dimension(name: str, values: Float[np.ndarray, "count ..."]) -> str:
    """Return the dimension of an axis: its name or, for vectors and matrices, which label no points, another one."""
    return name if values.ndim == 1 else f"{name}_number"


def axis_dimensions(name: str, values: Float[np.ndarray, "count ..."]) -> tuple[str, ...]:
    """Return the dimension of an axis and those of the vectors or matrices along it."""
    return (axis_dimension(name, values), *(f"{name}_{axis}" for axis in range(1, values.ndim)))


def _own_names(where: str, names: Any, what: str) -> dict[str, str]:
    """Return the given names by those of the result, refused if there are none or two are one."""
    if not isinstance(names, Mapping) or not names:
        remedy = f"Pass a dictionary of names to {what}."
        raise error(where, f"be a mapping of names to {what}", shown(names), remedy)
    plain = {name: component_name(name) if isinstance(name, str) else name for name in names}
    if len(own_by_name := {checked_name(where, own, _COLUMNS): name for name, own in plain.items()}) < len(names):
        raise error(where, "name each value once", ", ".join(names), "Leave one out.")
    return own_by_name


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class MemberBlock(Mapping[str, Any]):
    """Some members of a sweep in order: a mapping of names to arrays whose first axis is that of the members.

    Attributes:
        first: Number of the first member.
        count: How many.
        seed: Seed of the design.
        arrays: Values by name.

    Example:
        >>> block = block_of(nh.Grid({"a": [1.0, 2.0, 3.0]}), first=1, count=2)
        >>> block["a"], block.index, block.random(3).shape
        (array([2., 3.]), array([1, 2]), (2, 3))
    """

    first: int
    count: int
    seed: int
    arrays: dict[str, np.ndarray]

    def __getitem__(self, name: str) -> np.ndarray:
        name = name if name in self.arrays else component_name(name)
        if name not in self.arrays:
            raise KeyError(f"{name!r}: the design has {', '.join(self.arrays)}")
        return self.arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.arrays)

    def __len__(self) -> int:
        return len(self.arrays)

    def __repr__(self) -> str:
        return f"<MemberBlock: members {self.first} to {self.first + self.count - 1}, {', '.join(self)}>"

    @property
    def index(self) -> np.ndarray:
        """Numbers of the members."""
        return np.arange(self.first, self.first + self.count)

    def random(self, width: int, stream: str = "") -> Float[np.ndarray, "count width"]:
        """Return uniform numbers in [0, 1) of each member, the same in any block; streams are independent."""
        remedy = "Pass how many numbers each member needs."
        width = bounded_count("MemberBlock.random(width=...)", width, 24.0 * self.count, remedy)
        text("MemberBlock.random(stream=...)", stream)
        return uniform_numbers(self.seed, f"task {stream}", self.first, self.count, width)

    def part(self, begin: int, end: int) -> "MemberBlock":
        """Return some of the members, counted from the first one here."""
        begin, end = (natural("MemberBlock.part(...)", x, "Pass numbers of members here.") for x in (begin, end))
        arrays = {name: values[begin:end] for name, values in self.arrays.items()}
        return MemberBlock(self.first + begin, end - begin, self.seed, arrays)


def block_of(design: AbstractDesign, first: int, count: int) -> MemberBlock:
    """Return some members of a design."""
    return MemberBlock(first, count, design.seed, design.values(first, count))
