"""`nonholo info`, `export` and `plot`: what a store holds, in figures, as a table of poses, as a picture."""

import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

from typer import Argument, Option, echo

from nonholo import io
from nonholo.cli import screen
from nonholo.cli.commands.run import Json, Overwrite
from nonholo.cli.screen.errors import FAILED, USAGE, leave, reporting_warnings, store_errors

Store = Annotated[Path, Argument(metavar="STORE", help="A store made by simulate, sweep or save_orbit.")]


def info(
    store: Store,
    json: Json = False,
    scenario: Annotated[bool, Option("--scenario", help="Print the scenario that was run, as TOML.")] = False,
) -> None:
    """Show the provenance of a run and measure again what it should keep.

    Of a sweep: its progress, how members ended, the first errors, its ranges.

    nonholo info runs/suslov-001.zarr
    nonholo info runs/suslov-001.zarr --scenario > again.toml
    """
    is_sweep = _is_sweep(store)
    with store_errors(USAGE):
        attributes = io.metadata.read_attributes(store, io.places.SWEEP_FORMAT if is_sweep else io.places.FORMAT)
    if scenario:
        if "scenario" not in attributes:
            leave("This store was not made from a scenario.", FAILED)
        echo(attributes["scenario"], nl=False)
    elif is_sweep:
        screen.report.show_sweep_standing(store, attributes, json=json)
    elif partly := io.orbits.standing(store):
        screen.report.show_standing(store, attributes, partly, json=json)
    else:
        try:
            orbit, failure = io.load_orbit(store), None
        except (OSError, ValueError) as caught:
            orbit, failure = None, caught
        screen.report.show_provenance(store, attributes, orbit, json=json)
        if failure:
            leave(f"Its orbit cannot be loaded. {failure}", FAILED)


def export(
    store: Annotated[Path, Argument(metavar="STORE", help="A store of a run or a sweep, finished or not.")],
    output: Annotated[
        Path | None, Option("-o", "--output", metavar="CSV", help="A new file; by default standard output.")
    ] = None,
    every: Annotated[int, Option(metavar="N", min=1, help="Write one in N of the saved states.")] = 1,
    overwrite: Overwrite = False,
) -> None:
    """Write the poses of a run as CSV, read back exactly, in the body frame of the scenario.

    Columns: t,x,y,theta in the plane; t,qw,qx,qy,qz for rotations of space;
    t,x,y,z,qw,qx,qy,qz for motions of space; else the entries of the matrix.
    Of a run that is not finished, what is there. Of a sweep the last pose of
    each member, with its number, values, outcome and time.

    nonholo export runs/sleigh-001.zarr -o sleigh.csv
    nonholo export run.zarr --every 100 | head
    """
    is_sweep = _is_sweep(store)
    with store_errors(USAGE):
        if is_sweep and every != 1:
            raise ValueError("`--every` thins the states of a run. Got it for a sweep. Leave it out.")
        if not is_sweep:
            io.metadata.read_attributes(store)
        if output:
            io.places.check_file(output, overwrite=overwrite)
    with store_errors(FAILED), reporting_warnings(), _ending_with_the_reader():
        if is_sweep:
            from nonholo.ensembles import sweep_to_csv

            sweep_to_csv(store, output or sys.stdout, overwrite=overwrite)
        else:
            shown = output is not None and sys.stderr.isatty()
            io.store_to_csv(store, output or sys.stdout, every=every, overwrite=overwrite, progress=shown)
    if output:
        echo(output)


def _is_sweep(store: Path) -> bool:
    return io.places.format_of(store) == io.places.SWEEP_FORMAT


@contextlib.contextmanager
def _ending_with_the_reader() -> Iterator[None]:
    """Write to the standard output until its reader has seen enough, as `head` does."""
    try:
        yield
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


Output = Annotated[Path | None, Option("-o", "--output", metavar="PICTURE", help="Another place: .png, .svg or .pdf.")]
Kind = Annotated[str, Option(metavar="KIND", help="Of a run: a picture of nonholo.plot, such as blade-track; or all.")]


def plot(
    store: Store,
    output: Output = None,
    kind: Kind = "overview",
    gif: Annotated[bool, Option("--gif", help="Of a run: draw an animation instead.")] = False,
    color: Annotated[str | None, Option(metavar="NAME", help="Of a sweep: the quantity that is shown.")] = None,
    x: Annotated[str | None, Option("--x", metavar="NAME", help="Of a sweep or section: what runs across.")] = None,
    y: Annotated[str | None, Option("--y", metavar="NAME", help="Of a sweep or section: what runs up.")] = None,
    title: Annotated[str | None, Option(help="Instead of the picture's own; '' for none.")] = None,
    size: Annotated[str | None, Option(metavar="WxH", help="In inches, as 16x9; fonts grow with it.")] = None,
    dpi: Annotated[float, Option(min=10, max=1200, help="Dots per inch of a .png.")] = 150,
    dark: Annotated[bool | None, Option("--dark/--light", help="Colors for a dark or a light background.")] = None,
    overwrite: Overwrite = False,
) -> None:
    """Draw the overview of a run, another picture or an animation of it, or the map of a sweep.

    The picture beside STORE is drawn again; one at -o is replaced only with --overwrite.

    nonholo plot runs/sleigh-001.zarr -o sleigh.pdf
    nonholo plot runs/sleigh-001.zarr --gif
    nonholo plot runs/sleigh-001.zarr --kind blade-track --title 'A sleigh' --size 16x9 --dark
    nonholo plot runs/sleigh-001.zarr --kind all
    nonholo plot crossings.zarr --kind section --x body_velocity.0 --y momentum.1
    nonholo plot sweep.zarr --color outcome --x body.a --y run.time_step
    """
    pictures, kind = screen.pictures, kind.replace("_", "-")
    is_sweep = _is_sweep(store)
    if is_sweep and (gif or kind != pictures.OVERVIEW):
        leave("A sweep has one kind of picture, its map. Leave --kind and --gif out.", USAGE)
    if not is_sweep:
        _check_kind(kind, gif, color, x or y)
    path, look = _picture_path(store, output, gif=gif, overwrite=overwrite), _look(title, size, dark)
    if is_sweep:
        paths = pictures.draw_stored_sweep(store, path, color, x, y, dpi=dpi, **look)
    else:
        paths = pictures.draw_stored_run(store, path, look, pictures.FILM if gif else kind, dpi, across=x, up=y)
    echo("\n".join(paths))


def _picture_path(store: Path, output: Path | None, *, gif: bool, overwrite: bool) -> Path:
    """Return the place of a picture: a new path where a picture can be, by default beside the store."""
    from nonholo.plot.parts import check_picture

    if output is None:
        return screen.pictures.beside(store, "gif" if gif else "png")
    with store_errors(USAGE):
        check = io.places.check_file if gif else check_picture  # what a film can be, `animate` says
        check(output, overwrite=overwrite, where="nonholo plot -o")
    return output


def _check_kind(kind: str, gif: bool, color: str | None, axis: str | None) -> None:
    """Refuse options that do not belong to this kind of picture of a run."""
    pictures = screen.pictures
    if kind not in (names := [*pictures.kinds(), pictures.ALL]):
        leave(f"--kind must be one of {', '.join(names)}. Got '{kind}'.", USAGE)
    if color or (axis and kind != "section"):
        leave("--color, --x and --y are for the store of a sweep; --x and --y for --kind section too.", USAGE)
    if gif and kind != pictures.OVERVIEW:
        leave("--gif is a separate kind. Leave --kind out.", USAGE)


def _look(title: str | None, size: str | None, dark: bool | None) -> dict[str, Any]:
    """Return the options of a picture, as the library takes them."""
    look: dict[str, Any] = {"title": title, "dark": dark}
    if size is not None:
        try:
            look["size"] = tuple(map(float, size.lower().split("x")))
        except ValueError:
            look["size"] = ()
        if len(look["size"]) != 2 or not all(1 <= side <= 100 for side in look["size"]):
            leave(f"--size must be width and height in inches, 1 to 100, as 16x9. Got '{size}'.", USAGE)
    return {name: value for name, value in look.items() if value is not None}
