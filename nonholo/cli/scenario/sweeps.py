"""The scenario of a sweep: a body, a start and a run as for one motion, a design, what to keep; and its file.

Values of a design are lists and ranges of a grid, or distributions: the classes of `nonholo` by their names.
"""

import contextlib
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Generic, Literal, Self, TypeVar

import numpy as np
from pydantic import AliasChoices, Field, model_validator

import nonholo
from nonholo.base.checks import bounded_count
from nonholo.cli.scenario import files, sections
from nonholo.cli.scenario.bodies import arguments, is_example
from nonholo.cli.scenario.motion import AbstractScenario, Start, is_ready
from nonholo.ensembles import REDUCTIONS, STARTS, component_of, force_numbers, start_component
from nonholo.ensembles.distributions import DISTRIBUTIONS, AbstractDistribution

_SIZES = {"size": "vectors", "n": "matrices"}  # what a distribution calls the length of what it draws
_WORDS = {re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower(): make for name, make in DISTRIBUTIONS.items()}
TABLES = ("body", "start", "run", "forces")
Rng = Annotated[int, Field(ge=0, lt=2**63, validation_alias=AliasChoices("rng", "seed"))]  # stores have "seed" too
Value = TypeVar("Value")


class Range(sections.Section):
    """Values along one axis of a grid, from one bound to the other."""

    begin: sections.Finite = Field(alias="from")
    end: sections.Finite = Field(alias="to")
    count: sections.Count
    spacing: Literal["linear", "logarithmic"] = "linear"

    @model_validator(mode="after")
    def _can_be_made(self) -> Self:
        bounded_count("count", self.count, 64.0, "Pass how many values.")
        if self.spacing == "logarithmic" and not min(self.begin, self.end) > 0:
            got = f"{self.begin:g} and {self.end:g}"
            raise ValueError(f"must have positive bounds for logarithmic spacing. Got {got}")
        return self


def along(value: Any) -> np.ndarray:
    """Return the values along one axis of a grid.

    Example:
        >>> along({"from": 1.0, "to": 100.0, "count": 3, "spacing": "logarithmic"})
        array([  1.,  10., 100.])
    """
    if isinstance(value, dict):
        own = Range.model_validate(value)
        return (np.geomspace if own.spacing == "logarithmic" else np.linspace)(own.begin, own.end, own.count)
    requirement = "must be a list of numbers, vectors or matrices of one shape, or a range such as"
    with contextlib.suppress(ValueError):
        if isinstance(value, list) and value:
            sections.check_numbers(value)
            return np.array(value, dtype=float)
    raise ValueError(f"{requirement} {{from = 0.1, to = 10.0, count = 50}}. Got {value!r}")


def distribution_of(table: Any) -> AbstractDistribution:
    """Return the distribution that a table describes.

    Example:
        >>> distribution_of({"uniform": [0.1, 1.0]})
        Uniform(low=0.1, high=1.0)
        >>> distribution_of({"direction": 0.3, "size": 2})
        Direction(size=2, length=0.3)
    """
    word = _word_in(table)
    own, sizes = _arguments(word)
    if unknown := table.keys() - {word, *(["size"] if sizes else [])}:
        raise ValueError(f"must have the keys of {{{word} = ...}}. Got a table with {', '.join(unknown)}")
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


class Values(sections.Section, Generic[Value]):
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


class GridDesign(sections.Section):
    """Every combination of values along axes; with `members`, about this many of them.

    Attributes:
        members: About this many: counts of ranges are scaled alike.
        rng: The integer that random numbers are made of.
        values: The varied keys, by path, and their values: a list, or a range with a count.
    """

    kind: Literal["grid"]
    members: sections.Count | None = None
    rng: Rng = 0
    values: Values[Annotated[Any, sections.checked_by(along)]]

    @model_validator(mode="after")
    def _with_members(self) -> Self:
        """Return the design with the counts of its ranges multiplied by one factor, for this number of members."""
        if self.members is None:
            return self
        values = self.values.model_dump()
        ranges = [table[name] for table in values.values() for name in table if isinstance(table[name], dict)]
        if not ranges:
            raise ValueError("`Grid(members=...)` needs a range with a count to scale")
        whole = math.prod(len(along(value)) for table in values.values() for value in table.values())
        factor = (self.members / whole) ** (1 / len(ranges))
        for entry in ranges:
            entry["count"] = max(1, round(entry["count"] * factor))
        return self.model_validate(self.model_dump(exclude={"members"}) | {"values": values})

    def design(self) -> nonholo.Grid:
        """Return the design under the names of the library."""
        return nonholo.Grid({name: along(value) for name, value in self.values.by_name()}, rng=self.rng)


class RandomMembers(sections.Section):
    """Members drawn from distributions.

    Attributes:
        members: How many.
        rng: The integer that random numbers are made of.
        values: The varied keys, by path, and their distributions.
    """

    kind: Literal["random"]
    members: sections.Count
    rng: Rng = 0
    values: Values[Annotated[Any, sections.checked_by(distribution_of)]]

    def design(self) -> nonholo.RandomDesign:
        """Return the design under the names of the library."""
        drawings = {name: distribution_of(value) for name, value in self.values.by_name()}
        return nonholo.RandomDesign(self.members, drawings, rng=self.rng)


DESIGNS: dict[str, type[sections.Section]] = {"grid": GridDesign, "random": RandomMembers}


class Keep(sections.Section):
    """The quantities kept of each member.

    Attributes:
        reductions: Names of the quantities.
        poses: Compute them: for final_state, and for limit_angle of a top.
    """

    reductions: list[Literal[tuple(REDUCTIONS)]] = Field(default_factory=lambda: ["final_state"])  # type: ignore[valid-type]
    poses: bool = True


class SweepOutput(sections.Section):
    """The picture beside the store: a quantity by color, over one or two values of the design.

    Attributes:
        plot: Draw a picture beside the store.
        color: The quantity that it shows.
        x: The key along the horizontal axis, by its path.
        y: The key along the vertical axis.
    """

    plot: bool = True
    color: str | None = None
    x: str | None = None
    y: str | None = None


class SweepScenario(AbstractScenario):
    """The scenario of a sweep."""

    start: Start | None = None
    design: Annotated[Any, sections.by_kind(DESIGNS.__getitem__, lambda name: sections.suggestion(name, DESIGNS))]
    keep: Keep = Keep()
    output: SweepOutput = SweepOutput()

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


def load_sweep_scenario(
    name: str, settings: list[files.Setting], module: Path | None = None
) -> files.Loaded[SweepScenario]:
    """Return the scenario of a sweep with settings applied, or raise with all its problems."""
    files.take_module(module)
    origin, document = files.read_document(name, files.built_in("sweeps"), settings)
    files.by_table(document)
    body = files.table_in(document, "body").get("kind")
    if not (isinstance(body, str) and is_example(body)):
        _complete(document)
    files.complete(document, name, origin, start=False)
    request = files.validate(document, SweepScenario, Path(name).stem, origin)
    if flaws := list(_refusals(request.scenario)):
        raise origin.error(*flaws)
    return request


def _complete(document: dict[str, Any]) -> None:
    """Take the size of a distribution from the value it varies; give a value that is varied and not given."""
    values = files.table_in(files.table_in(document, "design"), "values")
    for table in ("body", "start", "run"):
        if own := files.table_in(values, table):
            document.setdefault(table, {})
        for name, value in own.items():
            _complete_one(files.table_in(document, table), name, value)
    _complete_start(files.table_in(document, "start"), files.table_in(values, "start"))


def _complete_one(own: dict[str, Any], name: str, value: Any) -> None:
    if needs_size(value) and isinstance(own.get(name), list):
        value["size"] = len(own[name])
    if name not in own and not start_component(name):
        with contextlib.suppress(ValueError):  # reported as a problem of the design
            own[name] = _typical(value)


def _complete_start(own: dict[str, Any], values: dict[str, Any]) -> None:
    """Give a start of which every component is varied, from the first one on, and none is given."""
    parts = {part: value for name, value in values.items() if (part := start_component(name))}
    if not parts or not set(STARTS).isdisjoint([*own, *values]):
        return
    owner, _ = next(iter(parts))
    places = [(owner, component) for component in range(len(parts))]
    if parts.keys() == set(places):
        with contextlib.suppress(ValueError):  # reported as a problem of the design
            own[owner] = [_typical(parts[place]) for place in places]


def _typical(value: Any) -> Any:
    if not isinstance(value, dict) or "count" in value:
        return along(value)[0].tolist()
    distribution = distribution_of(value)
    return distribution.draw(np.random.default_rng(0).random((1, distribution.width)))[0].tolist()


def _refusals(scenario: SweepScenario) -> Iterator[tuple[str, str]]:
    """Yield key paths and texts of what a design cannot vary, and a scenario of one motion may say, but no sweep."""
    entries = [(table, name) for table in TABLES for name in getattr(scenario.design.values, table)]
    if not entries:
        yield "design.values", 'must name what is varied, for example "body.a" = [0.1, 0.2]'
    names = _varied_names(scenario)
    yield from filter(None, (_flaw(scenario, table, name, names[table]) for table, name in entries))
    if scenario.is_family == (scenario.start is not None):
        yield "start", "is not for sweeps of this body, whose keys have its start" if scenario.start else "is missing"
    for key in ("displacement", "configuration"):
        if getattr(scenario.start, key, None) is not None:
            yield f"start.{key}", f"is not for sweeps. Start by {', '.join(STARTS)}"
    if scenario.run.save_every != 1:
        yield "run.save_every", "is not for sweeps: [keep] lists what is kept"


def _flaw(scenario: SweepScenario, table: str, name: str, names: tuple[str, ...]) -> tuple[str, str] | None:
    """Return what is wrong with a value that is varied, and where; None of one that can be."""
    own = library_name(f"{table}.{name}")
    whole = _whole(own, names)
    is_part = whole != own
    if whole not in names or (is_part and table == "body" and not scenario.is_family):
        return f"design.values.{table}.{name}", f"cannot be varied. {sections.suggestion(own, names)}"
    if is_part and table == "start" and scenario.start and getattr(scenario.start, whole) is None:
        return f"start.{whole}", f"is missing: {name} is varied, the other components are given here"
    return None


def _whole(name: str, names: tuple[str, ...]) -> str:
    """Return the array that a name is a component of, where the name itself is not known."""
    part = component_of(name)
    return part[0] if part and name not in names else name


def _varied_names(scenario: SweepScenario) -> dict[str, tuple[str, ...]]:
    """Return what can be varied by table, as the library calls it."""
    if scenario.is_family:
        names = tuple(arguments(type(scenario.body).make))
        return {"body": names, "start": ("configuration", "body_velocity"), "run": ("time_step",), "forces": ()}
    system: Any = scenario.system()
    leaves = (*system.inside.leaves, "inertia_operator")
    body = tuple(name for name in type(scenario.body).model_fields if name in leaves)
    return {"body": body, "start": STARTS, "run": ("time_step",), "forces": tuple(force_numbers(system))}
