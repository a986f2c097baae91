"""The figures of a run, measured, as plain numbers for `--json`, and as a table with what to expect of them.

The content of a store: how it was made, its invariants measured again; figures of a sweep.
"""

import dataclasses
import json as json_text
import math
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import typer
import xarray
from rich import box
from rich.table import Column, Table

from nonholo.analysis import invariants
from nonholo.base.limits import size_text
from nonholo.base.progress import progress_bar
from nonholo.cli.screen.errors import FAILED, USAGE, leave, store_errors
from nonholo.cli.screen.tables import plain_console, table
from nonholo.ensembles import load_sweep, standing_of
from nonholo.ensembles.stores import AXIS, OUTCOME, open_store
from nonholo.groups import SO
from nonholo.io.orbits import Standing
from nonholo.io.provenance import described_system, fields_of
from nonholo.orbit import AbstractOrbit

Facts = dict[str, Any]
_SLAB = 1 << 22  # members whose numbers are in memory at once
_MOST_BLOCKS = 1000  # of a sweep that are read, some milliseconds each
_NESTED = ("parameters", "motion", "versions", "arrays", "run", "sweep")
ROUNDING = "rounding"
_ENERGY = {True: "exact by theorem", False: "not exact for this discretization", None: "tolerance of the solver"}
_WIDEST = 6  # columns of a matrix that is shown whole
_LARGE = 100  # dimension of a group from which inertia operators are too large to print
_LABELS = {"mass_tensor": "mass tensor J", "inertia_tensor": "inertia tensor tr(J)-J"}


def figures(orbit: AbstractOrbit) -> dict[str, Any]:
    """Return the invariants of an orbit and its body as plain numbers; None where a figure is not defined."""
    numbers = dataclasses.asdict(invariants(orbit))
    blanks = [name for name, value in numbers.items() if isinstance(value, float) and not math.isfinite(value)]
    about = {"energy_is_exact": orbit.conserves_energy, "outcome": orbit.outcome.name, "message": orbit.outcome.message}
    return numbers | dict.fromkeys(blanks) | about | {"body": _body(orbit)}


def show(figures: dict[str, Any], heading: dict[str, str]) -> None:
    """Print what was run, the table of invariants and the body."""
    console = plain_console()
    console.print(heading.pop("title"), style="bold")
    console.print(_table(("", ""), heading.items()))
    if figures:
        body = [(_label(name), _shown(value)) for name, value in figures["body"].items()]
        console.print(_table(("", "measured", "expected"), _rows(figures)), _table(("", ""), body))


def _table(columns: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Table:
    first, *others = (Column(name, overflow="fold") for name in columns)
    first.min_width = 24
    return table((first, *others), rows, box=box.SIMPLE_HEAD, show_header=any(columns))


def show_paths(paths: dict[str, Any]) -> None:
    """Print where things are."""
    for kind, path in paths.items():
        if isinstance(path, str):
            typer.echo(f"{kind:<9} {path}")


def show_json(document: dict[str, Any]) -> None:
    """Print one JSON object."""
    typer.echo(json_text.dumps(document, indent=2, allow_nan=False))


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


def show_provenance(store: Path, attributes: Facts, orbit: AbstractOrbit | None, *, json: bool) -> None:
    """Print attributes and, where the orbit could be loaded, invariants, as tables or as one JSON object."""
    record = _record(attributes)
    with progress_bar("measuring", sys.stderr.isatty()):
        numbers = {} if orbit is None else figures(orbit)
    if json:
        show_json({"store": str(store), "provenance": record, **numbers})
        return
    thinning = "" if record["save_every"] == 1 else f", one in {record['save_every']} steps"
    show(numbers, {"title": str(store), "states": f"{record['arrays']['time'][0]}{thinning}"} | _origin(record))


def show_standing(store: Path, attributes: Facts, standing: Standing, *, json: bool) -> None:
    """Print the progress of an unfinished run, and who is writing it."""
    record, now = _record(attributes), standing._asdict()
    if json:
        show_json({"store": str(store), "unfinished": now, "provenance": record})
        return
    came = f"{standing.done} of {standing.steps}, {100 * standing.done / standing.steps:.1f} %"
    next_one = f"written by {standing.owner}" if standing.owner else f"stopped; resume with: nonholo resume {store}"
    show({}, {"title": str(store), "steps": came, "run": next_one} | _origin(record))


def show_sweep_standing(store: Path, attributes: Facts, *, json: bool) -> None:
    """Print the progress of a sweep and, if it is finished, sound and not too large, the ranges of its quantities."""
    record = _record(attributes)
    result = failure = None
    with store_errors(USAGE):
        if (sweep := open_store(store)).is_finished and sweep.layout.blocks <= _MOST_BLOCKS:
            try:
                result = load_sweep(store)
            except ValueError as caught:
                failure = caught
        numbers = sweep_figures(store, result)
    task, design = record["sweep"]["task"], record["sweep"]["design"]
    heading = {"task": task["name"]} if "name" in task else {"system": task["system"], "steps": f"{task['steps']:,}"}
    heading |= {"design": f"{design['kind']}, seed {design['seed']}", **_scenario(record)}
    provenance = {name: value for name, value in record.items() if name != "sweep"} | record["sweep"]
    show_sweep(store, numbers, {"title": str(store)} | heading, {"provenance": provenance} if json else {}, json=json)
    if failure:
        leave(str(failure), FAILED)


def _record(attributes: Facts) -> Facts:
    return {name: json_text.loads(value) if name in _NESTED else value for name, value in attributes.items()}


def _origin(record: Facts) -> dict[str, str]:
    return {"motion": _list_of(record["motion"]), **_scenario(record)}


def _scenario(record: Facts) -> dict[str, str]:
    return {
        "made with": _list_of(record["versions"] | {"kernels": record.get("kernels", "not recorded")}),
        "scenario": f"sha256 {record['scenario_sha256'][:16]}" if "scenario" in record else "none",
    }


def _list_of(entries: Facts) -> str:
    return ", ".join(f"{key} {value}" for key, value in entries.items())


def sweep_figures(store: Path, result: xarray.Dataset | None, seconds: float | None = None, before: int = 0) -> Facts:
    """Return what is known of a sweep as plain numbers.

    Args:
        store: Where it is.
        result: Its results, for ranges; None if it is not finished.
        seconds: How long it took now, with all that comes before the first member.
        before: Members that had been done before.
    """
    standing = standing_of(store)
    steps = open_store(store).description["task"].get("steps")
    rate = None if math.isnan(standing.rate) else standing.rate
    return {
        "members": standing.members,
        "done": standing.done,
        "failed": standing.failure_count,
        "outcomes": dict(sorted(standing.outcomes.items(), key=lambda entry: -entry[1])),
        "ranges": {} if result is None else _ranges(result),
        "seconds": seconds,
        "members_per_second": (standing.done - before) / seconds if seconds else None,
        "members_per_second_of_one_worker": rate,
        "steps_per_second_of_one_worker": rate * steps if rate and steps and not standing.failure_count else None,
        "bytes": sum(file.stat().st_size for file in store.rglob("*") if file.is_file()),
        "messages": [list(message) for message in standing.messages[:3]],
        "state": standing.state,
    }


def show_sweep(store: Path, figures: Facts, heading: dict[str, str], more: Facts, *, json: bool) -> None:
    """Print figures of a sweep as a table or as one JSON object, with what else is to be reported."""
    if json:
        show_json({"store": str(store), **more, **figures})
        return
    show({}, heading | _sweep_rows(store, figures))
    for member, message in figures["messages"]:
        typer.echo(f"member {member} raised {message}")
    show_paths({"store": str(store), **more})


def leave_if_all_raised(figures: Facts) -> None:
    """End the command with a failure if not one member has a result."""
    if figures["outcomes"].get("raised") == figures["members"]:
        reason = f": {figures['messages'][0][1]}" if figures["messages"] else ""
        leave(f"Every member raised{reason}", FAILED)


def _sweep_rows(store: Path, figures: Facts) -> dict[str, str]:
    members, count_done = figures["members"], figures["done"]
    part = f"{count_done:,} of {members:,}, {100 * count_done / members:.1f} %"
    came = f"{members:,}" if count_done == members else part
    state = figures["state"] + (f"; resume with: nonholo resume {store}" if figures["state"] == "stopped" else "")
    speeds = {"members_per_second_of_one_worker": "members/s", "steps_per_second_of_one_worker": "steps/s"}
    rates = [f"{figures[key]:,.3g} {unit}" for key, unit in speeds.items() if figures[key]]
    speed = figures["members_per_second"]
    time = {"time": f"{duration(figures['seconds'])}, {speed:,.3g} members/s"} if speed else {}
    rows = {"members": came} | ({} if state == "finished" else {"sweep": state})
    rows |= {f"  {name}": f"{n:,}  ({100 * n / count_done:.3g} %)" for name, n in figures["outcomes"].items()}
    rows |= {name: f"{least:.6g} to {most:.6g}  {words}" for name, (least, most, words) in figures["ranges"].items()}
    return rows | time | {"one worker": ", ".join(rates) or "unknown", "size on disk": size_text(figures["bytes"])}


def _ranges(result: xarray.Dataset) -> dict[str, tuple[float, float, str]]:
    """Return least and largest number of each quantity over the members that succeeded, and what it means."""
    ranges: dict[str, tuple[float, float, str]] = {}
    first, *others = result[OUTCOME].dims
    rows = max(1, _SLAB // math.prod(result.sizes[name] for name in others))  # parts that fit in memory
    for begin in range(0, result.sizes[first], rows):
        part = result.isel({first: slice(begin, begin + rows)})
        good = part[OUTCOME] == 0
        for name, values in part.data_vars.items():
            if name == OUTCOME or values.attrs.get("long_name") == AXIS["long_name"] or values.dtype.kind not in "if":
                continue
            finite = values.where(good).values
            if (finite := finite[np.isfinite(finite)]).size:
                meaning = str(values.attrs.get("long_name", ""))
                least, most, _ = ranges.get(str(name), (math.inf, -math.inf, ""))
                ranges[str(name)] = (min(least, float(finite.min())), max(most, float(finite.max())), meaning)
    return ranges
