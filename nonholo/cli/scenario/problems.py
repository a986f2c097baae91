"""Problems of a scenario, in words: each one with its file or option and its key path."""

import re
import reprlib
from typing import Any, NamedTuple

from pydantic import ValidationError

from nonholo.cli.scenario.sections import UNKNOWN

_CORE = re.compile(r"`[\w.]+\((\w+)=\.\.\.\)` (.*)", re.DOTALL)
_TEXTS = {"missing": "is missing", "model_type": "must be a table", "model_attributes_type": "must be a table"}
Key = tuple[int | str, ...]


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


def problems_of(failure: ValidationError, source: str, options: dict[str, str], table: Key = ()) -> list[Problem]:
    """Return the problems of a validation, all within a table; `options`: key paths of the command line."""
    entries = [_problem(dict(entry), table) for entry in failure.errors(include_url=False)]
    return [problem(key, text, source, options) for key, text in entries]


def problem(key: str, text: str, source: str, options: dict[str, str]) -> Problem:
    """Return what is wrong at a key path, with the option that gave it, or the file."""
    for path, option in options.items():
        if key == path or key.startswith((f"{path}.", f"{path}[")) or path.startswith(f"{key}."):
            return Problem(option, key, text)
    return Problem(source, key, text)


def _problem(entry: dict[str, Any], table: Key) -> tuple[str, str]:
    key = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in (*table, *entry["loc"])).lstrip(".")
    if entry["type"] == "value_error":
        return split_core(key, str(entry["ctx"]["error"]))
    if entry["type"] == UNKNOWN:
        return key, entry["msg"]
    text = _TEXTS.get(entry["type"]) or entry["msg"].replace("Input should", "must", 1)
    return key, text if entry["type"] == "missing" else f"{text}. Got {reprlib.repr(entry['input'])}"


def split_core(section: str, message: str) -> tuple[str, str]:
    """Return the key path of the argument that an error of the library names, and what it says; else the section."""
    match = _CORE.fullmatch(message)
    return (f"{section}.{match[1]}", match[2]) if match else (section, message)
