"""Films of bodies: the parts of a motion that a film shows, and what draws a frame of each, in the plane and in space.

In the plane a sleigh with its blade, center of mass and track, the outline of a system, a point; in space boxes over
their shadows, and boxes on the sphere that a body axis of theirs travels on.
"""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, TypeAlias, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb, to_rgba

from nonholo.analysis.bodies import Box, box_in_space, box_in_sphere, plate
from nonholo.analysis.planar import blade_axes
from nonholo.base.types import Float, Int
from nonholo.groups import SE
from nonholo.orbit import AbstractOrbit, Orbit
from nonholo.plot import theme
from nonholo.plot.motion.coordinates import Bodies, Track, bodies_of
from nonholo.plot.motion.spheres import known_axes, rotation_axes
from nonholo.plot.parts import evenly_spread, fit_view, forbidden_axis, some_states, turn_per_state, window
from nonholo.plot.sphere import View, arcs, best_view, draw_globe, set_curve
from nonholo.systems import System

Show: TypeAlias = Callable[[int], None]
"""A function that shows a frame."""

_BETWEEN = 8  # states of a flow from frame to frame
_MOST_PIECES = 1500  # of a trail
_TURN, _WAY = np.radians(15.0), 0.12  # most of a turn, and of the length of a body, between two frames


class Part(NamedTuple):
    """A part of a motion.

    Attributes:
        path: The states on its path.
        frames: The states of the frames.
        past: How many states of the path are past in each frame.
        is_flow: Whether it is the continuous motion beside another one.
    """

    path: Any
    frames: Any
    past: Int[np.ndarray, "F"]
    is_flow: bool = False

    def colors(self, orbit: AbstractOrbit, time: Float[np.ndarray, "L"]) -> Float[np.ndarray, "L 4"]:
        """Return the colors at these times: of time as in an orbit, or the one of a flow."""
        return np.tile(to_rgba(theme.CONTINUOUS), (len(time), 1)) if self.is_flow else theme.time_colors(orbit, time)


def shown_states(orbit: AbstractOrbit, motion: float, total: int) -> Int[np.ndarray, "F"]:
    """Return the states of the frames: the whole orbit, or the part about the transition if it moves too fast for that.

    `motion` is the motion of the body between two saved states, in units of what the eye can follow; 0 for all.
    """
    stride = max(1, int(1 / motion)) if motion > 0 else len(orbit)
    if len(orbit) <= stride * total:
        return np.linspace(0, len(orbit) - 1, total).round().astype(int)
    return np.arange(len(orbit))[window(cast(Orbit, orbit), motion, 1.0, total)]


def part_of(orbit: AbstractOrbit, states: Int[np.ndarray, "F"]) -> Part:
    """Return the part of an orbit between the states of the frames."""
    return Part(orbit.chosen(slice(states[0], states[-1] + 1)), orbit.chosen(states), states - states[0] + 1)


def part_of_flow(flow: AbstractOrbit, times: Float[np.ndarray, "F"]) -> Part:
    """Return a flow at the times of the frames and between them; at its nearest states if it has no others."""
    at = np.arange(_BETWEEN * (len(times) - 1) + 1)
    between = np.interp(at / _BETWEEN, np.arange(len(times)), times)
    if flow.span is None:
        onward = np.sign(flow.time[-1] - flow.time[0])
        nearest = np.interp(onward * between, onward * flow.time, np.arange(len(flow)))
        path = flow.chosen(nearest.round().astype(int))
    else:
        path = flow.at(between.clip(*np.sort(flow.span)))
    return Part(path, path.chosen(slice(None, None, _BETWEEN)), at[::_BETWEEN] + 1, is_flow=True)


def motion_of(orbit: Orbit, point: Float[np.ndarray, "n dim"], length: float) -> float:
    """Return the motion of a body between saved states, in units of what the eye can follow from frame to frame.

    Args:
        orbit: The orbit, on SE(n).
        point: The map from a body velocity to the velocity of the point to follow.
        length: Of the body.
    """
    if len(orbit) < 2:
        return 0.0
    speed = np.linalg.norm(some_states(orbit, 1000).body_velocity @ point.T, axis=1).max()
    return float(max(turn_per_state(orbit) / _TURN, speed * np.abs(np.diff(orbit.time)).max() / (_WAY * length)))


def draw_trail(axes: Axes, orbit: AbstractOrbit, part: Part, path: np.ndarray, color: Any = None, **look: Any) -> Show:
    """Return what draws the points of a path up to a frame, in the colors of time, or as the line of a flow."""
    at = evenly_spread(path, _MOST_PIECES)
    pieces, past = theme.pieces(path[at]), np.searchsorted(at, part.past - 1, side="right")
    if color is None:
        color = part.colors(orbit, part.path.time[at][1:])
        look["label"] = "continuous" if part.is_flow else theme.option("label", None)
    look = {"linewidth": 1.2 if part.is_flow else 2, "zorder": 2} | look
    trail = LineCollection(pieces, colors=color, **look)
    axes.add_collection(trail, autolim=False)
    return lambda frame: trail.set_segments(pieces[: past[frame] - 1])


def draw_point(axes: Axes, part: Part, points: Float[np.ndarray, "F 2"]) -> Show:
    """Return what draws the point of a frame, as a ring for a flow."""
    color = theme.CONTINUOUS if part.is_flow else theme.option("color", theme.INK)
    face = "none" if part.is_flow else color
    dot = axes.plot([], [], "o", markersize=8, markerfacecolor=face, color=color, zorder=4)[0]
    return lambda frame: dot.set_data(*points[frame : frame + 1].T)


Motion: TypeAlias = tuple[Part, Float[np.ndarray, "K 2"], Bodies | None]  # a part, its path, its body in each frame


def motion_in_plane(orbit: Orbit) -> float:
    """Return the motion of the body between saved states, in units of what the eye can follow from frame to frame."""
    point = SE(2).adjoint(SE(2).inverse(_axes(orbit.system)))[1:]
    return motion_of(orbit, point, float(np.ptp(plate(orbit.system)[0][:, 0])))


def draw_body_in_plane(axes: Axes, orbit: Orbit, parts: list[Part]) -> Iterator[Show]:
    """Draw a body on SE(2) and others beside; return what shows a frame."""
    frame, outline = _axes(orbit.system), plate(orbit.system)
    radius = max(float(np.linalg.norm(corners, axis=1).max()) for corners in outline)
    motions: list[Motion] = []
    for part in parts:
        g = part.frames.configuration @ frame
        outlines = [[corners @ pose[:2, :2].T + pose[:2, 2] for corners in outline] for pose in g]
        bodies = Bodies(g[:, :2, 2], g[:, :2, 0], outlines, radius, 1.0)
        motions.append((part, (part.path.configuration @ frame)[:, :2, 2], bodies))
    return _draw_in_plane(axes, orbit, motions)


def draw_path_in_plane(track: Track, axes: Axes, orbit: AbstractOrbit, parts: list[Part]) -> Iterator[Show]:
    """Draw a path in two coordinates, with the outline of the system or as a point; return what shows a frame."""
    points = track.points(orbit)
    bodies = [bodies_of(orbit, points, part.frames) if track.is_place else None for part in parts]
    motions = [(part, track.points(part.path), at) for part, at in zip(parts, bodies, strict=True)]
    return _draw_in_plane(axes, orbit, motions, track)


def _axes(system: System) -> Float[np.ndarray, "3 3"]:
    """Return the axes in the body that are drawn: those of its blade, if it has one."""
    axes = blade_axes(system.inside)
    return np.eye(3) if axes is None else axes


def _draw_in_plane(axes: Axes, orbit: AbstractOrbit, motions: list[Motion], track: Any = None) -> Iterator[Show]:
    """Draw motions whose points are places, or those of a track; yield what shows a frame."""
    shown = np.concatenate([path if at is None else at.with_corners(path) for _, path, at in motions])
    if getattr(track, "is_place", True):
        fit_view(axes, shown, ("", ""))
    else:
        look: Any = {"transform": axes.transAxes, "color": theme.QUIET}
        axes.text(0.99, 0.01, track.names[0], ha="right", **look)
        axes.text(0.01, 0.99, track.names[1], va="top", **look)
        axes.margins(0.1)
        axes.update_datalim(shown)
        axes.autoscale_view()
    axes.grid(color=theme.LEVEL, linewidth=0.8, alpha=0.3)
    axes.tick_params(length=0, labelleft=False, labelbottom=False)
    axes.spines[:].set_visible(False)
    axes.set_axisbelow(True)
    for part, path, at in motions:
        yield draw_trail(axes, orbit, part, path)
        yield draw_point(axes, part, track.points(part.frames)) if at is None else _draw_outline(axes, part, at)
    theme.legend(axes, loc="best")


def _draw_outline(axes: Axes, part: Part, bodies: Bodies) -> Show:
    """Return what draws the outline of a frame: the body in a light shade, what it carries in a dark one."""
    edge: Any = theme.CONTINUOUS if part.is_flow else theme.option("color", theme.INK)
    look: Any = {"edgecolors": [edge], "linewidths": 1.2}
    kinds = [("none", 2.2)] * 2 if part.is_flow else [(theme.INSIDE, 1.0), (edge, 3.0)]  # below the trail and above it
    body, cargo = (PolyCollection([], facecolors=[face], zorder=layer, **look) for face, layer in kinds)
    for collection in (body, cargo):
        axes.add_collection(collection, autolim=False)

    def show(frame: int) -> None:
        body.set_verts(bodies.outlines[frame][:1])
        cargo.set_verts(bodies.outlines[frame][1:])

    return show


_LIGHT = np.array([-0.4, 0.6, 0.7]) / np.linalg.norm([-0.4, 0.6, 0.7])  # right, up, toward the eye


def draw_box(axes: Axes, view: View, box: Box, *, zorder: float, ghost: bool = False) -> Callable[[Any], None]:
    """Draw a box, or its edges alone; return what shows it in a pose."""
    edge = theme.CONTINUOUS if ghost else theme.MUTED
    faces = PolyCollection([], edgecolors=edge, linewidths=1.4 if ghost else 0.9, zorder=zorder, facecolors="none")
    axes.add_collection(faces, autolim=False)
    shade = np.array(to_rgb("#56b4e9" if theme.is_dark() else "#a8d4f2"))

    def show(g: Float[np.ndarray, "N N"]) -> None:
        facing = box.normals(g) @ view.frame.T
        front = facing[:, 2] > 0
        faces.set_verts(list(view(box.corners(g)[front])[0]))
        if not ghost:
            light = 0.62 + 0.38 * np.clip(facing[front] @ _LIGHT, 0.0, 1.0)
            faces.set_facecolor([tuple(one * shade) for one in light])

    return show


_VIEW = View(-58.0, 22.0)
_SQUARES = 12  # of the floor
_ARM = 1.5  # of a body axis, in half diagonals of the box


def motion_in_space(orbit: Orbit) -> float:
    """Return the motion of the body between saved states, in units of what the eye can follow from frame to frame."""
    return motion_of(orbit, np.eye(6)[3:], 2 * float(np.linalg.norm(box_in_space(orbit.system).half)))


def draw_in_space(track: Track, axes: Axes, orbit: AbstractOrbit, parts: list[Part]) -> Iterator[Show]:
    """Draw a path in three coordinates with a body on SE(3) as a box, or a point; return what shows a frame."""
    box = box_in_space(orbit.system) if isinstance(orbit, Orbit) else None
    paths = [track.points(part.path) for part in parts]
    reach = 0.0 if box is None else float(np.linalg.norm(box.half) * _ARM + np.linalg.norm(box.center))
    every = np.concatenate(paths)
    floor = _draw_floor(axes, np.concatenate([every - reach, every + reach]))
    for part, path in zip(parts, paths, strict=True):
        yield draw_trail(axes, orbit, part, _shadow(path, floor), color=theme.LEVEL, zorder=1)
        yield draw_trail(axes, orbit, part, _VIEW(path)[0], zorder=2.5)
        if box is None:
            yield draw_point(axes, part, _VIEW(track.points(part.frames))[0])
        else:
            yield _draw_box_with_axes(axes, part, box, floor)
    theme.legend(axes, loc="upper right")


def _draw_floor(axes: Axes, points: Float[np.ndarray, "L 3"]) -> float:
    """Draw a floor below the points, in squares, and let the axes show both; return its height."""
    low, high = points.min(axis=0), points.max(axis=0)
    height, side = float(low[2]), float((high - low).max() or 1.0) / _SQUARES
    marks = [np.arange(np.floor(low[i] / side), np.ceil(high[i] / side) + 1) * side for i in (0, 1)]
    lines = [[(x, marks[1][0], height), (x, marks[1][-1], height)] for x in marks[0]]
    lines += [[(marks[0][0], y, height), (marks[0][-1], y, height)] for y in marks[1]]
    flat = _VIEW(np.array(lines))[0]
    axes.add_collection(LineCollection(list(flat), colors=theme.LEVEL, linewidths=0.6, alpha=0.6, zorder=0))
    fit_view(axes, np.concatenate([flat.reshape(-1, 2), _VIEW(points)[0]]))
    axes.set_axis_off()
    return height


def _shadow(points: Float[np.ndarray, "... 3"], floor: float) -> Float[np.ndarray, "... 2"]:
    """Return the shadows of points in the picture."""
    return _VIEW(np.concatenate([points[..., :2], np.full_like(points[..., :1], floor)], axis=-1))[0]


def _draw_box_with_axes(axes: Axes, part: Part, box: Box, floor: float) -> Show:
    """Return what draws the box of a frame, its shadow, and the body axes from the reference point."""
    poses = part.frames.configuration
    show_box = draw_box(axes, _VIEW, box, zorder=3.5 if part.is_flow else 4, ghost=part.is_flow)
    if part.is_flow:
        return lambda frame: show_box(poses[frame])
    shade = PolyCollection([], facecolors=theme.LEVEL, linewidths=0, zorder=1.2)
    axes.add_collection(shade, autolim=False)
    arm = _ARM * float(np.linalg.norm(box.half))
    looks: list[Any] = [{"color": theme.COMPONENTS[i], "label": f"body axis {i + 1}"} for i in range(3)]
    sticks = [axes.plot([], [], linewidth=2.0, solid_capstyle="round", **look)[0] for look in looks]

    def show(frame: int) -> None:
        g = poses[frame]
        show_box(g)
        shade.set_verts(list(_shadow(box.corners(g), floor)))
        for axis, stick in zip(g[:3, :3].T, sticks, strict=True):
            flat, depth = _VIEW(np.stack([g[:3, 3], g[:3, 3] + arm * axis]))
            stick.set_data(*flat.T)
            stick.set_zorder(5 if depth[1] >= depth[0] else 3)

    return show


Axis = Float[np.ndarray, "3"]
_TURN_ON_SPHERE = np.radians(22.0)  # most between two frames
_PIECE = np.radians(4.0)
_AXIS = {"linewidth": 3.0, "marker": "o", "markersize": 6}
_SPIN = {"linewidth": 2.0, "marker": "D", "markersize": 4, "label": "angular velocity"}


def motion_on_sphere(orbit: Orbit) -> float:
    """Return the turn of the body between saved states, in units of what the eye can follow from frame to frame."""
    return turn_per_state(orbit) / float(_TURN_ON_SPHERE)


def draw_on_sphere(axes: Axes, orbit: Orbit, parts: list[Part]) -> Iterator[Show]:
    """Draw the sphere, and on it the body and others beside; return what shows a frame."""
    gamma = forbidden_axis(orbit.system)
    name = "body axis 3" if gamma is None else "forbidden axis"
    gamma = np.array([0.0, 0.0, 1.0]) if gamma is None else gamma
    view = best_view(parts[0].path.configuration @ gamma, known_axes(*rotation_axes(orbit)))
    draw_globe(axes, view)
    for part in reversed(parts):
        yield _trace(axes, view, part, gamma, part.colors(orbit, part.path.time[1:]))
        yield (_ghost if part.is_flow else _sticks)(axes, view, part.frames, gamma, name)
    theme.legend(axes, loc="lower left", borderaxespad=0.0)


def _ghost(axes: Axes, view: View, frames: Orbit, *_: Any) -> Show:
    """Draw the edges of the box of a flow."""
    axes.plot([], [], color=theme.CONTINUOUS, label="continuous")
    poses, show_box = frames.configuration, draw_box(axes, view, box_in_sphere(frames.system), zorder=4.5, ghost=True)
    return lambda frame: show_box(poses[frame])


def _sticks(axes: Axes, view: View, frames: Orbit, gamma: Axis, name: str) -> Show:
    """Draw the box with its axis and its angular velocity, which begin where they leave it."""
    poses = frames.configuration
    spins = frames.body_velocity
    spins = spins * 1.12 / (np.linalg.norm(spins, axis=1).max() or 1.0)
    box = box_in_sphere(frames.system)
    show_box = draw_box(axes, view, box, zorder=4)
    show_axis = _stick(axes, view, color=theme.INK, label=theme.option("label", name), **_AXIS)
    show_spin = _stick(axes, view, color=theme.UNSTABLE, **_SPIN)

    def show(frame: int) -> None:
        g, spin = poses[frame], spins[frame]
        show_box(g)
        show_axis(min(box.way_out(gamma), 1.0) * (g @ gamma), g @ gamma)
        show_spin(min(box.way_out(spin), 1.0) * (g @ spin), g @ spin)

    return show


def _trace(axes: Axes, view: View, of: Part, gamma: Axis, colors: Float[np.ndarray, "L 4"]) -> Show:
    """Return what shows the path of an axis up to a frame, beneath the body and above it."""
    points = of.path.configuration @ gamma
    step = np.linalg.norm(np.diff(points, axis=0), axis=1).max(initial=0.0)
    pieces = max(1, int(np.ceil(step / _PIECE)))
    path, colors = arcs(points, pieces), np.repeat(colors, pieces, axis=0)
    sides = {-1: LineCollection([], zorder=2), 1: LineCollection([], zorder=6)}
    for collection in sides.values():
        axes.add_collection(collection, autolim=False)

    def show(frame: int) -> None:
        past = pieces * int(of.past[frame] - 1)
        for side, collection in sides.items():
            set_curve(collection, view, path[: past + 1], colors[:past], width=1.2 if of.is_flow else 1.8, side=side)

    return show


def _stick(axes: Axes, view: View, **look: Any) -> Callable[[Axis, Axis], None]:
    """Return what shows a stick from one point of space to another, under the box if it points away from the eye."""
    line = axes.plot([], [], solid_capstyle="round", markevery=[1], **look)[0]

    def show(foot: Axis, tip: Axis) -> None:
        flat, depth = view(np.stack([foot, tip]))
        line.set_data(*flat.T)
        line.set(zorder=7 if depth[1] >= 0 else 3, alpha=1.0 if depth[1] >= 0 else 0.55)

    return show
