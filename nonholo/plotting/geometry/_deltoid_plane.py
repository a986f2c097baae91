"""The plane of a sleigh's restricted momenta with its deltoid, inside which the discrete map has three real values.

Coordinates are those of the canonical frame, pi = p_theta + b p_1 and p_1. What is drawn on it is not decided here.
"""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from nonholo.analysis import Deltoid
from nonholo.plotting import theme
from nonholo.plotting.sheets import on_plane

INSIDE = "#dbe9f3"


def draw_deltoid(axes: Axes, found: Deltoid) -> tuple[Polygon, Line2D, PathCollection]:
    """Draw the region with three real values, its boundary and its cusps."""
    around, cusps = on_plane(found.discrete.system, found.boundary(601)), on_plane(found.discrete.system, found.cusps)
    inside = axes.fill(*around.T, color=INSIDE, linewidth=0, zorder=1)[0]
    boundary = axes.plot(*around.T, color=theme.DISCRETE, linewidth=1.8, zorder=2, label="two meet")[0]
    dots = axes.scatter(*cusps.T, s=34, color=theme.DISCRETE, zorder=4, label="three meet")
    return inside, boundary, dots


def name_inside(axes: Axes, found: Deltoid, words: str) -> None:
    """Write words into the region with three real values."""
    x, y = on_plane(found.discrete.system, found.cusps).T @ [0.4, 0.3, 0.3]
    look: Any = {"ha": "center", "va": "center", "color": theme.DISCRETE, "fontweight": "bold", "zorder": 5}
    axes.annotate(words, (x, y), **look)


def dress(axes: Axes, found: Deltoid, title: str) -> None:
    """Name the axes; the corners beside the long cusp are free, for the legend and for words."""
    cusps = on_plane(found.discrete.system, found.cusps)
    points_down = bool(cusps[0, 1] < cusps[1, 1])
    side, anchor = (0.03, "left") if points_down else (0.97, "right")
    axes.margins(0.1)
    axes.text(side, 0.96, "1 real value", transform=axes.transAxes, ha=anchor, va="top", fontweight="bold")
    axes.set(xlabel=r"$\pi = p_\theta + b\,p_1$", ylabel=r"momentum along the blade  $p_1$", title=title)
    axes.legend(loc="lower left" if points_down else "upper left")
