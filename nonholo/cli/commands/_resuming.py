"""The work of `nonholo resume` and `nonholo extend` around the run, or around the sweep."""

import contextlib
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import cast

from nonholo.base.results import OutcomeError
from nonholo.cli.screen.errors import FAILED, USAGE, leave, reporting_warnings, store_errors, warn
from nonholo.cli.screen.provenance import show_provenance
from nonholo.cli.screen.sweep_report import leave_if_all_raised, show_sweep, sweep_figures
from nonholo.ensembles import functions_of, resume, standing_of
from nonholo.io import read_attributes
from nonholo.orbit import Orbit

_MOST_WARNINGS = 5  # warnings of a sweep that are reported


def continue_and_report(store: Path, continued: Callable[[bool], Orbit], *, json: bool) -> None:
    """Run, name what was damaged, report what the store holds now."""
    stopped = None
    with reporting_warnings(), store_errors(USAGE):
        try:
            orbit = continued(sys.stderr.isatty())
        except OutcomeError as failure:
            orbit, stopped = cast(Orbit, failure.orbit), str(failure)
        except KeyboardInterrupt as failure:
            leave(str(failure), FAILED)
    show_provenance(store, read_attributes(store), orbit, json=json)
    if stopped:
        leave(f"Stopped early; the good steps are kept. {stopped}", FAILED)


def resume_sweep(store: Path, scheduler: str | None, workers: int | None, *, trust: bool, json: bool) -> None:
    """Do what a sweep lacks, report what the store holds now; name what is trusted first."""
    with store_errors(USAGE):
        done, imported = standing_of(store).done, functions_of(store)
    if trust and imported:
        warn(f"trusted, and run with your rights: {', '.join(imported)}")
    begun = time.perf_counter()
    with store_errors(USAGE), reporting_stops(store):
        result = resume(store, scheduler=scheduler, workers=workers, trust=trust, progress=sys.stderr.isatty())
    figures = sweep_figures(store, result, time.perf_counter() - begun, done)
    show_sweep(store, figures, {"title": str(store)}, {}, json=json)
    leave_if_all_raised(figures)


@contextlib.contextmanager
def reporting_stops(store: Path) -> Iterator[None]:
    """Tell what stopped a sweep and how to resume, and at its end what it warned of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RuntimeWarning)
        try:
            yield
        except KeyboardInterrupt:
            leave(f"Stopped {_where(store)}", FAILED)
        except OSError as failure:
            if not store.exists() or isinstance(failure, FileExistsError | BlockingIOError):
                raise
            leave(f"{failure.strerror or failure} (nonholo resume {store})", FAILED)
        finally:
            for warning in caught[:_MOST_WARNINGS]:
                warn(str(warning.message))
            if len(caught) > _MOST_WARNINGS:
                warn(f"and {len(caught) - _MOST_WARNINGS} more of this kind.")


def _where(store: Path) -> str:
    """Say how far a sweep came; before its store is there it has not begun."""
    return f"at {standing_of(store)}. Resume with: nonholo resume {store}" if store.exists() else "before it began."
