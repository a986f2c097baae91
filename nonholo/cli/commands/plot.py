"""`nonholo plot`: draw a run or a sweep that was kept."""

import sys
from collections.abc import Collection
from pathlib import Path
from typing import Annotated, Any

import typer

from nonholo.cli.screen.kinds import KINDS

Store = Annotated[Path, typer.Argument(metavar="STORE", help="A store made by simulate, sweep or save_orbit.")]
Output = Annotated[
    Path | None,
    typer.Option("-o", "--output", metavar="PICTURE", help="A .png, .svg or .pdf; by default beside STORE."),
]
Kind = Annotated[str, typer.Option(metavar="KIND", help=f"Of a run: {', '.join(KINDS)}.")]
Gif = Annotated[bool, typer.Option("--gif", help="Of a run: draw an animation instead.")]
Color = Annotated[str | None, typer.Option(metavar="NAME", help="Of a sweep: the quantity that is shown.")]
Across = Annotated[str | None, typer.Option("--x", metavar="NAME", help="Of a sweep or section: what runs across.")]
Up = Annotated[str | None, typer.Option("--y", metavar="NAME", help="Of a sweep or section: what runs up.")]
Title = Annotated[str | None, typer.Option(help="Instead of the picture's own; '' for none.")]
Size = Annotated[str | None, typer.Option(metavar="WxH", help="In inches, as 16x9; fonts grow with it.")]
Dpi = Annotated[float, typer.Option(min=10, max=1200, help="Dots per inch of a .png.")]
Dark = Annotated[bool | None, typer.Option("--dark/--light", help="Colors for a dark or a light background.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace an older PICTURE.")]


def plot(
    store: Store,
    output: Output = None,
    kind: Kind = KINDS[0],
    gif: Gif = False,
    color: Color = None,
    x: Across = None,
    y: Up = None,
    title: Title = None,
    size: Size = None,
    dpi: Dpi = 150,
    dark: Dark = None,
    overwrite: Overwrite = False,
) -> None:
    """Draw the overview of a run, another picture or an animation of it, or the map of a sweep.

    The picture beside STORE is drawn anew; one at -o is replaced only with --overwrite.

    nonholo plot runs/sleigh-001.zarr -o sleigh.pdf
    nonholo plot runs/sleigh-001.zarr --gif
    nonholo plot runs/sleigh-001.zarr --kind blade-track --title 'A sleigh' --size 16x9 --dark
    nonholo plot crossings.zarr --kind section --x body_velocity.0 --y momentum.1
    nonholo plot sweep.zarr --color outcome --x body.a --y run.time_step
    """
    from nonholo import io
    from nonholo.cli.screen.errors import FAILED, USAGE, leave, store_errors
    from nonholo.cli.screen.pictures import beside

    if output is not None:
        with store_errors(USAGE):
            io.check_file(output, overwrite=overwrite, where="nonholo plot -o")
    path = output or beside(store, "gif" if gif else "png")
    look = _look(title, size, dark)
    if io.format_of(store) == io.SWEEP_FORMAT:
        from nonholo.cli.screen.sweep_picture import draw_stored_sweep

        if gif or kind != KINDS[0]:
            leave("A sweep has one kind of picture, its map. Leave --kind and --gif out.", USAGE)
        drawn = draw_stored_sweep(store, path, color, x, y, dpi=dpi, **look)
    else:
        _check_kind(kind, gif, color, x or y)
        names = {"across": x, "up": y} if kind == "section" else {}
        drawn = _draw_run(store, path, look, gif=gif, kind=kind, dpi=dpi, **names)
    if str(path) not in drawn:
        raise typer.Exit(FAILED)
    typer.echo(path)


def _check_kind(kind: str, gif: bool, color: str | None, axis: str | None) -> None:
    """Refuse options that do not belong to this kind of picture of a run."""
    from nonholo.cli.screen.errors import USAGE, leave

    if kind not in KINDS:
        leave(f"--kind must be one of {', '.join(KINDS)}. Got '{kind}'.", USAGE)
    if color or (axis and kind != "section"):
        leave("--color, --x and --y are for the store of a sweep; --x and --y for --kind section too.", USAGE)
    if gif and kind != KINDS[0]:
        leave("--gif is a kind of its own. Leave --kind out.", USAGE)


def _look(title: str | None, size: str | None, dark: bool | None) -> dict[str, Any]:
    """Return what is asked of a picture, as the library takes it."""
    from nonholo.cli.screen.errors import USAGE, leave

    look: dict[str, Any] = {"title": title, "dark": dark}
    if size is not None:
        try:
            look["size"] = tuple(map(float, size.lower().split("x")))
        except ValueError:
            look["size"] = ()
        if len(look["size"]) != 2 or not all(1 <= side <= 100 for side in look["size"]):
            leave(f"--size must be width and height in inches, 1 to 100, as 16x9. Got '{size}'.", USAGE)
    return {name: value for name, value in look.items() if value is not None}


def _draw_run(store: Path, path: Path, look: dict[str, Any], *, gif: bool, **options: Any) -> Collection[str | None]:
    """Draw a picture or the animation of a run, and return the paths of what was drawn."""
    from nonholo import io
    from nonholo.base.progress import waiting
    from nonholo.cli.screen.errors import FAILED, USAGE, store_errors
    from nonholo.cli.screen.pictures import draw

    with store_errors(USAGE):
        io.read_attributes(store)
    with store_errors(FAILED), waiting("reading", shown := sys.stderr.isatty()):
        orbit = io.load_orbit(store)
    return draw(orbit, None if gif else path, path if gif else None, progress=shown, look=look, **options).values()
