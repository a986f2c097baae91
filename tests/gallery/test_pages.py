"""The Python blocks of pages run: their assertions are the statements of the text around them. Named tests exist."""

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
PAGES = (
    "theory/euler-poincare-suslov.md",
    "theory/discrete-equations.md",
    "theory/energy-theorem.md",
    "theory/groups-and-systems.md",
    "theory/right-invariant.md",
    "how-to/choose-a-branch-rule.md",
    "how-to/choose-a-discretisation.md",
    "how-to/compare-motions.md",
    "how-to/differentiate-and-fit.md",
    "how-to/drive-a-robot.md",
    "how-to/gaits.md",
    "how-to/run-an-ensemble.md",
    "how-to/style-a-picture.md",
    "how-to/why-a-run-stopped.md",
)


LONG = ["how-to/choose-a-discretisation.md", "how-to/d*.md", "how-to/gaits.md"]


@pytest.mark.profile("paper", cases=LONG)
@pytest.mark.parametrize("page", PAGES)
def test_the_blocks_run(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The blocks of a page, one after another in one namespace, raise nothing."""
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(), re.DOTALL)
    names: dict[str, object] = {}
    monkeypatch.chdir(tmp_path)
    assert blocks
    for block in blocks:
        exec(compile(block, page, "exec"), names)  # noqa: S102


def test_tests_that_the_theory_names_exist() -> None:
    """Every page of the theory but its index names tests, and each file named is there."""
    pages = {path.name: path.read_text() for path in (DOCS / "theory").glob("*.md") if path.name != "index.md"}
    named = {name: re.findall(r"(?:tests|benchmarks)/[\w/]+\.py", text) for name, text in pages.items()}
    assert [name for name, files in named.items() if not files] == []
    assert [file for files in named.values() for file in files if not (DOCS.parent / file).exists()] == []
