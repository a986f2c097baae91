"""Running a scenario and keeping what it gave: the orbit, its store, its pictures."""

import contextlib
import functools
import itertools
import os
import re
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from nonholo.base.limits import within_disk
from nonholo.base.progress import waiting
from nonholo.base.results import Outcome, OutcomeError
from nonholo.cli.scenario.files import Loaded, effective_text
from nonholo.cli.scenario.problems import ScenarioError, problem_of_value
from nonholo.cli.screen.errors import USAGE, store_errors
from nonholo.cli.screen.pictures import beside
from nonholo.discrete import Discretization
from nonholo.io import check_target, load_orbit, read_attributes, remove_store, save_orbit
from nonholo.orbit import Orbit
from nonholo.simulation import resume_run, simulate, size_in_blocks

RUNS = Path("runs")
Made = TypeVar("Made")


class Ran(NamedTuple):
    """A run: its good steps if there are any, how long it took, and why it stopped early, if it did."""

    orbit: Orbit | None
    seconds: float
    stopped: str | None


def run_and_keep(loaded: Loaded, store: Path | None, *, overwrite: bool, progress: bool) -> tuple[Path | None, Ran]:
    """Run a scenario and keep it at the path given or under the next free number; return where, and what it gave.

    Compilation is over before the clock starts. What takes several blocks goes to the store as it is computed.
    """
    with waiting("compiling", progress):
        scenario, (discrete, starts) = loaded.scenario, _tried(loaded)
    task: Any = functools.partial(simulate, discrete, steps=scenario.run.steps, progress=progress, **scenario.options())
    text = scenario_text(loaded)
    size = size_in_blocks(discrete, scenario.run.branch, scenario.run.steps, scenario.run.save_every)
    if size and starts:
        with store_errors(USAGE):
            within_disk(
                "run.save_every", size, RUNS if store is None else store.parent, "Raise it to keep fewer states."
            )
        if overwrite and store is not None and store.exists():
            check_target(store, overwrite=True)
            remove_store(store)
        return at_free_path(loaded.name, store, lambda path: _ran(task, store=path, scenario=text))
    ran = _ran(task)
    if ran.orbit is None:
        return None, ran
    orbit, replace = ran.orbit, overwrite and store is not None  # what has a number is never replaced
    path, _ = at_free_path(loaded.name, store, lambda at: save_orbit(orbit, at, overwrite=replace, scenario=text))
    return path, ran


def scenario_text(loaded: Loaded) -> str:
    """Return the scenario that a store of its run keeps."""
    scenario, discrete = loaded.scenario, _discretized(loaded)
    return effective_text(scenario.in_force(discrete) if isinstance(discrete, Discretization) else scenario)


def is_stopped(store: Path, text: str, pictures: list[str], read: Callable[[Path], dict[str, Any]]) -> bool:
    """Tell whether a store holds what this scenario began, and lacks a part of it or a picture: it was stopped."""
    with contextlib.suppress(OSError, ValueError):
        stored = read(store)
        is_whole = "outcome" in stored or stored.get("finished", False)
        return stored.get("scenario") == text and not (is_whole and all(beside(store, p).exists() for p in pictures))
    return False


def continued(store: Path, *, progress: bool) -> Ran:
    """Do what a run that was stopped lacks; of one that came to its end the orbit is read."""
    if "outcome" in read_attributes(store):
        return _ran(functools.partial(load_orbit, store))
    return _ran(functools.partial(resume_run, store, discrete=None, events=None, throw=True, progress=progress))


def _tried(loaded: Loaded) -> tuple[Discretization, bool]:
    """Return the discretized body of a scenario after a first step, which compiles, and whether there is a start."""
    discrete = _discretized(loaded)
    try:
        first = simulate(discrete, steps=1, throw=False, **loaded.scenario.options())
    except OutcomeError:
        return discrete, False  # off the principal branch: the run proper says so
    except ValueError as failure:
        section = "run" if str(failure).startswith("`simulate(branch=") else "start"
        raise ScenarioError([problem_of_value(failure, section, loaded.source, loaded.options)]) from None
    return discrete, len(first) > 0


def _ran(task: Callable[..., Orbit], **kept: Any) -> Ran:
    begun = time.perf_counter()
    try:
        orbit = task(**kept)
    except OutcomeError as failure:
        good = failure.orbit if isinstance(failure.orbit, Orbit) and len(failure.orbit) else None
        return Ran(good, time.perf_counter() - begun, str(failure))
    stopped = None if orbit.outcome == Outcome.successful else orbit.outcome.message
    return Ran(orbit, time.perf_counter() - begun, stopped)


def _discretized(loaded: Loaded) -> Discretization:
    try:
        return loaded.scenario.discretization()
    except ValueError as failure:
        raise ScenarioError([problem_of_value(failure, "run", loaded.source, loaded.options)]) from None


def check_output(store: Path | None, *, overwrite: bool) -> None:
    """Refuse, before any work is done, a place where the results cannot go."""
    folder = RUNS if store is None else store.parent
    folder.mkdir(parents=True, exist_ok=True)
    if not os.access(folder, os.W_OK | os.X_OK):
        raise PermissionError(f"The results cannot be kept in '{folder}': not writable. Choose another place with -o.")
    check_target(RUNS / "new.zarr" if store is None else store, overwrite=overwrite)
    for picture in () if store is None or overwrite else (beside(store, "png"), beside(store, "gif")):
        if picture.exists():
            raise FileExistsError(f"A picture '{picture}' exists. Choose another name, or remove it (--overwrite).")


def at_free_path(name: str, store: Path | None, make: Callable[[Path], Made]) -> tuple[Path, Made]:
    """Make a store at the path given or under the next free number; return where, and what came of it."""
    if store is not None:
        return store, make(store)
    for path in _next_names(name):
        with contextlib.suppress(FileExistsError):  # another run was faster
            return path, make(path)
    raise AssertionError("the numbers do not end")


def _next_names(name: str) -> Iterable[Path]:
    """Return the numbered paths that are free for a scenario, in order."""
    pattern = re.compile(re.escape(name) + r"-(\d+)\.\w+")
    taken = [int(match[1]) for path in RUNS.iterdir() if (match := pattern.fullmatch(path.name))]
    return (RUNS / f"{name}-{number:03d}.zarr" for number in itertools.count(max(taken, default=0) + 1))
