"""Commented scenarios of bodies without a file, from signatures and docstrings."""

import contextlib
import inspect
import json
import textwrap
from typing import Any

import numpy as np

from nonholo.cli.scenario.bodies import body_table
from nonholo.cli.scenario.files import as_toml
from nonholo.cli.scenario.motion import Output, Run, Start, is_ready
from nonholo.cli.scenario.sections import Section

_WIDTH = 110


def template(kind: str) -> str:
    """Return a scenario of a kind of body: every key with its default and its meaning.

    Raises:
        KeyError: There is no such kind.

    Example:
        >>> template("ArrowheadTop").splitlines()[2:6]
        ['title = "ArrowheadTop"', '', '[body]', 'kind = "ArrowheadTop"']
    """
    table = body_table(kind)
    about = inspect.getdoc(table.make) or ""
    heading = _comment(about.split("\n\n")[0])
    is_whole = not any(field.is_required() for name, field in table.model_fields.items() if name != "kind")
    example = None
    if is_whole:
        with contextlib.suppress(ValueError):  # running the template says why
            example = table.model_validate({"kind": kind}).creation
    own = ("configuration", "body_velocity") if is_ready(example) else ()
    starts = {name: np.asarray(getattr(example, name)).tolist() for name in own}
    run = {name: getattr(example, name) for name in ("time_step", "steps") if hasattr(example, name)}
    parts = [
        heading,
        f"title = {json.dumps(kind)}",
        _section("body", table, {"kind": kind}),
        _section("start", Start, starts, as_comments=bool(starts)),
        _section("run", Run, run),
        _section("output", Output, {}),
    ]
    return "\n\n".join(parts) + "\n"


def _section(name: str, table: type[Section], values: dict[str, Any], *, as_comments: bool = False) -> str:
    """Return a table: keys with a value, its own or by default, then as comments those without; or all as comments."""
    lines = [f"# [{name}]  # the start of the example, unless this one is given" if as_comments else f"[{name}]"]
    for key, field in table.model_fields.items():
        value = values.get(key, None if field.is_required() else field.default)
        meaning = field.description or ""
        if value is None:
            lines.append(_entry(f"# {key} = ...", f"needed: {meaning}" if field.is_required() else meaning))
        else:
            lines.append(_entry(f"{'# ' if as_comments else ''}{key} = {as_toml(value)}", meaning))
    return "\n".join(lines)


def _entry(line: str, meaning: str) -> str:
    """Return a line with its meaning behind it or, where that is long, above it."""
    if not meaning:
        return line
    whole = f"{line}  # {meaning}"
    return whole if len(whole) <= _WIDTH else f"{_comment(meaning)}\n{line}"


def _comment(text: str) -> str:
    return textwrap.fill(" ".join(text.split()), _WIDTH, initial_indent="# ", subsequent_indent="# ")
