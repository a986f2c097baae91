"""The list of public names is the one that the script writes; what the site does with docstrings, and what it loads."""

import re
from collections import Counter
from pathlib import Path

import pytest
from fuzz.calls import public_names
from scripts import script

PAGES = Path(__file__).parents[2] / "docs" / "api"


def test_pages_are_up_to_date() -> None:
    """The pages in the repository are those that the script writes."""
    written = {path.name: path.read_text("utf-8") for path in PAGES.iterdir()}
    assert written == script("docs/make_api_pages.py").pages(), "run `python docs/make_api_pages.py`"


def test_every_public_name_is_described_once() -> None:
    """Each public name has one entry on one page and one row: else run `python docs/make_api_pages.py`."""
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


restructured = script("docs/extensions/docstrings.py").restructured
loaded_from_elsewhere = script("docs/extensions/offline.py").loaded_from_elsewhere


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("`Event`s of $n$s, ($n$-dimensional)", r"`Event`\ s of :math:`n`\ s, (:math:`n`-dimensional)"),
        ("D > 2|c|^2 and Ad*_W, W_ too", r"D > 2\|c\|^2 and Ad\*_W, W\_ too"),
        ("mass: m.\n1. no list", "mass: \\m.\n\\1. no list"),
        (r"$|x|_*$ and `a|b`", r":math:`|x|_*` and `a|b`"),
        ("  $$ a\n  = b $$\n", "  \n\n  .. math::\n\n     a = b\n\n  \n"),
        (">>> x = a_ * |b|\nc_|\n\nd_\n", ">>> x = a_ * |b|\nc_|\n\nd\\_\n"),
    ],
)
def test_only_code_and_formulas_are_marked(text: str, expected: str) -> None:
    """Formulas become the markup of Sphinx; bars, stars and underscores beside them stay what they are."""
    assert restructured(text) == expected


@pytest.mark.parametrize(
    ("name", "text", "loads"),
    [
        ("a.html", '<script defer src="https://cdn.example/x.js"></script>', True),
        ("a.html", "<link rel='stylesheet'\n href='//fonts.example/x.css'>", True),
        ("a.html", '<img src="http://example.org/x.png">', True),
        ("a.html", '<a href="https://example.org">there</a> <script src="_static/x.js"></script>', False),
        ("a.css", '@import "https://example.org/x.css";', True),
        ("a.css", "b { src: url('//example.org/x.woff2') }", True),
        ("a.css", '@import "../basic.css"; b { src: url(data:font/woff2;base64,AA//BB) }', False),
    ],
)
def test_what_a_page_loads(tmp_path: Path, name: str, text: str, loads: bool) -> None:
    """Scripts, style sheets, pictures and fonts with an address on the net are named; links to follow are not."""
    (tmp_path / name).write_text(text)
    assert bool(loaded_from_elsewhere(tmp_path)) is loads
