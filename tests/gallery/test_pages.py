"""The Python blocks of pages run: their assertions are the statements of the text around them. Named tests exist."""

import re
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import xarray
from matplotlib.figure import Figure
from scripts import script

import nonholo as nh

DOCS = Path(__file__).parents[2] / "docs"
PAGES = (
    "index.md", "theory/euler-poincare-suslov.md", "theory/discrete-equations.md", "theory/energy-theorem.md",
    "theory/groups-and-systems.md", "theory/right-invariant.md", "how-to/choose-a-branch-rule.md",
    "how-to/choose-a-discretisation.md", "how-to/compare-motions.md", "how-to/differentiate-and-fit.md",
    "how-to/drive-a-robot.md", "how-to/events-and-sections.md", "how-to/explore.md", "how-to/export-poses.md",
    "how-to/gaits.md", "how-to/linearize.md", "how-to/make-a-dataset.md", "how-to/run-a-sweep.md",
    "how-to/run-an-ensemble.md", "how-to/run-for-days.md", "how-to/steer.md", "how-to/style-a-picture.md",
    "how-to/why-a-run-stopped.md",
)  # fmt: skip
ELSEWHERE = {  # pages whose blocks run with what stands around them, and where
    "how-to/beyond-one-machine.md": "ensembles/test_cluster.py",
    "how-to/define-your-own-system.md": "testing/test_how_to.py",
}
NOTEBOOKS = {"how-to/steer.md", "how-to/differentiate-and-fit.md", "how-to/gaits.md"}
LONG = {
    "how-to/events-and-sections.md", "how-to/style-a-picture.md", "how-to/run-a-sweep.md",
    "how-to/choose-a-discretisation.md", "how-to/drive-a-robot.md", "how-to/linearize.md",
    "how-to/make-a-dataset.md", "how-to/run-for-days.md",
}  # fmt: skip


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


GALLERY = script("docs/make_gallery.py")
CARDS = [name for names in GALLERY.SECTIONS.values() for name in names]
QUICK = ["sleigh_cusp", "gathering", "tumbling_body"]


@pytest.mark.profile("paper", keep=QUICK)
@pytest.mark.parametrize("name", CARDS)
def test_a_card_is_true_and_drawn(name: str) -> None:
    """What it measures is within its tolerance of what is known; a figure with something in each of its axes."""
    found, figure = GALLERY.load(name).numbers(), GALLERY.load(name).draw()
    assert found
    assert {
        what: value for what, (value, reference, allowed) in found.items() if not abs(value - reference) <= allowed
    } == {}
    assert isinstance(figure, Figure)
    assert all(axes.has_data() for axes in figure.axes)
    figure.canvas.draw()


def test_the_page_is_up_to_date() -> None:
    """The page is the one that `python docs/make_gallery.py` writes, and every picture on it is there."""
    assert GALLERY.PAGE.read_text("utf-8") == GALLERY.page()
    assert [name for name in (*CARDS, *GALLERY.STUDIES) if not (GALLERY.PICTURES / f"{name}.png").exists()] == []


def test_every_ready_system_and_script_has_its_place() -> None:
    """No ready system, and no script, is left out; there are 25 or more."""
    scripts = {path.stem for path in GALLERY.PAGE.parent.glob("[a-z]*.py")} - {"theory_pictures"}
    assert scripts == {*CARDS, *GALLERY.STUDIES}
    assert {*nh.examples.__all__} - {"Example"} <= set(CARDS)
    assert len(scripts) >= 25


SCRIPT = "docs/gallery/sleigh_turning.py"


@pytest.fixture(scope="module")
def found(script: ModuleType) -> xarray.Dataset:
    """The sweep on a coarse grid."""
    return script.swept(16)


def test_members_are_lost_above_the_curve_only(script: ModuleType, found: xarray.Dataset) -> None:
    """None below, most above."""
    below, above = script.lost(found)
    assert below == 0
    assert above > 0.8


def test_the_curve_has_no_kink(script: ModuleType) -> None:
    """Both closed forms agree where they meet, J = 2 m a^2, to first order."""
    bounds = script.bound(2 + np.array([-1e-4, 0.0, 1e-4]))
    assert abs(bounds[1] - np.sqrt(4.5)) < 1e-14
    assert abs(np.diff(bounds, 2)[0]) < 1e-8


def test_the_picture(script: ModuleType, found: xarray.Dataset, tmp_path: Path) -> None:
    """A map with the curve, and rows with the leading term."""
    figure = script.draw(found)
    assert [len(axes.get_lines()) for axes in figure.axes[:2]] == [1, 4]
    figure.savefig(tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 10_000
