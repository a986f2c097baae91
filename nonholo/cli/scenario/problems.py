"""Problems of a scenario, in words: each one with its file or option and its key path."""

import difflib
import re
import reprlib
from collections.abc import Collection
from typing import Any, NamedTuple, get_args

from pydantic import ValidationError

from nonholo.cli.scenario._groups import NAME, TABLE, GroupTable
from nonholo.cli.scenario.bodies import BODIES
from nonholo.cli.scenario.forces import DIAGONAL, WHOLE
from nonholo.cli.scenario.sections import Section
from nonholo.cli.scenario.sweeps import DESIGNS

_TAGGED: dict[str, dict[str, type[Section]]] = {"body": dict(BODIES), "design": DESIGNS}
"""Tables that are one of several: pydantic puts the one that was meant into the key path."""
_CORE = re.compile(r"`[\w.]+\((\w+)=\.\.\.\)` (.*)", re.DOTALL)
_TEXTS = {
    "missing": "is missing",
    "union_tag_not_found": "needs kind = {kinds}",
    "union_tag_invalid": "must have kind {kinds}",
    "model_type": "must be a table",
    "model_attributes_type": "must be a table",
}


class Problem(NamedTuple):
    """One thing wrong, and where it was said: a file or an option, and a key path."""

    source: str
    key: str
    text: str

    def __str__(self) -> str:
        return ": ".join(part for part in self if part)


class ScenarioError(Exception):
    """A scenario that cannot be run, with everything that is wrong with it."""

    def __init__(self, problems: list[Problem]) -> None:
        super().__init__("\n".join(map(str, problems)))
        self.problems = problems


def problems_of(failure: ValidationError, model: type[Section], source: str, options: dict[str, str]) -> list[Problem]:
    """Return the problems that the validation of a model found; `options`: key paths of the command line."""
    found = [_problem(dict(entry), model) for entry in failure.errors(include_url=False)]
    return [problem(key, text, source, options) for key, text in found]


def problem_of_value(failure: ValueError, section: str, source: str, options: dict[str, str]) -> Problem:
    """Return the problem behind an error of the library about an argument that a section gave."""
    return problem(*_split_core(section, str(failure)), source, options)


def problem(key: str, text: str, source: str, options: dict[str, str]) -> Problem:
    """Return what is wrong at a key path, with the option that gave it, or the file."""
    for path, option in options.items():
        if key == path or key.startswith((f"{path}.", f"{path}[")) or path.startswith(f"{key}."):
            return Problem(option, key, text)
    return Problem(source, key, text)


def suggestion(name: str, known: list[str]) -> str:
    """Return the known name that was probably meant, or all of them."""
    close = difflib.get_close_matches(name, known, n=1)
    return f"Did you mean {close[0]}?" if close else f"Known: {', '.join(known)}."


def _problem(entry: dict[str, Any], model: type[Section]) -> tuple[str, str]:
    kinds = _TAGGED.get(str(entry["loc"][0]), {}) if entry["loc"] else {}
    location = _location(entry["loc"], kinds)
    key = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in location).lstrip(".")
    if entry["type"] == "value_error":
        return _split_core(key, str(entry["ctx"]["error"]))
    if entry["type"] == "extra_forbidden":
        return key, f"is not a known key. {suggestion(str(location[-1]), _known(entry['loc'], model))}"
    text = _text(entry, kinds)
    if entry["type"] in ("missing", "union_tag_not_found"):
        return key, text
    got = entry["ctx"]["tag"] if entry["type"] == "union_tag_invalid" else entry["input"]
    return key, f"{text}. Got {reprlib.repr(got)}"


def _text(entry: dict[str, Any], kinds: Collection[str]) -> str:
    text = _TEXTS.get(entry["type"]) or entry["msg"].replace("Input should", "must", 1)
    return text.format(kinds=" or ".join(f'"{kind}"' for kind in kinds)) if "{kinds}" in text else text


def _location(path: tuple[int | str, ...], kinds: Collection[str]) -> list[int | str]:
    """Return a path of pydantic without what names the kind of a table, as it stands in the file."""
    named = [part for i, part in enumerate(path) if not (i == 1 and part in kinds)]
    return [part for part in named if part not in (NAME, TABLE, DIAGONAL, WHOLE)]


def _known(location: tuple[int | str, ...], model: type[Section]) -> list[str]:
    """Return the keys of the table in which one is not known."""
    if TABLE in location:
        return list(GroupTable.model_fields)
    table: Any = model
    for name in location[:-1]:
        held = _TAGGED.get(str(location[0]), {}).get(str(name)) or table.model_fields[str(name)].annotation
        table = (*get_args(held), held)[0]  # of one that may be left out, too
    return list(table.model_fields)


def _split_core(section: str, message: str) -> tuple[str, str]:
    named = _CORE.fullmatch(message)
    return (f"{section}.{named[1]}", named[2]) if named else (section, message)
