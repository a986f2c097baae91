"""Forces in a scenario, as data: the classes of `nonholo` that act, by their names, and a table of rows."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, create_model

import nonholo
from nonholo.base.checks import shown
from nonholo.base.limits import read_text
from nonholo.cli.scenario.bodies import MadeTable, Maker, arguments, summary, table_of
from nonholo.cli.scenario.sections import Numbers, Section, checked_by
from nonholo.groups import components_of

if TYPE_CHECKING:
    from nonholo.systems import System

_KINDS = (nonholo.Gravity, nonholo.Linear, nonholo.Spring, nonholo.Friction, nonholo.Slip)
_CLASSES: dict[str, Maker] = {make.__name__.lower(): make for make in _KINDS}


class AbstractForces(Section):
    """Forces on the body beside those of its constraint; several add up."""

    table: Numbers | None = None
    """A force for each step, in body axes: rows, or the path of a CSV file of them, from the folder of the scenario."""
    scheme: Literal["energy", "variational"] | None = None
    """Where forces act: "energy" keeps T + U and every balance exactly, "variational" kicks at the nodes."""

    def on(self, system: "System") -> "System":
        """Return the system under these forces, the system itself without any."""
        tables = {word: getattr(self, word) for word in (*_CLASSES, "table")}
        parts: dict[str, Any] = {word: table for word, table in tables.items() if table is not None}
        for word in filter(_CLASSES.__contains__, parts):  # one with a single argument is written without its name
            own = parts[word]
            parts[word] = own.creation if isinstance(own, MadeTable) else _CLASSES[word](own)
        if not parts:
            return system
        for word, part in parts.items():
            try:
                nonholo.Forced(system, **_acting([part]))
            except ValueError as failure:
                raise ValueError(f"`Forces({word}=...)` {_requirement(failure)}") from None
        return nonholo.Forced(system, **_acting([*parts.values()]), scheme=self.scheme)

    def check(self, system: "System", steps: int) -> None:
        """Refuse forces that cannot act on a system, or that end before a run does."""
        self.on(system)
        if self.table is not None and len(self.table) < steps:
            got = f"{len(self.table)}. Add rows, or take fewer steps"
            raise ValueError(f"`Forces(table=...)` must have a row for each of {steps} steps. Got {got}")

    def about(self, system: "System") -> dict[str, str]:
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
    forces = [part for part in parts if not hasattr(part, "energy")]
    several = {"potential": potentials, "force": forces}
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
    import numpy as np

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
