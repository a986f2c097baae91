"""The page of findings: what it says, that it needs nothing else, whose folder it overwrites."""

import html
import json
import re
from pathlib import Path

import numpy as np
import pytest
from links import Links
from matplotlib.figure import Figure as MatplotlibFigure
from scripts import script

from nonholo_paper._checklist import sections
from nonholo_paper._finding import Measured, finding
from nonholo_paper._folder import check_folder, write_folder
from nonholo_paper._formulas import to_html
from nonholo_paper._page import page
from nonholo_paper._registry import Entry, entries
from nonholo_paper._run import Result, evaluate, evaluate_all
from nonholo_paper._verdict import Verdict
from nonholo_paper.figures import Figure


@finding("plus", "equation", "Section 4, equation (plus)", r"$1 + 1 = 2$", tolerance=1e-12)
def plus() -> Measured:
    """Add, and return a number of NumPy."""
    return Measured(np.float64(1e-16), note="one sum")


FALSE = {"verdict": Verdict.FALSE, "corrected": "right", "errata": ("S1",)}


@finding("minus", "lemma", "Section 4, a < b", "\u201cIt is wrong.\u201d", tolerance=1.0, **FALSE)
def minus() -> Measured:
    """Give an infinite defect of what is printed."""
    return Measured(0.0, float("inf"))


@finding("raises", "remark", "Section 4, remark", "Nothing.", tolerance=1.0)
def raises() -> Measured:
    """Raise."""
    raise ZeroDivisionError("no <number>")


def drawn() -> MatplotlibFigure:
    """Draw a line."""
    figure = MatplotlibFigure()
    figure.add_subplot().plot([0, 1])
    return figure


def results(*chosen: str) -> list[Result]:
    """Evaluate findings of this file; `plus` has a picture."""
    own = {"plus": plus, "minus": minus, "raises": raises}
    picture = Figure(name="line", labels=("plus",), caption="A line, $a = 1$.", draw=drawn, finding=plus)
    return [evaluate(Entry(own[name], sections()[3], picture if name == "plus" else None)) for name in chosen]


def test_what_raises_fails() -> None:
    """A finding that raises has failed, and says why."""
    (result,) = results("raises")
    assert not result.holds
    assert result.failure == "ZeroDivisionError: no <number>"


def test_a_picture_that_cannot_be_drawn_fails() -> None:
    """A finding whose picture raises has failed even though its number is right."""
    broken = Figure(name="line", labels=("plus",), caption="", draw=raises.measure, finding=plus)
    assert not evaluate(Entry(plus, sections()[3], broken)).holds


def test_progress_is_reported() -> None:
    """The report hears of every finding before it is measured."""
    heard: list[tuple[int, int]] = []
    evaluate_all([Entry(plus, sections()[3]), Entry(minus, sections()[3])], lambda done, of: heard.append((done, of)))
    assert heard == [(0, 2), (1, 2)]


def test_page_is_well_formed_and_alone() -> None:
    """Tags close in order, addresses are on the page, in its folder or embedded, none occurs twice."""
    reader = Links(page(results("plus", "minus", "minus", "raises")))
    assert reader.in_order
    assert not reader.open
    assert len(set(reader.places)) == len(reader.places)
    for source in reader.referred:
        inside = source.startswith("#") and source[1:] in reader.places
        assert inside or source.startswith(("data:image/", "figures/line.")) or source == "findings.json", source


def test_page_says_what_was_found() -> None:
    """Claim, verdict, correction, numbers and failure stand on the page."""
    text = page(results("plus", "minus", "raises"), "Only a part.")
    report = ["1 of 3 fail", "correction holds", "It is wrong.", "Right:</strong> right", Verdict.FALSE.meaning]
    report += ["1.0e-16", "1.0e-12", "inf", "Only a part.", "a &lt; b", "no &lt;number&gt;"]
    report += ["S1", "one sum", "A line, <math"]
    assert [words for words in report if words not in text] == []


def test_page_has_no_script_and_no_network() -> None:
    """Nothing is loaded, and no script runs."""
    text = page(results("plus", "minus"))
    assert "<script" not in text
    assert set(re.findall(r"https?://[^\s\"'<]+", text)) <= {"http://www.w3.org/1998/Math/MathML"}


def test_letters_of_a_style_are_characters() -> None:
    """Double-struck, fraktur, script and bold letters do not rely on an attribute that browsers have dropped."""
    text = html.unescape(to_html(r"$\mathbb R\mathfrak d\mathcal{U}\mathbf M\mathfrak{C}$"))
    assert "mathvariant" not in text
    for character in ("\u211d", "\U0001d521", "\U0001d4b0", "\U0001d40c", "\u212d"):
        assert character in text


def test_names_of_functions_stand_apart() -> None:
    """A thin space follows the name of a function, but not before a bracket."""
    assert to_html(r"$\dim\mathfrak g$").count("<mspace") == 1
    assert to_html(r"$\exp(x)$").count("<mspace") == 0


@pytest.mark.parametrize("text", ["costs 5 $", r"$\foo x$"])
def test_what_is_no_formula_is_refused(text: str) -> None:
    """A lone dollar sign and an unknown command are refused."""
    with pytest.raises(ValueError, match="formula"):
        to_html(text)


@pytest.mark.parametrize("entry", entries(), ids=lambda entry: entry.finding.label)
def test_formulas_are_known(entry: Entry) -> None:
    """The texts of every finding can be shown, and have neither an em dash nor an empty claim."""
    finding = entry.finding
    texts = [finding.claim, finding.source, finding.corrected or "", entry.figure.caption if entry.figure else ""]
    assert finding.claim
    for text in texts:
        assert "\u2014" not in text
        to_html(text)


def test_folder(tmp_path: Path) -> None:
    """The page, the findings as data and the pictures are written; a second run writes over them."""
    folder = tmp_path / "new" / "page"
    for _ in range(2):
        check_folder(folder)
        write_folder(folder, results("plus", "minus", "raises"))
    files = sorted(str(path.relative_to(folder)) for path in folder.rglob("*.*"))
    assert files == ["figures/line.pdf", "figures/line.png", "figures/line.svg", "findings.json", "index.html"]
    report = json.loads((folder / "findings.json").read_text())
    assert [row["label"] for row in report] == ["plus", "minus", "raises"]
    assert [row["holds"] for row in report] == [True, True, False]
    assert [row["verdict"] for row in report] == ["right as printed", "false", "right as printed"]
    assert (report[0]["measured"], report[1]["printed_measured"], report[2]["measured"]) == (1e-16, "inf", None)
    keys = {"kind", "claim", "verdict", "corrected", "tolerance", "seconds", "source", "errata", "note", "figure"}
    assert keys <= set(report[0])


def test_foreign_files_stay(tmp_path: Path) -> None:
    """What the user adds to the folder of a page is not touched."""
    write_folder(tmp_path, results("minus"))
    (tmp_path / "notes.txt").write_text("mine")
    check_folder(tmp_path)
    write_folder(tmp_path, results("minus"))
    assert (tmp_path / "notes.txt").read_text() == "mine"


@pytest.mark.parametrize("name", ["index.html", "thesis.tex"])
def test_foreign_folder_is_refused(name: str, tmp_path: Path) -> None:
    """A folder with other files is refused, also if one of them is called like the page."""
    (tmp_path / name).write_text("<html>mine</html>")
    with pytest.raises(FileExistsError, match="Choose an empty or a new one with -o"):
        check_folder(tmp_path)


def test_a_file_as_folder_is_refused(tmp_path: Path) -> None:
    """A path that is a file is refused."""
    (tmp_path / "paper").write_text("")
    with pytest.raises(NotADirectoryError, match="Choose another one with -o"):
        check_folder(tmp_path / "paper")


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
