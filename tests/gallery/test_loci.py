"""The page of loci: it is drawn, with six panels."""

import importlib.util
from pathlib import Path

SCRIPT = Path(__file__).parents[2] / "docs" / "gallery" / "loci.py"


def test_page_is_drawn() -> None:
    """A coarse page has two panels in space and four in the plane, and renders."""
    spec = importlib.util.spec_from_file_location("loci", SCRIPT)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    figure = module.draw(resolution=6)
    assert [axes.name for axes in figure.axes] == ["3d", "3d"] + 4 * ["rectilinear"]
    figure.canvas.draw()
