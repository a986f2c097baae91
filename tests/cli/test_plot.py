"""`nonholo plot`, every kind of picture; `cite`, `examples` and `paper --list`: what they print, from where."""

import functools
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Command, assert_ends, words_of
from matplotlib.figure import Figure
from PIL import Image
from plot.runs import run_of, sleigh_run, top_run

import nonholo as nh
from nonholo.cli.screen.pictures import figure_of, kinds
from nonholo_paper import entries

_sleigh = functools.partial(sleigh_run, (0.1, -1.0, 0.0))


def test_every_kind_of_picture() -> None:
    """Each function that draws a run is a kind, named with hyphens, and gives a figure with the title that is asked."""
    functions = {name.replace("_", "-") for name in nh.plot.__all__ if name.islower()}
    assert set(kinds()) == functions - {"animate", "comparison", "convergence", "curvature", "sweep-map"}
    sleigh, free = _sleigh(steps=200, events=[nh.cusp]), run_of(nh.RigidBody(np.diag([1.0, 3.0, 2.0])))
    others = {"body-axis-track": top_run((0.4, 0.9, 0.0), steps=20), "momentum-sphere": free}
    for kind in kinds():
        names = {"across": "body_velocity.0", "up": "heading"} if kind == "section" else {}
        figure = figure_of(kind, others.get(kind, sleigh), {"title": "Mine"}, **names)
        assert isinstance(figure, Figure)
        axes = figure.axes[0]
        title = figure.texts[0].get_text() if kind == "overview" else axes.get_title(loc="left")
        assert title == "Mine", kind
        if kind == "section":
            assert (axes.get_xlabel(), axes.get_ylabel()) == ("body velocity.0", "heading")


@pytest.mark.parametrize("place", [".", ".."])
def test_a_store_that_is_where_one_stands(place: str, nonholo: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """Inside of a store its picture lies beside it, too; the root of all folders is no store."""
    nh.save_orbit(_sleigh(steps=2), "a.zarr")
    picture = Path("a.png").absolute()
    monkeypatch.chdir("a.zarr" if place == "." else "a.zarr/time")
    assert_ends(nonholo("plot", place), 0)
    assert picture.exists()
    assert_ends(nonholo("plot", "/"), 2, "must be a store of an orbit")


def test_options_of_pictures(nonholo: Command) -> None:
    """Kind, as `nh.plot` spells it too, title, size, dots per inch and background are what the options say."""
    nh.save_orbit(_sleigh(steps=20), "a.zarr")
    options = ("--kind", "blade_track", "--size", "8x4.5", "--dpi", 40, "--dark", "--title", "Mine")
    assert_ends(nonholo("plot", "a.zarr", *options), 0)
    with Image.open("a.png") as picture:
        assert picture.size == (320, 180)
        assert max(picture.convert("RGB").getpixel((0, 0))) < 40
    assert nonholo("plot", "a.zarr", *options, "-o", "a.svg").exit_code == 0
    assert ">Mine</text>" in Path("a.svg").read_text()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--kind", "portrait"), "--kind must be one of overview, "),
        (("--size", "16"), "--size must be width and height in inches, 1 to 100, as 16x9. Got '16'"),
        (("--size", "0x9"), "--size must be width and height"),
        (("--kind", "branches", "--gif"), "Leave --kind out"),
        (("--x", "momentum.0"), "--x and --y for --kind section too"),
        (("-o", "a.txt"), "`nonholo plot -o` must end in a picture format. Got 'a.txt'"),
    ],
)
def test_refusals(options: tuple[str, ...], words: str, nonholo: Command) -> None:
    """Unknown kinds, sizes and contradictions are refused before the store is read."""
    nh.save_orbit(_sleigh(steps=2), "a.zarr")
    assert_ends(nonholo("plot", "a.zarr", *options), 2, words)


def test_what_a_section_needs(nonholo: Command) -> None:
    """A run without events has no section, and its refusal says what has one; so does a quantity that is none."""
    nh.save_orbit(_sleigh(steps=2), "a.zarr")
    ended = nonholo("plot", "a.zarr", "--kind", "section", "--x", "heading", "--y", "time")
    assert words_of(assert_ends(ended, 1)).startswith("`section(crossings=...)` must hold crossings of an event")
    with pytest.raises(ValueError, match=r"needs --x and --y like body_velocity.0. Got 'speed' to run across"):
        figure_of("section", _sleigh(steps=200, events=[nh.cusp]), {}, across="speed", up="time")


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
    """The names of `nh.examples` and the built-in scenarios stand in the list; of a scenario it prints the command."""
    listed = set(re.findall(r"^│ (\w+) ", nonholo("examples").stdout, re.MULTILINE))
    assert listed == {*nh.examples.__all__, *_scenarios()} - {"Example"}
    assert all(f"nonholo simulate {name}\n" in nonholo("examples", name).stdout for name in _scenarios())


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


def test_findings_are_listed_and_not_measured(nonholo: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """`paper --list` has a row for each finding, of a choice only its own, and leaves the folder empty."""
    monkeypatch.setattr("nonholo_paper.evaluate_all", lambda *_: pytest.fail("measured"))
    monkeypatch.setenv("COLUMNS", "400")
    rows = re.findall(r"^│ (.*?) *│", nonholo("paper", "--list").stdout, re.MULTILINE)
    assert rows == [", ".join(entry.names) for entry in entries()]
    assert all(len(names := row.split(", ")) == len({*names}) for row in rows)
    assert len(re.findall("^│", nonholo("paper", "--list", "--only", "S14").stdout, re.MULTILINE)) == 1
    assert list(Path().glob("paper")) == []
