"""What a store says about how it was made, with its invariants measured again."""

import json as jsonlib
from pathlib import Path
from typing import Any

import typer

from nonholo.cli._report import as_json, figures, show
from nonholo.io import Standing
from nonholo.orbit import Orbit

_NESTED = ("parameters", "motion", "versions", "arrays", "run")


def show_provenance(store: Path, stored: dict[str, Any], orbit: Orbit | None, *, json: bool) -> None:
    """Print attributes and, where the orbit could be loaded, invariants, as tables or as one JSON object."""
    told = _told(stored)
    measured = {} if orbit is None else figures(orbit)
    if json:
        typer.echo(as_json({"store": str(store), "provenance": told, **measured}))
        return
    thinned = "" if told["save_every"] == 1 else f", one in {told['save_every']} steps"
    heading = {"title": str(store), "states": f"{told['arrays']['time'][0]}{thinned}"}
    show(measured, heading | _made(told))


def show_standing(store: Path, stored: dict[str, Any], standing: Standing, *, json: bool) -> None:
    """Print how far an unfinished run came, and who is writing it."""
    told, now = _told(stored), standing._asdict()
    if json:
        typer.echo(as_json({"store": str(store), "unfinished": now, "provenance": told}))
        return
    came = f"{standing.done} of {standing.steps}, {100 * standing.done / standing.steps:.1f} %"
    next_one = f"written by {standing.owner}" if standing.owner else f"stopped; go on with: nonholo resume {store}"
    show({}, {"title": str(store), "steps": came, "run": next_one} | _made(told))


def _told(stored: dict[str, Any]) -> dict[str, Any]:
    return {name: jsonlib.loads(value) if name in _NESTED else value for name, value in stored.items()}


def _made(told: dict[str, Any]) -> dict[str, str]:
    return {
        "motion": _listed(told["motion"]),
        "made with": _listed(told["versions"]),
        "scenario": f"sha256 {told['scenario_sha256'][:16]}" if "scenario" in told else "none",
    }


def _listed(entries: dict[str, Any]) -> str:
    return ", ".join(f"{key} {value}" for key, value in entries.items())
