"""The work of `nonholo explore`, once the compilers know where to keep their code."""

import webbrowser
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

from nonholo import explorer, io, simulation
from nonholo.cli.scenario.files import built_in, given_settings, load_scenario
from nonholo.cli.screen.errors import FAILED, USAGE, leave, reporting_warnings, scenario_errors, store_errors
from nonholo.orbit import Orbit


def write_page(
    source: str,
    chosen: dict[str, tuple[str, Any]],
    settings: list[str],
    output: Path | None,
    *,
    browser: bool,
    overwrite: bool,
) -> Path:
    """Write the page of a scenario or a store, and return its path."""
    if output is not None:
        with store_errors(USAGE):
            io.check_file(output, overwrite=overwrite, where="nonholo explore -o")
    if source not in built_in() and Path(source).is_dir():
        with store_errors(FAILED):
            orbit = io.load_orbit(source)
    else:
        orbit = _orbit_of(source, chosen, settings)
    path = output or Path(mkdtemp(prefix="nonholo-")) / f"{Path(source).stem}.html"
    with store_errors(FAILED):
        explorer.orbit_to_html(orbit, path, overwrite=overwrite)
    if browser:
        webbrowser.open(path.resolve().as_uri())
    return path


def _orbit_of(source: str, chosen: dict[str, tuple[str, Any]], settings: list[str]) -> Orbit:
    with scenario_errors(), reporting_warnings():
        scenario = load_scenario(source, given_settings(chosen, settings)).scenario
        try:
            discrete = scenario.discretization()
            return simulation.simulate(discrete, steps=scenario.run.steps, throw=False, **scenario.options())
        except ValueError as refusal:
            leave(str(refusal), USAGE)
