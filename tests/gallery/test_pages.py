"""The Python blocks of pages run: their assertions are the statements of the text around them. Named tests exist."""

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
PAGES = (
    "index.md",
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
    "how-to/events-and-sections.md",
    "how-to/explore.md",
    "how-to/export-poses.md",
    "how-to/gaits.md",
    "how-to/linearize.md",
    "how-to/make-a-dataset.md",
    "how-to/run-a-sweep.md",
    "how-to/run-an-ensemble.md",
    "how-to/run-for-days.md",
    "how-to/steer.md",
    "how-to/style-a-picture.md",
    "how-to/why-a-run-stopped.md",
)
ELSEWHERE = {  # pages whose blocks run with what stands around them, and where
    "how-to/beyond-one-machine.md": "ensembles/test_cluster.py",
    "how-to/define-your-own-system.md": "testing/test_how_to.py",
}
NOTEBOOKS = {"how-to/steer.md", "how-to/differentiate-and-fit.md", "how-to/gaits.md"}
LONG = {
    "how-to/events-and-sections.md",
    "how-to/style-a-picture.md",
    "how-to/run-a-sweep.md",
    "how-to/choose-a-discretisation.md",
    "how-to/drive-a-robot.md",
    "how-to/linearize.md",
    "how-to/make-a-dataset.md",
    "how-to/run-for-days.md",
}


def _profile(page: str) -> list[pytest.MarkDecorator]:
    """Return where a page runs: that of the default run has no mark; those that are notebooks, too, run as these."""
    if page in NOTEBOOKS:
        return [pytest.mark.profile("long", instead="test_notebooks_run")]
    return [pytest.mark.profile("paper", instead="test_every_page_with_blocks_is_run")] if page in LONG else []


@pytest.mark.parametrize("page", [pytest.param(page, marks=_profile(page), id=page) for page in PAGES])
def test_the_blocks_run(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The blocks of a page, one after another in one namespace, raise nothing."""
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(), re.DOTALL)
    names: dict[str, object] = {}
    monkeypatch.chdir(tmp_path)
    assert blocks
    for block in blocks:
        exec(compile(block, page, "exec"), names)  # noqa: S102


def test_every_page_with_blocks_is_run() -> None:
    """No block of Python in the docs is left out; those of tutorials run when the site is built."""
    written = {str(path.relative_to(DOCS)) for path in DOCS.rglob("*.md") if "```python\n" in path.read_text()}
    assert written == {*PAGES, *ELSEWHERE}
    for page, test in ELSEWHERE.items():
        assert Path(page).name in (Path(__file__).parents[1] / test).read_text()


def test_tests_that_the_theory_names_exist() -> None:
    """Every page of the theory but its index names tests, and each file named is there."""
    pages = {path.name: path.read_text() for path in (DOCS / "theory").glob("*.md") if path.name != "index.md"}
    named = {name: re.findall(r"(?:tests|benchmarks)/[\w/]+\.py", text) for name, text in pages.items()}
    assert [name for name, files in named.items() if not files] == []
    assert [file for files in named.values() for file in files if not (DOCS.parent / file).exists()] == []
