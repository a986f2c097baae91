r"""Docstrings for Sphinx: plain text in which `code` and $formulas$ are marked, and nothing else is.

What reStructuredText would take for markup beyond that, as the bars of |c|^2 or the star of Ad*, is escaped. Doctests
stay as they are.
"""

import re
from typing import Any

MARKED = re.compile(r"(\$\$.+?\$\$|\$.+?\$|`[^`]+`)", re.DOTALL)
SPECIAL = re.compile(r"[\\*|]|_(?!\w)|\b(?:\w|\d+)[.)](?=\s)")  # the last ones would number a list
DOCTEST = re.compile(r"^ *>>> .*\n(?: *\S.*\n)*", re.MULTILINE)


def restructured(text: str) -> str:
    """Return a docstring as reStructuredText; sections are left to napoleon."""
    result, end = [], 0
    for example in DOCTEST.finditer(text):
        result += [_translated(text[end : example.start()]), example.group()]
        end = example.end()
    return "".join([*result, _translated(text[end:])])


def _translated(text: str) -> str:
    pieces = MARKED.split(text)
    plain = [SPECIAL.sub(r"\\\g<0>", piece) for piece in pieces[::2]]
    result = plain[0]
    for marked, before, after in zip(pieces[1::2], pieces[:-1:2], plain[1:], strict=True):
        if marked.startswith("$$"):
            margin = before[len(before.rstrip(" ")) :]
            result += f"\n\n{margin}.. math::\n\n{margin}   {' '.join(marked[2:-2].split())}\n\n{margin}{after}"
        else:
            inline = f":math:`{marked[1:-1]}`" if marked.startswith("$") else marked
            result += _apart(before[-1:], inline, after[:1]) + after
    return result


def _apart(before: str, inline: str, after: str) -> str:
    """Return inline markup with the invisible blanks that it needs beside letters."""
    return ("\\ " if re.match(r"[^\s(\[{<\"'/:-]", before) else "") + inline + ("\\ " if after.isalnum() else "")


def _process(_app: Any, kind: str, _name: str, _value: Any, _options: Any, lines: list[str]) -> None:
    text = restructured("\n".join([*lines, ""]))
    if kind in {"attribute", "data", "property"}:
        text = "..\n\n" + text  # an empty comment, or napoleon takes "A: b" for a type and its meaning
    lines[:] = text.splitlines()


def setup(app: Any) -> dict[str, bool]:
    """Connect, before napoleon."""
    app.connect("autodoc-process-docstring", _process, priority=400)
    return {"parallel_read_safe": True}
