"""Films of bodies in space: boxes over their shadows, and on the sphere that a body axis of theirs travels on."""

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb, to_rgba

from nonholo.analysis.bodies import Box, box_in_space, box_in_sphere
from nonholo.base.types import Float
from nonholo.orbit import AbstractOrbit, Orbit
from nonholo.plot import theme
from nonholo.plot.animation._part import Part, Points, Show, draw_point, draw_trail, motion_of, name_of_trail, together
from nonholo.plot.motion.coordinates import Track
from nonholo.plot.motion.spheres import known_axes, rotation_axes
from nonholo.plot.parts import fit_view, forbidden_axis, turn_per_state
from nonholo.plot.sphere import View, arcs, best_view, draw_globe, set_curve

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


def motion(orbit: Orbit) -> float:
    """Return the motion of the body between saved states, in units of what the eye can follow from frame to frame."""
    return motion_of(orbit, np.eye(6)[3:], 2 * float(np.linalg.norm(box_in_space(orbit.system).half)))


def draw_body(axes: Axes, orbit: Orbit, parts: list[Part]) -> Show:
    """Draw a body on SE(3) as a box, and others beside; return what shows a frame."""
    return _draw(axes, orbit, parts, lambda states: states.configuration[:, :3, 3], box_in_space(orbit.system))


def draw_path(track: Track, axes: Axes, orbit: AbstractOrbit, parts: list[Part]) -> Show:
    """Draw a path in three coordinates and a point on it; return what shows a frame."""
    return _draw(axes, orbit, parts, track.points, None)


def _draw(axes: Axes, orbit: AbstractOrbit, parts: list[Part], points: Points, box: Box | None) -> Show:
    paths = [points(part.path) for part in parts]
    reach = 0.0 if box is None else float(np.linalg.norm(box.half) * _ARM + np.linalg.norm(box.center))
    every = np.concatenate(paths)
    floor = _draw_floor(axes, np.concatenate([every - reach, every + reach]))
    shows = []
    for part, path in zip(parts, paths, strict=True):
        shows.append(draw_trail(axes, orbit, part, _shadow(path, floor), color=theme.LEVEL, zorder=1))
        shows.append(draw_trail(axes, orbit, part, _VIEW(path)[0], zorder=2.5, label=name_of_trail(part)))
        if box is None:
            shows.append(draw_point(axes, part, _VIEW(points(part.frames))[0]))
        else:
            shows.append(_draw_body(axes, part, box, floor))
    theme.legend(axes, loc="upper right")
    return together(shows)


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


def _draw_body(axes: Axes, part: Part, box: Box, floor: float) -> Show:
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
_TURN = np.radians(22.0)  # most between two frames
_PIECE = np.radians(4.0)
_AXIS = {"linewidth": 3.0, "marker": "o", "markersize": 6}
_SPIN = {"linewidth": 2.0, "marker": "D", "markersize": 4, "label": "angular velocity"}


def motion_on_sphere(orbit: Orbit) -> float:
    """Return the turn of the body between saved states, in units of what the eye can follow from frame to frame."""
    return turn_per_state(orbit) / float(_TURN)


def draw_on_sphere(axes: Axes, orbit: Orbit, parts: list[Part]) -> Show:
    """Draw the sphere, and on it the body and others beside; return what shows a frame."""
    gamma = forbidden_axis(orbit.system)
    name = "body axis 3" if gamma is None else "forbidden axis"
    gamma = np.array([0.0, 0.0, 1.0]) if gamma is None else gamma
    own = parts[0]
    view = best_view(own.path.configuration @ gamma, known_axes(*rotation_axes(orbit)))
    draw_globe(axes, view)
    shows = [_beside(axes, view, other, gamma) for other in parts[1:]]
    colors = theme.time_colors(orbit, own.path.time[1:])
    shows += [_trace(axes, view, own, gamma, colors, 1.8), _sticks(axes, view, own.frames, gamma, name)]
    theme.legend(axes, loc="lower left", borderaxespad=0.0)
    return together(shows)


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


def _beside(axes: Axes, view: View, other: Part, gamma: Axis) -> Show:
    colors = np.broadcast_to(to_rgba(theme.CONTINUOUS), (len(other.path) - 1, 4))
    axes.plot([], [], color=theme.CONTINUOUS, label="continuous")
    show_trace = _trace(axes, view, other, gamma, colors, 1.2)
    show_box = draw_box(axes, view, box_in_sphere(other.frames.system), zorder=4.5, ghost=True)
    poses = other.frames.configuration
    return together([show_trace, lambda frame: show_box(poses[frame])])


def _trace(axes: Axes, view: View, of: Part, gamma: Axis, colors: Float[np.ndarray, "L 4"], width: float) -> Show:
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
            set_curve(collection, view, path[: past + 1], colors[:past], width=width, side=side)

    return show


def _stick(axes: Axes, view: View, **look: Any) -> Callable[[Axis, Axis], None]:
    """Return what shows a stick from one point of space to another, under the box if it points away from the eye."""
    line = axes.plot([], [], solid_capstyle="round", markevery=[1], **look)[0]

    def show(foot: Axis, tip: Axis) -> None:
        flat, depth = view(np.stack([foot, tip]))
        line.set_data(*flat.T)
        line.set(zorder=7 if depth[1] >= 0 else 3, alpha=1.0 if depth[1] >= 0 else 0.55)

    return show
