"""The record in a store of how it was made, with its invariants measured again."""

import json as jsonlib
import sys
from pathlib import Path
from typing import Any

import typer

from nonholo.base.progress import waiting
from nonholo.cli.screen.errors import FAILED, USAGE, leave, store_errors
from nonholo.cli.screen.report import as_json, figures, show
from nonholo.cli.screen.sweep_report import show_sweep, sweep_figures
from nonholo.ensembles import load_sweep
from nonholo.ensembles.stores import open_store
from nonholo.io import Standing
from nonholo.orbit import AbstractOrbit

_MOST_BLOCKS = 1000  # of a sweep that are read, some milliseconds each
_NESTED = ("parameters", "motion", "versions", "arrays", "run", "sweep")


def show_provenance(store: Path, stored: dict[str, Any], orbit: AbstractOrbit | None, *, json: bool) -> None:
    """Print attributes and, where the orbit could be loaded, invariants, as tables or as one JSON object."""
    record = _record(stored)
    with waiting("measuring", sys.stderr.isatty()):
        measured = {} if orbit is None else figures(orbit)
    if json:
        typer.echo(as_json({"store": str(store), "provenance": record, **measured}))
        return
    thinned = "" if record["save_every"] == 1 else f", one in {record['save_every']} steps"
    heading = {"title": str(store), "states": f"{record['arrays']['time'][0]}{thinned}"}
    show(measured, heading | _made(record))


def show_standing(store: Path, stored: dict[str, Any], standing: Standing, *, json: bool) -> None:
    """Print how far an unfinished run came, and who is writing it."""
    record, now = _record(stored), standing._asdict()
    if json:
        typer.echo(as_json({"store": str(store), "unfinished": now, "provenance": record}))
        return
    came = f"{standing.done} of {standing.steps}, {100 * standing.done / standing.steps:.1f} %"
    next_one = f"written by {standing.owner}" if standing.owner else f"stopped; resume with: nonholo resume {store}"
    show({}, {"title": str(store), "steps": came, "run": next_one} | _made(record))


def show_sweep_standing(store: Path, stored: dict[str, Any], *, json: bool) -> None:
    """Print how far a sweep came and, if it is finished, sound and not too large, the ranges of its quantities."""
    record = _record(stored)
    result = failure = None
    with store_errors(USAGE):
        opened = open_store(store)
        if opened.is_finished and opened.layout.blocks <= _MOST_BLOCKS:
            try:
                result = load_sweep(store)
            except ValueError as caught:
                failure = caught
        measured = sweep_figures(store, result)
    task, design = record["sweep"]["task"], record["sweep"]["design"]
    made = {"task": task["name"]} if "name" in task else {"system": task["system"], "steps": f"{task['steps']:,}"}
    made |= {"design": f"{design['kind']}, seed {design['seed']}", **_scenario(record)}
    provenance = {name: value for name, value in record.items() if name != "sweep"} | record["sweep"]
    show_sweep(store, measured, {"title": str(store)} | made, {"provenance": provenance} if json else {}, json=json)
    if failure:
        leave(str(failure), FAILED)


def _record(stored: dict[str, Any]) -> dict[str, Any]:
    return {name: jsonlib.loads(value) if name in _NESTED else value for name, value in stored.items()}


def _made(record: dict[str, Any]) -> dict[str, str]:
    return {"motion": _listed(record["motion"]), **_scenario(record)}


def _scenario(record: dict[str, Any]) -> dict[str, str]:
    return {
        "made with": _listed(record["versions"] | {"kernels": record.get("kernels", "not recorded")}),
        "scenario": f"sha256 {record['scenario_sha256'][:16]}" if "scenario" in record else "none",
    }


def _listed(entries: dict[str, Any]) -> str:
    return ", ".join(f"{key} {value}" for key, value in entries.items())
