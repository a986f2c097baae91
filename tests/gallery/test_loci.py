"""The page of loci: it is drawn, with six panels."""

from scripts import script


def test_page_is_drawn() -> None:
    """A coarse page has two panels in space and four in the plane, and renders."""
    figure = script("docs/gallery/loci.py").draw(resolution=6)
    assert [axes.name for axes in figure.axes] == ["3d", "3d"] + 4 * ["rectilinear"]
    figure.canvas.draw()
