"""Tables on the screen: of names and what they are, of findings, of data sets."""

from collections.abc import Iterable

from rich.console import Console
from rich.table import Column, Table


def show_table(columns: Iterable[str], rows: Iterable[Iterable[str]], title: str | None = None) -> None:
    """Print a table; its first column is never broken."""
    first, *others = columns
    table = Table(Column(first, no_wrap=True), *others, title=title, title_justify="left")
    for row in rows:
        table.add_row(*row)
    Console().print(table)
