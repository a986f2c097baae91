"""README and pages say what is so: commands are those of CI, the example runs, links and references lead somewhere."""

import json
import re
from pathlib import Path

import pytest
from fuzz.__main__ import merged
from fuzz.judge import BROKEN, GOOD
from scripts import script

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


def test_commands() -> None:
    """The two commands stand on lines of their own, where `.ci/run` finds them."""
    setup = "python3 -m venv .venv && .venv/bin/pip install -q -c constraints.txt -e"
    first, second = [line for line in README.splitlines() if line.startswith("python3")]
    assert first == f"{setup} . && .venv/bin/nonholo simulate suslov"
    assert second == f"{setup} '.[all,test]' && .venv/bin/python -m pytest -q"
    ci = (ROOT / ".ci" / "run").read_text()
    assert all(f"readme_command '{command}$'" in ci for command in ("nonholo simulate suslov", "python -m pytest -q"))


def test_example(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The Python example runs twice, keeps energy as it claims, and leaves its files."""
    monkeypatch.chdir(tmp_path)
    (example,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    for _ in range(2):
        exec(example, {})  # noqa: S102
    assert float(capsys.readouterr().out.split()[0]) < 1e-15
    assert (tmp_path / "sleigh.png").stat().st_size > 10_000
    assert (tmp_path / "sleigh.zarr").is_dir()


@pytest.mark.parametrize("page", sorted(ROOT.glob("*.md")) + sorted(ROOT.glob("docs/**/*.md")), ids=lambda p: p.name)
def test_links(page: Path) -> None:
    """Every relative link of every page leads to a file."""
    links = re.findall(r"\]\((?!https?:|#)([^)#]+)", page.read_text())
    assert [link for link in links if not (page.parent / link).exists()] == []


CLASSES = dict.fromkeys([*GOOD, *BROKEN], 1) | {"refused": 9}
DOCS = ROOT / "docs"
MAKER = "benchmarks/figures.py"


def test_the_figures_are_what_the_script_writes() -> None:
    """The page is the one of the figures in the repository: `python benchmarks/figures.py --parts`."""
    result = json.loads((DOCS / "figures.json").read_text())
    assert (DOCS / "project" / "figures.md").read_text("utf-8") == script(MAKER).page(result)


def test_what_it_names_is_there() -> None:
    """Files of tests on the page about reliability exist."""
    text = (DOCS / "reliability.md").read_text("utf-8")
    files = [word.split()[0] for word in text.split("`") if word.startswith("tests/")]
    assert files
    assert [file for file in files if not (ROOT / file).exists()] == []


@pytest.mark.parametrize(
    ("fuzzer", "figures", "words"),
    [
        ("api", {"trials": 3000, "call forms": 90, "named": 7, "classes": CLASSES}, "3,000 calls of 90 forms"),
        ("stores", {"openings": 1200, "classes": {"orbit, damage": {"same": 3, "raw": 2}}}, "age: 3 same, 2 raw"),
        ("kills", {"orbit": {"runs": 3, "killed": 2, "wrong": ["x"]}, "restarts": "skipped"}, "2 killed, 1 wrong; re"),
        ("steps", {"all": {"steps": 10, "wrong: a root": 2, "not finite": 1}, "families": {"a": {}}}, "; 3 wrong"),
    ],
)
def test_figures_are_shown_as_they_are(fuzzer: str, figures: dict, words: str) -> None:
    """What went wrong is on the page too."""
    text = script(MAKER).FUZZED[fuzzer](figures)
    assert words in text


def test_figures_of_other_fuzzers_stay(tmp_path: Path) -> None:
    """A run of one fuzzer replaces its own figures in the file, whose order is that of the page."""
    file = tmp_path / "figures.json"
    assert merged(file, {"kills": {"a": 1}}) == {"kills": {"a": 1}}
    file.write_text(json.dumps({"steps": {"b": 1}, "api": {"c": 1}}))
    assert list(merged(file, {"api": {"c": 2}}).items()) == [("api", {"c": 2}), ("steps", {"b": 1})]


LIST = DOCS / "references.md"
KEY = r"\[([a-z]+(?:-[a-z]+)*-(?:19|20)\d\d)\]"


def cited() -> set[str]:
    """Return the keys in brackets in the documentation, the package and the benchmarks."""
    places = [*ROOT.glob("docs/**/*.md"), *ROOT.glob("nonholo/**/*.py"), *ROOT.glob("benchmarks/**/*.py")]
    return {key for place in places if place != LIST for key in re.findall(KEY, place.read_text("utf-8"))}


def test_every_reference_is_listed_once_and_cited() -> None:
    """Keys are listed in order, once, and cited; the last column says how much of the text was at hand."""
    rows = re.findall(rf"^\| {KEY} \|.*\| (.*) \|$", LIST.read_text("utf-8"), re.MULTILINE)
    listed = [key for key, _ in rows]
    assert listed == sorted(set(listed))
    assert cited() == set(listed)
    assert all(re.match("text|abstract|not read|not recorded", read) for _, read in rows)
