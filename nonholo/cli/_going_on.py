"""What `nonholo resume` and `nonholo extend` do around the run."""

import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import cast

from nonholo._results import OutcomeError
from nonholo.cli._errors import FAILED, USAGE, leave, store_errors, warn
from nonholo.cli._provenance import show_provenance
from nonholo.io import read_attributes
from nonholo.orbit import Orbit


def go_on_and_report(store: Path, going_on: Callable[[bool], Orbit], *, json: bool) -> None:
    """Run, name what was damaged, report what the store holds now."""
    stopped = None
    with warnings.catch_warnings(record=True) as told, store_errors(USAGE):
        warnings.simplefilter("always", RuntimeWarning)
        try:
            orbit = going_on(sys.stderr.isatty())
        except OutcomeError as failure:
            orbit, stopped = cast(Orbit, failure.orbit), str(failure)
        except KeyboardInterrupt as failure:
            leave(str(failure), FAILED)
    for warning in told:
        warn(str(warning.message))
    show_provenance(store, read_attributes(store), orbit, json=json)
    if stopped:
        leave(f"Stopped early; the good steps are kept. {stopped}", FAILED)
