"""`nonholo plot`: draw a run or a sweep that was kept."""

import sys
from collections.abc import Collection
from pathlib import Path
from typing import Annotated

import typer


def plot(
    store: Annotated[Path, typer.Argument(metavar="STORE", help="A store made by simulate, sweep or save_orbit.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="PICTURE", help="A .png, .svg or .pdf; by default beside STORE."),
    ] = None,
    gif: Annotated[bool, typer.Option("--gif", help="Of a run: draw an animation instead.")] = False,
    color: Annotated[str | None, typer.Option(metavar="NAME", help="Of a sweep: the quantity that is shown.")] = None,
    x: Annotated[str | None, typer.Option("--x", metavar="NAME", help="Of a sweep: what runs across.")] = None,
    y: Annotated[str | None, typer.Option("--y", metavar="NAME", help="Of a sweep: what runs up.")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an older PICTURE.")] = False,
) -> None:
    """Draw the overview of a run, an animation of it, or the map of a sweep.

    The picture beside STORE is drawn anew; one at -o is replaced only with --overwrite.

    nonholo plot runs/sleigh-001.zarr -o sleigh.pdf
    nonholo plot runs/sleigh-001.zarr --gif
    nonholo plot sweep.zarr --color outcome --x body.a --y run.time_step
    """
    from nonholo import io
    from nonholo.cli.screen.errors import FAILED, USAGE, leave, store_errors
    from nonholo.cli.screen.pictures import beside

    if output is not None:
        with store_errors(USAGE):
            io.check_file(output, overwrite=overwrite, where="nonholo plot -o")
    path = output or beside(store, "gif" if gif else "png")
    if io.format_of(store) == io.SWEEP_FORMAT:
        from nonholo.cli.screen.sweep_picture import draw_stored_sweep

        if gif:
            leave("A sweep has no animation. Leave --gif out.", USAGE)
        drawn = draw_stored_sweep(store, path, color, x, y)
    else:
        if color or x or y:
            leave("--color, --x and --y are for the store of a sweep.", USAGE)
        drawn = _draw_run(store, path, gif=gif)
    if str(path) not in drawn:
        raise typer.Exit(FAILED)
    typer.echo(path)


def _draw_run(store: Path, path: Path, *, gif: bool) -> Collection[str | None]:
    """Draw the overview or the animation of a run, and return the paths of what was drawn."""
    from nonholo import io
    from nonholo.base.progress import waiting
    from nonholo.cli.screen.errors import FAILED, USAGE, store_errors
    from nonholo.cli.screen.pictures import draw

    with store_errors(USAGE):
        io.read_attributes(store)
    with store_errors(FAILED), waiting("reading", shown := sys.stderr.isatty()):
        orbit = io.load_orbit(store)
    return draw(orbit, None if gif else path, path if gif else None, progress=shown).values()
