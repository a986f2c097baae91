"""Marks that several pictures share, in the plane and in space, and which states are drawn: enough for the eye.

Curves are thinned evenly along the drawn line, so that a short transition in a long run is not lost.
"""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from mpl_toolkits.mplot3d.art3d import Line3DCollection

from nonholo.base.types import Float, Int
from nonholo.orbit import AbstractOrbit, Orbit
from nonholo.plot import theme

MOST_DOTS = 1500  # of most pictures


def evenly_spread(points: Float[np.ndarray, "K d"], most: int = MOST_DOTS) -> Int[np.ndarray, "L"]:
    """Return at most `most` + 2 indices, evenly along the polygon through the points, both ends kept.

    Example:
        >>> evenly_spread(np.array([[0.0], [0.0], [0.0], [1.0], [2.0]]), most=3).tolist()
        [0, 3, 4]
    """
    if len(points) <= most:
        return np.arange(len(points))
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    distance = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.searchsorted(distance, np.linspace(0.0, distance[-1], most))
    return np.unique(np.concatenate([[0], at, [len(points) - 1]]))


def evenly_in_box(points: Float[np.ndarray, "K d"], most: int = MOST_DOTS) -> Int[np.ndarray, "L"]:
    """Do the same after scaling each coordinate to its own range, as axes do."""
    extent = np.ptp(points, axis=0)
    return evenly_spread(points / np.where(extent > 0, extent, 1.0), most)


def some_states(orbit: Orbit, most: int) -> Orbit:
    """Return the orbit at about this many states, evenly in momentum and, as momentum may be conserved, in time."""
    evenly_in_time = np.linspace(0, len(orbit) - 1, min(most, len(orbit))).round().astype(int)
    return orbit.chosen(np.union1d(evenly_spread(orbit.reduced_momentum, most), evenly_in_time))


def transition(orbit: Orbit) -> int:
    """Return the state about which the momentum changes fastest; 0 if it does not change."""
    momentum = orbit.reduced_momentum
    change = np.abs(np.diff(momentum, axis=0)).sum(axis=1)
    moving = len(change) > 0 and change.max() > 1e-9 * np.abs(momentum).max(initial=0.0)
    return int(change.argmax()) if moving else 0


def turn_per_state(orbit: Orbit) -> float:
    """Return the largest angle, in radians, between saved states: greatest angular speed times distance in time."""
    if len(orbit) < 2:
        return 0.0
    speed = orbit.system.group.angle(some_states(orbit, 1000).body_velocity).max()
    return float(speed * np.abs(np.diff(orbit.time)).max())


def window(orbit: Orbit, step: float, finest: float, most: int) -> slice:
    """Return at most `most` states about the transition; they start at the first state if they can.

    Args:
        orbit: The orbit.
        step: The motion in a picture between two states.
        finest: The least motion between two of them.
        most: Number of states.
    """
    stride = max(1, int(finest / step)) if step > 0 else max(1, len(orbit) // most)
    span = stride * most
    if len(orbit) <= span:
        return slice(0, len(orbit), stride)
    first = min(max(0, transition(orbit) - span // 2), len(orbit) - span)
    return slice(first, first + span, stride)


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
    points, time, own = points[states], orbit.time[states], theme.option("color", None)
    colors = {"cmap": theme.TIME, "norm": theme.time_scale(orbit if whole is None else whole)} if own is None else {}
    if label is not None or orbit.is_discrete:
        size = theme.dot_size(len(orbit)) if size is None else size
        name = theme.option("label", label or ("given poses" if orbit.is_measured else "discrete orbit"))
        colors |= {"c": time if own is None else [own], "label": name}
        return axes.scatter(*points.T, s=size, linewidths=0, zorder=zorder, **_flat(points), **colors)
    path = segments(points[:-1], points[1:], linewidth=2, zorder=zorder, **colors)
    path.set(label=theme.option("label", "flow"), **({"array": time[1:]} if own is None else {"color": own}))
    axes.add_collection(path)
    return path


def draw_orbit(axes: Axes, orbit: Orbit, places: Float[np.ndarray, "K 2"]) -> Any:
    """Draw the states of a discrete orbit at their places over a picture of its map, as larger dots."""
    size = theme.dot_size(len(orbit)) + 6
    return draw_in_time(axes, orbit, places, evenly_in_box(places), zorder=6, size=size, label="orbit")


def draw_flow(axes: Any, points: Float[np.ndarray, "K d"]) -> Any:
    """Draw the path of a continuous motion beside an orbit, as a thin line."""
    line = points[evenly_spread(points, 10 * MOST_DOTS)]
    return axes.plot(*line.T, color=theme.CONTINUOUS, linewidth=1.0, zorder=4, label="continuous")[0]


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
