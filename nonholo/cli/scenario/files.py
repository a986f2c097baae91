"""Reading a scenario: a file or a built-in name, changed by options, checked as a whole."""

import json
import operator
import re
from importlib import resources
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

from pydantic import ValidationError

from nonholo.base.limits import read_text
from nonholo.cli.scenario.forces import read_table
from nonholo.cli.scenario.motion import Scenario
from nonholo.cli.scenario.problems import Problem, ScenarioError, problem, problems_of, suggestion
from nonholo.cli.scenario.sections import Section
from nonholo.cli.scenario.toml import parsed

Model = TypeVar("Model", bound=Section)


class Setting(NamedTuple):
    """A value given on the command line: the option as it is shown, the key path, the value."""

    option: str
    key: str
    value: Any


class Loaded(NamedTuple, Generic[Model]):
    """A checked scenario, its short name, where it came from, and which key paths the command line set."""

    scenario: Model
    name: str
    source: str
    options: dict[str, str]


def load_scenario(name: str, settings: list[Setting]) -> Loaded[Scenario]:
    """Return the scenario of a file or a built-in name with settings applied, or raise with all its problems."""
    source, document = read_document(name, built_in())
    if "design" in document:
        raise ScenarioError([Problem(source, "design", f"is for sweeps: nonholo sweep {name}")])
    for setting in settings:
        assign(document, setting)
    take_table(document, name, source, settings)
    return checked(document, Scenario, Path(name).stem, source, settings)


def take_table(document: dict[str, Any], name: str, source: str, settings: list[Setting]) -> None:
    """Read the table of forces that a document names, from its own folder or, where an option does, from here."""
    options = {setting.key: setting.option for setting in settings}
    try:
        read_table(document, Path() if {"forces", "forces.table"} & options.keys() else Path(name).parent)
    except ValueError as failure:
        raise ScenarioError([problem("forces.table", str(failure), source, options)]) from None


def read_document(name: str, own: dict[str, str]) -> tuple[str, dict[str, Any]]:
    """Return how the scenario of a file or a built-in name is called in messages, and what it says."""
    source, text = _text_of(name, own)
    try:
        return source, parsed(text)
    except ValueError as failure:
        raise ScenarioError([Problem(source, "", f"is not valid TOML: {failure}")]) from None


def checked(
    document: dict[str, Any], model: type[Model], name: str, source: str, settings: list[Setting]
) -> Loaded[Model]:
    """Return a scenario of that model, or raise with all its problems."""
    options = {setting.key: setting.option for setting in settings}
    try:
        return Loaded(model.model_validate(document), name, source, options)
    except ValidationError as failure:
        raise ScenarioError(problems_of(failure, model, source, options)) from None


def given_settings(chosen: dict[str, tuple[str, Any]], texts: list[str]) -> list[Setting]:
    """Return the settings of a command line: its options by key path, those that are given, then those of `--set`."""
    given = [Setting(f"{option} {value}", key, value) for key, (option, value) in chosen.items() if value is not None]
    return given + [parse_setting(text) for text in texts]


def parse_setting(text: str) -> Setting:
    """Read KEY=VALUE with a dotted key and a TOML value.

    Example:
        >>> parse_setting("body.a=0.3").value
        0.3
    """
    option = f"--set {text}"
    key, equals, value = text.partition("=")
    key = key.strip()
    if not equals or not all(key.split(".")):
        raise ScenarioError([Problem(option, "", "must be KEY=VALUE, for example --set body.a=0.3")])
    try:
        found = parsed(f"value = {value}")
    except ValueError:
        found = {}
    if set(found) != {"value"}:
        remedy = f"a number, true, [1, 2] or a quoted string: --set '{key}=\"{value}\"'"
        raise ScenarioError([Problem(option, "", f"must have a TOML value: {remedy}")])
    return Setting(option, key, found["value"])


def built_in(kind: str = "") -> dict[str, str]:
    """Return the texts of the scenarios that come with the package, by name; of one motion, or in "sweeps"."""
    folder = resources.files("nonholo.cli") / "scenarios" / kind
    files = sorted((f for f in folder.iterdir() if f.name.endswith(".toml")), key=lambda f: f.name)
    return {file.name.removesuffix(".toml"): file.read_text("utf-8") for file in files}


def effective_text(scenario: Scenario) -> str:
    """Return a scenario as TOML with every value that was in force; running it again repeats the run."""
    document = scenario.model_dump(exclude_none=True)
    tables = {name: value for name, value in document.items() if isinstance(value, dict)}
    return toml_text(document["title"], tables)


def toml_text(title: str, tables: dict[str, dict[str, Any]]) -> str:
    """Return a title and tables as TOML, without those that are empty."""
    lines = [f"title = {json.dumps(title, ensure_ascii=False)}"]
    for name, table in filter(operator.itemgetter(1), tables.items()):
        lines += ["", f"[{name}]", *(f"{_key(key)} = {_as_toml(value)}" for key, value in table.items())]
    return "\n".join(lines) + "\n"


def _key(name: str) -> str:
    return name if re.fullmatch(r"[\w-]+", name, re.ASCII) else json.dumps(name)


def _as_toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(key)} = {_as_toml(entry)}" for key, entry in value.items()) + "}"
    return json.dumps(value)


def _text_of(name: str, own: dict[str, str]) -> tuple[str, str]:
    if name in own:
        return f"{name} (built in)", own[name]
    try:
        return name, read_text(Path(name))
    except FileNotFoundError:
        text = f"there is no such file, and no built-in scenario of this name. {suggestion(name, list(own))}"
    except (OSError, UnicodeDecodeError) as failure:
        text = f"cannot be read as a text file: {failure}"
    raise ScenarioError([Problem(name, "", text)])


def assign(document: dict[str, Any], setting: Setting) -> None:
    """Put a value of the command line into a document."""
    *tables, last = setting.key.split(".")
    for table in tables:
        document = document.setdefault(table, {})
        if not isinstance(document, dict):
            raise ScenarioError([Problem(setting.option, setting.key, f"{table} is a value, not a table")])
    document[last] = setting.value
