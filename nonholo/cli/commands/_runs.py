"""Running a scenario of one motion: the orbit, its store, its pictures, its page, once compilers know their caches."""

import contextlib
import functools
import itertools
import os
import re
import sys
import time
import webbrowser
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, NamedTuple, TypeVar

import typer

from nonholo import explorer, io
from nonholo.base.limits import within_disk
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome, OutcomeError
from nonholo.cli.scenario.files import Loaded, built_in, effective_text, given_settings, load_scenario
from nonholo.cli.screen.errors import FAILED, USAGE, leave, reporting_warnings, scenario_errors, store_errors
from nonholo.cli.screen.pictures import beside, draw, warn_of_older
from nonholo.cli.screen.report import duration, figures, show, show_json
from nonholo.orbit import AbstractOrbit
from nonholo.simulation import resume_run, simulate, size_in_blocks

RUNS = Path("runs")
Chosen = dict[str, tuple[str, Any]]
Loader = Callable[..., Loaded]
Result = TypeVar("Result")


class Ran(NamedTuple):
    """A run: its good steps if there are any, how long it took, and why it stopped early, if it did."""

    orbit: AbstractOrbit | None
    seconds: float
    reason: str | None


def request_of(
    name: str, options: Chosen, settings: list[str] | None, module: Path | None, load: Loader = load_scenario
) -> Any:
    """Load a scenario; options of the command line come before the settings of `--set`."""
    with scenario_errors(), reporting_warnings():
        return load(name, given_settings(options, settings or []), module)


def simulate_and_keep(request: Loaded, output: Path | None, *, json: bool, overwrite: bool, quiet: bool) -> None:
    """Run, save, draw, report."""
    part = _part_of(request, output, overwrite=overwrite)
    progress = sys.stderr.isatty() and not quiet
    with _reporting_stops(), store_errors(FAILED), scenario_errors(), reporting_warnings():
        if part:
            store, ran = part, _complete(request, part, progress=progress)
        else:
            store, ran = run_and_keep(request, output, overwrite=overwrite, progress=progress)
    if store is None or ran.orbit is None:
        leave(f"Nothing to keep. {ran.reason}", FAILED)
    wishes = request.scenario.output
    paths = (beside(store, "png") if wishes.plot else None, beside(store, "gif") if wishes.gif else None)
    pictures = draw(ran.orbit, *paths, progress=progress)
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


def _part_of(request: Loaded, output: Path | None, *, overwrite: bool) -> Path | None:
    """Return the store at a path if this very command began it and was stopped; refuse what else is in the way."""
    suffixes = ["png"] * request.scenario.output.plot + ["gif"] * request.scenario.output.gif
    with store_errors(USAGE), scenario_errors(), reporting_warnings():
        again = False
        if output is not None and not overwrite and output.exists():
            again = is_stopped(output, scenario_text(request), suffixes, io.read_attributes)
        check_output(output, overwrite=overwrite or again)
    return output if again else None


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
    for kind, path in paths.items():
        if path:
            typer.echo(f"{kind:<9} {path}")


def run_and_keep(request: Loaded, store: Path | None, *, overwrite: bool, progress: bool) -> tuple[Path | None, Ran]:
    """Run a scenario and keep it at the path given or under the next free number; return where, and what it gave.

    Compilation is over before the clock starts. A run of several blocks goes to the store as it is computed.
    """
    with progress_bar("compiling", progress):
        scenario, (discrete, starts) = request.scenario, _try(request)
    task: Any = functools.partial(simulate, discrete, steps=scenario.run.steps, progress=progress, **scenario.options())
    text = scenario_text(request)
    size = size_in_blocks(discrete, scenario.run.branch, scenario.run.steps, scenario.run.save_every)
    if size and starts:
        with store_errors(USAGE):
            folder = RUNS if store is None else store.parent
            within_disk("run.save_every", size, folder, "Raise it to keep fewer states.")
        if overwrite and store is not None and store.exists():
            io.check_target(store, overwrite=True)
            io.remove_store(store)
        return at_free_path(request.name, store, lambda path: _run(task, store=path, scenario=text))
    ran = _run(task)
    if ran.orbit is None:
        return None, ran
    orbit, replace = ran.orbit, overwrite and store is not None  # what has a number is never replaced
    path, _ = at_free_path(request.name, store, lambda at: io.save_orbit(orbit, at, overwrite=replace, scenario=text))
    return path, ran


def scenario_text(request: Loaded) -> str:
    """Return the scenario that a store of its run keeps."""
    return effective_text(request.scenario.in_force(_discretize(request)))


def is_stopped(store: Path, text: str, pictures: list[str], read: Callable[[Path], dict[str, Any]]) -> bool:
    """Return whether a store holds what this scenario began, and lacks a part of it or a picture: it was stopped."""
    with contextlib.suppress(OSError, ValueError):
        attributes = read(store)
        is_whole = "outcome" in attributes or attributes.get("finished", False)
        has_all = is_whole and all(beside(store, suffix).exists() for suffix in pictures)
        return attributes.get("scenario") == text and not has_all
    return False


def _complete(request: Loaded, store: Path, *, progress: bool) -> Ran:
    """Do what a run that was stopped lacks; of one that came to its end the orbit is read."""
    discrete = _discretize(request) if request.module else None  # of the user's own: no store holds it
    if "outcome" in io.read_attributes(store):
        return _run(functools.partial(io.load_orbit, store, discrete=discrete))
    return _run(functools.partial(resume_run, store, discrete=discrete, events=None, throw=True, progress=progress))


def _try(request: Loaded) -> tuple[Any, bool]:
    """Return the discretized body of a scenario after a first step, which compiles, and whether there is a start."""
    discrete = _discretize(request)
    with contextlib.suppress(OutcomeError), request.reporting("start"):
        return discrete, len(simulate(discrete, steps=1, throw=False, **request.scenario.options())) > 0
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


def check_output(store: Path | None, *, overwrite: bool) -> None:
    """Refuse, before any work is done, a place where the results cannot go."""
    folder = RUNS if store is None else store.parent
    folder.mkdir(parents=True, exist_ok=True)
    if not os.access(folder, os.W_OK | os.X_OK):
        raise PermissionError(f"The results cannot be kept in '{folder}': not writable. Choose another place with -o.")
    io.check_target(RUNS / "new.zarr" if store is None else store, overwrite=overwrite)
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
            io.check_file(output, overwrite=overwrite, where="nonholo explore -o")
    if source not in built_in() and Path(source).is_dir():
        with store_errors(FAILED):
            orbit = io.load_orbit(source)
    else:
        request = ask()
        options = {"steps": request.scenario.run.steps, "throw": False} | request.scenario.options()
        with scenario_errors(), reporting_warnings(), store_errors(USAGE):
            orbit = simulate(_discretize(request), **options)
    path = output or Path(mkdtemp(prefix="nonholo-")) / f"{Path(source).stem}.html"
    with store_errors(FAILED):
        explorer.orbit_to_html(orbit, path, overwrite=overwrite)
    if browser:
        webbrowser.open(path.resolve().as_uri())
    return path
