"""`nonholo plot`: draw a run that was kept."""

from pathlib import Path
from typing import Annotated

import typer


def plot(
    store: Annotated[Path, typer.Argument(metavar="STORE", help="A store made by simulate or save_orbit.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="PICTURE", help="A .png, .svg or .pdf; by default beside STORE."),
    ] = None,
    gif: Annotated[bool, typer.Option("--gif", help="Draw an animation instead.")] = False,
) -> None:
    """Draw the overview of a run, or an animation of it.

    nonholo plot runs/sleigh-001.zarr -o sleigh.pdf
    nonholo plot runs/sleigh-001.zarr --gif
    """
    from nonholo.cli._caches import use_cache_folders

    use_cache_folders()
    from nonholo.cli._errors import FAILED, USAGE, store_errors
    from nonholo.cli._pictures import beside, draw
    from nonholo.io import load_orbit, read_attributes

    with store_errors(USAGE):
        read_attributes(store)
    with store_errors(FAILED):
        orbit = load_orbit(store)
    path = output or beside(store, "gif" if gif else "png")
    drawn = draw(orbit, None if gif else path, path if gif else None)
    if str(path) not in drawn.values():
        raise typer.Exit(FAILED)
    typer.echo(path)
