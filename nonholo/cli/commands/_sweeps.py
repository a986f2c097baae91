"""The work of `nonholo sweep`; that of `resume` and `extend` around what resumes a run or a sweep."""

import contextlib
import functools
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import typer

from nonholo import ensembles, io
from nonholo.base.results import OutcomeError
from nonholo.cli.commands._runs import at_free_path, check_output, is_stopped
from nonholo.cli.scenario.files import Loaded, stored_scenario
from nonholo.cli.scenario.motion import Scenario
from nonholo.cli.scenario.sweeps import SweepScenario, sweep_text
from nonholo.cli.screen.errors import FAILED, USAGE, leave, reporting_warnings, scenario_errors, store_errors, warn
from nonholo.cli.screen.pictures import beside, draw_sweep
from nonholo.cli.screen.stores import leave_if_all_raised, show_provenance, show_sweep, sweep_figures
from nonholo.ensembles.stores import attributes_of
from nonholo.orbit import AbstractOrbit

_MOST_WARNINGS = 5  # warnings of a sweep that are reported


def sweep_and_keep(
    request: Loaded[SweepScenario], output: Path | None, how: dict[str, Any], *, json: bool, quiet: bool
) -> None:
    """Run, draw, report; how: scheduler and workers."""
    with scenario_errors(), reporting_warnings(), request.reporting():
        task = request.scenario.task()
    scenario, begin = request.scenario, time.perf_counter()
    text = sweep_text(scenario if scenario.is_family else scenario.in_force(task.discrete))
    again = _is_stopped(output, text, scenario.output.plot)
    design, progress = scenario.design.design(), sys.stderr.isatty() and not quiet
    run = functools.partial(ensembles.sweep, task, design, **how, resume=again, progress=progress, scenario=text)
    with store_errors(USAGE):
        store, result = at_free_path(request.name, output, lambda path: reporting_stops(path)(run)(store=path))
    seconds, wishes = time.perf_counter() - begin, scenario.output
    picture = draw_sweep(result, beside(store, "png"), wishes.color, wishes.x, wishes.y) if wishes.plot else None
    figures = sweep_figures(store, result, seconds)
    if quiet and not json:
        typer.echo(store)
    else:
        heading = {"title": scenario.title or request.name} | scenario.forces.about(scenario.system())
        show_sweep(store, figures, heading, {"picture": picture}, json=json)
    leave_if_all_raised(figures)


def _is_stopped(output: Path | None, text: str, has_picture: bool) -> bool:
    """Return whether this very sweep was begun at a path and stopped; refuse a path that holds something else."""
    again = output is not None and is_stopped(output, text, ["png"] * has_picture, attributes_of)
    if output is not None and output.exists() and not again:
        leave(f"'{output}' exists. Choose another path, or resume what it holds: nonholo resume {output}", USAGE)
    with store_errors(USAGE):
        check_output(None if again else output, overwrite=False)
    return again


def continue_and_report(store: Path, module: Path | None, resume: Callable[..., AbstractOrbit], *, json: bool) -> None:
    """Run, name what was damaged, report what the store holds now; `resume` takes `discrete` that no store holds."""
    reason = None
    with reporting_warnings(), scenario_errors(), store_errors(USAGE):
        motion = stored_scenario(io.read_attributes(store), module, Scenario).discretization() if module else None
        try:
            orbit: Any = resume(discrete=motion, progress=sys.stderr.isatty())
        except OutcomeError as failure:
            orbit, reason = failure.orbit, str(failure)
        except KeyboardInterrupt as failure:
            leave(str(failure), FAILED)
    show_provenance(store, io.read_attributes(store), orbit, json=json)
    if reason:
        leave(f"Stopped early; the good steps are kept. {reason}", FAILED)


def resume_sweep(store: Path, module: Path | None, how: dict[str, Any], *, json: bool) -> None:
    """Do what a sweep lacks, report what the store holds now; name what is trusted first."""
    with store_errors(USAGE):
        before, names = ensembles.standing_of(store).done, ensembles.functions_of(store)
    with scenario_errors(), reporting_warnings():
        task = stored_scenario(attributes_of(store), module, SweepScenario).task() if module else None
    if how["trust"] and names:
        warn(f"trusted, and run with your rights: {', '.join(names)}")
    begin = time.perf_counter()
    with store_errors(USAGE), reporting_stops(store):
        result = ensembles.resume(store, **how, task=task, progress=sys.stderr.isatty())
    figures = sweep_figures(store, result, time.perf_counter() - begin, before)
    show_sweep(store, figures, {"title": str(store)}, {}, json=json)
    leave_if_all_raised(figures)


@contextlib.contextmanager
def reporting_stops(store: Path) -> Iterator[None]:
    """Report why a sweep stopped and how to resume it, and at its end its warnings."""
    with warnings.catch_warnings(record=True) as messages:
        warnings.simplefilter("always", RuntimeWarning)
        try:
            yield
        except KeyboardInterrupt:
            resume = f"at {ensembles.standing_of(store)}. Resume with: nonholo resume" if store.exists() else ""
            leave(f"Stopped {resume} {store}" if resume else "Stopped before it began.", FAILED)
        except OSError as failure:
            if not store.exists() or isinstance(failure, FileExistsError | BlockingIOError):
                raise
            leave(f"{failure.strerror or failure} (nonholo resume {store})", FAILED)
        finally:
            for warning in messages[:_MOST_WARNINGS]:
                warn(str(warning.message))
            if len(messages) > _MOST_WARNINGS:
                warn(f"and {len(messages) - _MOST_WARNINGS} more of this kind.")
