"""Errors as users of the command line see them: a sentence on standard error and an exit code, never a traceback."""

import contextlib
import functools
import sys
import warnings
from collections.abc import Iterator
from typing import NoReturn

import typer

from nonholo.cli import scenario

FAILED = 1
USAGE = 2


def leave(message: str, code: int) -> NoReturn:
    """Print a message on standard error and end the command."""
    typer.secho(message, fg=typer.colors.RED, err=True)
    raise typer.Exit(code)


def warn(message: str) -> None:
    """Print a warning on standard error, above a progress bar, which replaces `sys.stderr` while it is shown."""
    typer.secho(f"Warning: {message}", fg=typer.colors.YELLOW, file=sys.stderr)


_warn_once = functools.cache(warn)  # of a body, which a command may make several times


@contextlib.contextmanager
def reporting_warnings() -> Iterator[None]:
    """Print warnings of the library as they come, those of a body once."""

    def show(message: Warning | str, category: type[Warning], *_: object) -> None:
        (warn if issubclass(category, RuntimeWarning) else _warn_once)(str(message))

    with warnings.catch_warnings():
        warnings.showwarning = show
        warnings.simplefilter("always", RuntimeWarning)
        warnings.simplefilter("always", UserWarning)
        yield


@contextlib.contextmanager
def scenario_errors() -> Iterator[None]:
    """Report everything that is wrong with a scenario."""
    try:
        yield
    except scenario.sections.ScenarioError as failure:
        count = len(failure.problems)
        heading = "The scenario cannot be run" + (f", {count} problems:" if count > 1 else ":")
        leave("\n".join([heading, *(f"  {problem}" for problem in failure.problems)]), USAGE)


@contextlib.contextmanager
def store_errors(code: int) -> Iterator[None]:
    """Report a store that cannot be read or written."""
    try:
        yield
    except (OSError, ValueError) as failure:
        leave(str(failure), code)
