"""What a scenario may say: a body, its start, a run, its output. The file itself is read in `_scenario_file`."""

from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

if TYPE_CHECKING:
    from nonholo.discrete import Discretization
    from nonholo.systems import AbstractLLSystem

Number = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Count = Annotated[int, Field(gt=0, le=10**15)]
Vector = list[Number]
Matrix = list[Vector]


class Section(BaseModel):
    """A table of a scenario: no unknown keys, no silent conversions."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class SuslovBody(Section):
    """A rigid body about a fixed point that may not spin about one of its axes; it settles to a permanent rotation."""

    kind: Literal["suslov"]
    mass_tensor: Matrix | None = None
    inertia: Matrix | None = None
    axis: Vector = [0.0, 0.0, 1.0]

    @model_validator(mode="after")
    def _is_a_body(self) -> Self:
        _exactly_one(self, ("mass_tensor", "inertia"))
        self.system()
        return self

    def system(self) -> "AbstractLLSystem":
        """Return the top."""
        import numpy as np

        from nonholo.systems import SuslovTop

        if self.inertia is not None:
            return SuslovTop.from_inertia(self.inertia, axis=self.axis)
        return SuslovTop(np.array(self.mass_tensor), axis=np.array(self.axis))


class SleighBody(Section):
    """A rigid body in the plane on a blade that cannot slip sideways; it turns round until its mass leads."""

    kind: Literal["sleigh"]
    mass: Positive
    inertia: Positive
    a: Number
    b: Number = 0.0

    def system(self) -> "AbstractLLSystem":
        """Return the sleigh."""
        from nonholo.systems import ChaplyginSleigh

        return ChaplyginSleigh(self.mass, self.inertia, self.a, self.b)


class Start(Section):
    """Where the motion starts: one of four ways to say how fast, and a first pose."""

    body_velocity: Vector | None = None
    restricted_velocity: Vector | None = None
    momentum: Vector | None = None
    displacement: Matrix | None = None
    configuration: Matrix | None = None

    @model_validator(mode="after")
    def _is_one_start(self) -> Self:
        _exactly_one(self, ("body_velocity", "restricted_velocity", "momentum", "displacement"))
        return self


class Run(Section):
    """The discretisation and the length of the run."""

    time_step: Positive
    steps: Count
    save_every: Count = 1
    difference: Literal["matrix", "logarithmic"] = "matrix"
    constraint: Literal["skew", "exponential"] = "skew"
    branch: Literal["principal"] = "principal"


class Output(Section):
    """What is drawn beside the store."""

    plot: bool = True
    gif: bool = False


class Scenario(Section):
    """A whole scenario."""

    title: str = ""
    body: Annotated[SuslovBody | SleighBody, Field(discriminator="kind")]
    start: Start
    run: Run
    output: Output = Output()

    def discretization(self) -> "Discretization":
        """Return the discretised body."""
        from nonholo.discrete import discretize

        return discretize(self.body.system(), self.run.time_step, self.run.difference, self.run.constraint)

    def options(self) -> dict[str, Any]:
        """Return the arguments of `simulate`."""
        return {
            **self.start.model_dump(exclude_none=True),
            "save_every": self.run.save_every,
            "branch": self.run.branch,
        }


BODIES = {"suslov": SuslovBody, "sleigh": SleighBody}


def _exactly_one(section: Section, names: tuple[str, ...]) -> None:
    given = [name for name in names if getattr(section, name) is not None]
    if len(given) != 1:
        raise ValueError(f"must hold exactly one of {', '.join(names)}. Got {' and '.join(given) or 'none'}.")
