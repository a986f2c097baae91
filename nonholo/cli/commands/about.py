"""`nonholo cite`, `examples`, `new` and `systems`: what there is, and how to cite it; they run nothing."""

from pathlib import Path
from typing import Annotated, Any

from typer import Argument, BadParameter, Option, echo

import nonholo
from nonholo.cli import scenario, screen
from nonholo.cli.commands.run import Module
from nonholo.cli.screen.errors import USAGE, leave, scenario_errors, store_errors

_ABOUT = "name", "description"


def cite(cff: Annotated[bool, Option("--cff", help="Print CITATION.cff, for reference managers.")] = False) -> None:
    """Print BibTeX entries of this version of the library and of the paper behind it.

    Please cite both: the discrete maps of tops and sleighs are the paper's.

    nonholo cite >> references.bib
    nonholo cite --cff
    """
    import yaml

    room = Path(__file__).parents[1]  # the file is beside it in an installed package, at the root of a checkout
    file = next(path for path in (room / "CITATION.cff", room.parents[1] / "CITATION.cff") if path.exists())
    text = file.read_text("utf-8")
    if cff:
        echo(text, nl=False)
        return
    about = yaml.safe_load(text)
    entries = [_entry("nonholo", about)]
    for each in about["references"]:
        names = (author["family-names"].lower() for author in each["authors"])
        entries.append(_entry("-".join([*names, str(each["year"])]), each))
    echo("\n\n".join(entries))


def _entry(key: str, about: dict[str, Any]) -> str:
    """Return a BibTeX entry of a work as CITATION.cff describes it; braces keep capitals and the names of groups."""
    fields = {
        "author": " and ".join(map(_author, about["authors"])),
        "title": f"{{{about['title']}}}",
        "journal": about.get("journal"),
        "volume": about.get("volume"),
        "number": about.get("issue"),
        "pages": f"{about['start']}--{about['end']}" if "start" in about else None,
        "version": about.get("version"),
        "year": about.get("year") or about["date-released"].year,
        "doi": about.get("doi"),
    }
    lines = [f"  {name} = {{{value}}}," for name, value in fields.items() if value is not None]
    return "\n".join([f"@{about['type']}{{{key},", *lines, "}"])


def _author(about: dict[str, str]) -> str:
    return f"{about['family-names']}, {about['given-names']}" if "family-names" in about else f"{{{about['name']}}}"


def examples(name: Annotated[str | None, Argument(metavar="NAME", help="One that is listed.")] = None) -> None:
    """List the ready systems of the literature and the built-in scenarios; of one, show what is known.

    All of them are for `nonholo simulate`, `explore` and `new`.

    nonholo examples
    nonholo examples snakeboard
    nonholo examples suslov
    """
    if name in (scenarios := scenario.files.built_in_titles()):
        echo(f"{name}: {scenarios[name]}\n\n{_commands(name)}")
        return
    with store_errors(USAGE):
        ready = scenario.bodies.examples()
    if name is None:
        own = ((each, scenario.bodies.summary(make)) for each, make in ready.items())
        screen.tables.show_table(_ABOUT, own, "Ready systems, nonholo.examples")
        screen.tables.show_table(_ABOUT, scenarios.items(), "Built-in scenarios")
    elif name in ready:
        _show(ready[name]())
    else:
        remedy = scenario.sections.suggestion(name, [*ready, *scenarios])
        leave(f"There is no ready system or scenario {name!r}. {remedy}", USAGE)


def _commands(name: str) -> str:
    return "\n".join(f"  nonholo {command} {name}" for command in ("simulate", "explore", "new"))


def _show(example: "nonholo.examples.Example") -> None:
    """Print the start, the facts and the conserved quantities of a system, and how to run it."""
    parts: dict[str, list[Any]] = {
        "Start": [
            f"coordinates: {', '.join(example.coordinates)}",
            f"configuration: {example.configuration.tolist()}",
            f"velocity: {example.body_velocity.round(12).tolist()}",
        ],
        "Facts": [*example.facts],
        "Conserved along the motion": [*example.conserved],
        "In Python": [
            f"ready = nh.examples.{example.name}()",
            "discrete = nh.discretize(ready.system, 0.05)",
            "start = dict(configuration=ready.configuration, body_velocity=ready.body_velocity)",
            "orbit = nh.simulate(discrete, **start, steps=400)",
        ],
    }
    echo(scenario.bodies.summary(scenario.bodies.examples()[example.name]))
    for title, lines in parts.items():
        if lines:
            echo("\n".join([f"\n{title}", *(f"  {line}" for line in lines)]))
    echo(f"\nHere\n{_commands(example.name)}")


def new(
    kind: Annotated[str, Argument(metavar="KIND", help="suslov, ..., see `nonholo systems` and `examples`; or sweep.")],
    module: Module = None,
) -> None:
    """Print a commented scenario: every key, with its meaning.

    nonholo new sleigh > my.toml
    nonholo simulate my.toml
    nonholo new roller_racer > racer.toml
    nonholo new sweep > many.toml
    """
    files = scenario.files
    own = {**files.built_in(), **files.built_in("sweeps")}
    with scenario_errors():
        files.take_module(module)
    if kind in own:
        echo(own[kind], nl=False)
        return
    try:
        echo(scenario.files.template(kind), nl=False)
    except KeyError:
        raise BadParameter(f"there is no kind {kind!r}. {scenario.bodies.nearest_kind(kind)}") from None


def systems(module: Module = None) -> None:
    """List the bodies that a scenario can hold, with their parameters, and the built-in scenarios.

    nonholo systems
    nonholo new suslov > my.toml        a scenario to edit
    nonholo systems --module my_robot.py
    """
    with scenario_errors():
        scenario.files.take_module(module)
    tables = ((kind, scenario.bodies.body_table(kind)) for kind in scenario.bodies.own_kinds())
    rows = ((kind, scenario.bodies.summary(body.make), ", ".join([*body.model_fields][1:])) for kind, body in tables)
    screen.tables.show_table(("kind", "description", "parameters"), rows, "Bodies")
    screen.tables.show_table(_ABOUT, scenario.files.built_in_titles().items(), "Built-in scenarios")
    echo("And every ready system of `nonholo examples`.")
