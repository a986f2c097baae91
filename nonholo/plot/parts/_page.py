"""Pages: a figure with a head and panels below it, and where it is saved."""

from pathlib import Path

from matplotlib import rcParams
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from nonholo.base.checks import error
from nonholo.base.checks import path as checked_path
from nonholo.io import check_file
from nonholo.plot import theme


def new_page(where: str, size: tuple[float, float], path: str | Path | None, *, overwrite: bool) -> Figure:
    """Return a figure for a head and panels; a path where it cannot be saved is refused in the name of `where`."""
    figure = theme.new_figure(size)
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
    """Write the head above the panels, with the title that is asked for, and save the figure."""
    line = rcParams["font.size"] / 72 / figure.get_figheight()  # in parts of the figure
    title = theme.asked("title", title)
    figure.text(0.012, 0.985, title, va="top", fontsize="xx-large", fontweight="bold")
    below = 0.985 - 2.8 * line * bool(title)
    if theme.asked("annotate", True):
        said = "      ".join(facts).replace("-", "\u2212")
        figure.text(0.012, below, said, va="top", color=theme.QUIET)
        below -= 1.6 * line
    layout = ConstrainedLayoutEngine(rect=(0.004, 0.004, 0.992, below), hspace=0.05, wspace=0.03)
    figure.set_layout_engine(layout)
    if path is not None:
        figure.savefig(path)
    return figure
