"""The list of public names: it is the one that the script writes, and holds each name once."""

import re
from collections import Counter
from pathlib import Path

from fuzz.calls import public_names
from scripts import script

PAGES = Path(__file__).parents[2] / "docs" / "api"


def test_pages_are_up_to_date() -> None:
    """The pages in the repository are those that the script writes: `python docs/make_api_pages.py`."""
    assert {path.name: path.read_text("utf-8") for path in PAGES.iterdir()} == script("docs/make_api_pages.py").pages()


def test_every_public_name_is_described_once() -> None:
    """Each public name has one entry on one page, and stands in one table."""
    text = "".join(path.read_text("utf-8") for path in PAGES.iterdir())
    entries = Counter(re.findall(r"^\.\. auto(?:class|exception|function|data):: nonholo\.(\S+)$", text, re.MULTILINE))
    rows = Counter(re.findall(r"^   nonholo\.(\S+)$", text, re.MULTILINE))
    assert set(public_names()) <= set(entries)
    assert entries == rows
    assert set(entries.values()) == {1}


def test_every_public_name_has_one_task() -> None:
    """Each name, and each open room, is one line of one group of `help(nonholo)`; so the page by task has it once."""
    module = script("docs/make_api_pages.py")
    listed = Counter(name for names in module.tasks().values() for name in names)
    assert listed == Counter([*(name for name in public_names() if "." not in name), *module.OPEN])
    rows = re.findall(r"^\| \S+`(\S+) <nonholo\.\S+>` \|", (PAGES / "index.md").read_text("utf-8"), re.MULTILINE)
    assert Counter(rows) == Counter(public_names())


def test_help_says_what_names_are_for() -> None:
    """The docstring of the package has the first line of each name's own."""
    module = script("docs/make_api_pages.py")
    assert module.INIT.read_text("utf-8") == module.package_text()


def test_reference_pages_are_up_to_date() -> None:
    """The pages of commands and scenarios are those that the script writes: `python docs/make_reference_pages.py`."""
    folder = PAGES.parent / "reference"
    for name, text in script("docs/make_reference_pages.py").pages().items():
        assert (folder / name).read_text("utf-8") == text


def test_every_key_of_a_scenario_says_what_it_means() -> None:
    """No row of the tables of keys lacks its last cell."""
    text = (PAGES.parent / "reference" / "scenarios.md").read_text("utf-8")
    assert re.findall(r"^\| `\w+` \|.*\|  \|$", text, re.MULTILINE) == []


def test_every_page_is_in_the_contents() -> None:
    """The first page leads to all others."""
    contents = re.findall(r"^[a-z-]+$", (PAGES / "index.md").read_text("utf-8"), re.MULTILINE)
    assert sorted(contents) == sorted(path.stem for path in PAGES.iterdir() if path.stem != "index")
