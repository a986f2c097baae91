"""What a store says about how it was made, with its invariants measured again."""

import json as jsonlib
from pathlib import Path
from typing import Any

import typer

from nonholo.cli._report import as_json, figures, show
from nonholo.orbit import Orbit

_NESTED = ("parameters", "motion", "versions", "arrays")


def show_provenance(store: Path, stored: dict[str, Any], orbit: Orbit | None, *, json: bool) -> None:
    """Print attributes and, where the orbit could be loaded, invariants, as tables or as one JSON object."""
    told = {name: jsonlib.loads(value) if name in _NESTED else value for name, value in stored.items()}
    measured = {} if orbit is None else figures(orbit)
    if json:
        typer.echo(as_json({"store": str(store), "provenance": told, **measured}))
        return
    thinned = "" if told["save_every"] == 1 else f", one in {told['save_every']} steps"
    heading = {
        "title": str(store),
        "states": f"{told['arrays']['time'][0]}{thinned}",
        "motion": _listed(told["motion"]),
        "made with": _listed(told["versions"]),
        "scenario": f"sha256 {told['scenario_sha256'][:16]}" if "scenario" in told else "none",
    }
    show(measured, heading)


def _listed(entries: dict[str, Any]) -> str:
    return ", ".join(f"{key} {value}" for key, value in entries.items())
