"""The work of `nonholo sweep`, once the compilers know where to keep their code."""

import functools
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import typer
import xarray

from nonholo.cli.commands._resuming import reporting_stops
from nonholo.cli.commands._running import at_free_path, check_output, is_stopped
from nonholo.cli.scenario.files import Loaded, given_settings
from nonholo.cli.scenario.problems import ScenarioError, problem_of_value
from nonholo.cli.scenario.sweep_files import load_sweep_scenario, sweep_text
from nonholo.cli.scenario.sweeps import SweepScenario
from nonholo.cli.screen.errors import USAGE, leave, reporting_warnings, scenario_errors, store_errors
from nonholo.cli.screen.pictures import beside
from nonholo.cli.screen.sweep_picture import draw_sweep
from nonholo.cli.screen.sweep_report import leave_if_all_raised, show_sweep, sweep_figures
from nonholo.ensembles import EnsembleTask, sweep
from nonholo.ensembles.stores import attributes_of


def sweep_and_keep(
    name: str,
    chosen: dict[str, tuple[str, Any]],
    settings: list[str],
    output: Path | None,
    *,
    scheduler: str | None,
    workers: int | None,
    json: bool,
    quiet: bool,
) -> None:
    """Load, run, draw, report; options of the command line come before the settings of `--set`."""
    with scenario_errors(), reporting_warnings():
        loaded = load_sweep_scenario(name, given_settings(chosen, settings))
        task = _task(loaded)
    text, begun = sweep_text(loaded.scenario.in_force(task.discrete)), time.perf_counter()
    wanted = loaded.scenario.output
    again = _is_stopped(output, text, wanted.plot)
    design, shown = loaded.scenario.design.design(), sys.stderr.isatty() and not quiet
    how: Any = {"scheduler": scheduler, "workers": workers, "resume": again}
    run = functools.partial(sweep, task, design, **how, progress=shown, scenario=text)
    with store_errors(USAGE):
        store, result = at_free_path(loaded.name, output, lambda path: _kept(run, path))
    seconds = time.perf_counter() - begun
    picture = draw_sweep(result, beside(store, "png"), wanted.color, wanted.x, wanted.y) if wanted.plot else None
    figures = sweep_figures(store, result, seconds)
    if quiet and not json:
        typer.echo(store)
    else:
        heading = {"title": loaded.scenario.title or loaded.name} | loaded.scenario.forces.about(task.discrete.system)
        show_sweep(store, figures, heading, {"picture": picture}, json=json)
    leave_if_all_raised(figures)


def _is_stopped(output: Path | None, text: str, is_drawn: bool) -> bool:
    """Tell whether this very sweep was begun at a path and stopped; refuse a path that holds something else."""
    again = output is not None and is_stopped(output, text, ["png"] * is_drawn, attributes_of)
    if output is not None and output.exists() and not again:
        leave(f"'{output}' exists. Choose another path, or resume what it holds: nonholo resume {output}", USAGE)
    with store_errors(USAGE):
        check_output(None if again else output, overwrite=False)
    return again


def _task(loaded: Loaded[SweepScenario]) -> EnsembleTask:
    try:
        return loaded.scenario.task()
    except ValueError as failure:
        section = "start" if "velocity" in str(failure) or "momentum" in str(failure) else "run"
        raise ScenarioError([problem_of_value(failure, section, loaded.source, loaded.options)]) from None


def _kept(run: Callable[..., xarray.Dataset], store: Path) -> xarray.Dataset:
    with reporting_stops(store):
        return run(store=store)
