"""`nonholo cite`: how to cite the library and the paper that its discrete maps come from."""

from pathlib import Path
from typing import Annotated, Any

import typer


def cite(
    cff: Annotated[
        bool, typer.Option("--cff", help="Print CITATION.cff, for repositories and reference managers.")
    ] = False,
) -> None:
    """Print BibTeX entries of this version of the library and of the paper behind it.

    Please cite both: the discrete maps of tops and sleighs are the paper's.

    nonholo cite >> references.bib
    nonholo cite --cff
    """
    import yaml

    text = _citation().read_text("utf-8")
    if cff:
        typer.echo(text, nl=False)
        return
    about = yaml.safe_load(text)
    typer.echo("\n\n".join([_entry("nonholo", about), *(_entry(_key(each), each) for each in about["references"])]))


def _citation() -> Path:
    """Return the file: in an installed package beside the room, in a checkout at its root."""
    room = Path(__file__).parents[2]
    return next(path for path in (room / "CITATION.cff", room.parents[1] / "CITATION.cff") if path.exists())


def _key(about: dict[str, Any]) -> str:
    names = (author["family-names"].lower() for author in about["authors"])
    return "-".join([*names, str(about["year"])])


def _entry(key: str, about: dict[str, Any]) -> str:
    """Return a BibTeX entry of a work as CITATION.cff describes it; braces keep capitals and the names of groups."""
    fields = {
        "author": " and ".join(_author(each) for each in about["authors"]),
        "title": f"{{{about['title']}}}",
        "journal": about.get("journal"),
        "volume": about.get("volume"),
        "number": about.get("issue"),
        "pages": f"{about['start']}--{about['end']}" if "start" in about else None,
        "version": about.get("version"),
        "year": about.get("year") or about["date-released"].year,
        "doi": about.get("doi"),
    }
    lines = [f"  {name} = {{{value}}}," for name, value in fields.items() if value is not None]
    return "\n".join([f"@{about['type']}{{{key},", *lines, "}"])


def _author(about: dict[str, str]) -> str:
    return f"{about['family-names']}, {about['given-names']}" if "family-names" in about else f"{{{about['name']}}}"
