"""The path in space of the point of the body at the origin of its frame, for motions of the plane and of space."""

import dataclasses
from typing import Any, Unpack

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from nonholo.base.checks import error, shown
from nonholo.base.types import Float
from nonholo.groups import SE
from nonholo.orbit import AbstractOrbit, Orbit
from nonholo.plotting import parts, theme

_BODIES = 14  # places at which the axes of the body are drawn
_ARM = 0.055  # of a body axis, in parts of the picture
_THIN = 0.35  # shortest side of the box in space, in parts of its longest


@dataclasses.dataclass(frozen=True)
class PointTrack:
    """The artists of `point_track`; None where there was nothing to draw.

    Attributes:
        axes: The axes, three-dimensional from SE(3) on.
        coordinates: The coordinates of space that are shown, counted from 0.
        points: The drawn positions.
        track: The path, colored by time: dots if discrete, a line if a flow.
        frames: The body axes now and then, one collection for each axis.
        flow: The continuous path.
    """

    axes: Any
    coordinates: tuple[int, ...]
    points: Float[np.ndarray, "L d"]
    track: Artist
    frames: tuple[Artist, ...]
    flow: Artist | None


@theme.styled
def point_track(orbit: Orbit, axes: Any = None, flow: Orbit | None = None, **look: Unpack[theme.Look]) -> PointTrack:
    """Draw the path of the reference point of a body, with its body axes now and then.

    Motions of the plane are drawn in the plane, others in three dimensions: the three coordinates of space in which
    the path is largest, with the shadow of the path on the floor.

    Args:
        orbit: An orbit on SE(n), with poses.
        axes: Where to draw, three-dimensional (projection="3d") from SE(3) on; a new figure by default.
        flow: The continuous motion from the same initial data, drawn over it.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: An orbit on another group, one without poses, or axes of the wrong dimension.

    Example:
        >>> body = nh.RigidBody(np.diag([1.0, 2.0, 3.0, 1.0]), nh.SE(3))
        >>> orbit = nh.simulate(nh.discretize(body, 0.1), body_velocity=(0, 0.1, 1, 1, 0, 0), steps=30)
        >>> nh.plot.point_track(orbit).points.shape
        (31, 3)
    """
    where = "point_track(orbit=...)"
    orbit = parts.posed(where, orbit)
    group = orbit.system.group
    n = group.size - 1
    if n < 2 or group != SE(n):
        remedy = "Use `body_axis_track` on SO(3), `overview` on other groups."
        raise error(where, "be an orbit on SE(n)", f"{group}", remedy)
    flow = parts.same_group("point_track(flow=...)", flow, orbit)
    axes = _axes(axes, 2 if n == 2 else 3)
    shown = _largest(orbit.position)
    chosen = parts.evenly_spread(orbit.position)
    position = orbit.position[:, shown]
    points = position[chosen]
    names = [f"${letter}$" for letter in "xyz"] if shown.max() < 3 else [f"$x_{i + 1}$" for i in shown]
    theme.write_title(axes, "Reference point")
    view = dress_path(axes, points, names[: len(shown)])
    track = parts.draw_in_time(axes, orbit, position, chosen, zorder=3)
    curve = None if flow is None else parts.draw_flow(axes, flow.position[:, shown])
    frames = _frames(axes, orbit, shown, _ARM * np.ptp(view, axis=1).max())
    mark_path_ends(axes, points, orbit)
    theme.legend_above(axes)
    return PointTrack(axes, tuple(shown.tolist()), points, track, frames, curve)


def _axes(axes: Any, dimension: int) -> Any:
    if axes is not None and (not isinstance(axes, Axes) or hasattr(axes, "get_zlim") != (dimension == 3)):
        remedy = 'Make them with projection="3d".' if dimension == 3 else "Make them without a projection."
        raise error("point_track(axes=...)", f"be axes of dimension {dimension}", shown(axes), remedy)
    return theme.axes_or_new(axes, (6.0, 6.0), "3d" if dimension == 3 else None)


def _largest(position: Float[np.ndarray, "K n"]) -> np.ndarray:
    """Return the coordinates, three at most and in order, in which a path is largest."""
    extent = np.ptp(position, axis=0)
    return np.sort(np.argsort(-extent, kind="stable")[:3])


def dress_path(axes: Any, points: Float[np.ndarray, "L d"], names: list[str]) -> Float[np.ndarray, "d 2"]:
    """Set up axes of the plane or of space, with one unit, about the points of a path; return what they show."""
    if len(names) == 2:
        view = parts.fit_view(axes, points)
        axes.set(xlabel=names[0], ylabel=names[1])
        return view
    limits = _box_about(points)
    if axes.has_data():
        before = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
        limits = np.column_stack([np.minimum(before, limits)[:, 0], np.maximum(before, limits)[:, 1]])
    axes.set(xlim=limits[0], ylim=limits[1], zlim=limits[2])
    axes.set(xlabel=names[0], ylabel=names[1], zlabel=names[2])
    axes.view_init(elev=24, azim=-58)
    sides = np.ptp(limits, axis=1)
    axes.set_box_aspect(sides, zoom=0.88)
    for axis, side in zip((axes.xaxis, axes.yaxis, axes.zaxis), sides / sides.max(), strict=True):
        axis.pane.set(facecolor=theme.PAPER, edgecolor=theme.LEVEL)
        axis.set_major_locator(MaxNLocator(max(2, round(5 * side))))
        axis.labelpad = 4 + (14 if side == 1.0 else -7) * (1 - sides.min() / sides.max())  # away from numbers
    floor = np.column_stack([points[:, :2], np.full(len(points), limits[2, 0])])
    axes.plot(*floor.T, color=theme.LEVEL, linewidth=1.2, zorder=1)
    return limits


def _box_about(points: Float[np.ndarray, "L 3"]) -> Float[np.ndarray, "3 2"]:
    """Return a box with a margin about the points, no side much shorter than the longest."""
    square, extent = parts.square_about(points), np.ptp(points, axis=0)
    half = np.maximum(0.57 * extent, _THIN * np.ptp(square[0]) / 2)
    return square.mean(axis=1)[:, None] + half[:, None] * [-1.0, 1.0]


def _frames(axes: Any, orbit: Orbit, shown: np.ndarray, length: float) -> tuple[Artist, ...]:
    """Draw the body axes that belong to the coordinates shown."""
    some = orbit.chosen(parts.evenly_spread(orbit.position, _BODIES))
    foot, drawn = some.position[:, shown], []
    for axis, color in zip(shown, theme.COMPONENTS, strict=False):
        tip = foot + length * some.configuration[:, shown, axis]
        look = {"colors": color, "linewidth": 1.4, "zorder": 5, "label": f"body axis {axis + 1}"}
        drawn.append(axes.add_collection(parts.segments(foot, tip, **look)))
    return tuple(drawn)


def mark_path_ends(axes: Any, points: Float[np.ndarray, "L d"], orbit: AbstractOrbit) -> None:
    """Mark and name the first and the last point of a path."""
    parts.draw_ends(axes, points, orbit)
    axes.text(*points[0], "  start", zorder=9, path_effects=theme.HALO)
    if not np.allclose(points[0], points[-1]):
        axes.text(*points[-1], "  end", zorder=9, path_effects=theme.HALO)
