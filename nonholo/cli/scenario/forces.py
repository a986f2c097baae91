"""Forces in a scenario, as data: a weight, friction, a slip, a table; what `Forced` calls them too."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Discriminator, Tag, model_validator

import nonholo
from nonholo.base.checks import shown
from nonholo.base.limits import read_text
from nonholo.cli.scenario.bodies import BODIES
from nonholo.cli.scenario.sections import Matrix, Number, Section, Vector
from nonholo.groups import components_of

if TYPE_CHECKING:
    from nonholo.systems import System

DIAGONAL, WHOLE = "friction by coefficients", "friction by matrix"
"""Parts that pydantic adds to the key path of friction."""


def _tag(given: Any) -> str:
    match given:
        case [list(), *_]:
            return WHOLE
    return DIAGONAL


Coefficients = Annotated[Annotated[Vector, Tag(DIAGONAL)] | Annotated[Matrix, Tag(WHOLE)], Discriminator(_tag)]


class Weight(Section):
    """A force that is constant in space and acts at one point of the body."""

    force: Vector
    """In space: mass times the acceleration of gravity, for a weight."""
    point: Vector
    """In body coordinates: the center of mass, for a weight."""

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        nonholo.Gravity(self.force, self.point)
        return self


class Yielding(Section):
    """Rows of the constraint that may yield: one contact."""

    rows: Matrix
    """Rows of the annihilator, in body axes: `[[0, 0, 1]]` for the blade of a sleigh in the plane."""
    grip: Number
    """The largest reaction that holds."""
    viscous: Number = 0.0
    """The coefficient of viscous friction while the rows slide."""

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        nonholo.Slip(self.rows, self.grip, self.viscous)
        return self


class Forces(Section):
    """What acts on the body beside its constraint; several add up."""

    gravity: Weight | None = None
    """A force F that is constant in space, at a body point: `{force = [0, 0, -9.81], point = [0, 0, 0.3]}`."""
    friction: Coefficients | None = None
    """Against the body velocity: a coefficient for each of its components, or a matrix."""
    slip: Yielding | None = None
    """Rows of the constraint that slide beyond a grip: `{rows = [[0, 0, 1]], grip = 0.8}`."""
    table: Matrix | None = None
    """A force for each step, in body axes: rows, or the path of a CSV file of them, from the folder of the scenario."""

    scheme: Literal["energy", "variational"] | None = None
    """Where forces act: "energy" keeps T + U and every balance exactly, "variational" kicks at the nodes."""

    def on(self, system: "System") -> "System":
        """Return the system under these forces, the system itself without any."""
        parts = {
            name: self._part(name, make, system) for name, make in _PARTS.items() if getattr(self, name) is not None
        }
        gravity, force = parts.pop("gravity", None), tuple(parts.values())
        if gravity is None and not force:
            return system
        return nonholo.Forced(system, gravity, force[0] if len(force) == 1 else force or None, self.scheme)

    def check(self, system: "System", steps: int) -> None:
        """Refuse forces that cannot act on a system, or that end before a run does."""
        self.on(system)
        if self.table is not None and len(self.table) < steps:
            got = f"{len(self.table)}. Add rows, or take fewer steps"
            raise ValueError(f"`Forces(table=...)` must have a row for each of {steps} steps. Got {got}")

    def about(self, system: "System") -> dict[str, str]:
        """Return what a report says of a table, if there is one: how long it is, and what its columns are."""
        names, rows = ", ".join(components_of(system.group)), self.table
        return {} if rows is None else {"table of forces": f"{len(rows)} rows, columns {names}"}

    def _part(self, name: str, make: "Callable[[System, Any], Any]", system: "System") -> Any:
        try:
            return make(system, getattr(self, name))
        except ValueError as failure:
            requirement, _, _ = (str(failure).partition("` ")[2] or str(failure)).partition(". Pass ")
            raise ValueError(f"`Forces({name}=...)` {requirement}. {_REMEDIES[name]}") from None


_PARTS: "dict[str, Callable[[System, Any], Any]]" = {
    "gravity": lambda system, w: nonholo.Forced(system, nonholo.Gravity(w.force, w.point)).potential,
    "friction": lambda system, given: nonholo.Forced(system, force=nonholo.Friction(given)).force,
    "slip": lambda system, given: (
        nonholo.Forced(system, force=nonholo.Slip(given.rows, given.grip, given.viscous)).force
    ),
    "table": lambda system, rows: nonholo.Forced(system, force=rows).force,
}
"""How each acts on a system."""
_REMEDIES = {
    "gravity": "Give force and point as many numbers as space has directions",
    "friction": "Give each direction of the group a coefficient that is not negative, or a matrix",
    "slip": "Give rows that span the same as rows of the annihilator",
    "table": "Give each row one number for each direction of the group",
}


def read_table(document: dict[str, Any], folder: Path) -> None:
    """Put the rows of a CSV file where a document names it: the text of a scenario then says all of a run.

    Raises:
        ValueError: The file cannot be read, or is no table of numbers.
    """
    match document:
        case {"forces": {"table": str(name)} as forces}:
            try:
                forces["table"] = rows_of(read_text(folder / name), _directions(document))
            except (OSError, ValueError) as failure:
                fault = f"Got {name!r}: {failure}"
                raise ValueError(f"must be rows, or the path of a CSV file of numbers. {fault}") from None


def _directions(document: dict[str, Any]) -> tuple[str, ...] | None:
    """Return the names of the directions of the body of a document; None if it is no body, which is reported later."""
    try:
        return components_of(BODIES[document["body"]["kind"]].model_validate(document["body"]).system().group)
    except (KeyError, TypeError, ValueError):
        return None


def rows_of(text: str, names: tuple[str, ...] | None) -> list[list[float]]:
    r"""Return the rows of a table with commas; its first line may hold the names of the columns, and no other words.

    Example:
        >>> rows_of("omega, v1, v2\n0.1,2,0\n0.2,3,0\n", ("omega", "v1", "v2"))
        [[0.1, 2.0, 0.0], [0.2, 3.0, 0.0]]
    """
    import numpy as np

    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    number, first = lines[0] if lines else (0, "")
    named = bool(lines) and not any(map(_is_number, first.split(",")))
    if named and names is not None and tuple(word.strip() for word in first.split(",")) != names:
        raise ValueError(f"line {number} is {shown(first)}, neither numbers nor the names {','.join(names)}")
    if len(lines) <= named:
        raise ValueError("it has no rows")
    return np.loadtxt([line for _, line in lines[named:]], delimiter=",", ndmin=2, comments=None).tolist()


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
