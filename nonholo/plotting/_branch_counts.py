"""How many real values the discrete sleigh has, over the plane of its restricted momenta."""

import dataclasses
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from nonholo._types import Float
from nonholo.analysis import deltoid
from nonholo.discrete import Discretization
from nonholo.orbit import Orbit
from nonholo.plotting import _theme as theme
from nonholo.plotting._momentum_locus import own_orbit
from nonholo.plotting._thinning import evenly_in_box

_INSIDE = "#dbe9f3"
_MOST_DOTS = 1500


@dataclasses.dataclass(frozen=True)
class BranchCounts:
    """What `branch_counts` drew; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        inside: The region with three real values.
        boundary: Its boundary, where two values meet.
        cusps: Where all three meet.
        resting: Turns without translation.
        level: The energy ellipse of the orbit.
        orbit: The momenta of the orbit, coloured by time.
    """

    axes: Axes
    inside: Polygon
    boundary: Line2D
    cusps: PathCollection
    resting: Line2D
    level: Line2D | None
    orbit: PathCollection | None


@theme.styled
def branch_counts(discrete: Discretization, orbit: Orbit | None = None, axes: Axes | None = None) -> BranchCounts:
    r"""Draw where the discrete sleigh has one real value and where it has three: the deltoid.

    The plane is that of $\pi = p_\theta + bp_1$ and $p_1$. On the boundary two values meet, in the cusps three. The
    ellipse of turns without translation (for b = 0: $V_1 = 0$) is drawn dashed, the energy ellipse of the orbit solid.

    Args:
        discrete: A discretised sleigh with a not zero.
        orbit: An orbit of it.
        axes: Where to draw; a new figure by default.

    Raises:
        ValueError: Another system or discretisation, a = 0, an orbit of another discretised system.

    Example:
        >>> picture = nh.plot.branch_counts(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.5))
        >>> picture.cusps.get_offsets().shape
        (3, 2)
    """
    found = deltoid(discrete)
    own_orbit("plot.branch_counts(orbit=...)", orbit, discrete)
    axes = theme.axes_or_new(axes, (6.4, 5.4))
    reduce = np.asarray(discrete.system.frame_map).T
    around, cusps = found.boundary(601) @ reduce, found.cusps @ reduce
    inside = axes.fill(*around.T, color=_INSIDE, linewidth=0, zorder=1)[0]
    boundary = axes.plot(*around.T, color=theme.DISCRETE, linewidth=1.8, zorder=2, label="two meet")[0]
    dots = axes.scatter(*cusps.T, s=34, color=theme.DISCRETE, zorder=4, label="three meet")
    look = {"color": theme.MUTED, "linewidth": 1.3, "dashes": (4, 3), "zorder": 2}
    resting = axes.plot(*(found.resting() @ reduce).T, label="no translation", **look)[0]
    level = path = None
    if orbit is not None:
        level = _level(axes, orbit)
        path = _orbit(axes, orbit)
    _name(axes, cusps.T @ [0.2, 0.4, 0.4], "3 real values")
    _dress(axes, bool(cusps[0, 1] < cusps[1, 1]))
    return BranchCounts(axes, inside, boundary, dots, resting, level, path)


def _level(axes: Axes, orbit: Orbit) -> Line2D:
    angle = np.linspace(0.0, 2 * np.pi, 361)
    half_axes = np.linalg.cholesky(np.asarray(orbit.system.canonical.constrained_inertia))
    x, y = np.sqrt(2 * orbit.energy[0]) * half_axes @ np.array([np.cos(angle), np.sin(angle)])
    return axes.plot(x, y, color=theme.MUTED, linewidth=1.2, zorder=2, label="energy")[0]


def _orbit(axes: Axes, orbit: Orbit) -> PathCollection:
    momentum = orbit.reduced_momentum
    chosen = evenly_in_box(momentum, _MOST_DOTS)
    colours: Any = {"c": orbit.time[chosen], "cmap": theme.TIME, "norm": theme.time_scale(orbit)}
    size = theme.dot_size(len(orbit)) + 6
    return axes.scatter(*momentum[chosen].T, s=size, linewidths=0, zorder=6, label="orbit", **colours)


def _name(axes: Axes, place: Float[np.ndarray, "2"], words: str) -> None:
    look: Any = {"ha": "center", "va": "center", "color": theme.DISCRETE, "fontweight": "bold", "zorder": 5}
    axes.annotate(words, (place[0], place[1]), **look)


def _dress(axes: Axes, points_down: bool) -> None:
    """Name the axes; the corners beside the long cusp are free."""
    side, anchor = (0.03, "left") if points_down else (0.97, "right")
    axes.margins(0.1)
    axes.text(side, 0.96, "1 real value", transform=axes.transAxes, ha=anchor, va="top", fontweight="bold")
    axes.set(xlabel=r"$\pi = p_\theta + b\,p_1$", ylabel=r"momentum along the blade  $p_1$")
    axes.set_title("Real values")
    axes.legend(loc="lower left" if points_down else "upper left")
