"""`nonholo paper`: the page that it writes, what it prints, how it ends."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import Result as Ended

import nonholo_paper
from nonholo_paper import Entry, Measured, Verdict, _registry, _run, finding, sections

Command = Callable[..., Ended]


@finding(
    "right.eqn",
    "equation",
    "Section 4, equation",
    "\u201c$1 = 2$\u201d",
    verdict=Verdict.MISPRINT,
    corrected="$1 = 1$",
    errata=("S14",),
    tolerance=1e-45,
)
def right() -> Measured:
    """Hold."""
    return Measured(0.0, 1.0)


@finding("wrong.eqn", "equation", "Section 4, equation", "$1 = 2$", tolerance=1e-45)
def wrong() -> Measured:
    """Fail."""
    return Measured(1.0)


@pytest.fixture(autouse=True)
def _two_findings(monkeypatch: pytest.MonkeyPatch) -> None:
    found = (Entry(right, sections()[3]), Entry(wrong, sections()[3]))
    for module in (nonholo_paper, _registry):
        monkeypatch.setattr(module, "entries", lambda: found)


def labels(folder: str) -> list[str]:
    """Return the labels of the findings that were kept."""
    return [row["label"] for row in json.loads(Path(folder, "findings.json").read_text())]


def test_a_finding_that_fails_ends_the_command_with_1(nonholo: Command) -> None:
    """The page is written all the same, and the finding that fails is named."""
    ended = nonholo("paper")
    assert ended.exit_code == 1
    assert "1 of 2 findings fail: wrong.eqn." in ended.stderr
    assert labels("paper") == ["right.eqn", "wrong.eqn"]


def test_findings_that_hold_end_the_command_with_0(nonholo: Command) -> None:
    """With --only the page holds what was chosen, by label or by row of the errata, and each finding has a line."""
    for number, name in enumerate(("right.eqn", "S14")):
        ended = nonholo("paper", "-o", f"part{number}", "--only", name)
        assert ended.exit_code == 0, ended.output
        assert "right.eqn" in ended.stdout
        assert "misprint" in ended.stdout
        assert f"part{number}/index.html" in ended.stdout
        assert labels(f"part{number}") == ["right.eqn"]
        assert f"chosen with --only: {name}." in Path(f"part{number}", "index.html").read_text()


def test_a_rerun_writes_over_its_own_page(nonholo: Command) -> None:
    """The second page replaces the first."""
    nonholo("paper", "--only", "wrong.eqn")
    assert nonholo("paper", "--only", "right.eqn").exit_code == 0
    assert labels("paper") == ["right.eqn"]


def test_an_unknown_label_is_refused(nonholo: Command) -> None:
    """An unknown label ends with code 2 and near labels; nothing is measured or written."""
    ended = nonholo("paper", "--only", "rigth.eqn")
    assert ended.exit_code == 2
    assert "no finding 'rigth.eqn'. Did you mean right.eqn" in ended.stderr
    assert not Path("paper").exists()


def test_a_foreign_folder_is_refused_before_any_work(nonholo: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder with files of the user ends with code 2 and the remedy."""
    monkeypatch.setattr(_run, "evaluate", lambda _: pytest.fail("measured"))
    Path("paper").mkdir()
    Path("paper/thesis.tex").write_text("mine")
    ended = nonholo("paper")
    assert ended.exit_code == 2
    assert "Choose an empty or a new one with -o" in ended.stderr


def test_help_loads_nothing_heavy() -> None:
    """`nonholo paper --help` loads none of the libraries that the findings need."""
    heavy = ("numpy", "jax", "mpmath", "flint", "jinja2", "latex2mathml", "matplotlib")
    code = (
        "import sys\nfrom nonholo.cli._app import app\n"
        "try:\n    app(['paper', '--help'])\nexcept SystemExit:\n"
        f"    sys.exit(' '.join(name for name in {heavy} if name in sys.modules) or 0)"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)  # noqa: S603
    assert ended.returncode == 0, ended.stderr
    assert "--only" in ended.stdout


def test_without_the_extra_the_command_names_it(nonholo: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """What `nonholo paper` needs beyond the core is an extra, and the command says which."""
    monkeypatch.setitem(sys.modules, "nonholo_paper", None)
    ended = nonholo("paper")
    assert ended.exit_code == 2
    assert "pip install 'nonholo[paper]'" in ended.stderr
