"""The contents of a scenario: a body, its start, a run, forces, its output. The file itself is read in `files`."""

import contextlib
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import ValidationInfo, field_validator, model_validator

import nonholo
from nonholo.cli.scenario.bodies import body_table, is_example, nearest_kind
from nonholo.cli.scenario.forces import Forces
from nonholo.cli.scenario.sections import Count, Numbers, Positive, Section, by_kind

if TYPE_CHECKING:
    from nonholo.discrete import Discretization
    from nonholo.systems import System

SPEEDS = ("body_velocity", "restricted_velocity", "momentum", "displacement")


class Start(Section):
    """The start of the motion: one of four forms of the velocity, and a first pose."""

    body_velocity: Numbers | None = None
    """Velocity in body axes, or of the coordinates, which must satisfy the constraint."""
    restricted_velocity: Numbers | None = None
    """Its components along the constraint subspace."""
    momentum: Numbers | None = None
    """Discrete body momentum, or its components along the constraint subspace."""
    displacement: Numbers | None = None
    """The first displacement, a matrix of the group, or what is added to the coordinates."""
    configuration: Numbers | None = None
    """First pose, a matrix of the group, by default the identity; or the first coordinates."""

    @model_validator(mode="after")
    def _is_one_start(self) -> Self:
        own = [name for name in SPEEDS if getattr(self, name) is not None]
        if len(own) != 1:
            raise ValueError(f"must hold exactly one of {', '.join(SPEEDS)}. Got {' and '.join(own) or 'none'}.")
        return self


class Run(Section):
    """The discretization and the length of the run."""

    time_step: Positive
    """Time from one state to the next, in your units; of an example, its own by default."""
    steps: Count
    """How many; of an example, its own by default."""
    save_every: Count = 1
    """Steps between saved states."""
    difference: Literal["matrix", "logarithmic"] | None = None
    """The discrete Lagrangian; by default the one with exact energy, where there is one."""
    constraint: Literal["skew", "exponential", "naive"] | None = None
    """The displacements that are allowed; by default those that belong to the difference."""
    order: Literal[2, 4, 6, 8] = 2
    """Above 2 a symmetric composition of steps."""
    branch: Literal["principal", "nearest", "smallest", "largest", "inner", "outer"] = "principal"
    """Which value of the multivalued map."""


class Output(Section):
    """The picture beside the store."""

    plot: bool = True
    """Draw a picture beside the store."""
    gif: bool = False
    """Draw an animation beside it: of bodies on SO(3), SE(2) and SE(3), and of coordinates."""


class AbstractScenario(Section):
    """The tables that scenarios of one motion and of sweeps share."""

    title: str = ""
    body: Annotated[Any, by_kind(body_table, nearest_kind)]
    run: Run
    forces: Forces = Forces()

    @field_validator("forces")
    @classmethod
    def _can_act(cls, forces: Forces, rest: ValidationInfo) -> Forces:
        if {"body", "run"} <= rest.data.keys():
            forces.check(moving(rest.data["body"].creation), rest.data["run"].steps)
        return forces

    def system(self) -> "System":
        """Return the body under its forces."""
        return self.forces.on(moving(self.body.creation))

    def discretization(self) -> "Discretization":
        """Return the discretized body."""
        run = self.run
        return nonholo.discretize(self.system(), run.time_step, run.difference, run.constraint, run.order)

    def in_force(self, discrete: "Discretization") -> Self:
        """Return the scenario with the library's choices of difference and constraint written out."""
        choices = {name: getattr(discrete, name, None) for name in ("difference", "constraint")}
        return self.model_copy(update={"run": self.run.model_copy(update=choices)})


class Scenario(AbstractScenario):
    """A whole scenario."""

    start: Start
    output: Output = Output()

    def options(self) -> dict[str, Any]:
        """Return the arguments of `simulate`."""
        branch = {} if self.run.branch == "principal" else {"branch": self.run.branch}
        return {**self.start.model_dump(exclude_none=True), "save_every": self.run.save_every, **branch}


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
                product = body_table(kind).model_validate(body).creation
                if is_ready(product):
                    _complete_by(product, document, start=start)


def _complete_by(example: Any, document: dict[str, Any], *, start: bool) -> None:
    run, own = document.setdefault("run", {}), document.setdefault("start", {}) if start else None
    if isinstance(run, dict):
        own_run = {name: getattr(example, name, None) for name in ("time_step", "steps")}
        run |= {name: value for name, value in own_run.items() if value is not None and name not in run}
    if isinstance(own, dict):
        names = ("configuration",) if own.keys() & {*SPEEDS} else ("configuration", "body_velocity")
        own |= {name: np.asarray(getattr(example, name)).tolist() for name in names if name not in own}
