"""The contents of the scenario of a sweep: a body, a start and a run as for one motion, a design, what to keep."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Generic, Literal, Self, TypeVar

from pydantic import Field

import nonholo
from nonholo.cli.scenario._values import Along, Drawn, along, drawn, is_range
from nonholo.cli.scenario.motion import AbstractScenario
from nonholo.cli.scenario.sections import Count, Section, checked_by

if TYPE_CHECKING:
    from nonholo.ensembles import EnsembleTask
    from nonholo.ensembles.designs import Grid, RandomDesign

Seed = Annotated[int, Field(ge=0, lt=2**63)]
Given = TypeVar("Given")


class Values(Section, Generic[Given]):
    """What is varied, by table and key: values along the axes of a grid, or distributions."""

    body: dict[str, Given] = Field(default_factory=dict)
    start: dict[str, Given] = Field(default_factory=dict)
    run: dict[str, Given] = Field(default_factory=dict)


class GridDesign(Section):
    """Every combination of values along axes; with `members`, about this many of them."""

    kind: Literal["grid"]
    members: Count | None = None
    """About this many: counts of ranges are scaled alike."""
    seed: Seed = 0
    """Of random numbers."""
    values: Values[Along]
    """What is varied, by key path, and its values: a list, or a range with a count."""

    def scaled(self) -> Self:
        """Return the design with the counts of its ranges multiplied by one factor, for the members asked for."""
        if self.members is None:
            return self
        values = self.values.model_dump()
        ranges = [table[name] for table in values.values() for name in table if is_range(table[name])]
        if not ranges:
            raise ValueError("needs a range with a count to scale")
        whole = math.prod(len(along(given)) for table in values.values() for given in table.values())
        factor = (self.members / whole) ** (1 / len(ranges))
        for given in ranges:
            given["count"] = max(1, round(given["count"] * factor))
        return self.model_copy(update={"members": None, "values": Values[Along].model_validate(values)})

    def design(self) -> "Grid":
        """Return the design under the names of the library."""
        return nonholo.Grid({name: along(given) for name, given in named(self.values)}, seed=self.seed)


class RandomMembers(Section):
    """Members drawn from distributions."""

    kind: Literal["random"]
    members: Count
    """How many."""
    seed: Seed = 0
    """Of random numbers."""
    values: Values[Drawn]
    """What is varied, by key path, and its distribution."""

    def scaled(self) -> Self:
        """Return the design itself: it has the members asked for."""
        return self

    def design(self) -> "RandomDesign":
        """Return the design under the names of the library."""
        drawings = {name: drawn(given) for name, given in named(self.values)}
        return nonholo.RandomDesign(self.members, drawings, seed=self.seed)


DESIGNS: dict[str, type[Section]] = {"grid": GridDesign, "random": RandomMembers}


def _check_reduction(name: str) -> None:
    from nonholo.ensembles import REDUCTIONS

    if name not in REDUCTIONS:
        raise ValueError(f"must be one of {', '.join(REDUCTIONS)}. Got {name!r}")


Reduction = Annotated[str, checked_by(_check_reduction)]


class Keep(Section):
    """The quantities kept of each member."""

    reductions: list[Reduction] = Field(default_factory=lambda: ["final_state"])
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
    """What is varied along the horizontal axis, by key path."""
    y: str | None = None
    """What is varied along the vertical axis."""


class SweepScenario(AbstractScenario):
    """The scenario of a sweep."""

    design: Annotated[GridDesign | RandomMembers, Field(discriminator="kind")]
    keep: Keep = Keep()
    output: SweepOutput = SweepOutput()

    def task(self) -> "EnsembleTask":
        """Return what is done with every member."""
        start: Any = self.start.model_dump(exclude_none=True)
        options: Any = {"reductions": self.keep.reductions, "reconstruct": self.keep.poses, "branch": self.run.branch}
        return nonholo.EnsembleTask(self.discretization(), steps=self.run.steps, **start, **options)


def named(values: Values) -> Iterator[tuple[str, Any]]:
    """Yield the entries of a design under the names of the library, which are those of the keys."""
    for table in (values.body, values.start, values.run):
        yield from table.items()


def library_name(path: str) -> str:
    """Return the name of a key path in the result of a sweep; names of results stay.

    Example:
        >>> library_name("body.inertia"), library_name("heading_turn")
        ('inertia', 'heading_turn')
    """
    table, _, name = path.partition(".")
    return name if table in ("body", "start", "run") and name else path
