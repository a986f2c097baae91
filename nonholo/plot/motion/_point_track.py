"""The path of the reference point of a body in the plane or in space, with the body now and then."""

import dataclasses
from typing import Any, Unpack

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from nonholo.base.checks import error, shown
from nonholo.base.types import Float
from nonholo.groups import SE
from nonholo.orbit import AbstractOrbit, Orbit
from nonholo.plot import parts, theme
from nonholo.plot.motion._coordinates import draw_track, track_of
from nonholo.plot.motion._path import dress_path, mark_path_ends

_BODIES = 14  # places at which the axes of the body are drawn
_ARM = 0.055  # of a body axis, in parts of the picture


@dataclasses.dataclass(frozen=True)
class PointTrack:
    """The artists of `point_track`; None where there was nothing to draw.

    Attributes:
        axes: The axes, three-dimensional from SE(3) on.
        coordinates: The coordinates of space that are shown, counted from 0.
        points: The drawn positions.
        track: The path, colored by time: dots if discrete, a line if a flow.
        frames: The body now and then: its axes, one collection for each, or its outline and heading.
        flow: The continuous path.
    """

    axes: Any
    coordinates: tuple[int, ...]
    points: Float[np.ndarray, "L d"]
    track: Artist
    frames: tuple[Artist, ...]
    flow: Artist | None


@theme.styled
def point_track(
    orbit: AbstractOrbit, axes: Any = None, flow: AbstractOrbit | None = None, **look: Unpack[theme.Look]
) -> PointTrack:
    """Draw the path of the reference point of a body, with the body now and then.

    Motions of the plane are drawn in the plane, others in three dimensions: the three coordinates of space in which
    the path is largest, with the shadow of the path on the floor. On SE(n) the body axes are drawn; of a system with
    coordinates named x and y its `outline`, to scale, and an arrow along its `heading`, where it has them. A body that
    is small beside its path is drawn larger, and the legend says by how much.

    Args:
        orbit: An orbit on SE(n), with poses, or in coordinates with x and y among them.
        axes: Where to draw, three-dimensional (projection="3d") from SE(3) on; a new figure by default.
        flow: The continuous motion from the same initial data, drawn over it.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: An orbit on another group, one without poses or places, or axes of the wrong dimension.

    Example:
        >>> body = nh.RigidBody(np.diag([1.0, 2.0, 3.0, 1.0]), nh.SE(3))
        >>> orbit = nh.simulate(nh.discretize(body, 0.1), body_velocity=(0, 0.1, 1, 1, 0, 0), steps=30)
        >>> nh.plot.point_track(orbit).points.shape
        (31, 3)
    """
    where = "point_track(orbit=...)"
    orbit = parts.drawable_in_time(where, orbit)
    if orbit.coordinates:
        return _in_coordinates(where, orbit, axes, flow)
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


def _in_coordinates(where: str, orbit: AbstractOrbit, axes: Any, flow: AbstractOrbit | None) -> PointTrack:
    track = track_of(orbit)
    if track is None or not track.is_place:
        remedy = "Name its coordinates, `LagrangeDAlembert(coordinates=...)`, or use `overview`."
        raise error(where, "have coordinates named x and y", f"{', '.join(orbit.coordinates)}", remedy)
    if flow is not None and parts.drawable_in_time("point_track(flow=...)", flow).space != orbit.space:
        raise error("point_track(flow=...)", f"move in {orbit.space}", f"{flow.space}", "Pass one of the same system.")
    dimension = len(track.names)
    axes = _axes(axes, dimension)
    drawn, bodies, curve = draw_track(track, orbit, flow, axes)
    return PointTrack(axes, tuple(range(dimension)), track.points(orbit), drawn, bodies, curve)


def _axes(axes: Any, dimension: int) -> Any:
    if axes is not None and (not isinstance(axes, Axes) or hasattr(axes, "get_zlim") != (dimension == 3)):
        remedy = 'Make them with projection="3d".' if dimension == 3 else "Make them without a projection."
        raise error("point_track(axes=...)", f"be axes of dimension {dimension}", shown(axes), remedy)
    return theme.axes_or_new(axes, (6.0, 6.0), "3d" if dimension == 3 else None)


def _largest(position: Float[np.ndarray, "K n"]) -> np.ndarray:
    """Return the coordinates, three at most and in order, in which a path is largest."""
    extent = np.ptp(position, axis=0)
    return np.sort(np.argsort(-extent, kind="stable")[:3])


def _frames(axes: Any, orbit: Orbit, shown: np.ndarray, length: float) -> tuple[Artist, ...]:
    """Draw the body axes that belong to the coordinates shown."""
    some = orbit.chosen(parts.evenly_spread(orbit.position, _BODIES))
    foot, drawn = some.position[:, shown], []
    for axis, color in zip(shown, theme.COMPONENTS, strict=False):
        tip = foot + length * some.configuration[:, shown, axis]
        look = {"colors": color, "linewidth": 1.4, "zorder": 5, "label": f"body axis {axis + 1}"}
        drawn.append(axes.add_collection(parts.segments(foot, tip, **look)))
    return tuple(drawn)
