"""`nonholo explore`: the live page of a scenario or of a run that was kept."""

from pathlib import Path
from typing import Annotated

import typer

from nonholo.cli.commands.simulate import Module, Overwrite, Settings, Steps, TimeStep

Source = Annotated[
    str, typer.Argument(metavar="[SCENARIO | STORE]", help="What `nonholo simulate` takes, or a store that it made.")
]
Output = Annotated[Path | None, typer.Option("-o", "--output", metavar="FILE", help="Where to write the page.")]
Browser = Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")]


def explore(
    source: Source = "sleigh",
    output: Output = None,
    steps: Steps = None,
    time_step: TimeStep = None,
    settings: Settings = None,
    module: Module = None,
    browser: Browser = True,
    overwrite: Overwrite = False,
) -> None:
    """Write the live page of a motion, one file, and open it in the browser.

    Tops with n = 3 or 4 and sleighs in the plane run in the page itself, with the
    same numbers; others are replayed. Without -o the page is a temporary file.

    nonholo explore suslov
    nonholo explore snakeboard
    nonholo explore my.toml -o top.html --no-browser
    nonholo explore runs/sleigh-001.zarr
    """
    from nonholo.cli.commands._runs import write_page

    options = {"run.steps": ("--steps", steps), "run.time_step": ("--time-step", time_step)}
    how = {"module": module, "browser": browser, "overwrite": overwrite}
    typer.echo(write_page(source, options, settings or [], output, **how))
