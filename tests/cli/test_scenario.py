"""Scenarios: everything wrong is reported at once, with where it was said; settings pass the same checks."""

import functools
import tomllib
from pathlib import Path
from typing import Any

import pytest
from commands import problems_of
from hypothesis import given
from hypothesis import strategies as st

from nonholo.cli.scenario.bodies import SHORT
from nonholo.cli.scenario.files import effective_text, load_scenario, parse_setting
from nonholo.cli.scenario.sections import ScenarioError

_GOOD = """
[body]
kind = "sleigh"
mass = 1
inertia = 1.0
a = 0.5
[start]
body_velocity = [0.1, 1, 0]
[run]
time_step = 0.1
steps = 3
"""


_problems = functools.partial(problems_of, load_scenario)


def test_all_problems_at_once() -> None:
    """Three mistakes in three tables are four problems, each with file, key path and what was got."""
    text = (
        _GOOD.replace("a = 0.5", "aa = 0.5")
        .replace("steps = 3", 'steps = "3"')
        .replace("[0.1, 1, 0]", "[0.1, true, 0]")
    )
    found = _problems(text)
    assert len(found) == 4
    assert "my.toml: body.a: is missing" in found
    assert "my.toml: body.aa: is not a known key. Did you mean a?" in found
    assert any(f.startswith("my.toml: start.body_velocity[1]: must be a valid number") for f in found)
    assert "my.toml: run.steps: must be a valid integer. Got '3'" in found


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('kind = "sleigh"', 'kind = "slegh"', "body: must have a known kind. Got 'slegh'. Did you mean s"),
        ('kind = "sleigh"', "", f"body: must have a known kind. Got none. Known: {', '.join(SHORT)}, "),
        ("[run]", "[outptu]\nplot = true\n[run]", "outptu: is not a known key. Did you mean output?"),
        ("[body]", "output = 1\n[body]", "output: must be a table. Got 1"),
        ("mass = 1", "mass = -1", "body.mass: must be positive. Got -1"),
        ("[run]", "momentum = [1, 2]\n[run]", "start: must hold exactly one of body_velocity, restricted_velocity"),
        ("[run]", "momentum = [1, 2]\n[run]", "Got body_velocity and momentum."),
        ("body_velocity = [0.1, 1, 0]", "", "Got none."),
        ("[body]", "[body", "is not valid TOML"),
        ("mass = 1", "mass = 1\nmass = 2", "is not valid TOML"),
    ],
)
def test_a_problem_is_told_with_its_place(old: str, new: str, told: str) -> None:
    """What is unknown, missing, double or refused by the library has its key path; what is no TOML its line."""
    (problem,) = _problems(_GOOD.replace(old, new))
    assert told in problem
    assert problem.startswith("my.toml: ")
    assert "line" in problem or "TOML" not in told


def test_unreadable_files(tmp_path: Path) -> None:
    """A missing file, a folder and bytes that are no text are refused; a near miss of a built-in name is suggested."""
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    for name, told in (("sleig", "Did you mean sleigh?"), (".", "cannot be read"), ("binary.toml", "cannot be read")):
        with pytest.raises(ScenarioError, match=told.replace("?", r"\?")):
            load_scenario(name, [])


def test_settings_name_their_option() -> None:
    """A wrong value from the command line is reported with the option, the rest with the file."""
    found = _problems(_GOOD.replace("mass = 1", "mass = -1"), "body.a=nan", "start.velocity=1")
    assert found[0] == "--set body.a=nan: body.a: must be a finite number. Got nan"
    assert found[1].startswith("--set start.velocity=1: start.velocity: is not a known key. Did you mean")


@pytest.mark.parametrize("text", ["body.a", "=1", "body..a=1", "body.a=x", "body.a=1\nb=2", "body.a="])
def test_malformed_settings(text: str) -> None:
    """A setting that is not KEY=VALUE with a TOML value is refused with an example."""
    with pytest.raises(ScenarioError, match=r"must (be KEY=VALUE|have a TOML value)"):
        parse_setting(text)


def test_setting_a_key_below_a_value() -> None:
    """A setting cannot descend into a number."""
    assert "mass is a value, not a table" in _problems(_GOOD, "body.mass.x=1")[0]


def test_setting_replaces_a_table() -> None:
    """An inline table replaces a whole table, so that the start can be of another sort."""
    Path("my.toml").write_text(_GOOD)
    loaded = load_scenario("my.toml", [parse_setting("start={momentum=[0.1, 1.0]}")])
    assert loaded.scenario.start.momentum == [0.1, 1.0]


@given(
    mass=st.floats(min_value=1e-150, max_value=1e150),
    a=st.floats(min_value=-1e150, max_value=1e150),
    steps=st.integers(1, 10**15),
    title=st.text(st.characters(exclude_categories=["Cs", "Cc"])),
)
def test_effective_text_repeats_the_scenario(mass: float, a: float, steps: int, title: str) -> None:
    """The text kept in a store, read again, is the same scenario, exact in every number."""
    path = Path("any.toml")
    path.write_text(_GOOD)
    settings: list[Any] = [parse_setting(f"body.mass={mass!r}"), parse_setting(f"body.a={a!r}")]
    scenario = load_scenario(str(path), [*settings, parse_setting(f"run.steps={steps}")]).scenario
    scenario = scenario.model_copy(update={"title": title})
    again = type(scenario).model_validate(tomllib.loads(effective_text(scenario)))
    assert again == scenario
