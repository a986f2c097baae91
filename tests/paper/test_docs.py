"""The pages on the paper and its errata are what the findings say."""

import re
from pathlib import Path

import pytest
from scripts import script

from nonholo_paper._checklist import sections
from nonholo_paper._registry import entries

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize("name", ["paper.md", "errata.md"])
def test_page_is_up_to_date(name: str) -> None:
    """The page in the repository is the one that the script writes: `python docs/make_paper_pages.py`."""
    assert (DOCS / name).read_text("utf-8") == script("docs/make_paper_pages.py").page(name)


def test_every_row_of_the_errata_is_on_its_page() -> None:
    """The errata page has one row for each number, with as many cells as the heading."""
    rows = re.findall(r"^\| ([SC]\d+) \|(.*)\|$", (DOCS / "errata.md").read_text("utf-8"), re.MULTILINE)
    assert sorted(number for number, _ in rows) == sorted(number for part in sections() for number in part.errata)
    for number, cells in rows:
        assert len(re.findall(r"(?<!\\)\|", cells)) == 4, number


def test_every_finding_is_on_the_page_of_the_paper() -> None:
    """The page of the paper has one row for each finding, with as many cells as the heading."""
    rows = re.findall(r"^\| (?!place)([^*|].*)\|$", (DOCS / "paper.md").read_text("utf-8"), re.MULTILINE)
    assert len(rows) == len(entries())
    for cells in rows:
        assert len(re.findall(r"(?<!\\)\|", cells)) == 4, cells


def test_bars_stay_within_their_cell() -> None:
    """Absolute values and norms in formulas, and bars in words, do not end a cell of a table."""
    assert script("docs/make_paper_pages.py")._cell("a | b $|x| \\| y$\nc") == r"a \| b $\vert x\vert  \Vert  y$ c"
