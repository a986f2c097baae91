"""The figures of a run: measured, as plain numbers for `--json`, and as a table with what to expect of them."""

import dataclasses
import json
import math
from collections.abc import Iterable
from typing import Any

import numpy as np
import typer
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from nonholo.analysis import invariants
from nonholo.groups import SO
from nonholo.io import described_system, fields_of
from nonholo.orbit import AbstractOrbit

ROUNDING = "rounding"
_ENERGY = {True: "exact by theorem", False: "not exact for this discretization", None: "tolerance of the solver"}
_WIDEST = 6  # columns of a matrix that is shown whole
_LARGE = 100  # dimension of a group from which inertia operators are too large to print
_LABELS = {"mass_tensor": "mass tensor J", "inertia_tensor": "inertia tensor tr(J)-J"}


def figures(orbit: AbstractOrbit) -> dict[str, Any]:
    """Return the invariants of an orbit and its body as plain numbers; None where a figure is not defined."""
    quantities = dataclasses.asdict(invariants(orbit))
    is_odd = {name: isinstance(value, float) and not math.isfinite(value) for name, value in quantities.items()}
    return {
        **{name: None if is_odd[name] else value for name, value in quantities.items()},
        "energy_is_exact": orbit.conserves_energy,
        "outcome": orbit.outcome.name,
        "message": orbit.outcome.message,
        "body": _body(orbit),
    }


def show(figures: dict[str, Any], heading: dict[str, str]) -> None:
    """Print what was run, the table of invariants and the body."""
    console = Console(highlight=False)
    console.print(heading.pop("title"), style="bold", markup=False)
    console.print(_table(("", ""), heading.items()))
    if figures:
        body = [(_label(name), _shown(value)) for name, value in figures["body"].items()]
        console.print(_table(("", "measured", "expected"), _rows(figures)), _table(("", ""), body))


def _table(columns: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, show_header=any(columns))
    for number, column in enumerate(columns):
        table.add_column(column, min_width=24 if number == 0 else None, overflow="fold")
    for row in rows:
        table.add_row(*(escape(cell) for cell in row))
    return table


def show_json(document: dict[str, Any]) -> None:
    """Print one JSON object."""
    typer.echo(json.dumps(document, indent=2, allow_nan=False))


def duration(seconds: float) -> str:
    """Write a duration in a unit that suits it.

    Example:
        >>> duration(4.2e-08)
        '42 ns'
    """
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def _rows(figures: dict[str, Any]) -> list[tuple[str, str, str]]:
    """Return label, value and expectation of the figures that are defined for the orbit."""
    expectations = {
        "energy_drift": ("relative energy drift", "", _ENERGY[figures["energy_is_exact"]]),
        "constraint_residual": ("constraint residual", "", ROUNDING),
        "group_residual": ("group residual", "", ROUNDING),
        "reversal_defect": ("one-step reversal defect", "", ROUNDING),
        "largest_step_angle": ("largest step angle", " degrees", "well below 90 degrees"),
    }
    if figures["work"] is not None:
        expectations["energy_drift"] = ("energy less work of forces", "", "of order 2 in the time step")
        expectations["work"] = ("work of forces", "", "")
    rows = [(figures[name], *entry) for name, entry in expectations.items()]
    lines = [(label, f"{value:.3g}{unit}", note) for value, label, unit, note in rows if value is not None]
    return [*lines, ("outcome", figures["outcome"], "successful")]


def _label(name: str) -> str:
    return _LABELS.get(name, name.replace("_", " "))


def _body(orbit: AbstractOrbit) -> dict[str, Any]:
    """Return the parameters of the system as plain data, with its inertia, unless that is large."""
    system = orbit.system
    if not orbit.is_compact:
        kind, parameters = described_system(system)
        about = {"coordinates": ", ".join(orbit.coordinates)} if "orbits" in parameters else parameters
        about = {name: value for name, value in about.items() if value is not None}
        return {"system": kind, "name": system.name, **about}
    fields = {name: value for name, value in fields_of(system).items() if name != "group" and value is not None}
    if system.group.dim > _LARGE:
        return {"system": type(system).__name__, "group": repr(system.group), **fields}
    inertia = np.asarray(system.inertia_operator).tolist()
    name = "inertia_tensor" if "mass_tensor" in fields and system.group == SO(3) else "inertia_operator"
    fields.pop("given_inertia", None)
    return {"system": type(system).__name__, "group": repr(system.group), **fields, name: inertia}


def _shown(value: Any) -> str:
    """Write a name, a number, or the rows of an array in columns."""
    if isinstance(value, str):
        return value
    if isinstance(value, dict):  # a system inside another, or a force
        return "\n".join(f"{_label(name)}: {_shown(inside)}" for name, inside in value.items())
    if type(value) is list and dict in map(type, value):  # several forces
        return "\n".join(map(_shown, value))
    shape = np.shape(value)
    if 0 in shape or max(shape, default=0) > _WIDEST:
        return " x ".join(map(str, shape)) if shape != (0,) else "none"
    return _columns(np.atleast_2d(value))


def _columns(rows: np.ndarray) -> str:
    cells = [[f"{number:.6g}" for number in row] for row in rows]
    width = max(len(cell) for row in cells for cell in row)
    return "\n".join("  ".join(cell.rjust(width) for cell in row) for row in cells)
