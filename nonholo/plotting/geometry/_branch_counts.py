"""The number of real values of the discrete sleigh, over the plane of its restricted momenta: three inside the deltoid.

Coordinates are those of the canonical frame, pi = p_theta + b p_1 and p_1.
"""

import dataclasses
from typing import Any, Unpack

from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from nonholo.analysis import Deltoid, deltoid
from nonholo.discrete import Discretization
from nonholo.orbit import Orbit
from nonholo.plotting import theme
from nonholo.plotting.parts import draw_orbit, own_orbit
from nonholo.plotting.sheets import ellipse, momenta_on_plane, on_plane


def draw_deltoid(axes: Axes, found: Deltoid) -> tuple[Polygon, Line2D, PathCollection]:
    """Draw the region with three real values, its boundary and its cusps."""
    around, cusps = on_plane(found.discrete.system, found.boundary(601)), on_plane(found.discrete.system, found.cusps)
    inside = axes.fill(*around.T, color=theme.INSIDE, linewidth=0, zorder=1)[0]
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
    axes.set(xlabel=r"$\pi = p_\theta + b\,p_1$", ylabel=r"momentum along the blade  $p_1$")
    theme.write_title(axes, title)
    theme.legend(axes, loc="lower left" if points_down else "upper left")


@dataclasses.dataclass(frozen=True)
class BranchCounts:
    """The artists of `branch_counts`; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        inside: The region with three real values.
        boundary: Its boundary, where two values meet.
        cusps: Where all three meet.
        resting: Turns without translation.
        level: The energy ellipse of the orbit.
        orbit: The momenta of the orbit, colored by time.
    """

    axes: Axes
    inside: Polygon
    boundary: Line2D
    cusps: PathCollection
    resting: Line2D
    level: Line2D | None
    orbit: PathCollection | None


@theme.styled
def branch_counts(
    discrete: Discretization, orbit: Orbit | None = None, axes: Axes | None = None, **look: Unpack[theme.Look]
) -> BranchCounts:
    r"""Draw where the discrete sleigh has one real value and where it has three: the deltoid.

    The plane is that of $\pi = p_\theta + bp_1$ and $p_1$. On the boundary two values meet, in the cusps three. The
    ellipse of turns without translation (for b = 0: $V_1 = 0$) is drawn dashed, the energy ellipse of the orbit solid.

    Args:
        discrete: A discretized sleigh with a not zero.
        orbit: An orbit of it.
        axes: Where to draw; a new figure by default.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: Another system or discretization, a = 0, an orbit of another discretized system.

    Example:
        >>> picture = nh.plot.branch_counts(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.5))
        >>> picture.cusps.get_offsets().shape
        (3, 2)
    """
    found = deltoid(discrete)
    own_orbit("plot.branch_counts(orbit=...)", orbit, discrete)
    axes = theme.axes_or_new(axes, (6.4, 5.4))
    inside, boundary, dots = draw_deltoid(axes, found)
    dashed: Any = {"color": theme.MUTED, "linewidth": 1.3, "dashes": (4, 3), "zorder": 2}
    resting = axes.plot(*on_plane(discrete.system, found.resting()).T, label="no translation", **dashed)[0]
    level = path = None
    if orbit is not None:
        around = ellipse(orbit.system, float(orbit.energy[0]))
        level = axes.plot(*around.T, color=theme.MUTED, linewidth=1.2, zorder=2, label="energy")[0]
        path = draw_orbit(axes, orbit, momenta_on_plane(orbit))
    name_inside(axes, found, "3 real values")
    dress(axes, found, "Real values")
    return BranchCounts(axes, inside, boundary, dots, resting, level, path)
