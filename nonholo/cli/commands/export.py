"""`nonholo export`: the poses of a run as CSV, for other programs."""

import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer


def export(
    store: Annotated[Path, typer.Argument(metavar="STORE", help="A store of a run or a sweep, finished or not.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="CSV", help="A new file; by default standard output.")
    ] = None,
    every: Annotated[int, typer.Option(metavar="N", min=1, help="Write one in N of the saved states.")] = 1,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an older file at CSV.")] = False,
) -> None:
    """Write the poses of a run as CSV, read back exactly, in the body frame of the scenario.

    Columns: t,x,y,theta in the plane; t,qw,qx,qy,qz for rotations of space;
    t,x,y,z,qw,qx,qy,qz for motions of space; else the entries of the matrix.
    Of a run that is not finished, what is there. Of a sweep the last pose of
    each member, with its number, values, outcome and time.

    nonholo export runs/sleigh-001.zarr -o sleigh.csv
    nonholo export run.zarr --every 100 | head
    """
    from nonholo.cli.screen.errors import FAILED, USAGE, reporting_warnings, store_errors
    from nonholo.io import SWEEP_FORMAT, check_file, format_of, read_attributes, store_to_csv

    is_sweep = format_of(store) == SWEEP_FORMAT
    with store_errors(USAGE):
        if is_sweep and every != 1:
            raise ValueError("`--every` thins the states of a run. Got it for a sweep. Leave it out.")
        if not is_sweep:
            read_attributes(store)
        if output:
            check_file(output, overwrite=overwrite)
    with store_errors(FAILED), reporting_warnings(), _ending_with_the_reader():
        if is_sweep:
            from nonholo.ensembles import sweep_to_csv

            sweep_to_csv(store, output or sys.stdout, overwrite=overwrite)
        else:
            shown = output is not None and sys.stderr.isatty()
            store_to_csv(store, output or sys.stdout, every=every, overwrite=overwrite, progress=shown)
    if output:
        typer.echo(output)


@contextlib.contextmanager
def _ending_with_the_reader() -> Iterator[None]:
    """Write to the standard output until its reader has seen enough, as `head` does."""
    try:
        yield
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
