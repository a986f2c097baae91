"""`nonholo new`: write a commented scenario to start from."""

from typing import Annotated, Literal

import typer


def new(kind: Annotated[Literal["sleigh", "suslov"], typer.Argument(metavar="KIND", help="sleigh or suslov.")]) -> None:
    """Print a commented scenario: every key, with its meaning.

    nonholo new sleigh > my.toml
    nonholo simulate my.toml
    """
    from nonholo.cli._scenario_file import built_in

    typer.echo(built_in()[kind], nl=False)
