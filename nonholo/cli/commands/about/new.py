"""`nonholo new`: write a commented scenario to start from."""

import difflib
from typing import Annotated

import typer

KINDS = (
    "suslov",
    "sleigh",
    "multidimensional_sleigh",
    "rigid_body",
    "veselova",
    "left_invariant",
    "right_invariant",
    "sweep",
)
_CALLED = {"top": ("suslov", "veselova"), "body": ("rigid_body",), "skate": ("sleigh",)}


def _known(kind: str) -> str:
    """Refuse a kind that there is not, with the nearest ones."""
    if kind in KINDS:
        return kind
    near = (*_CALLED.get(kind.lower(), ()), *difflib.get_close_matches(kind.lower(), KINDS))
    found = f"Did you mean {' or '.join(near)}?" if near else f"Known: {', '.join(KINDS)}."
    raise typer.BadParameter(f"there is no kind {kind!r}. {found}")


def new(
    kind: Annotated[
        str,
        typer.Argument(
            metavar="KIND", help=f"{', '.join(KINDS[:-1])}, see `nonholo systems`; or {KINDS[-1]}.", callback=_known
        ),
    ],
) -> None:
    """Print a commented scenario: every key, with its meaning.

    nonholo new sleigh > my.toml
    nonholo simulate my.toml
    nonholo new sweep > many.toml
    """
    from nonholo.cli.scenario.files import built_in

    typer.echo({**built_in(), **built_in("sweeps")}[kind], nl=False)
