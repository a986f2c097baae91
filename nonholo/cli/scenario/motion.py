"""The contents of a scenario: a body, its start, a run, forces, its output. The file itself is read in `files`.

Forces are data: the classes of `nonholo` that act, by their names, and a table of rows.
"""

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, ValidationInfo, create_model, field_validator, model_validator

import nonholo
from nonholo.base.checks import shown
from nonholo.base.limits import read_text
from nonholo.cli.scenario.bodies import MadeTable, Maker, arguments, body_table, is_example, nearest_kind, table_of
from nonholo.cli.scenario.sections import Count, Numbers, Positive, Section, by_kind, checked_by, summary
from nonholo.groups import components_of
from nonholo.systems import System

_KINDS = (nonholo.Gravity, nonholo.Linear, nonholo.Spring, nonholo.Friction, nonholo.Slip)
_CLASSES: dict[str, Maker] = {make.__name__.lower(): make for make in _KINDS}
SPEEDS = ("body_velocity", "restricted_velocity", "momentum", "displacement")


class Start(Section):
    """The start of the motion: one of four forms of the velocity, and a first pose.

    Attributes:
        body_velocity: Velocity in body axes, or of the coordinates, which must satisfy the constraint.
        restricted_velocity: Its components along the constraint subspace.
        momentum: Discrete body momentum, or its components along the constraint subspace.
        displacement: The first displacement, a matrix of the group, or what is added to the coordinates.
        configuration: First pose, a matrix of the group, by default the identity; or the first coordinates.
    """

    body_velocity: Numbers | None = None
    restricted_velocity: Numbers | None = None
    momentum: Numbers | None = None
    displacement: Numbers | None = None
    configuration: Numbers | None = None

    @model_validator(mode="after")
    def _is_one_start(self) -> Self:
        if len(own := [name for name in SPEEDS if getattr(self, name) is not None]) != 1:
            raise ValueError(f"must hold exactly one of {', '.join(SPEEDS)}. Got {' and '.join(own) or 'none'}.")
        return self


class Run(Section):
    """The discretization and the length of the run.

    Attributes:
        time_step: Time from one state to the next, in your units; of an example, its own by default.
        steps: How many; of an example, its own by default.
        save_every: Steps between saved states.
        difference: The discrete Lagrangian; by default the one with exact energy, where there is one.
        constraint: The displacements that are allowed; by default those that belong to the difference.
        order: Above 2 a symmetric composition of steps.
        branch: Which value of the multivalued map.
    """

    time_step: Positive
    steps: Count
    save_every: Count = 1
    difference: Literal["matrix", "logarithmic"] | None = None
    constraint: Literal["skew", "exponential", "naive"] | None = None
    order: Literal[2, 4, 6, 8] = 2
    branch: Literal["principal", "nearest", "smallest", "largest", "inner", "outer"] = "principal"


class AbstractForces(Section):
    """Forces on the body beside those of its constraint; several add up.

    Attributes:
        table: A force for each step, in body axes: rows, or the path of a CSV file of them, from the folder of the
            scenario.
        scheme: Where forces act: "energy" keeps T + U and every balance exactly, "variational" kicks at the nodes.
    """

    table: Numbers | None = None
    scheme: Literal["energy", "variational"] | None = None

    def on(self, system: System) -> System:
        """Return the system under these forces, the system itself without any."""
        parts = []
        for word, make in (*_CLASSES.items(), ("table", None)):
            if (own := getattr(self, word)) is None:
                continue
            if make is not None:  # one with a single argument is written without its name
                own = own.creation if isinstance(own, MadeTable) else make(own)
            try:
                nonholo.Forced(system, **_acting([own]))
            except ValueError as failure:
                raise ValueError(f"`Forces({word}=...)` {_requirement(failure)}") from None
            parts.append(own)
        return nonholo.Forced(system, **_acting(parts), scheme=self.scheme) if parts else system

    def about(self, system: System) -> dict[str, str]:
        """Return what a report says of a table, if there is one: how long it is, and what its columns are."""
        if self.table is None:
            return {}
        return {"table of forces": f"{len(self.table)} rows, columns {', '.join(components_of(system.group))}"}


def _requirement(failure: ValueError) -> str:
    """Return what an error asks for, without its owner, and without remedies that a scenario does not have."""
    text, _, _ = (str(failure).partition("` ")[2] or str(failure)).partition(". Pass ")
    return text


def _acting(parts: list[Any]) -> dict[str, Any]:
    """Return the arguments of `Forced`: what has an energy is a potential."""
    potentials = [part for part in parts if hasattr(part, "energy")]
    several = {"potential": potentials, "force": [part for part in parts if not hasattr(part, "energy")]}
    return {name: tuple(own) if len(own) > 1 else own[0] for name, own in several.items() if own}


def _value(word: str, make: Maker) -> Any:
    """Return what a scenario holds of a class: its table, or the value of its only argument."""
    if len(arguments(make)) > 1:
        return table_of(word, make) | None

    def check(value: Any) -> None:
        try:
            make(value)
        except ValueError as failure:
            raise ValueError(_requirement(failure)) from None

    return Annotated[Numbers, checked_by(check)]


_FIELDS: Any = {w: (_value(w, make), Field(None, description=summary(make))) for w, make in _CLASSES.items()}
if TYPE_CHECKING:
    Forces = AbstractForces
else:
    Forces = create_model("Forces", __base__=AbstractForces, __doc__=AbstractForces.__doc__, **_FIELDS)


def read_table(document: dict[str, Any], folder: Path, names: tuple[str, ...] | None) -> None:
    """Put the rows of a CSV file where a document names it: the text of a scenario then says all of a run.

    Raises:
        ValueError: The file cannot be read, or is no table of numbers.
    """
    match document:
        case {"forces": {"table": str(name)} as forces}:
            try:
                forces["table"] = rows_of(read_text(folder / name), names)
            except (OSError, ValueError) as failure:
                fault = f"Got {name!r}: {failure}"
                raise ValueError(f"must be rows, or the path of a CSV file of numbers. {fault}") from None


def rows_of(text: str, names: tuple[str, ...] | None) -> list[list[float]]:
    r"""Return the rows of a table with commas; its first line may hold the names of the columns, and no other words.

    Example:
        >>> rows_of("omega, v1, v2\n0.1,2,0\n0.2,3,0\n", ("omega", "v1", "v2"))
        [[0.1, 2.0, 0.0], [0.2, 3.0, 0.0]]
    """
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    number, first = lines[0] if lines else (0, "")
    has_names = bool(lines) and not any(map(_is_number, first.split(",")))
    if has_names and names is not None and tuple(word.strip() for word in first.split(",")) != names:
        raise ValueError(f"line {number} is {shown(first)}, neither numbers nor the names {','.join(names)}")
    if len(lines) <= has_names:
        raise ValueError("it has no rows")
    return np.loadtxt([line for _, line in lines[has_names:]], delimiter=",", ndmin=2, comments=None).tolist()


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


class Output(Section):
    """The picture beside the store.

    Attributes:
        plot: Draw a picture beside the store.
        gif: Draw an animation beside it: of bodies on SO(3), SE(2) and SE(3), and of coordinates.
    """

    plot: bool = True
    gif: bool = False


class AbstractScenario(Section):
    """The tables that scenarios of one motion and of sweeps share."""

    title: str = ""
    body: Annotated[Any, by_kind(body_table, nearest_kind)]
    run: Run
    forces: Forces = Forces()

    @field_validator("forces")
    @classmethod
    def _can_act(cls, forces: Forces, rest: ValidationInfo) -> Forces:
        """Refuse forces that cannot act on the body, or that end before the run does."""
        if {"body", "run"} <= rest.data.keys():
            forces.on(moving(rest.data["body"].creation))
            steps, table = rest.data["run"].steps, forces.table
            if table is not None and len(table) < steps:
                got = f"{len(table)}. Add rows, or take fewer steps"
                raise ValueError(f"`Forces(table=...)` must have a row for each of {steps} steps. Got {got}")
        return forces

    def system(self) -> System:
        """Return the body under its forces."""
        return self.forces.on(moving(self.body.creation))

    def discretization(self) -> "nonholo.Discretization":
        """Return the discretized body."""
        run = self.run
        return nonholo.discretize(self.system(), run.time_step, run.difference, run.constraint, run.order)

    def in_force(self, discrete: "nonholo.Discretization") -> Self:
        """Return the scenario with the library's choices of difference and constraint written out."""
        choices = {name: getattr(discrete, name, None) for name in ("difference", "constraint")}
        return self.model_copy(update={"run": self.run.model_copy(update=choices)})


class Scenario(AbstractScenario):
    """A whole scenario."""

    start: Start
    output: Output = Output()

    def options(self) -> dict[str, Any]:
        """Return the arguments of `simulate`."""
        return self.start.model_dump(exclude_none=True) | self.run.model_dump(include={"steps", "save_every", "branch"})


def is_ready(product: Any) -> bool:
    """Return whether what a body made comes with a start, as the examples do."""
    return hasattr(product, "configuration") and hasattr(product, "body_velocity")


def moving(product: Any) -> Any:
    """Return the system of what a body made."""
    return product.system if is_ready(product) else product


def complete_ready(document: dict[str, Any], *, start: bool = True) -> None:
    """Take from an example what a document leaves out: its start, its time step, how many steps show it.

    Raises:
        ValidationError: The body is none.
    """
    match document:
        case {"body": {"kind": str(kind)} as body} if is_example(kind):
            with contextlib.suppress(KeyError):  # of an unknown kind, which is reported with the rest
                if is_ready(product := body_table(kind).model_validate(body).creation):
                    _complete_by(product, document, start=start)


def _complete_by(example: Any, document: dict[str, Any], *, start: bool) -> None:
    run, own = document.setdefault("run", {}), document.setdefault("start", {}) if start else None
    if isinstance(run, dict):
        own_run = {name: getattr(example, name, None) for name in ("time_step", "steps")}
        run |= {name: value for name, value in own_run.items() if value is not None and name not in run}
    if isinstance(own, dict):
        names = ("configuration",) if own.keys() & {*SPEEDS} else ("configuration", "body_velocity")
        own |= {name: np.asarray(getattr(example, name)).tolist() for name in names if name not in own}
