"""Pages, figures with a head and panels below it; the view of a plane curve, and its enlarged detail in a corner."""

import weakref
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from nonholo.base.checks import error
from nonholo.base.checks import path as checked_path
from nonholo.base.types import Float
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
    suffixes = figure.canvas.get_supported_filetypes()
    if checked_path(where, path).suffix[1:].lower() not in suffixes:
        remedy = "Use a path that ends in .png, .svg or .pdf."
        raise error(where, "end in a picture format", f"{str(path)!r}", remedy)


def finish_page(figure: Figure, title: str, facts: list[str], path: str | Path | None) -> Figure:
    """Write the head above the panels, with the given title, and save the figure."""
    line = rcParams["font.size"] / 72 / figure.get_figheight()  # in parts of the figure
    title = theme.option("title", title)
    figure.text(0.012, 0.985, title, va="top", fontsize="xx-large", fontweight="bold")
    below = 0.985 - 2.8 * line * bool(title)
    if theme.option("annotate", True):
        words = "      ".join(facts).replace("-", "\u2212")
        figure.text(0.012, below, words, va="top", color=theme.QUIET)
        below -= 1.6 * line
    layout = ConstrainedLayoutEngine(rect=(0.004, 0.004, 0.992, below), hspace=0.05, wspace=0.03)
    figure.set_layout_engine(layout)
    if path is not None:
        figure.savefig(path)
    return figure


Square: TypeAlias = Float[np.ndarray, "2 2"]  # rows (x_min, x_max), (y_min, y_max)
_DETAILS: weakref.WeakKeyDictionary[Axes, tuple[Any, Any]] = weakref.WeakKeyDictionary()

_SMALL = 0.2  # a turn below this part of the picture is shown enlarged as a whole, else its cusp is
_NEAR_CUSP = 0.055  # part of the picture, to either side
_SIZE, _MARGIN = 0.40, 0.07  # of the enlarged detail, in parts of the picture


def fit_view(axes: Axes, points: Float[np.ndarray, "K 2"]) -> Square:
    """Let axes of one scale show the points, as large as their shape allows, with all that they show already."""
    box, square = axes.get_window_extent(), square_about(points)
    wide, extent = max(1.0, box.width / box.height), np.ptp(points, axis=0)
    half = 0.57 * max(extent[1], extent[0] / wide) * np.array([wide, 1.0])
    view = square if not half.any() else square.mean(axis=1)[:, None] + half[:, None] * [-1.0, 1.0]
    axes.margins(0.0)
    axes.update_datalim(view.T)
    axes.autoscale_view()
    axes.set(xlabel="$x$", ylabel="$y$", aspect="equal")
    return view


def square_about(points: Float[np.ndarray, "K d"]) -> Float[np.ndarray, "d 2"]:
    """Return a square with a margin about the points.

    Example:
        >>> square_about(np.array([[0.0, 0.0], [2.0, 1.0]])).round(2)
        array([[-0.14,  2.14],
               [-0.64,  1.64]])
    """
    low, high = points.min(axis=0), points.max(axis=0)
    reach = 0.57 * float((high - low).max()) or 1.0
    center = (low + high) / 2
    return np.stack([center - reach, center + reach], axis=1)


def detail(
    position: Float[np.ndarray, "K 2"], turning: Float[np.ndarray, "K"], cusp: Float[np.ndarray, "2"], view: Square
) -> tuple[slice, Square]:
    """Return the states and the square to enlarge: the turn, if it is small in the picture, else what is near the cusp.

    Args:
        position: Points of the curve.
        turning: Angular velocities there.
        cusp: A cusp of the curve.
        view: The view of the picture.
    """
    fast = np.flatnonzero(np.abs(turning) > 0.1 * np.abs(turning).max())
    turn = slice(fast[0], fast[-1] + 1)
    square = square_about(position[turn])
    side = np.ptp(view, axis=1).min()
    if np.ptp(square[0]) <= _SMALL * side:
        return turn, square
    reach = _NEAR_CUSP * side
    near = np.flatnonzero(np.abs(position - cusp).max(axis=1) < 1.5 * reach)
    return slice(near[0], near[-1] + 1), np.stack([cusp - reach, cusp + reach], axis=1)


def remove_detail(axes: Axes) -> None:
    """Remove the detail of a track to which another one comes."""
    for artist in _DETAILS.pop(axes, ()):
        artist.remove()


def corner_axes(axes: Axes, track: Float[np.ndarray, "L 2"], view: Square, near: Square) -> Axes:
    """Return axes that show the square `near` in the corner of `axes` where the fewest points are drawn."""
    points = (track - view[:, 0]) / np.ptp(view, axis=1)
    corners = [(x, y) for y in (0.95 - _SIZE, 0.02) for x in (0.98 - _SIZE, 0.02)]
    crowd = [np.sum(np.abs(points - corner - _SIZE / 2).max(axis=1) < _SIZE / 2 + _MARGIN) for corner in corners]
    inset = axes.inset_axes((*corners[int(np.argmin(crowd))], _SIZE, _SIZE), zorder=10)
    inset.set(xlim=near[0], ylim=near[1], xticks=[], yticks=[], aspect="equal", autoscale_on=False)
    inset.spines[:].set(visible=True, color=theme.MUTED)
    times = _SIZE * np.ptp(view, axis=1).min() / np.ptp(near[0])
    inset.set_title(
        f"enlarged {times:.{0 if times >= 9.5 else 1}f} times",
        loc="left",
        fontsize="medium",
        fontweight="normal",
        pad=4,
    )
    frame = axes.indicate_inset_zoom(inset, edgecolor=theme.MUTED, alpha=0.8)
    _DETAILS[axes] = inset, frame
    for connector in frame.connectors or ():
        connector.set_visible(False)
    return inset
