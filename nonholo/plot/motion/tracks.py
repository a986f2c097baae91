"""Paths on the plane and in space: a sleigh's blade with its cusp, the reference point of a body now and then.

[fedorov-zenkov-2004], sketch chsleigh and section 5.
"""

from typing import Any, NamedTuple, Unpack, cast

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.lines import Line2D

from nonholo.base.checks import error, flags, shown
from nonholo.base.types import Float
from nonholo.orbit import AbstractOrbit, Orbit
from nonholo.plot import parts, theme
from nonholo.plot.motion.coordinates import draw_track, dress_path, mark_path_ends, track_of
from nonholo.plot.sheets import StripSheet, strip_of


class BladeTrack(NamedTuple):
    """The artists of `blade_track`; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        track: The contact points, colored by time: dots if discrete, a line if a flow.
        blades: Strokes along the blade at some of the states.
        masses: The centers of mass at the same states.
        cusps: The points where the blade reverses.
        ends: The first and the last contact point.
        flow: The continuous curve.
        enlarged: The axes in a corner that show the cusp, or the turn of a long run, enlarged.
    """

    axes: Axes
    track: PathCollection | LineCollection
    blades: LineCollection
    masses: PathCollection
    cusps: PathCollection | None
    ends: PathCollection
    flow: Line2D | None
    enlarged: Axes | None


@theme.in_style
def blade_track(
    orbit: Orbit, axes: Axes | None = None, flow: Orbit | None = None, enlarge: bool = True, **look: Unpack[theme.Look]
) -> BladeTrack:
    r"""Draw the path of the contact point of a sleigh, the blade now and then, and the cusp.

    The cusp is where the velocity along the blade changes sign, $v_1 = 0$; between two states it is interpolated. It is
    shown enlarged in a corner. A gray pin leads from the blade to the center of mass.

    Reference: [fedorov-zenkov-2004], sketch chsleigh.

    Args:
        orbit: An orbit of a sleigh in the plane, with poses.
        axes: Where to draw; a new figure by default.
        flow: The continuous motion from the same initial data, drawn over it.
        enlarge: Whether to show the cusp enlarged, in axes that hold no other track.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: An orbit of another system, or without poses.

    Example:
        >>> sleigh = nh.ChaplyginSleigh(mass=1, inertia=1, a=0.5, b=0.3)
        >>> orbit = nh.simulate(nh.discretize(sleigh, 0.1), body_velocity=(0.1, -1, 0), steps=120)
        >>> track = nh.plot.blade_track(orbit)
        >>> len(track.track.get_offsets()), len(track.cusps.get_offsets())
        (121, 1)
    """
    flags("blade_track", enlarge=enlarge)
    orbit, strip = _with_blade("blade_track(orbit=...)", orbit)
    flow = None if flow is None else _with_blade("blade_track(flow=...)", flow)[0]
    axes = theme.axes_or_new(axes, (6.0, 6.0))
    enlarge = enlarge and not axes.has_data()
    parts.remove_detail(axes)
    position = strip.contact(orbit)
    cusps, view = _cusps(position, strip.speed(orbit)), parts.fit_view(axes, position)
    track, blades, masses, line = _draw(axes, orbit, orbit, flow, view, blades=18, length=0.032)
    ends = parts.draw_ends(axes, position, orbit)
    middle = position[parts.evenly_spread(position)].mean(axis=0)
    _name(axes, "start", position[0], middle)
    if not parts.is_closed(position):
        _name(axes, "end", position[-1], middle)
    stars = _stars(axes, position, cusps) if len(cusps) else None
    theme.legend_above(axes, "Track of the blade")
    inset = _enlarge(axes, orbit, flow, cusps, view) if enlarge and len(cusps) else None
    return BladeTrack(axes, track, blades, masses, stars, ends, line, inset)


def _with_blade(where: str, orbit: Any) -> tuple[Orbit, StripSheet]:
    """Return an orbit with poses, dense enough for a curve, and its blade."""
    orbit = parts.drawable(where, orbit)
    if (strip := strip_of(orbit.system)) is None:
        raise error(where, "be an orbit of a sleigh in the plane", shown(orbit), "Use `body_axis_track` for a top.")
    return parts.orbit_with_poses(where, orbit), strip


def _contact(orbit: Orbit) -> Float[np.ndarray, "K 2"]:
    return cast(StripSheet, strip_of(orbit.system)).contact(orbit)


def _cusps(position: Float[np.ndarray, "K 2"], speed: Float[np.ndarray, "K"]) -> Float[np.ndarray, "C 2"]:
    """Return the points at which v_1 changes sign, linear between states; zeros in between count once."""
    moving = np.flatnonzero(speed)
    turns = np.flatnonzero(speed[moving[:-1]] * speed[moving[1:]] < 0)
    before, after = moving[turns], moving[turns + 1]
    share = (speed[before] / (speed[before] - speed[after]))[:, None]
    return (1 - share) * position[before] + share * position[after]


def _draw(
    axes: Axes, part: Orbit, whole: Orbit, flow: Orbit | None, view: parts.Square, blades: int, length: float
) -> tuple[PathCollection | LineCollection, LineCollection, PathCollection, Line2D | None]:
    """Draw a part of the orbit with the colors of the whole; the length of blades is in parts of the view."""
    position = _contact(part)
    track = parts.draw_in_time(axes, part, position, parts.evenly_spread(position), zorder=3, whole=whole)
    strokes, masses = _blades(axes, part, blades, length * np.ptp(view, axis=1).min())
    return track, strokes, masses, None if flow is None else parts.draw_flow(axes, _contact(flow))


def _blades(axes: Axes, orbit: Orbit, count: int, length: float) -> tuple[LineCollection, PathCollection]:
    strip = cast(StripSheet, strip_of(orbit.system))
    # states evenly in way and, with less weight, in turn, so that the cusp gets its share
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(strip.contact(orbit), axis=0), axis=1))])
    turn = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(orbit.heading)))])
    shares = [weight * total / total[-1] for weight, total in ((1.0, way), (0.35, turn)) if total[-1] > 0]
    some = parts.evenly_spread(np.sum(shares, axis=0)[:, None], count) if shares else np.array([0])
    poses = strip.blades(orbit.chosen(some))
    points, half = poses[:, :2, 2], length / 2 * poses[:, :2, 0]
    center = (poses @ np.append(strip.center, 1.0))[:, :2]
    blades = parts.segments(points - half, points + half, colors=theme.INK, linewidth=1.5, zorder=5)
    axes.add_collection(parts.segments(points, center, colors=theme.MUTED, linewidth=0.7, zorder=2))
    axes.add_collection(blades)
    look: Any = {"facecolors": theme.PAPER, "edgecolors": theme.MUTED, "linewidths": 0.8, "zorder": 2.2}
    return blades, axes.scatter(*center.T, s=9, label="center of mass", **look)


def _stars(axes: Axes, position: Float[np.ndarray, "K 2"], cusps: Float[np.ndarray, "C 2"]) -> PathCollection:
    nearest = int(np.linalg.norm(position - cusps[0], axis=1).argmin())
    extent = np.ptp(position, axis=0).max()
    if np.linalg.norm(position[[0, -1]] - cusps[0], axis=1).min() > 0.08 * extent:  # else the words would collide
        _name(axes, "cusp", cusps[0], position[max(0, nearest - 8) : nearest + 9].mean(axis=0))
    return axes.scatter(*cusps.T, s=100, marker="*", color=theme.UNSTABLE, linewidths=0, zorder=8)


def _name(axes: Axes, word: str, point: Float[np.ndarray, "2"], middle: Float[np.ndarray, "2"]) -> None:
    distance = np.linalg.norm(point - middle)
    away = (point - middle) / distance if distance > 0 else np.array([0.0, 1.0])
    place = {"xytext": tuple(17 * away), "textcoords": "offset points", "ha": "center", "va": "center"}
    axes.annotate(word, tuple(point), zorder=9, path_effects=theme.HALO, annotation_clip=False, **place)


def _enlarge(axes: Axes, orbit: Orbit, flow: Orbit | None, cusps: Float[np.ndarray, "C 2"], view: parts.Square) -> Axes:
    position = _contact(orbit)
    rows, near = parts.detail(position, orbit.body_velocity[:, 0], cusps[0], view)
    inset = parts.corner_axes(axes, position[parts.evenly_spread(position)], view, near)
    _draw(inset, orbit[rows], orbit, flow, near, blades=10, length=0.11)
    inset.scatter(*cusps.T, s=110, marker="*", color=theme.UNSTABLE, linewidths=0, zorder=8)
    return inset


_BODIES = 14  # places at which the axes of the body are drawn
_ARM = 0.055  # of a body axis, in parts of the picture


class PointTrack(NamedTuple):
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


@theme.in_style
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
    orbit = parts.orbit_with_poses(where, orbit)
    group = orbit.system.group
    if not group.is_affine:
        remedy = "Use `body_axis_track` on SO(3), `overview` on other groups."
        raise error(where, "be an orbit on SE(n)", f"{group}", remedy)
    beside: Any = parts.same_space("point_track(flow=...)", flow, orbit, parts.orbit_with_poses)
    axes = _axes(axes, 2 if group.size == 3 else 3)
    largest = np.sort(np.argsort(-np.ptp(orbit.position, axis=0), kind="stable")[:3])  # in which the path is largest
    at = parts.evenly_spread(orbit.position)
    position = orbit.position[:, largest]
    points = position[at]
    names = [f"${letter}$" for letter in "xyz"] if largest.max() < 3 else [f"$x_{i + 1}$" for i in largest]
    view = dress_path(axes, points, names[: len(largest)])
    track = parts.draw_in_time(axes, orbit, position, at, zorder=3)
    curve = None if beside is None else parts.draw_flow(axes, beside.position[:, largest])
    frames = _frames(axes, orbit, largest, _ARM * np.ptp(view, axis=1).max())
    mark_path_ends(axes, points, orbit)
    theme.legend_above(axes, "Reference point")
    return PointTrack(axes, tuple(largest.tolist()), points, track, frames, curve)


def _in_coordinates(where: str, orbit: AbstractOrbit, axes: Any, flow: AbstractOrbit | None) -> PointTrack:
    if (track := track_of(orbit)) is None or not track.is_place:
        remedy = "Name its coordinates, `LagrangeDAlembert(coordinates=...)`, or use `overview`."
        raise error(where, "have coordinates named x and y", f"{', '.join(orbit.coordinates)}", remedy)
    flow = parts.same_space("point_track(flow=...)", flow, orbit)
    dimension = len(track.names)
    axes = _axes(axes, dimension)
    path, bodies, curve = draw_track(track, orbit, flow, axes)
    return PointTrack(axes, tuple(range(dimension)), track.points(orbit), path, bodies, curve)


def _axes(axes: Any, dimension: int) -> Any:
    if axes is not None and (not isinstance(axes, Axes) or hasattr(axes, "get_zlim") != (dimension == 3)):
        remedy = 'Make them with projection="3d".' if dimension == 3 else "Make them without a projection."
        raise error("point_track(axes=...)", f"be axes of dimension {dimension}", shown(axes), remedy)
    return theme.axes_or_new(axes, (6.0, 6.0), "3d" if dimension == 3 else None)


def _frames(axes: Any, orbit: Orbit, largest: np.ndarray, length: float) -> tuple[Artist, ...]:
    """Draw the body axes that belong to the coordinates shown."""
    some = orbit.chosen(parts.evenly_spread(orbit.position, _BODIES))
    foot, frames = some.position[:, largest], []
    for axis, color in zip(largest, theme.COMPONENTS, strict=False):
        tip = foot + length * some.configuration[:, largest, axis]
        look = {"colors": color, "linewidth": 1.4, "zorder": 5, "label": f"body axis {axis + 1}"}
        frames.append(axes.add_collection(parts.segments(foot, tip, **look)))
    return tuple(frames)
