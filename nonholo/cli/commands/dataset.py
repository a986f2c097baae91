"""`nonholo dataset`: orbits of a ready or a custom system, for people who train models."""

import sys
from pathlib import Path
from typing import Annotated, Any

from typer import Argument, Option, echo

import nonholo
from nonholo.cli import scenario, screen
from nonholo.cli.commands.run import Module, Quiet
from nonholo.cli.screen.errors import FAILED, USAGE, leave, reporting_warnings, scenario_errors, store_errors


def dataset(
    name: Annotated[str | None, Argument(metavar="NAME", help="One of those that --list shows.")] = None,
    output: Annotated[Path | None, Option("-o", "--output", metavar="FOLDER", help="A new folder.")] = None,
    orbits: Annotated[int, Option(metavar="N", min=1, help="How many orbits.")] = 1000,
    steps: Annotated[int, Option(metavar="N", min=1, help="Steps of each; there is one state more.")] = 500,
    time_step: Annotated[float | None, Option(metavar="H", help="Time between states.")] = None,
    rng: Annotated[int, Option(metavar="N", min=0, help="The same integer gives the same numbers.")] = 0,
    noise: Annotated[float, Option(metavar="SIGMA", help="Also write fields `observed_...` with noise.")] = 0.0,
    split: Annotated[str, Option(metavar="A/B/C", help="For training, validation, test.")] = "0.8/0.1/0.1",
    file_format: Annotated[str, Option("--format", metavar="HOW", help="zarr, or csv: tables.")] = "zarr",
    license_name: Annotated[str, Option("--license", metavar="NAME", help="The license in the data card.")] = "CC0-1.0",
    shown: Annotated[bool, Option("--list", help="List the data sets.")] = False,
    module: Module = None,
    quiet: Quiet = False,
) -> None:
    """Write orbits of a ready system or your own with labels, a split and a data card, for people who train models.

    The folder gets orbits.zarr (or train.csv, validation.csv, test.csv),
    metadata.json with hashes and versions, and README.md, a data card.
    Fields: poses or coordinates, velocities, momenta, multipliers, energy;
    row k is a state, row k + 1 the next one. Orbit i does not depend on
    how many there are. Stopped? The same command resumes it.

    With --module a name may be that of a function in your own file, whose
    random arguments have distributions as defaults: speed=nh.Uniform(1, 2).

    nonholo dataset --list
    nonholo dataset sleigh -o sleighs
    nonholo dataset snakeboard -o boards --orbits 200 --noise 0.01
    nonholo dataset top -o tops --rng 7 --format csv
    nonholo dataset robot -o robots --module my_robot.py
    """
    if shown:
        from nonholo.ensembles import DEFINITIONS

        random = {k: ", ".join(each.distributions).replace("start_", "") for k, each in DEFINITIONS.items()}
        rows = ((k, each.title, random[k], str(each.version)) for k, each in DEFINITIONS.items())
        screen.tables.show_table(("name", "system", "random", "version"), rows, "Data sets")
        return
    if name is None or output is None:
        leave("Pass a name and -o FOLDER; `nonholo dataset --list` lists the names.", USAGE)
    options: dict[str, Any] = {"orbits": orbits, "steps": steps, "time_step": time_step, "rng": rng, "noise": noise}
    options |= {"file_format": file_format, "license_name": license_name, "progress": sys.stderr.isatty() and not quiet}
    with scenario_errors(), store_errors(USAGE), reporting_warnings():
        own = scenario.files.take_module(module)
        try:
            folder = nonholo.dataset(own.get(name, name), output, split=_fractions(split), **options)
        except KeyboardInterrupt:
            leave("Stopped; the same command resumes it.", FAILED)
    echo(folder if quiet else f"{folder / 'README.md'} describes the files.")


def _fractions(split: str) -> list[float]:
    try:
        return [float(part) for part in split.split("/")]
    except ValueError:
        raise ValueError(f"`--split` must be three numbers such as 0.8/0.1/0.1. Got {split!r}. Mend it.") from None
