"""The page of guarantees, and the figures of the fuzzers."""

import json
from pathlib import Path

import pytest
from fuzz.__main__ import merged
from fuzz.judge import BROKEN, GOOD
from scripts import script

CLASSES = dict.fromkeys([*GOOD, *BROKEN], 1) | {"refused": 9}
DOCS = Path(__file__).parents[1] / "docs"
MAKER = "benchmarks/figures.py"


def test_the_figures_are_what_the_script_writes() -> None:
    """The page is the one of the figures in the repository: `python benchmarks/figures.py --parts`."""
    found, fuzz = (json.loads((DOCS / name).read_text()) for name in ("figures.json", "figures-of-fuzz.json"))
    assert (DOCS / "project" / "figures.md").read_text("utf-8") == script(MAKER).page(found, fuzz)


def test_what_it_names_is_there() -> None:
    """Links and files of tests on the page exist."""
    text = (DOCS / "reliability.md").read_text("utf-8")
    links = [link.split(")")[0].partition("#")[0] for link in text.split("](")[1:] if not link.startswith("http")]
    files = [word for word in text.split("`") if word.startswith("tests/")]
    assert links
    assert files
    assert all((DOCS / link).exists() for link in links)
    assert all((DOCS.parent / file.split()[0]).exists() for file in files)


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
    text = script(MAKER).page({}, {fuzzer: figures})
    assert words in text
    assert text.count("| not run |") == 3


def test_figures_of_other_fuzzers_stay(tmp_path: Path) -> None:
    """A run of one fuzzer replaces its own figures in the file, whose order is that of the page."""
    file = tmp_path / "figures.json"
    assert merged(file, {"kills": {"a": 1}}) == {"kills": {"a": 1}}
    file.write_text(json.dumps({"steps": {"b": 1}, "api": {"c": 1}}))
    assert list(merged(file, {"api": {"c": 2}}).items()) == [("api", {"c": 2}), ("steps", {"b": 1})]
