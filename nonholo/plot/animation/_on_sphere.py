"""Films of bodies that turn about a fixed point: a box within the sphere on which one of its axes leaves a trace."""

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba

from nonholo.base.types import Float
from nonholo.orbit import Orbit
from nonholo.plot import theme
from nonholo.plot.animation._in_space import box_of, draw_box
from nonholo.plot.animation._part import Part, Show, together
from nonholo.plot.motion.spheres import known_axes, rotation_axes
from nonholo.plot.parts import forbidden_axis, turn_per_state
from nonholo.plot.sphere import View, arcs, best_view, draw_globe, set_curve

Axis = Float[np.ndarray, "3"]
_TURN = np.radians(22.0)  # most between two frames
_PIECE = np.radians(4.0)
_LONGEST = 0.72  # from the center of the box to its corners, in radii of the sphere
_AXIS = {"linewidth": 3.0, "marker": "o", "markersize": 6}
_SPIN = {"linewidth": 2.0, "marker": "D", "markersize": 4, "label": "angular velocity"}


def motion(orbit: Orbit) -> float:
    """Return the turn of the body between saved states, in units of what the eye can follow from frame to frame."""
    return turn_per_state(orbit) / float(_TURN)


def draw_body(axes: Axes, orbit: Orbit, parts: list[Part]) -> Show:
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
    box = _box_in_sphere(frames)
    show_box = draw_box(axes, view, box, zorder=4)
    show_axis = _stick(axes, view, color=theme.INK, label=theme.option("label", name), **_AXIS)
    show_spin = _stick(axes, view, color=theme.UNSTABLE, **_SPIN)

    def show(frame: int) -> None:
        g, spin = poses[frame], spins[frame]
        show_box(g)
        show_axis(min(box.way_out(gamma), 1.0) * (g @ gamma), g @ gamma)
        show_spin(min(box.way_out(spin), 1.0) * (g @ spin), g @ spin)

    return show


def _box_in_sphere(frames: Orbit) -> Any:
    box = box_of(np.asarray(frames.system.inertia_operator), 1.0)
    return box._replace(half=_LONGEST * box.half / np.linalg.norm(box.half))


def _beside(axes: Axes, view: View, other: Part, gamma: Axis) -> Show:
    colors = np.broadcast_to(to_rgba(theme.CONTINUOUS), (len(other.path) - 1, 4))
    axes.plot([], [], color=theme.CONTINUOUS, label="continuous")
    show_trace = _trace(axes, view, other, gamma, colors, 1.2)
    show_box = draw_box(axes, view, _box_in_sphere(other.frames), zorder=4.5, ghost=True)
    poses = other.frames.configuration

    def show(frame: int) -> None:
        show_trace(frame)
        show_box(poses[frame])

    return show


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
