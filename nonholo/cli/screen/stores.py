"""The content of a store on the screen: how it was made, its invariants measured again; figures of a sweep."""

import json as jsonlib
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import typer
import xarray

from nonholo.base.limits import size_text
from nonholo.base.progress import progress_bar
from nonholo.cli.screen.errors import FAILED, USAGE, leave, store_errors
from nonholo.cli.screen.report import duration, figures, show, show_json
from nonholo.ensembles import SweepStanding, load_sweep, standing_of
from nonholo.ensembles.stores import AXIS, OUTCOME, attributes_of, open_store
from nonholo.io import Standing
from nonholo.orbit import AbstractOrbit

Facts = dict[str, Any]
_SLAB = 1 << 22  # members whose numbers are in memory at once
_MESSAGES = 3
_MOST_BLOCKS = 1000  # of a sweep that are read, some milliseconds each
_NESTED = ("parameters", "motion", "versions", "arrays", "run", "sweep")


def show_provenance(store: Path, attributes: Facts, orbit: AbstractOrbit | None, *, json: bool) -> None:
    """Print attributes and, where the orbit could be loaded, invariants, as tables or as one JSON object."""
    record = _record(attributes)
    with progress_bar("measuring", sys.stderr.isatty()):
        numbers = {} if orbit is None else figures(orbit)
    if json:
        show_json({"store": str(store), "provenance": record, **numbers})
        return
    thinning = "" if record["save_every"] == 1 else f", one in {record['save_every']} steps"
    heading = {"title": str(store), "states": f"{record['arrays']['time'][0]}{thinning}"}
    show(numbers, heading | _origin(record))


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
        sweep = open_store(store)
        if sweep.is_finished and sweep.layout.blocks <= _MOST_BLOCKS:
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
    return {name: jsonlib.loads(value) if name in _NESTED else value for name, value in attributes.items()}


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
    steps = jsonlib.loads(attributes_of(store)["sweep"])["task"].get("steps")
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
        "messages": [list(message) for message in standing.messages[:_MESSAGES]],
        "state": _state(standing),
    }


def show_sweep(store: Path, figures: Facts, heading: dict[str, str], more: Facts, *, json: bool) -> None:
    """Print figures of a sweep as a table or as one JSON object, with what else is to be reported."""
    if json:
        show_json({"store": str(store), **more, **figures})
        return
    show({}, heading | _rows(store, figures))
    for member, message in figures["messages"]:
        typer.echo(f"member {member} raised {message}")
    for kind, path in {"store": str(store), **more}.items():
        if isinstance(path, str):
            typer.echo(f"{kind:<9} {path}")


def leave_if_all_raised(figures: Facts) -> None:
    """End the command with a failure if not one member has a result."""
    if figures["outcomes"].get("raised") == figures["members"]:
        reason = f": {figures['messages'][0][1]}" if figures["messages"] else ""
        leave(f"Every member raised{reason}", FAILED)


def _state(standing: SweepStanding) -> str:
    if standing.finished:
        return "finished"
    return f"written by {standing.owner}" if standing.owner else "stopped"


def _rows(store: Path, figures: Facts) -> dict[str, str]:
    members, count_done = figures["members"], figures["done"]
    part = f"{count_done:,} of {members:,}, {100 * count_done / members:.1f} %"
    came = f"{members:,}" if count_done == members else part
    state = figures["state"] + (f"; resume with: nonholo resume {store}" if figures["state"] == "stopped" else "")
    speeds = {"members_per_second_of_one_worker": "members/s", "steps_per_second_of_one_worker": "steps/s"}
    rates = [f"{figures[key]:,.3g} {unit}" for key, unit in speeds.items() if figures[key]]
    speed = figures["members_per_second"]
    time = {"time": f"{duration(figures['seconds'])}, {speed:,.3g} members/s"} if speed else {}
    rows = {"members": came} | ({} if state == "finished" else {"sweep": state})
    for name, count in figures["outcomes"].items():
        rows[f"  {name}"] = f"{count:,}  ({100 * count / count_done:.3g} %)"
    for name, (least, most, meaning) in figures["ranges"].items():
        rows[name] = f"{least:.6g} to {most:.6g}  {meaning}"
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
            finite = finite[np.isfinite(finite)]
            if finite.size:
                meaning = str(values.attrs.get("long_name", ""))
                least, most, _ = ranges.get(str(name), (math.inf, -math.inf, ""))
                ranges[str(name)] = (min(least, float(finite.min())), max(most, float(finite.max())), meaning)
    return ranges
