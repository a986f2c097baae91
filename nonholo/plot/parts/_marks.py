"""Marks that several pictures share, on axes of the plane and of space: states in time, ends, a flow, equilibria."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from mpl_toolkits.mplot3d.art3d import Line3DCollection

from nonholo.base.types import Float, Int
from nonholo.orbit import AbstractOrbit, Orbit
from nonholo.plot import theme
from nonholo.plot.parts._thinning import MOST_DOTS, evenly_in_box, evenly_spread


def draw_in_time(
    axes: Any,
    orbit: AbstractOrbit,
    points: Float[np.ndarray, "K d"],
    states: Int[np.ndarray, "L"],
    *,
    zorder: float,
    size: float | None = None,
    label: str | None = None,
    whole: AbstractOrbit | None = None,
) -> Any:
    """Draw some states at their points in the colors of time: dots of a discrete orbit, a line of a flow.

    Args:
        axes: Where to draw.
        orbit: The orbit.
        points: A point of the plane or of space for each of its states.
        states: Which of them to draw.
        zorder: The layer.
        size: Area of the dots; by default by their number.
        label: Name of the dots; where it is given there are dots of any orbit.
        whole: The orbit whose colors these are, where `orbit` is a part of it.
    """
    points, time, own = points[states], orbit.time[states], theme.asked("color", None)
    colors = {"cmap": theme.TIME, "norm": theme.time_scale(orbit if whole is None else whole)} if own is None else {}
    if label is not None or orbit.is_discrete:
        size = theme.dot_size(len(orbit)) if size is None else size
        name = theme.asked("label", label or ("given poses" if orbit.is_measured else "discrete orbit"))
        colors |= {"c": time if own is None else [own], "label": name}
        return axes.scatter(*points.T, s=size, linewidths=0, zorder=zorder, **_flat(points), **colors)
    path = segments(points[:-1], points[1:], linewidth=2, zorder=zorder, **colors)
    path.set(label=theme.asked("label", "flow"), **({"array": time[1:]} if own is None else {"color": own}))
    axes.add_collection(path)
    return path


def draw_orbit(axes: Axes, orbit: Orbit, places: Float[np.ndarray, "K 2"]) -> Any:
    """Draw the states of a discrete orbit at their places over a picture of its map, as larger dots."""
    size = theme.dot_size(len(orbit)) + 6
    return draw_in_time(axes, orbit, places, evenly_in_box(places), zorder=6, size=size, label="orbit")


def draw_flow(axes: Any, points: Float[np.ndarray, "K d"]) -> Any:
    """Draw the path of a continuous motion beside an orbit, as a thin line."""
    drawn = points[evenly_spread(points, 10 * MOST_DOTS)]
    return axes.plot(*drawn.T, color=theme.CONTINUOUS, linewidth=1.0, zorder=4, label="continuous")[0]


def segments(feet: Float[np.ndarray, "L d"], tips: Float[np.ndarray, "L d"], **look: Any) -> LineCollection:
    """Return segments of the plane or of space, from each foot to its tip."""
    kind = Line3DCollection if feet.shape[1] == 3 else LineCollection
    return kind(list(np.stack([feet, tips], axis=1)), **look)


def draw_ends(axes: Any, points: Float[np.ndarray, "K d"], orbit: AbstractOrbit) -> Any:
    """Mark the first point, empty, and the last one, in the colors of the first and the last state."""
    rim = theme.end_colors(orbit)
    look: Any = {"facecolors": [theme.PAPER, rim[1]], "edgecolors": rim, "linewidths": 1.6, "zorder": 7}
    return axes.scatter(*points[[0, -1]].T, s=44, **look, **_flat(points))


def draw_equilibria(
    axes: Axes, points: Float[np.ndarray, "E 2"], reach: Float[np.ndarray, "2"], size: float
) -> tuple[PathCollection, PathCollection]:
    """Draw attracting equilibria, filled, their opposites, empty, and the line of both through the origin."""
    axes.plot(*np.stack([0 * reach, reach], axis=1), color=theme.STABLE, linewidth=0.9, zorder=2)
    axes.plot(*np.stack([0 * reach, -reach], axis=1), color=theme.UNSTABLE, linewidth=0.9, dashes=(5, 3), zorder=2)
    stable = axes.scatter(*points.T, s=size, color=theme.STABLE, zorder=5, label="stable")
    empty: Any = {"facecolors": theme.PAPER, "edgecolors": theme.UNSTABLE, "linewidths": 1.5}
    return stable, axes.scatter(*-points.T, s=size, zorder=5, label="unstable", **empty)


def _flat(points: Float[np.ndarray, "L d"]) -> dict[str, Any]:
    """Return what keeps dots in space from fading with their distance."""
    return {"depthshade": False} if points.shape[1] == 3 else {}
