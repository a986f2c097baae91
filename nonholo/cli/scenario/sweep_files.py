"""Reading the scenario of a sweep: names of a design as key paths, and values of a body that the design varies."""

import contextlib
import re
from pathlib import Path
from typing import Any

from nonholo.cli.scenario._values import along, drawn, needs_size
from nonholo.cli.scenario.files import Loaded, Setting, assign, built_in, checked, read_document, take_table, toml_text
from nonholo.cli.scenario.problems import ScenarioError, problem, suggestion
from nonholo.cli.scenario.sweeps import SweepScenario

_TABLES = ("body", "start", "run")
_STARTS = ("body_velocity", "restricted_velocity", "momentum")
_COMPONENT = re.compile(rf"({'|'.join(_STARTS)})(?:_(\d+)|\[(\d+)\])")


def load_sweep_scenario(name: str, settings: list[Setting]) -> Loaded[SweepScenario]:
    """Return the scenario of a sweep with settings applied, or raise with all its problems."""
    source, document = read_document(name, built_in("sweeps"))
    _by_table(document)
    for setting in settings:
        assign(document, setting)
    _by_table(document)
    _complete(document)
    take_table(document, name, source, settings)
    loaded = checked(document, SweepScenario, Path(name).stem, source, settings)
    refused = [problem(*found, source, loaded.options) for found in _refusals(loaded.scenario)]
    if refused:
        raise ScenarioError(refused)
    try:
        design = loaded.scenario.design.scaled()
    except ValueError as failure:
        raise ScenarioError([problem("design.members", str(failure), source, loaded.options)]) from None
    return loaded._replace(scenario=loaded.scenario.model_copy(update={"design": design}))


def sweep_text(scenario: SweepScenario) -> str:
    """Return the scenario of a sweep as TOML with every value that was in force; running it again repeats it."""
    document = scenario.model_dump(exclude_none=True)
    title, design = document.pop("title"), document.pop("design")
    values = {f"{table}.{name}": given for table, held in design.pop("values").items() for name, given in held.items()}
    return toml_text(title, {**document, "design": design, "design.values": values})


def _by_table(document: dict[str, Any]) -> None:
    """Put values under quoted key paths, "body.a" = ..., where unquoted ones stand: in tables."""
    values = _table(_table(document, "design"), "values")
    for path in [path for path in values if "." in path]:
        table, _, name = path.partition(".")
        held = values.setdefault(table, {})
        if isinstance(held, dict):
            held.setdefault(name, values.pop(path))


def _complete(document: dict[str, Any]) -> None:
    """Take the size of a distribution from the value it varies; give a value that is varied and not given."""
    values = _table(_table(document, "design"), "values")
    for table in _TABLES:
        held = _table(values, table)
        if held:
            document.setdefault(table, {})
        for name, given in held.items():
            _complete_one(_table(document, table), name, given)
    _complete_start(_table(document, "start"), _table(values, "start"))


def _table(document: dict[str, Any], name: str) -> dict[str, Any]:
    """Return a table of a document; an empty one where there is none, or a value, which is refused later."""
    held = document.get(name)
    return held if isinstance(held, dict) else {}


def _complete_one(own: dict[str, Any], name: str, given: Any) -> None:
    if needs_size(given) and isinstance(own.get(name), list):
        given["size"] = len(own[name])
    if name in own or _COMPONENT.fullmatch(name):
        return
    with contextlib.suppress(ValueError):  # reported as a problem of the design
        own[name] = _typical(given)


def _complete_start(own: dict[str, Any], held: dict[str, Any]) -> None:
    """Give a start of which every component is varied, from the first one on, and none is given."""
    parts = {(part[1], int(part[2] or part[3])): held[name] for name in held if (part := _COMPONENT.fullmatch(name))}
    if not parts or not set(_STARTS).isdisjoint([*own, *held]):
        return
    owner, _ = next(iter(parts))
    wanted = [(owner, component) for component in range(len(parts))]
    if parts.keys() != set(wanted):
        return
    with contextlib.suppress(ValueError):  # reported as a problem of the design
        own[owner] = [_typical(parts[part]) for part in wanted]


def _typical(given: Any) -> Any:
    import numpy as np

    if isinstance(given, list) or "count" in given:
        return along(given)[0].tolist()
    distribution = drawn(given)
    return distribution.draw(np.random.default_rng(0).random((1, distribution.width)))[0].tolist()


def _refusals(scenario: SweepScenario) -> list[tuple[str, str]]:
    """Return key paths and texts of what a scenario of one motion may say, but no sweep."""
    found = _refused_values(scenario)
    for key in ("displacement", "configuration"):
        if getattr(scenario.start, key) is not None:
            found.append((f"start.{key}", f"is not for sweeps. Start by {', '.join(_STARTS)}"))
    if scenario.run.save_every != 1:
        found.append(("run.save_every", "is not for sweeps: [keep] says what is kept"))
    return found


def _refused_values(scenario: SweepScenario) -> list[tuple[str, str]]:
    """Return key paths and texts of what a design cannot vary."""
    found, values = [], scenario.design.values
    if not any((values.body, values.start, values.run)):
        found.append(("design.values", 'must name what is varied, for example "body.a" = [0.1, 0.2]'))
    known = {"body": _parameters(scenario), "start": _STARTS, "run": ("time_step",)}
    for table, names in known.items():
        for name in getattr(values, table):
            whole = _COMPONENT.sub(r"\1", name) if table == "start" else name
            if whole not in names:
                problem = f"cannot be varied. {suggestion(name, list(names))}"
                found.append((f"design.values.{table}.{name}", problem))
            elif whole != name and getattr(scenario.start, whole) is None:
                found.append((f"start.{whole}", f"is missing: {name} is varied, the other components are given here"))
    return found


def _parameters(scenario: SweepScenario) -> tuple[str, ...]:
    """Return the keys of a body that are parameters of its system; of one under forces there are none."""
    system = scenario.system()
    leaves = () if system.is_forced else (*system.leaves, "inertia_operator")
    return tuple(name for name in type(scenario.body).model_fields if name in leaves)
