"""Values as notebooks show them: a title and rows of words, all of them escaped."""

import html
from collections.abc import Iterable, Sequence
from typing import Any


def table(title: str, rows: Iterable[Sequence[Any]], head: Sequence[Any] = ()) -> str:
    """Return a table; words of several lines keep them.

    Example:
        >>> table("<Top>", [("time", 0.5)])
        '<table><caption><b>&lt;Top&gt;</b></caption><tr><td>time</td><td>0.5</td></tr></table>'
    """
    lines = [_row("th", head)] if head else []
    lines += [_row("td", row) for row in rows]
    return f"<table><caption><b>{_cell(title)}</b></caption>{''.join(lines)}</table>"


def _row(cell: str, words: Sequence[Any]) -> str:
    return f"<tr>{''.join(f'<{cell}>{_cell(word)}</{cell}>' for word in words)}</tr>"


def _cell(word: Any) -> str:
    text = html.escape(str(word))
    return f'<pre style="text-align:left;margin:0">{text}</pre>' if "\n" in text else text
