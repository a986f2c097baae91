"""`nonholo paper`: the page that it writes, what it prints, how it ends."""

import json
import sys
from pathlib import Path

import pytest
from commands import Command, assert_ends
from paper.test_page import minus, raises

import nonholo_paper
from nonholo_paper import Entry, _registry, _run, sections


@pytest.fixture(autouse=True)
def _two_findings(monkeypatch: pytest.MonkeyPatch) -> None:
    result = (Entry(minus, sections()[3]), Entry(raises, sections()[3]))
    for module in (nonholo_paper, _registry):
        monkeypatch.setattr(module, "entries", lambda: result)


def labels(folder: str) -> list[str]:
    """Return the labels of the findings that were kept."""
    return [row["label"] for row in json.loads(Path(folder, "findings.json").read_text())]


def test_a_finding_that_fails_ends_the_command_with_1(nonholo: Command) -> None:
    """The page is written all the same, and the finding that fails is named."""
    assert_ends(nonholo("paper"), 1, "1 of 2 findings fail: raises.")
    assert labels("paper") == ["minus", "raises"]


def test_findings_that_hold_end_the_command_with_0(nonholo: Command) -> None:
    """With --only the page holds what was chosen, by label or by row of the errata, and each finding has a line."""
    for number, name in enumerate(("minus", "S1")):
        ended = assert_ends(nonholo("paper", "-o", f"part{number}", "--only", name), 0)
        assert "minus" in ended.stdout
        assert "false" in ended.stdout
        assert f"part{number}/index.html" in ended.stdout
        assert labels(f"part{number}") == ["minus"]
        assert f"chosen with --only: {name}." in Path(f"part{number}", "index.html").read_text()


def test_a_rerun_writes_over_its_own_page(nonholo: Command) -> None:
    """The second page replaces the first."""
    nonholo("paper", "--only", "raises")
    assert nonholo("paper", "--only", "minus").exit_code == 0
    assert labels("paper") == ["minus"]


def test_an_unknown_label_is_refused(nonholo: Command) -> None:
    """An unknown label ends with code 2 and near labels; nothing is measured or written."""
    assert_ends(nonholo("paper", "--only", "minsu"), 2, "no finding 'minsu'. Did you mean minus")
    assert not Path("paper").exists()


def test_a_foreign_folder_is_refused_before_any_work(nonholo: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder with files of the user ends with code 2 and the remedy."""
    monkeypatch.setattr(_run, "evaluate", lambda _: pytest.fail("measured"))
    Path("paper").mkdir()
    Path("paper/thesis.tex").write_text("mine")
    assert_ends(nonholo("paper"), 2, "Choose an empty or a new one with -o")


def test_without_the_extra_the_command_names_it(nonholo: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """What `nonholo paper` needs beyond the core is an extra, and the command says which."""
    monkeypatch.setitem(sys.modules, "nonholo_paper", None)
    assert_ends(nonholo("paper"), 2, "pip install 'nonholo[paper]'")
