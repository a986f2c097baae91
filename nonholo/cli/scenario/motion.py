"""The contents of a scenario: a body, its start, a run, forces, its output. The file itself is read in `files`."""

from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, ValidationInfo, field_validator, model_validator

import nonholo
from nonholo.cli.scenario.bodies import AnyBody
from nonholo.cli.scenario.forces import Forces
from nonholo.cli.scenario.sections import Count, Matrix, Positive, Section, Vector, exactly_one

if TYPE_CHECKING:
    from nonholo.discrete import Discretization
    from nonholo.systems import System


class Start(Section):
    """The start of the motion: one of four ways to say how fast, and a first pose."""

    body_velocity: Vector | None = None
    """Velocity in body axes, which must satisfy the constraint."""
    restricted_velocity: Vector | None = None
    """Its components along the constraint subspace."""
    momentum: Vector | None = None
    """Discrete body momentum, or its components along the constraint subspace."""
    displacement: Matrix | None = None
    """The first displacement, a matrix of the group."""
    configuration: Matrix | None = None
    """First pose, a matrix of the group; by default the identity."""

    @model_validator(mode="after")
    def _is_one_start(self) -> Self:
        exactly_one(self, ("body_velocity", "restricted_velocity", "momentum", "displacement"))
        return self


class Run(Section):
    """The discretization and the length of the run."""

    time_step: Positive
    """Time from one state to the next, in your units."""
    steps: Count
    """How many."""
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
    body: Annotated[AnyBody, Field(discriminator="kind")]
    start: Start
    run: Run
    forces: Forces = Forces()

    @field_validator("forces")
    @classmethod
    def _can_act(cls, forces: Forces, rest: ValidationInfo) -> Forces:
        if {"body", "run"} <= rest.data.keys():
            forces.check(rest.data["body"].system(), rest.data["run"].steps)
        return forces

    def system(self) -> "System":
        """Return the body under its forces."""
        return self.forces.on(self.body.system())

    def discretization(self) -> "Discretization":
        """Return the discretized body."""
        run = self.run
        return nonholo.discretize(self.system(), run.time_step, run.difference, run.constraint, run.order)

    def in_force(self, discrete: "Discretization") -> Self:
        """Return the scenario with the library's choices of difference and constraint written out."""
        chosen = {"difference": discrete.difference, "constraint": discrete.constraint}
        return self.model_copy(update={"run": self.run.model_copy(update=chosen)})


class Scenario(AbstractScenario):
    """A whole scenario."""

    output: Output = Output()

    def options(self) -> dict[str, Any]:
        """Return the arguments of `simulate`."""
        return {
            **self.start.model_dump(exclude_none=True),
            "save_every": self.run.save_every,
            "branch": self.run.branch,
        }
