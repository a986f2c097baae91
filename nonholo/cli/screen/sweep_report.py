"""The figures of a sweep: how members ended, the range of what is kept, how fast it went, how large it is."""

import json as jsonlib
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import typer
import xarray

from nonholo.base.limits import size_text
from nonholo.cli.screen.errors import FAILED, leave
from nonholo.cli.screen.report import as_json, duration, show
from nonholo.ensembles import SweepStanding, standing_of
from nonholo.ensembles.stores import attributes_of

_SLAB = 1 << 22  # members whose numbers are in memory at once
_MESSAGES = 3
_OUTCOME, _DRAWN = "outcome", "value of the design"


def sweep_figures(
    store: Path, result: xarray.Dataset | None, seconds: float | None = None, before: int = 0
) -> dict[str, Any]:
    """Return what is known of a sweep as plain numbers.

    Args:
        store: Where it is.
        result: What it gave, for ranges; None if it is not finished.
        seconds: How long it took now, with all that comes before the first member.
        before: Members that had been done before.
    """
    standing = standing_of(store)
    steps = jsonlib.loads(attributes_of(store)["sweep"])["task"].get("steps")
    rate = None if math.isnan(standing.rate) else standing.rate
    return {
        "members": standing.members,
        "done": standing.done,
        "failed": standing.failed,
        "outcomes": dict(sorted(standing.outcomes.items(), key=lambda entry: -entry[1])),
        "ranges": {} if result is None else _ranges(result),
        "seconds": seconds,
        "members_per_second": (standing.done - before) / seconds if seconds else None,
        "members_per_second_of_one_worker": rate,
        "steps_per_second_of_one_worker": rate * steps if rate and steps and not standing.failed else None,
        "bytes": sum(file.stat().st_size for file in store.rglob("*") if file.is_file()),
        "messages": [list(message) for message in standing.messages[:_MESSAGES]],
        "state": _state(standing),
    }


def show_sweep(
    store: Path, figures: dict[str, Any], heading: dict[str, str], more: dict[str, Any], *, json: bool
) -> None:
    """Print figures of a sweep as a table or as one JSON object, with what else is to be reported."""
    if json:
        typer.echo(as_json({"store": str(store), **more, **figures}))
        return
    show({}, heading | _rows(store, figures))
    for member, message in figures["messages"]:
        typer.echo(f"member {member} raised {message}")
    for kind, path in {"store": str(store), **more}.items():
        if isinstance(path, str):
            typer.echo(f"{kind:<9} {path}")


def leave_if_all_raised(figures: dict[str, Any]) -> None:
    """End the command with a failure if not one member has a result."""
    if figures["outcomes"].get("raised") == figures["members"]:
        reason = f": {figures['messages'][0][1]}" if figures["messages"] else ""
        leave(f"Every member raised{reason}", FAILED)


def _state(standing: SweepStanding) -> str:
    if standing.finished:
        return "finished"
    return f"written by {standing.owner}" if standing.owner else "stopped"


def _rows(store: Path, figures: dict[str, Any]) -> dict[str, str]:
    members, done = figures["members"], figures["done"]
    came = f"{members:,}" if done == members else f"{done:,} of {members:,}, {100 * done / members:.1f} %"
    state = figures["state"] + (f"; resume with: nonholo resume {store}" if figures["state"] == "stopped" else "")
    speeds = {"members_per_second_of_one_worker": "members/s", "steps_per_second_of_one_worker": "steps/s"}
    rates = [f"{figures[key]:,.3g} {unit}" for key, unit in speeds.items() if figures[key]]
    speed = figures["members_per_second"]
    time = {"time": f"{duration(figures['seconds'])}, {speed:,.3g} members/s"} if speed else {}
    rows = {"members": came} | ({} if state == "finished" else {"sweep": state})
    for name, count in figures["outcomes"].items():
        rows[f"  {name}"] = f"{count:,}  ({100 * count / done:.3g} %)"
    for name, (least, most, meaning) in figures["ranges"].items():
        rows[name] = f"{least:.6g} to {most:.6g}  {meaning}"
    return rows | time | {"one worker": ", ".join(rates) or "unknown", "size on disk": size_text(figures["bytes"])}


def _ranges(result: xarray.Dataset) -> dict[str, tuple[float, float, str]]:
    """Return least and largest number of each quantity over the members that succeeded, and what it means."""
    found: dict[str, tuple[float, float, str]] = {}
    for part in _slabs(result):
        good = part[_OUTCOME] == 0
        for name, values in part.data_vars.items():
            if name == _OUTCOME or values.attrs.get("long_name") == _DRAWN or values.dtype.kind not in "if":
                continue
            kept = values.where(good).values
            kept = kept[np.isfinite(kept)]
            if kept.size:
                meaning = str(values.attrs.get("long_name", ""))
                least, most, _ = found.get(str(name), (math.inf, -math.inf, ""))
                found[str(name)] = (min(least, float(kept.min())), max(most, float(kept.max())), meaning)
    return found


def _slabs(result: xarray.Dataset) -> Iterator[xarray.Dataset]:
    """Cut a result along its first dimension, so that parts fit in memory."""
    first, *others = result[_OUTCOME].dims
    rows = max(1, _SLAB // math.prod(result.sizes[name] for name in others))
    for begin in range(0, result.sizes[first], rows):
        yield result.isel({first: slice(begin, begin + rows)})
