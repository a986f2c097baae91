"""The look of every picture: one palette, one style sheet, new axes. Nothing is drawn here.

Colors are from the palette of Okabe and Ito, legible to color-blind readers; the sheet is applied while drawing.
"""

import functools
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import matplotlib
import matplotlib.patheffects
import matplotlib.style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure

from nonholo.base.checks import instance
from nonholo.base.types import Float
from nonholo.orbit import AbstractOrbit, Orbit

STABLE = "#1a1a1a"
UNSTABLE = "#d55e00"
DISCRETE = "#0072b2"
CONTINUOUS = "#e69f00"
COMPONENTS = ("#0072b2", "#cc79a7", "#009e73", "#d55e00", "#56b4e9", "#1a1a1a")
LEVEL = "#c3c8d0"
INK = "#222222"
MUTED = "#8a8f98"
TIME = ListedColormap(matplotlib.colormaps["viridis"](np.linspace(0.0, 0.93, 256)), name="nonholo_time")
HALO = (matplotlib.patheffects.withStroke(linewidth=3, foreground="white"),)

_COMMANDS, _SIGNS = re.compile(r"\\[A-Za-z]+"), re.compile(r"[${}_^]")  # of formulas
_SETTLED = 0.01  # part of the largest momentum
_NARROW = 3.7  # inches
_RAISED = 24.0  # of a title above a legend, in points
_SHEET = Path(__file__).with_name("nonholo.mplstyle")
_P = ParamSpec("_P")
_R = TypeVar("_R")


def styled(draw: Callable[_P, _R]) -> Callable[_P, _R]:
    """Run a drawing function under the style sheet and restore all settings afterwards."""

    @functools.wraps(draw)
    def under_sheet(*arguments: _P.args, **named: _P.kwargs) -> _R:
        with matplotlib.style.context(_SHEET):
            return draw(*arguments, **named)

    return under_sheet


def axes_or_new(axes: Axes | None, size: tuple[float, float] = (6.0, 5.0)) -> Axes:
    """Return the given axes, or those of a new figure that no window manager knows."""
    if axes is None:
        return Figure(figsize=size, layout="constrained").add_subplot()
    return instance("plot(axes=...)", axes, Axes, "be axes of matplotlib", "Pass axes, or None.")


def time_scale(orbit: AbstractOrbit) -> Normalize:
    """Return the map from times of an orbit to the colors of `TIME`.

    The colors are spent on the transition and as long again, so that they do not fade in the uniform motion of a long
    run; earlier and later times have the colors of the ends.
    """
    first, last = float(orbit.time.min()), float(orbit.time.max())
    momentum = orbit.reduced_momentum if isinstance(orbit, Orbit) else orbit.body_velocity
    near = _SETTLED * np.abs(momentum).max(initial=0.0)
    left = np.flatnonzero(np.abs(momentum - momentum[0]).max(axis=1, initial=0.0) > near)
    settled = np.flatnonzero(np.abs(momentum - momentum[-1]).max(axis=1, initial=0.0) > near)
    if len(left) and len(settled) and left[0] <= settled[-1]:
        begin, end = sorted((float(orbit.time[left[0]]), float(orbit.time[settled[-1]])))
        half = (end - begin) / 2
        first, last = max(first, begin - half), min(last, end + half)
    return Normalize(first, last if last > first else first + 1.0, clip=True)


def component_colors(count: int) -> list[Any]:
    """Return colors for this many lines: the palette, or shades from one end to the other if they are too many."""
    if count <= len(COMPONENTS):
        return list(COMPONENTS[:count])
    return [tuple(shade) for shade in matplotlib.colormaps["plasma"](np.linspace(0.0, 0.88, count))]


def end_colors(orbit: AbstractOrbit) -> list[tuple[float, float, float, float]]:
    """Return the colors of the first and the last state."""
    first, last = TIME(time_scale(orbit)(orbit.time[[0, -1]]))
    return [tuple(first), tuple(last)]


component_colours, end_colours = component_colors, end_colors  # names they had, which still work


def mark_time(axes: Axes, orbit: AbstractOrbit) -> LineCollection | None:
    """Lay the colors of time along the bottom of axes whose abscissa is time: the key to the other panels."""
    if len(orbit) < 2:
        return None
    scale = time_scale(orbit)
    colored = scale.inverse(np.linspace(0.0, 1.0, 129))
    ends = np.unique(np.concatenate([orbit.time[[0, -1]], colored]))
    ground = np.stack([ends, np.zeros_like(ends)], axis=-1)
    look: Any = {"cmap": TIME, "norm": scale, "linewidth": 4, "capstyle": "butt", "clip_on": False, "zorder": 5}
    strip = LineCollection(pieces(ground), transform=axes.get_xaxis_transform())
    strip.set(array=(ends[:-1] + ends[1:]) / 2, **look)
    axes.add_collection(strip, autolim=False)
    return strip


def pieces(points: Float[np.ndarray, "K 2"]) -> list[Float[np.ndarray, "2 2"]]:
    """Return the pieces of a polygon, from each point to the next, for a `LineCollection`."""
    return list(np.stack([points[:-1], points[1:]], axis=1))


def dot_size(states: int) -> float:
    """Return the area of the dots of a discrete orbit: the fewer, the larger."""
    return 20.0 if states <= 100 else 10.0


def is_narrow(axes: Axes) -> bool:
    """Tell whether axes are too narrow for a title and a legend in one line."""
    box = axes.get_window_extent()
    is_square = axes.get_aspect() == 1.0 and axes.get_adjustable() == "box"
    side = min(box.width, box.height) if is_square else box.width
    return side < _NARROW * axes.figure.dpi


def legend_above(axes: Axes) -> None:
    """Put a one-line legend at the right above the axes, in the line of the title; inside narrow axes instead.

    Where both do not fit into one line the title moves up.
    """
    handles, labels = axes.get_legend_handles_labels()
    if not handles:
        return
    if is_narrow(axes):
        axes.legend(handles, labels, loc="best", fontsize="small", frameon=True, framealpha=0.8, edgecolor="none")
    else:
        close = {"handlelength": 0.8, "columnspacing": 0.7} if len(handles) > 3 else {}
        title = axes.get_title(loc="left")
        if _length(title, labels) > axes.get_window_extent().width / axes.figure.dpi:
            axes.set_title(title, pad=_RAISED)
        axes.legend(handles, labels, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(handles), **close)


def _length(title: str, labels: list[str]) -> float:
    """Return about how long a title and a legend in one line are, in inches."""
    seen = (_SIGNS.sub("", _COMMANDS.sub("x", label)) for label in labels)
    return 0.085 * len(title) + sum(0.067 * len(label) + 0.3 for label in seen) if title else 0.0
