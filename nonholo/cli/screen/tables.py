"""Tables on the screen: of names and what they are, of findings, of data sets. Brackets in texts are only brackets."""

from collections.abc import Iterable
from typing import Any

from rich.console import Console
from rich.table import Column, Table


def show_table(columns: Iterable[str], rows: Iterable[Iterable[str]], title: str | None = None) -> None:
    """Print a table; its first column is never broken."""
    first, *others = columns
    plain_console().print(table((Column(first, no_wrap=True), *others), rows, title=title, title_justify="left"))


def table(columns: Iterable[Column | str], rows: Iterable[Iterable[str]], **look: Any) -> Table:
    """Return a table of texts."""
    result = Table(*columns, **look)
    for row in rows:
        result.add_row(*row)
    return result


def plain_console() -> Console:
    """Return a console that prints texts as they are."""
    return Console(highlight=False, markup=False)
