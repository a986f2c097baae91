"""The list of references holds what the pages and the code cite, and nothing else."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
LIST = ROOT / "docs" / "references.md"
KEY = r"\[([a-z]+(?:-[a-z]+)*-(?:19|20)\d\d)\]"


def cited() -> set[str]:
    """Return the keys in brackets in the documentation, the package and the benchmarks."""
    places = [*ROOT.glob("docs/**/*.md"), *ROOT.glob("nonholo/**/*.py"), *ROOT.glob("benchmarks/**/*.py")]
    return {key for place in places if place != LIST for key in re.findall(KEY, place.read_text("utf-8"))}


def test_every_reference_is_listed_once_and_cited() -> None:
    """A key without an entry, an entry that nothing cites, and a second entry are errors; entries are in order."""
    listed = re.findall(rf"^\| {KEY} \|", LIST.read_text("utf-8"), re.MULTILINE)
    assert listed == sorted(set(listed))
    assert cited() == set(listed)


def test_every_reference_says_what_was_read() -> None:
    """The last column says how much of the text was at hand."""
    rows = re.findall(rf"^\| {KEY} \|.*\| (.*) \|$", LIST.read_text("utf-8"), re.MULTILINE)
    assert rows
    assert all(re.match("text|abstract|not read|not recorded", read) for _, read in rows)
