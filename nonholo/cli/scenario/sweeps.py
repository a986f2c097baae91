"""The contents of the scenario of a sweep: a body, a start and a run as for one motion, a design, what to keep.

Values of a design are lists and ranges of a grid, or distributions: the classes of `nonholo` by their names.
"""

import math
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Generic, Literal, Self, TypeVar

import numpy as np
from pydantic import AliasChoices, Field, model_validator

import nonholo
from nonholo.base.checks import is_integer, shown
from nonholo.base.limits import bounded_count
from nonholo.cli.scenario.bodies import arguments
from nonholo.cli.scenario.motion import AbstractScenario, Start, is_ready
from nonholo.cli.scenario.sections import Count, Section, by_kind, checked_by, is_finite, suggestion
from nonholo.ensembles import REDUCTIONS
from nonholo.ensembles.designs import DISTRIBUTIONS

if TYPE_CHECKING:
    from nonholo.ensembles import AbstractDistribution
    from nonholo.ensembles.designs import Grid, RandomDesign

_RANGE = "{from = 0.1, to = 10.0, count = 50}"
_SPACINGS = ("linear", "logarithmic")
_SIZES = {"size": "vectors", "n": "matrices"}  # what a distribution calls the length of what it draws
_WORDS = {re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower(): make for name, make in DISTRIBUTIONS.items()}
TABLES = ("body", "start", "run", "forces")
Rng = Annotated[int, Field(ge=0, lt=2**63, validation_alias=AliasChoices("rng", "seed"))]  # stores have "seed" too
Value = TypeVar("Value")


def is_range(value: Any) -> bool:
    """Return whether values of a grid are a range, whose count can be scaled."""
    return isinstance(value, dict)


def along(value: Any) -> np.ndarray:
    """Return the values along one axis of a grid.

    Example:
        >>> along({"from": 1.0, "to": 100.0, "count": 3, "spacing": "logarithmic"})
        array([  1.,  10., 100.])
    """
    return _range(value) if is_range(value) else _list(value)


def _range(table: dict[str, Any]) -> np.ndarray:
    _check_keys(table, ["from", "to", "count", "spacing"], ["from", "to", "count"], _RANGE)
    begin, end, spacing = table["from"], table["to"], table.get("spacing", "linear")
    if not (_is_number(begin) and _is_number(end)):
        raise ValueError(f"must have numbers at from and to. Got {begin!r} and {end!r}")
    size = _count(table["count"])
    if spacing not in _SPACINGS:
        raise ValueError(f'must have spacing "linear" or "logarithmic". Got {spacing!r}')
    if spacing == "logarithmic" and not (begin > 0 and end > 0):
        raise ValueError(f"must have positive bounds for logarithmic spacing. Got {begin} and {end}")
    return (np.geomspace if spacing == "logarithmic" else np.linspace)(begin, end, size)


def _count(value: Any) -> int:
    if not is_integer(value) or value < 1:
        raise ValueError(f"must have a positive integer as count. Got {shown(value)}")
    try:
        return bounded_count("count", value, 64.0, "Pass how many values.")
    except ValueError as failure:
        raise ValueError(f"must have a count that is possible: {failure}") from None


def _list(value: Any) -> np.ndarray:
    requirement = f"must be a list of numbers, vectors or matrices of one shape, or a range such as {_RANGE}"
    try:
        if isinstance(value, list) and value and _are_numbers(value):
            return np.array(value, dtype=float)
    except ValueError:
        pass
    raise ValueError(f"{requirement}. Got {value!r}")


def _are_numbers(value: Any) -> bool:
    return all(map(_are_numbers, value)) if isinstance(value, list) else _is_number(value)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and is_finite(value)


def distribution_of(table: Any) -> "AbstractDistribution":
    """Return the distribution that a table describes.

    Example:
        >>> distribution_of({"uniform": [0.1, 1.0]})
        Uniform(low=0.1, high=1.0)
        >>> distribution_of({"direction": 0.3, "size": 2})
        Direction(size=2, length=0.3)
    """
    word = _word_in(table)
    own, sizes = _arguments(word)
    _check_keys(table, [word, "size"] if sizes else [word], [word], f"{{{word} = ...}}")
    values = [table[word]] if len(own) == 1 else table[word]
    if not (isinstance(values, list) and len(values) == len(own)):
        raise ValueError(f"must be {word} = [{', '.join(own)}]. Got {values!r}")
    if needs_size(table):
        raise ValueError(f"needs size = ..., the length of the {_SIZES[sizes[0]]}, or a value in its own table")
    size = {name: table["size"] for name in sizes if "size" in table}
    try:
        return _WORDS[word](**dict(zip(own, values, strict=True)), **size)
    except ValueError as failure:
        raise ValueError(f"{word}: {str(failure).partition('` ')[2] or failure}") from None


def _word_in(table: Any) -> str:
    words = [word for word in table if word in _WORDS] if isinstance(table, dict) else []
    if len(words) != 1:
        raise ValueError(f"must hold one of {', '.join(_WORDS)}, as in {{uniform = [0.1, 1.0]}}. Got {table!r}")
    return words[0]


def _arguments(word: str) -> tuple[list[str], list[str]]:
    """Return the arguments of a distribution but for its size, and the one that is its size."""
    names = arguments(_WORDS[word])
    return [name for name in names if name not in _SIZES], [name for name in names if name in _SIZES]


def needs_size(table: Any) -> bool:
    """Return whether a distribution lacks the size that its own table can give it."""
    if not isinstance(table, dict) or "size" in table:
        return False
    each = (arguments(make)[name] for word, make in _WORDS.items() if word in table for name in _arguments(word)[1])
    return any(argument.default is argument.empty for argument in each)


def _check_keys(table: dict[str, Any], keys: list[str], necessary: list[str], example: str) -> None:
    unknown, missing = [key for key in table if key not in keys], [key for key in necessary if key not in table]
    if unknown or missing:
        fault = f"without {', '.join(missing)}" if missing else f"with {', '.join(unknown)}"
        raise ValueError(f"must have the keys of {example}. Got a table {fault}")


class Values(Section, Generic[Value]):
    """The varied keys, by table and key: values along the axes of a grid, or distributions."""

    body: dict[str, Value] = Field(default_factory=dict)
    start: dict[str, Value] = Field(default_factory=dict)
    run: dict[str, Value] = Field(default_factory=dict)
    forces: dict[str, Value] = Field(default_factory=dict)

    def by_name(self) -> Iterator[tuple[str, Any]]:
        """Yield the entries under the names of the library."""
        for table in TABLES:
            for name, value in getattr(self, table).items():
                yield library_name(f"{table}.{name}"), value


class GridDesign(Section):
    """Every combination of values along axes; with `members`, about this many of them."""

    kind: Literal["grid"]
    members: Count | None = None
    """About this many: counts of ranges are scaled alike."""
    rng: Rng = 0
    """The integer that random numbers are made of."""
    values: Values[Annotated[Any, checked_by(along)]]
    """The varied keys, by path, and their values: a list, or a range with a count."""

    def with_members(self) -> Self:
        """Return the design with the counts of its ranges multiplied by one factor, for the members asked for."""
        if self.members is None:
            return self
        values = self.values.model_dump()
        ranges = [table[name] for table in values.values() for name in table if is_range(table[name])]
        if not ranges:
            raise ValueError("needs a range with a count to scale")
        whole = math.prod(len(along(value)) for table in values.values() for value in table.values())
        factor = (self.members / whole) ** (1 / len(ranges))
        for entry in ranges:
            entry["count"] = max(1, round(entry["count"] * factor))
        return self.model_copy(update={"members": None, "values": type(self.values).model_validate(values)})

    def design(self) -> "Grid":
        """Return the design under the names of the library."""
        return nonholo.Grid({name: along(value) for name, value in self.values.by_name()}, rng=self.rng)


class RandomMembers(Section):
    """Members drawn from distributions."""

    kind: Literal["random"]
    members: Count
    """How many."""
    rng: Rng = 0
    """The integer that random numbers are made of."""
    values: Values[Annotated[Any, checked_by(distribution_of)]]
    """The varied keys, by path, and their distributions."""

    def with_members(self) -> Self:
        """Return the design itself: it has the members asked for."""
        return self

    def design(self) -> "RandomDesign":
        """Return the design under the names of the library."""
        drawings = {name: distribution_of(value) for name, value in self.values.by_name()}
        return nonholo.RandomDesign(self.members, drawings, rng=self.rng)


DESIGNS: dict[str, type[Section]] = {"grid": GridDesign, "random": RandomMembers}


def _check_reduction(name: str) -> None:
    if name not in REDUCTIONS:
        raise ValueError(f"must be one of {', '.join(REDUCTIONS)}. Got {name!r}")


class Keep(Section):
    """The quantities kept of each member."""

    reductions: list[Annotated[str, checked_by(_check_reduction)]] = Field(default_factory=lambda: ["final_state"])
    """Names of the quantities."""
    poses: bool = True
    """Compute them: for final_state, and for limit_angle of a top."""


class SweepOutput(Section):
    """The picture beside the store: a quantity by color, over one or two values of the design."""

    plot: bool = True
    """Draw a picture beside the store."""
    color: str | None = None
    """The quantity that it shows."""
    x: str | None = None
    """The key along the horizontal axis, by its path."""
    y: str | None = None
    """The key along the vertical axis."""


class SweepScenario(AbstractScenario):
    """The scenario of a sweep."""

    start: Start | None = None
    design: Annotated[Any, by_kind(DESIGNS.__getitem__, lambda name: suggestion(name, DESIGNS))]
    keep: Keep = Keep()
    output: SweepOutput = SweepOutput()

    @model_validator(mode="after")
    def _starts(self) -> Self:
        if self.start is None and not self.is_family:
            raise ValueError("`Scenario(start=...)` is missing")
        return self

    @property
    def is_family(self) -> bool:
        """Whether members are made by a function, with their start."""
        return is_ready(self.body.creation)

    def task(self) -> Any:
        """Return what is done with every member."""
        keep, run = self.keep, self.run
        if self.is_family:
            how: Any = {"parameters": self.body.keywords, "reductions": keep.reductions}
            return nonholo.FamilyTask(type(self.body).make, run.time_step, run.steps, **how)
        start: Any = self.start.model_dump(exclude_none=True) if self.start else {}
        options: Any = {"reductions": keep.reductions, "reconstruct": keep.poses, "branch": run.branch}
        return nonholo.EnsembleTask(self.discretization(), steps=run.steps, **start, **options)


def library_name(path: str) -> str:
    """Return the name of a key path in the result of a sweep; names of results stay.

    Example:
        >>> library_name("body.inertia"), library_name("forces.gravity.force_1"), library_name("heading_turn")
        ('inertia', 'gravity_force_1', 'heading_turn')
    """
    table, _, name = path.partition(".")
    return name.replace(".", "_") if table in TABLES and name else path
