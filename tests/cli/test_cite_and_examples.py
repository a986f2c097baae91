"""`nonholo cite`, `nonholo examples` and `nonholo paper --list`: what they print, from where."""

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from commands import Command, assert_ends

import nonholo as nh
from nonholo_paper import entries

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())


def test_entries_are_balanced_and_of_this_version(nonholo: Command) -> None:
    """Two BibTeX entries with braces in pairs, the version of the project and the identifier of the paper."""
    text = nonholo("cite").stdout
    assert re.findall(r"^@(\w+)\{([\w-]+),$", text, re.MULTILINE) == [
        ("software", "nonholo"),
        ("article", "fedorov-zenkov-2005"),
    ]
    assert text.count("{") == text.count("}")
    assert f"version = {{{PROJECT['project']['version']}}}," in text
    assert "doi = {10.1088/0951-7715/18/5/017}," in text


def test_the_file_is_the_one_of_the_repository(nonholo: Command) -> None:
    """`--cff` prints CITATION.cff, which wheels carry to where the command looks for it."""
    assert nonholo("cite", "--cff").stdout == (ROOT / "CITATION.cff").read_text()
    assert PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"] == {
        "CITATION.cff": "nonholo/cli/CITATION.cff"
    }


def test_every_ready_system_and_scenario_is_listed(nonholo: Command) -> None:
    """The names of `nh.examples` and the built-in scenarios stand in the list."""
    listed = set(re.findall(r"^│ (\w+) ", nonholo("examples").stdout, re.MULTILINE))
    assert listed == {*nh.examples.__all__, *_scenarios()} - {"Example"}


def _scenarios() -> list[str]:
    return [path.stem for path in (ROOT / "nonholo" / "cli" / "scenarios").glob("*.toml")]


def test_facts_are_those_of_the_example(nonholo: Command) -> None:
    """Of a ready system it prints every fact and conserved quantity, and lines of Python."""
    text = nonholo("examples", "rolling_disk").stdout
    ready = nh.examples.rolling_disk()
    assert [line for line in (*ready.facts, *ready.conserved) if f"  {line}\n" not in text] == []
    assert "nh.examples.rolling_disk()" in text.split("In Python\n")[1]


@pytest.mark.profile("routes", instead="test_facts_are_those_of_the_example")
@pytest.mark.parametrize("name", sorted({*nh.examples.__all__} - {"Example"}))
def test_its_lines_of_python_run(nonholo: Command, name: str) -> None:
    """What is printed under "In Python" gives an orbit of 400 steps, or one that says why it ended."""
    lines = nonholo("examples", name).stdout.split("In Python\n")[1].split("\nHere\n")[0]
    lines = lines.replace("steps=400", "steps=400, throw=False")
    names: dict[str, Any] = {"nh": nh}
    exec(re.sub(r"^  ", "", lines, flags=re.MULTILINE), names)  # noqa: S102
    assert len(names["orbit"]) == 401 or names["orbit"].outcome != nh.Outcome.successful


@pytest.mark.parametrize("name", _scenarios())
def test_of_a_scenario_it_says_what_runs_it(nonholo: Command, name: str) -> None:
    """Of a built-in scenario it prints the command."""
    assert f"nonholo simulate {name}\n" in nonholo("examples", name).stdout


def test_another_name_is_refused_with_the_nearest(nonholo: Command) -> None:
    """A name that is not there ends with code 2."""
    assert_ends(nonholo("examples", "snakbord"), 2, "Did you mean snakeboard?")


def test_findings_are_listed_and_not_measured(nonholo: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """`paper --list` has a row for each finding, of a choice only its own, and leaves the folder empty."""
    monkeypatch.setattr("nonholo_paper.evaluate_all", lambda *_: pytest.fail("measured"))
    monkeypatch.setenv("COLUMNS", "400")
    rows = re.findall(r"^│ (.*?) *│", nonholo("paper", "--list").stdout, re.MULTILINE)
    assert rows == [", ".join(entry.names) for entry in entries()]
    assert len(re.findall("^│", nonholo("paper", "--list", "--only", "S14").stdout, re.MULTILINE)) == 1
    assert list(Path().glob("paper")) == []
