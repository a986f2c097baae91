"""The work of the commands: runs and sweeps of scenarios, their stores, pictures and pages, and resuming them."""

import contextlib
import functools
import itertools
import os
import re
import sys
import time
import warnings
import webbrowser
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, NamedTuple, TypeVar

import typer

from nonholo import ensembles, explorer, io
from nonholo.base.checks import within_disk
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome, OutcomeError
from nonholo.cli.scenario.files import Loaded, built_in, effective_text, given_settings, load_scenario, stored_scenario
from nonholo.cli.scenario.motion import Scenario
from nonholo.cli.scenario.sweeps import SweepScenario, load_sweep_scenario
from nonholo.cli.screen import report
from nonholo.cli.screen.errors import FAILED, USAGE, leave, reporting_warnings, scenario_errors, store_errors, warn
from nonholo.cli.screen.pictures import beside, draw, draw_sweep, warn_of_older
from nonholo.cli.screen.report import duration, figures, leave_if_all_raised, show, show_json, show_provenance
from nonholo.io.metadata import read_attributes
from nonholo.io.places import FORMAT, SWEEP_FORMAT, check_target
from nonholo.orbit import AbstractOrbit
from nonholo.simulation import resume_run, simulate, size_in_blocks

RUNS = Path("runs")
_MOST_WARNINGS = 5  # warnings of a sweep that are reported
Result = TypeVar("Result")


class Ran(NamedTuple):
    """A run: its good steps if there are any, how long it took, and why it stopped early, if it did."""

    orbit: AbstractOrbit | None
    seconds: float
    reason: str | None


def request_of(name: str, options: Any, settings: list[str] | None, module: Path | None, of_sweep: bool = False) -> Any:
    """Load a scenario; options of the command line come before the settings of `--set`."""
    with scenario_errors(), reporting_warnings():
        own = given_settings(options, settings or [])
        return (load_sweep_scenario if of_sweep else load_scenario)(name, own, module)


def simulate_and_keep(request: Loaded, output: Path | None, *, json: bool, overwrite: bool, quiet: bool) -> None:
    """Run, save, draw, report."""
    wishes, progress = request.scenario.output, sys.stderr.isatty() and not quiet
    suffixes = ["png"] * wishes.plot + ["gif"] * wishes.gif
    again = _is_stopped(output, FORMAT, lambda: _scenario_text(request), suffixes, overwrite=overwrite)
    with _reporting_stops(), store_errors(FAILED), scenario_errors(), reporting_warnings():
        if output is not None and again:
            store, ran = output, _complete(request, output, progress=progress)
        else:
            store, ran = run_and_keep(request, output, overwrite=overwrite, progress=progress)
    if store is None or ran.orbit is None:
        leave(f"Nothing to keep. {ran.reason}", FAILED)
    pictures = draw(ran.orbit, store, suffixes, progress=progress)
    warn_of_older(store, pictures)
    _report(request, ran, {"store": str(store), **pictures}, json=json, quiet=quiet)
    if ran.reason:
        leave(f"Stopped early; the good steps are kept. {ran.reason}", FAILED)


@contextlib.contextmanager
def _reporting_stops() -> Iterator[None]:
    try:
        yield
    except KeyboardInterrupt as stop:
        leave(str(stop) or "Stopped. A run this short is not kept.", FAILED)
    except MemoryError:
        leave("The states do not fit in memory. Keep fewer of them: raise run.save_every.", USAGE)


def _is_stopped(output: Path | None, kind: str, text: Callable[[], str], pictures: list[str], overwrite: bool) -> bool:
    """Return whether this very command began the store at a path, and was stopped before all of it was there.

    Refuse, before any work is done, what else is in the way, and a place where the results cannot go.
    """
    with store_errors(USAGE), scenario_errors(), reporting_warnings():
        if output is not None and output.exists() and not overwrite and _lacks_a_part(output, kind, text, pictures):
            return True
        _check_output(output, overwrite=overwrite, new="nonholo sweep -o" if kind == SWEEP_FORMAT else None)
    return False


def _lacks_a_part(store: Path, kind: str, text: Callable[[], str], pictures: list[str]) -> bool:
    try:
        attributes = read_attributes(store, kind)
    except (OSError, ValueError):
        return False
    is_whole = "outcome" in attributes or attributes.get("finished", False)
    has_all = is_whole and all(beside(store, suffix).exists() for suffix in pictures)
    return attributes.get("scenario") == text() and not has_all


def _report(request: Loaded, ran: Ran, paths: dict[str, str | None], *, json: bool, quiet: bool) -> None:
    orbit: Any = ran.orbit
    if quiet and not json:
        typer.echo(paths["store"])
        return
    with progress_bar("measuring", sys.stderr.isatty()):
        numbers = figures(orbit)
    if is_part := bool(orbit.step[0] > 0):  # only the last block of so large a run was loaded
        numbers["steps"] = int(orbit.step[-1])
    each, scenario = ran.seconds / max(1, numbers["steps"]), request.scenario
    if json:
        times = {"seconds": ran.seconds, "seconds_per_step": each}
        show_json({"scenario": request.name, **paths, **times, **numbers, "stopped": ran.reason})
        return
    length = f"{numbers['steps']} of {scenario.run.steps}, time step {scenario.run.time_step:g}"
    heading = {"title": scenario.title or request.name, "steps": length}
    heading |= {"time per step": f"{duration(each)}, once compiled"} | scenario.forces.about(orbit.system)
    if is_part:
        heading["shown"] = f"the last {len(orbit):,} states; the store has all"
    show(numbers, heading)
    report.show_paths(paths)


def run_and_keep(request: Loaded, store: Path | None, *, overwrite: bool, progress: bool) -> tuple[Path | None, Ran]:
    """Run a scenario and keep it at the path given or under the next free number; return where, and what it gave.

    Compilation is over before the clock starts. A run of several blocks goes to the store as it is computed.
    """
    with progress_bar("compiling", progress):
        scenario, (discrete, starts) = request.scenario, _try(request)
    task: Any = functools.partial(simulate, discrete, progress=progress, **scenario.options())
    text = _scenario_text(request)
    if (size := size_in_blocks(discrete, scenario.run.branch, scenario.run.steps, scenario.run.save_every)) and starts:
        with store_errors(USAGE):
            folder = RUNS if store is None else store.parent
            within_disk("run.save_every", size, folder, "Raise it to keep fewer states.")
        if overwrite and store is not None and store.exists():
            check_target(store, overwrite=True)
            io.places.remove_store(store)
        return at_free_path(request.name, store, lambda path: _run(task, store=path, scenario=text))
    ran = _run(task)
    if ran.orbit is None:
        return None, ran
    orbit, replace = ran.orbit, overwrite and store is not None  # what has a number is never replaced
    path, _ = at_free_path(request.name, store, lambda at: io.save_orbit(orbit, at, overwrite=replace, scenario=text))
    return path, ran


def _complete(request: Loaded, store: Path, *, progress: bool) -> Ran:
    """Do what a run that was stopped lacks; of one that came to its end the orbit is read."""
    discrete = _discretize(request) if request.module else None  # of the user's own: no store holds it
    if "outcome" in read_attributes(store):
        return _run(functools.partial(io.load_orbit, store, discrete=discrete))
    return _run(functools.partial(resume_run, store, discrete=discrete, events=None, throw=True, progress=progress))


def _try(request: Loaded) -> tuple[Any, bool]:
    """Return the discretized body of a scenario after a first step, which compiles, and whether there is a start."""
    discrete = _discretize(request)
    with contextlib.suppress(OutcomeError), request.reporting("start"):
        return discrete, len(simulate(discrete, **request.scenario.options() | {"steps": 1, "throw": False})) > 0
    return discrete, False  # off the principal branch: the run proper says so


def _run(task: Callable[..., AbstractOrbit], **place: Any) -> Ran:
    begin = time.perf_counter()
    try:
        orbit = task(**place)
    except OutcomeError as failure:
        good = failure.orbit if isinstance(failure.orbit, AbstractOrbit) and len(failure.orbit) else None
        return Ran(good, time.perf_counter() - begin, str(failure))
    reason = None if orbit.outcome == Outcome.successful else orbit.outcome.message
    return Ran(orbit, time.perf_counter() - begin, reason)


def _discretize(request: Loaded) -> Any:
    with request.reporting():
        return request.scenario.discretization()


def _scenario_text(request: Loaded) -> str:
    """Return the scenario that a store of its run keeps."""
    return effective_text(request.scenario.in_force(_discretize(request)))


def _check_output(store: Path | None, *, overwrite: bool, new: str | None) -> None:
    """Refuse, before any work is done, a place where the results cannot go."""
    folder = RUNS if store is None else store.parent
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
    if not (folder.is_dir() and os.access(folder, os.W_OK | os.X_OK)):
        raise PermissionError(f"The results cannot be kept in '{folder}', no writable folder. Choose another with -o.")
    check_target(RUNS / "new.zarr" if store is None else store, overwrite=overwrite, new=new)
    for picture in () if store is None or overwrite else (beside(store, "png"), beside(store, "gif")):
        if picture.exists():
            raise FileExistsError(f"A picture '{picture}' exists. Choose another name, or remove it (--overwrite).")


def at_free_path(name: str, store: Path | None, make: Callable[[Path], Result]) -> tuple[Path, Result]:
    """Make a store at the path given or under the next free number; return where, and what came of it."""
    if store is not None:
        return store, make(store)
    pattern = re.compile(re.escape(name) + r"-(\d+)\.\w+")
    numbers = [int(match[1]) for path in RUNS.iterdir() if (match := pattern.fullmatch(path.name))]
    for number in itertools.count(max(numbers, default=0) + 1):
        path = RUNS / f"{name}-{number:03d}.zarr"
        with contextlib.suppress(FileExistsError):  # another run was faster
            return path, make(path)
    raise AssertionError("the numbers do not end")


def write_page(source: str, ask: Callable[[], Loaded], output: Path | None, *, browser: bool, overwrite: bool) -> Path:
    """Write the page of a scenario or a store, and return its path."""
    if output is not None:
        with store_errors(USAGE):
            io.places.check_file(output, overwrite=overwrite, where="nonholo explore -o")
    if source not in built_in() and Path(source).is_dir():
        with store_errors(USAGE):
            orbit = io.load_orbit(source)
    else:
        request = ask()
        with scenario_errors(), reporting_warnings(), store_errors(USAGE):
            orbit = simulate(_discretize(request), throw=False, **request.scenario.options())
    path = output or Path(mkdtemp(prefix="nonholo-")) / f"{Path(source).stem}.html"
    with store_errors(FAILED):
        explorer.orbit_to_html(orbit, path, overwrite=overwrite)
    if browser:
        webbrowser.open(path.resolve().as_uri())
    return path


def sweep_and_keep(request: Loaded[Any], output: Path | None, how: dict[str, Any], *, json: bool, quiet: bool) -> None:
    """Run, draw, report; how: scheduler and workers."""
    with scenario_errors(), reporting_warnings(), request.reporting():
        task = request.scenario.task()
    scenario, begin = request.scenario, time.perf_counter()
    text = effective_text(scenario if scenario.is_family else scenario.in_force(task.discrete))
    again = _is_stopped(output, SWEEP_FORMAT, lambda: text, ["png"] * scenario.output.plot, overwrite=False)
    design, progress = scenario.design.design(), sys.stderr.isatty() and not quiet
    run = functools.partial(ensembles.sweep, task, design, **how, resume=again, progress=progress, scenario=text)
    with store_errors(USAGE):
        store, result = at_free_path(request.name, output, lambda path: reporting_stops(path)(run)(store=path))
    seconds, wishes = time.perf_counter() - begin, scenario.output
    picture = draw_sweep(result, beside(store, "png"), wishes.color, wishes.x, wishes.y) if wishes.plot else None
    numbers = report.sweep_figures(store, result, seconds)
    if quiet and not json:
        typer.echo(store)
    else:
        heading = {"title": scenario.title or request.name} | scenario.forces.about(scenario.system())
        report.show_sweep(store, numbers, heading, {"picture": picture}, json=json)
    leave_if_all_raised(numbers)


def continue_and_report(store: Path, module: Path | None, resume: Callable[..., AbstractOrbit], *, json: bool) -> None:
    """Run, name what was damaged, report what the store holds now; `resume` takes `discrete` that no store holds."""
    reason = None
    with _reporting_stops(), reporting_warnings(), scenario_errors(), store_errors(USAGE):
        motion = stored_scenario(read_attributes(store), module, Scenario).discretization() if module else None
        try:
            orbit: Any = resume(discrete=motion, progress=sys.stderr.isatty())
        except OutcomeError as failure:
            orbit, reason = failure.orbit, str(failure)
    show_provenance(store, read_attributes(store), orbit, json=json)
    if reason:
        leave(f"Stopped early; the good steps are kept. {reason}", FAILED)


def resume_sweep(store: Path, module: Path | None, how: dict[str, Any], *, json: bool) -> None:
    """Do what a sweep lacks, report what the store holds now; name what is trusted first."""
    with store_errors(USAGE):
        before, names = ensembles.standing_of(store).done, ensembles.functions_of(store)
    with scenario_errors(), reporting_warnings():
        task = stored_scenario(read_attributes(store, SWEEP_FORMAT), module, SweepScenario).task() if module else None
    if how["trust"] and names:
        warn(f"trusted, and run with your rights: {', '.join(names)}")
    begin = time.perf_counter()
    with store_errors(USAGE), reporting_stops(store):
        result = ensembles.resume(store, **how, task=task, progress=sys.stderr.isatty())
    numbers = report.sweep_figures(store, result, time.perf_counter() - begin, before)
    report.show_sweep(store, numbers, {"title": str(store)}, {}, json=json)
    leave_if_all_raised(numbers)


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
