"""`nonholo new`: write a commented scenario to start from."""

from typing import Annotated, Literal

import typer

Kind = Literal[
    "suslov", "sleigh", "multidimensional_sleigh", "rigid_body", "veselova", "left_invariant", "right_invariant"
]
Template = Literal[Kind, "sweep"]


def new(
    kind: Annotated[Template, typer.Argument(metavar="KIND", help="A kind of body, see `nonholo systems`; or sweep.")],
) -> None:
    """Print a commented scenario: every key, with its meaning.

    nonholo new sleigh > my.toml
    nonholo simulate my.toml
    nonholo new sweep > many.toml
    """
    from nonholo.cli._scenario_file import built_in

    typer.echo({**built_in(), **built_in("sweeps")}[kind], nl=False)
