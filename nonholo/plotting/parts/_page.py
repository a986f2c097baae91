"""Pages: a figure with a head and panels below it, and where it is saved."""

from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from nonholo.base.checks import error
from nonholo.base.checks import path as checked_path
from nonholo.io import check_file

_HEAD = 0.722  # inches


def new_page(where: str, size: tuple[float, float], path: str | Path | None, *, overwrite: bool) -> Figure:
    """Return a figure with room for a head; a path where it cannot be saved is refused in the name of `where`."""
    below_head = 1 - _HEAD / size[1]
    layout = ConstrainedLayoutEngine(rect=(0.004, 0.004, 0.992, below_head), hspace=0.05, wspace=0.03)
    figure = Figure(figsize=size, layout=layout)
    if path is not None:
        _check_suffix(figure, path, f"{where}(path=...)")
        check_file(path, overwrite=overwrite, where=f"{where}(path=...)")
    return figure


def _check_suffix(figure: Figure, path: str | Path, where: str) -> None:
    """Refuse a path whose suffix is no picture format."""
    known = figure.canvas.get_supported_filetypes()
    if checked_path(where, path).suffix[1:].lower() not in known:
        remedy = "Use a path that ends in .png, .svg or .pdf."
        raise error(where, "end in a picture format", f"{str(path)!r}", remedy)


def finish_page(figure: Figure, title: str, facts: list[str], path: str | Path | None) -> Figure:
    """Write the head above the panels and save the figure."""
    width, height = figure.get_size_inches()
    left = 0.156 / width
    figure.text(left, 1 - 0.114 / height, title, va="top", fontsize=17, fontweight="bold")
    said = "      ".join(facts).replace("-", "\u2212")
    figure.text(left, 1 - 0.5016 / height, said, va="top", fontsize=10.5, color="#555a62")
    if path is not None:
        figure.savefig(path)
    return figure
