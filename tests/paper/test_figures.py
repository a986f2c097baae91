"""The figures: their list, their files, and that their numbers notice a wrong picture."""

import dataclasses
import io

import numpy as np
import pytest
from matplotlib.figure import Figure as MatplotlibFigure

from nonholo_paper._checklist import sections
from nonholo_paper._formulas import to_html
from nonholo_paper.figures import Figure, figures
from nonholo_paper.figures import cubic as cubic_figure
from nonholo_paper.figures import quat_dots as dots_figure
from nonholo_paper.figures import st1 as section_figure
from nonholo_paper.figures import suslov as suslov_figure

OF_THE_PAPER = {label.removesuffix(".fig") for part in sections() for label in part.labels if label.endswith(".fig")}
DESCRIBED = {"naive_spiral", "circle", "deltoid", "four_branches"}
FIGURES = figures()


def test_every_figure_is_drawn() -> None:
    """The figures are those of the paper, by their labels, and four that it describes in words."""
    assert set(FIGURES) == OF_THE_PAPER | {"quat_dots"} | DESCRIBED
    assert all(name == figure.name for name, figure in FIGURES.items())


def test_labels_are_known() -> None:
    """The labels of a figure, and the one of its finding, are labels or claims of the checklist."""
    reference = {label for part in sections() for label in (*part.labels, *part.claims)}
    assert {label for figure in FIGURES.values() for label in (*figure.labels, figure.finding.label)} <= reference
    assert {figure.finding.kind for figure in FIGURES.values()} == {"figure"}


@pytest.mark.profile("paper", keep=["st1", "generic_xy", "cusps", "mom_dynamics"])
@pytest.mark.parametrize("figure", FIGURES.values(), ids=FIGURES)
def test_axes_are_named(figure: Figure) -> None:
    """All axes with ticks have labels, and the caption and the claims can be shown."""
    drawn = figure.draw()
    assert isinstance(drawn, MatplotlibFigure)
    for axes in drawn.axes:
        assert axes.get_xlabel()
        assert axes.get_ylabel() or not len(axes.get_yticks())
    assert "<" in to_html(figure.caption)
    to_html(figure.finding.claim)


@pytest.mark.profile("paper", keep=["svg"])
@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_a_figure_can_be_saved(suffix: str) -> None:
    """A surface in space, of which a part is drawn in pixels, becomes a file of each format and of bounded size."""
    target = io.BytesIO()
    FIGURES["cubic"].draw().savefig(target, format=suffix)
    assert 10_000 < len(target.getvalue()) < 1_000_000


def test_a_shifted_dot_is_noticed() -> None:
    """The finding of the momentum dynamics fails if the dots are not where the flows end."""
    _, drawn = suslov_figure.picture()
    rows = np.array(drawn.stable.get_offsets())
    try:
        drawn.stable.set_offsets(rows + 1e-6)
        assert not suslov_figure.FIGURE.finding.holds(suslov_figure.FIGURE.finding.measure())
    finally:
        drawn.stable.set_offsets(rows)


def test_swapped_equilibria_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The finding of the discrete dynamics fails if filled and empty dots are exchanged."""
    drawn = dots_figure.picture()
    swapped = dataclasses.replace(drawn, stable=drawn.unstable, unstable=drawn.stable)
    monkeypatch.setattr(dots_figure, "picture", lambda: swapped)
    assert not dots_figure.FIGURE.finding.holds(dots_figure.FIGURE.finding.measure())


def test_another_inertia_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The finding of the cubic surface fails if the surface is that of another J."""
    monkeypatch.setattr(cubic_figure, "BODY", (1.0, 1.4, 1.0, 0.0))
    assert not cubic_figure.FIGURE.finding.holds(cubic_figure.FIGURE.finding.measure())


def test_another_section_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The finding of the circular section fails if it goes to another q0."""
    monkeypatch.setattr(section_figure, "LOW", 0.5)
    assert not section_figure.FIGURE.finding.holds(section_figure.FIGURE.finding.measure())
