"""Reading the scenario of a sweep: names of a design as key paths, and values of a body that the design varies."""

import contextlib
import re
from pathlib import Path
from typing import Any

import numpy as np

from nonholo.cli.scenario.bodies import arguments, is_example
from nonholo.cli.scenario.files import (
    Loaded,
    Setting,
    assign,
    built_in,
    by_table,
    complete,
    read_document,
    table_in,
    take_module,
    toml_text,
    validate,
)
from nonholo.cli.scenario.problems import ScenarioError, problem
from nonholo.cli.scenario.sections import suggestion
from nonholo.cli.scenario.sweeps import TABLES, SweepScenario, along, distribution_of, library_name, needs_size
from nonholo.ensembles import component_of, force_numbers

_STARTS = ("body_velocity", "restricted_velocity", "momentum")
_COMPONENT = re.compile(rf"({'|'.join(_STARTS)})(?:_(\d+)|\[(\d+)\])")


def load_sweep_scenario(name: str, settings: list[Setting], module: Path | None = None) -> Loaded[SweepScenario]:
    """Return the scenario of a sweep with settings applied, or raise with all its problems."""
    take_module(module)
    source, document = read_document(name, built_in("sweeps"))
    by_table(document)
    for setting in settings:
        assign(document, setting)
    by_table(document)
    body = table_in(document, "body").get("kind")
    if not (isinstance(body, str) and is_example(body)):
        _complete(document)
    complete(document, name, source, settings, start=False)
    request = validate(document, SweepScenario, Path(name).stem, source, settings)
    if flaws := [problem(*flaw, source, request.options) for flaw in _refusals(request.scenario)]:
        raise ScenarioError(flaws)
    try:
        design = request.scenario.design.with_members()
    except ValueError as failure:
        raise ScenarioError([problem("design.members", str(failure), source, request.options)]) from None
    return request._replace(scenario=request.scenario.model_copy(update={"design": design}))


def sweep_text(scenario: SweepScenario) -> str:
    """Return the scenario of a sweep as TOML with every value that was in force; running it again repeats it."""
    document = scenario.model_dump(exclude_none=True, serialize_as_any=True)
    title, design = document.pop("title"), document.pop("design")
    entries = design.pop("values").items()
    values = {f"{table}.{name}": value for table, own in entries for name, value in own.items()}
    return toml_text(title, {**document, "design": design, "design.values": values})


def _complete(document: dict[str, Any]) -> None:
    """Take the size of a distribution from the value it varies; give a value that is varied and not given."""
    values = table_in(table_in(document, "design"), "values")
    for table in ("body", "start", "run"):
        own = table_in(values, table)
        if own:
            document.setdefault(table, {})
        for name, value in own.items():
            _complete_one(table_in(document, table), name, value)
    _complete_start(table_in(document, "start"), table_in(values, "start"))


def _complete_one(own: dict[str, Any], name: str, value: Any) -> None:
    if needs_size(value) and isinstance(own.get(name), list):
        value["size"] = len(own[name])
    if name in own or _COMPONENT.fullmatch(name):
        return
    with contextlib.suppress(ValueError):  # reported as a problem of the design
        own[name] = _typical(value)


def _complete_start(own: dict[str, Any], values: dict[str, Any]) -> None:
    """Give a start of which every component is varied, from the first one on, and none is given."""
    parts = {
        (part[1], int(part[2] or part[3])): values[name] for name in values if (part := _COMPONENT.fullmatch(name))
    }
    if not parts or not set(_STARTS).isdisjoint([*own, *values]):
        return
    owner, _ = next(iter(parts))
    places = [(owner, component) for component in range(len(parts))]
    if parts.keys() != set(places):
        return
    with contextlib.suppress(ValueError):  # reported as a problem of the design
        own[owner] = [_typical(parts[place]) for place in places]


def _typical(value: Any) -> Any:
    if isinstance(value, list) or "count" in value:
        return along(value)[0].tolist()
    distribution = distribution_of(value)
    return distribution.draw(np.random.default_rng(0).random((1, distribution.width)))[0].tolist()


def _refusals(scenario: SweepScenario) -> list[tuple[str, str]]:
    """Return key paths and texts of what a scenario of one motion may say, but no sweep."""
    flaws = _refused_values(scenario)
    if scenario.start is not None:
        if scenario.is_family:
            flaws.append(("start", "is not for sweeps of this body, whose keys have its start"))
        for key in ("displacement", "configuration"):
            if getattr(scenario.start, key) is not None:
                flaws.append((f"start.{key}", f"is not for sweeps. Start by {', '.join(_STARTS)}"))
    if scenario.run.save_every != 1:
        flaws.append(("run.save_every", "is not for sweeps: [keep] lists what is kept"))
    return flaws


def _refused_values(scenario: SweepScenario) -> list[tuple[str, str]]:
    """Return key paths and texts of what a design cannot vary."""
    values = scenario.design.values
    entries = [(table, name) for table in TABLES for name in getattr(values, table)]
    if not entries:
        return [("design.values", 'must name what is varied, for example "body.a" = [0.1, 0.2]')]
    names = _varied_names(scenario)
    return [flaw for table, name in entries if (flaw := _flaw(scenario, table, name, names[table]))]


def _flaw(scenario: SweepScenario, table: str, name: str, names: tuple[str, ...]) -> tuple[str, str] | None:
    """Return what is wrong with a value that is varied, and where; None of one that can be."""
    own = library_name(f"{table}.{name}")
    whole = _whole(own, names)
    is_part = whole != own
    if whole not in names or (is_part and table == "body" and not scenario.is_family):
        return f"design.values.{table}.{name}", f"cannot be varied. {suggestion(own, names)}"
    if is_part and table == "start" and scenario.start and getattr(scenario.start, whole) is None:
        return f"start.{whole}", f"is missing: {name} is varied, the other components are given here"
    return None


def _whole(name: str, names: tuple[str, ...]) -> str:
    """Return the array that a name is a component of, where the name itself is not known."""
    part = component_of(name)
    return part[0] if part and name not in names else name


def _varied_names(scenario: SweepScenario) -> dict[str, tuple[str, ...]]:
    """Return what can be varied by table, as the library calls it."""
    if scenario.is_family:
        names = tuple(arguments(type(scenario.body).make))
        return {"body": names, "start": ("configuration", "body_velocity"), "run": ("time_step",), "forces": ()}
    system: Any = scenario.system()
    leaves = (*(system.system if system.is_forced else system).leaves, "inertia_operator")
    body = tuple(name for name in type(scenario.body).model_fields if name in leaves)
    return {"body": body, "start": _STARTS, "run": ("time_step",), "forces": tuple(force_numbers(system))}
