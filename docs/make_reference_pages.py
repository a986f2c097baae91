"""Write docs/reference/command-line.md and scenarios.md, from the commands and models themselves: run this file."""

import json
import re
from pathlib import Path
from typing import Any

import typer

from nonholo.cli._app import app
from nonholo.cli.scenario.bodies import body_table, examples, own_kinds
from nonholo.cli.scenario.files import built_in
from nonholo.cli.scenario.motion import Scenario
from nonholo.cli.scenario.sweeps import DESIGNS, SweepScenario

PAGES = Path(__file__).parent / "reference"
_WORDS = {
    "numbers": "number, or lists of them",
    "group": "group",
    "number": "number",
    "integer": "whole number",
    "boolean": "true or false",
    "string": "text",
    "null": "",
}


def pages() -> dict[str, str]:
    """Return the text of each page, by the name of its file."""
    return {"command-line.md": _command_line(), "scenarios.md": _scenarios()}


def _command_line() -> str:
    whole: Any = typer.main.get_command(app)
    sections = [f"## `nonholo {name}`\n\n{_command(command)}" for name, command in whole.commands.items()]
    return _COMMANDS.format(help=_block(whole.help), sections="\n\n".join(sections))


def _command(command: Any) -> str:
    """Return what a command does, and a table of what it takes."""
    first, _, more = command.help.partition("\n")
    rows = [f"| {_spelling(entry)} | {_cell(entry.help or '')} |" for entry in command.params if entry.name != "help"]
    table = "\n".join(["| takes | |", "|---|---|", *rows]) if rows else ""
    return "\n\n".join(filter(None, [first, _block(more), table]))


def _spelling(entry: Any) -> str:
    if entry.param_type_name == "argument":
        return f"`{(entry.metavar or entry.name.upper()).strip('[]')}`" + ("" if entry.required else ", optional")
    names = [*entry.opts, *entry.secondary_opts]
    return f"`{', '.join(names)}" + (f" {entry.metavar}`" if entry.metavar else "`")


def _block(text: str) -> str:
    plain = text.strip().replace("\\[", "[")  # escaped for rich
    return f"```text\n{plain}\n```" if plain else ""


def _scenarios() -> str:
    """Return the tables of the keys of both kinds of scenario, and the commented scenarios themselves."""
    bodies, ready = "\n\n".join(map(_body, own_kinds())), "\n\n".join(map(_body, examples()))
    own = {**built_in(), **built_in("sweeps")}
    texts = "\n\n".join(f"### `nonholo new {name}`\n\n```toml\n{text.strip()}\n```" for name, text in own.items())
    motion, sweep = (
        _nested(Scenario, ("start", "run", "forces", "output")),
        _nested(SweepScenario, ("design", "keep", "output")),
    )
    return _SCENARIOS.format(bodies=bodies, ready=ready, texts=texts, motion=motion, sweep=sweep)


def _body(kind: str) -> str:
    table = body_table(kind)
    schema = table.model_json_schema()
    del schema["properties"]["kind"]
    return f'### `kind = "{kind}"`\n\n{table.__doc__}\n\n{_table(schema)}'


def _nested(model: Any, tables: tuple[str, ...]) -> str:
    """Return a table for each table of a scenario."""
    schema = model.model_json_schema()
    parts = []
    for name in tables:
        schemas = [schema["$defs"][kind] for kind in _referred(schema["properties"][name])]
        for inner in schemas or [each.model_json_schema() for each in DESIGNS.values()]:
            own = inner["properties"].get("kind", {}).get("const")
            head = (f'`kind = "{own}"` ' if own else "") + inner.get("description", "")
            parts.append(f"**`[{name}]`** {head}\n\n{_table({'$defs': schema['$defs'], **inner})}")
    return "\n\n".join(parts)


def _referred(about: dict[str, Any]) -> list[str]:
    """Return the names of the models that a schema refers to."""
    return re.findall(r"'\$ref': '#/\$defs/(\w+)'", str(about))


def _table(schema: dict[str, Any]) -> str:
    lines = ["| key | takes | by default | meaning |", "|---|---|---|---|"]
    needed = schema.get("required", ())
    for key, about in schema["properties"].items():
        if key == "kind" and "const" in about:
            continue
        chosen = "" if about.get("default") is None else f"`{json.dumps(about['default'])}`"
        default = "needed" if key in needed else chosen
        lines.append(f"| `{key}` | {_cell(_kind(about))} | {default} | {_cell(about.get('description', ''))} |")
    return "\n".join(lines)


def _kind(about: dict[str, Any]) -> str:
    """Return in words what a key takes."""
    if choices := about.get("anyOf") or about.get("oneOf"):
        return " or ".join(filter(None, map(_kind, choices)))
    if "enum" in about or "const" in about:
        return ", ".join(f"`{value}`" for value in about.get("enum", [about.get("const")]))
    if about.get("type") == "array":
        inner = _kind(about["items"])
        return {"number": "list of numbers", "list of numbers": "list of rows"}.get(inner, f"list of {inner}")
    bounds = {"exclusiveMinimum": "&gt;", "minimum": "&ge;"}
    signs = [f" {sign} {about[word]:g}" for word, sign in bounds.items() if word in about]
    return _WORDS.get(about.get("type", ""), "a table") + "".join(signs)


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


_COMMANDS = """\
<!-- written by docs/make_reference_pages.py -->
# The command line

`nonholo COMMAND --help` says the same. Exit codes: 0; 1, a run that ended early or a finding that fails; 2, what was
asked cannot be done.

{help}

{sections}
"""

_SCENARIOS = """\
<!-- written by docs/make_reference_pages.py -->
# The keys of scenarios

A scenario is a TOML file with the tables `[body]`, `[start]`, `[run]`, `[forces]` and `[output]`; sweeps have
`[design]` and `[keep]` too. `nonholo new KIND` prints one with comments, as below. Everything is checked before
anything runs, and all problems are reported at once, with file and key. `--set run.time_step=0.05` changes a value on
the command line.

## One motion

`title`: a text for people.

{motion}

Forces are those of `nh.Forced`, for every kind of body. Components of friction and of a table are those of
`body_velocity`. A table stops acting after its last row, so it has one for each step at least; a first line of its file
may name the columns, in the plane `omega,v1,v2`, in space `omega1` to `v3`, and no other words; stores keep its rows.
Ready: [scenarios/hanging_top.toml](../../scenarios/hanging_top.toml),
[scenarios/twisted_sleigh.toml](../../scenarios/twisted_sleigh.toml).

## Bodies

`[body]` is one of these: a system of the library by the name of its class or a shorter one. Keys are the arguments of
the class, with the meanings that its documentation has.

{bodies}

## Ready examples

Or a system of the literature, of [`nonholo.examples`](../api/examples.md), whose name alone is a scenario:
`nonholo simulate snakeboard`. It has a start, a time step and a number of steps, so `[start]` and `[run]` may be left
out. `nonholo new snakeboard` prints its keys with their meanings, `nonholo examples snakeboard` what is known of it.

{ready}

## Your own bodies

`--module my_robot.py` imports your own Python file, and no other; each public function in it is a kind of body, with
its arguments as keys. It returns a system, or something with a `system`, a `configuration` and a `body_velocity` (as
the examples have, with `time_step` and `steps` if you like), which then needs no `[start]`; sweeps take these.
Commands that run the file are `simulate`, `explore`, `sweep`, `resume`, `extend`, `new` and `systems`.

## Sweeps

What a design varies are keys of `[body]`, starts or one of their components ("start.restricted_velocity_0"),
"run.time_step", and numbers of `[forces]`: "forces.gravity.force", "forces.gravity.force_2", "forces.friction_0",
"forces.slip.grip". Of an example, and of what your own file makes, it varies every argument, or a component of one
("body.planar_velocity_0").

{sweep}

## Commented scenarios

{texts}
"""


if __name__ == "__main__":
    PAGES.mkdir(exist_ok=True)
    for name, text in pages().items():
        (PAGES / name).write_text(text, "utf-8")
