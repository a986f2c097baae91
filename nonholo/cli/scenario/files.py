"""Reading a scenario: a file, a built-in name or an example, changed by options, checked as a whole; and writing it.

Commented scenarios of bodies without a file are made from signatures and docstrings.
"""

import contextlib
import inspect
import json
import operator
import re
import textwrap
import tomllib
from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

from pydantic import ValidationError

from nonholo.base.limits import read_text
from nonholo.cli.scenario.bodies import body_table, import_own, is_example, kinds, nearest_kind, summary
from nonholo.cli.scenario.motion import Output, Run, Scenario, Start, complete_ready, moving, read_table
from nonholo.cli.scenario.sections import Origin, Problem, ScenarioError, Section, split_core, suggestion
from nonholo.groups import components_of

Model = TypeVar("Model", bound=Section)
Document = dict[str, Any]
_WIDTH = 110  # of a commented scenario
_DEEPEST = 32  # arrays and tables in each other


class Setting(NamedTuple):
    """A value given on the command line: the option as it is shown, the key path, the value."""

    option: str
    key: str
    value: Any


class Loaded(NamedTuple, Generic[Model]):
    """A checked scenario, its short name, where it came from, whose bodies."""

    scenario: Model
    name: str
    origin: Origin
    module: Path | None = None

    @contextlib.contextmanager
    def reporting(self, section: str = "run") -> Iterator[None]:
        """Report an error of the library where the scenario has its argument, by default in a section."""
        try:
            yield
        except ValueError as failure:
            key, text = split_core(section, str(failure))
            _, _, name = key.partition(".")
            own = [each for each, model in (("run", Run), ("start", Start)) if name in model.model_fields]
            key = f"{own[0]}.{name}" if own else key
            raise self.origin.error((key, text)) from None


def parse_toml(text: str) -> Document:
    """Return the document of a text.

    Raises:
        ValueError: It is not valid TOML, has an integer of thousands of digits, or arrays within arrays without end.

    Example:
        >>> parse_toml("a = 1")
        {'a': 1}
    """
    try:
        document = tomllib.loads(text)
    except RecursionError:
        document = None
    if document is None or _depth(document) > _DEEPEST:
        raise ValueError(f"arrays or tables are nested deeper than {_DEEPEST}")
    return document


def _depth(document: Document) -> int:
    """Return how deep arrays and tables are nested, without recursion."""
    depth, level = 0, [document]
    while level:
        entries = [entry for each in level for entry in (each.values() if isinstance(each, dict) else each)]
        depth, level = depth + 1, [entry for entry in entries if isinstance(entry, dict | list)]
    return depth


def load_scenario(name: str, settings: list[Setting], module: Path | None = None) -> Loaded[Scenario]:
    """Return the scenario of a file, a built-in name or an example with settings, or raise with all its problems."""
    take_module(module)
    origin, document = read_document(name, built_in(), settings)
    if "design" in document:
        raise origin.error(("design", f"is for sweeps: nonholo sweep {name}"))
    complete(document, name, origin)
    return validate(document, Scenario, Path(name).stem, origin)._replace(module=module)


def take_module(module: Path | None) -> dict[str, Any]:
    """Run the user's module of `--module`, and no other: it makes kinds of bodies."""
    try:
        return import_own(module)
    except (Exception, SystemExit) as failure:
        kind = "" if isinstance(failure, ValueError) else f"{type(failure).__name__}: "
        raise ScenarioError([Problem(f"--module {module}", "", f"cannot be used. {kind}{failure}")]) from failure


def by_table(document: Document) -> None:
    """Put values under quoted key paths, "body.a" = ..., where unquoted ones stand: in tables."""
    values = table_in(table_in(document, "design"), "values")
    for path in [path for path in values if "." in path]:
        table, _, name = path.partition(".")
        if isinstance(own := values.setdefault(table, {}), dict):
            own.setdefault(name, values.pop(path))


def table_in(document: Document, name: str) -> Document:
    """Return a table of a document; an empty one where there is none, or a value, which is refused later."""
    inner = document.get(name)
    return inner if isinstance(inner, dict) else {}


def stored_scenario(attributes: dict[str, Any], module: Path | None, model: type[Model]) -> Model:
    """Return the scenario that a store keeps, of bodies of a module."""
    take_module(module)
    if "scenario" not in attributes:
        raise ScenarioError([Problem(f"--module {module}", "", "is for stores that were made from a scenario")])
    document = parse_toml(attributes["scenario"])
    by_table(document)
    return validate(document, model, "", Origin("the scenario of the store", {})).scenario


def complete(document: Document, name: str, origin: Origin, *, start: bool = True) -> None:
    """Take from an example what a document leaves out, and read the table of forces that it names.

    The table is in the folder of the scenario or, where an option names it, here.
    """
    try:
        complete_ready(document, start=start)
    except ValidationError as failure:
        raise origin.error_of(failure, ("body",)) from None
    folder = Path() if {"forces", "forces.table"} & origin.options.keys() else Path(name).parent
    try:
        read_table(document, folder, _directions(document))
    except ValueError as failure:
        raise origin.error(("forces.table", str(failure))) from None


def _directions(document: Document) -> tuple[str, ...] | None:
    """Return the names of the directions of the body of a document; None if it is no body, which is reported later."""
    try:
        body = document["body"]
        return components_of(moving(body_table(body["kind"]).model_validate(body).creation).group)
    except (AttributeError, KeyError, TypeError, ValueError):
        return None


def read_document(name: str, own: dict[str, str], settings: list[Setting]) -> tuple[Origin, Document]:
    """Return where the scenario of a file or a built-in name under settings comes from, and what both say."""
    source, text = _text_of(name, own)
    try:
        document = parse_toml(text)
    except ValueError as failure:
        raise ScenarioError([Problem(source, "", f"is not valid TOML: {failure}")]) from None
    by_table(document)
    for setting in settings:
        assign(document, setting)
    return Origin(source, {setting.key: setting.option for setting in settings}), document


def validate(document: Document, model: type[Model], name: str, origin: Origin) -> Loaded[Model]:
    """Return a scenario of that model, or raise with all its problems."""
    try:
        return Loaded(model.model_validate(document), name, origin)
    except ValidationError as failure:
        raise origin.error_of(failure) from None


def given_settings(options: dict[str, Any], texts: list[str]) -> list[Setting]:
    """Return the settings of a command line: its options by key path, those that are given, then those of `--set`.

    An option is called as the last part of its key path.
    """
    names = {key: key.rpartition(".")[2].replace("_", "-") for key in options}
    own = [Setting(f"--{names[key]} {value}", key, value) for key, value in options.items() if value is not None]
    return own + [parse_setting(text) for text in texts]


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
        document = parse_toml(f"value = {value}")
    except ValueError:
        document = {}
    if set(document) != {"value"}:
        remedy = f"a number, true, [1, 2] or a quoted string: --set '{key}=\"{value}\"'"
        raise ScenarioError([Problem(option, "", f"must have a TOML value: {remedy}")])
    return Setting(option, key, document["value"])


def built_in(kind: str = "") -> dict[str, str]:
    """Return the texts of the scenarios that come with the package, by name; of one motion, or in "sweeps"."""
    folder = resources.files("nonholo.cli") / "scenarios" / kind
    files = sorted((f for f in folder.iterdir() if f.name.endswith(".toml")), key=lambda f: f.name)
    return {file.name.removesuffix(".toml"): file.read_text("utf-8") for file in files}


def built_in_titles() -> dict[str, str]:
    """Return the titles of the scenarios of one motion that come with the package, by name."""
    return {name: parse_toml(text)["title"] for name, text in built_in().items()}


def effective_text(scenario: Section) -> str:
    """Return a scenario as TOML with every value that was in force; running it again repeats the run, or the sweep."""
    document = scenario.model_dump(exclude_none=True, serialize_as_any=True)
    title, design = document.pop("title"), document.pop("design", {})
    values = {f"{table}.{name}": x for table, own in design.pop("values", {}).items() for name, x in own.items()}
    return toml_text(title, {**document, "design": design, "design.values": values})


def toml_text(title: str, tables: dict[str, dict[str, Any]]) -> str:
    """Return a title and tables as TOML, without those that are empty."""
    lines = [f"title = {json.dumps(title, ensure_ascii=False)}"]
    for name, table in filter(operator.itemgetter(1), tables.items()):
        lines += ["", f"[{name}]", *(f"{_key(key)} = {as_toml(value)}" for key, value in table.items())]
    return "\n".join(lines) + "\n"


def _key(name: str) -> str:
    return name if re.fullmatch(r"[\w-]+", name, re.ASCII) else json.dumps(name)


def as_toml(value: Any) -> str:
    """Return a value as TOML."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(key)} = {as_toml(entry)}" for key, entry in value.items()) + "}"
    return json.dumps(value)


def _text_of(name: str, own: dict[str, str]) -> tuple[str, str]:
    if name in own:
        return f"{name} (built in)", own[name]
    try:
        return name, read_text(Path(name))
    except FileNotFoundError:
        may_be_kind = own == built_in() and name.isidentifier()
        if may_be_kind and is_example(name) and name in kinds():
            return f"{name} (example)", toml_text(summary(body_table(name).make), {"body": {"kind": name}})
        text = f"there is no such file, and no built-in scenario of this name. {_remedy(name, own, may_be_kind)}"
    except (OSError, UnicodeDecodeError) as failure:
        text = f"cannot be read as a text file: {failure}"
    raise ScenarioError([Problem(name, "", text)])


def _remedy(name: str, own: dict[str, str], may_be_kind: bool) -> str:
    """Return the advice for a scenario that is not there."""
    if not is_example(name):  # a class of systems
        return f"`nonholo new {name}` writes one."
    return nearest_kind(name) if may_be_kind else suggestion(name, own)


def assign(document: Document, setting: Setting) -> None:
    """Put a value of the command line into a document."""
    *tables, last = setting.key.split(".")
    for table in tables:
        if not isinstance(document := document.setdefault(table, {}), dict):
            raise ScenarioError([Problem(setting.option, setting.key, f"{table} is a value, not a table")])
    document[last] = setting.value


def template(kind: str) -> str:
    """Return a scenario of a kind of body: every key with its default and its meaning.

    Raises:
        KeyError: There is no such kind.

    Example:
        >>> template("ArrowheadTop").splitlines()[2:6]
        ['title = "ArrowheadTop"', '', '[body]', 'kind = "ArrowheadTop"']
    """
    table = body_table(kind)
    whole: dict[str, Any] = {"body": {"kind": kind}}
    with contextlib.suppress(ValueError):  # it needs values, or cannot be made: running the template says why
        complete_ready(whole)
    starts = whole.get("start", {})
    parts = [
        _comment((inspect.getdoc(table.make) or "").split("\n\n")[0]),
        f"title = {json.dumps(kind)}",
        _section("body", table, {"kind": kind}),
        _section("start", Start, starts, as_comments=bool(starts)),
        _section("run", Run, whole.get("run", {})),
        _section("output", Output, {}),
    ]
    return "\n\n".join(filter(None, parts)) + "\n"


def _section(name: str, table: type[Section], values: dict[str, Any], *, as_comments: bool = False) -> str:
    """Return a table: keys with a value, its own or by default, then as comments those without; or all as comments."""
    lines = [f"# [{name}]  # the start of the example, unless this one is given" if as_comments else f"[{name}]"]
    for key, field in table.model_fields.items():
        value = values.get(key, None if field.is_required() else field.default)
        line = f"# {key} = ..." if value is None else f"{'# ' if as_comments else ''}{key} = {as_toml(value)}"
        prefix = "needed: " if value is None and field.is_required() else ""
        lines.append(_entry(line, prefix + (field.description or "")))
    return "\n".join(lines)


def _entry(line: str, meaning: str) -> str:
    """Return a line with its meaning behind it or, where that is long, above it."""
    if not meaning:
        return line
    whole = f"{line}  # {meaning}"
    return whole if len(whole) <= _WIDTH else f"{_comment(meaning)}\n{line}"


def _comment(text: str) -> str:
    return textwrap.fill(" ".join(text.split()), _WIDTH, initial_indent="# ", subsequent_indent="# ")
