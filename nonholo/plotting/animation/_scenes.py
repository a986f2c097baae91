"""What an animation shows: a stage with a title, the time and a strip that shows how far time has come, and a body.

A sleigh is drawn with its blade, center of mass and track on the plane, a top as a box with its body axes inside the
sphere on which the forbidden axis leaves its trace.
"""

from collections.abc import Callable
from typing import Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from nonholo.base.types import Float, Int
from nonholo.orbit import Orbit
from nonholo.plotting import theme
from nonholo.plotting.motion import known_axes, rotation_axes
from nonholo.plotting.parts import (
    View,
    arcs,
    best_view,
    draw_globe,
    evenly_spread,
    forbidden_axis,
    set_curve,
    some_states,
    square_about,
    turn_per_state,
)
from nonholo.plotting.sheets import Blade, blade_of_system

_SIZE = 4.8  # inches; 480 pixels


def stage(title: str, orbit: Orbit, shown: Int[np.ndarray, "F"]) -> tuple[Figure, Axes, Callable[[int], None]]:
    """Return a figure, its axes, and what sets the clock to a frame."""
    figure = theme.new_figure((_SIZE, _SIZE), None)
    axes = figure.add_axes((0.02, 0.05, 0.96, 0.88))
    title = theme.asked("title", title)
    figure.text(0.03, 0.965, title, va="center", fontsize="large", fontweight="bold")
    clock = figure.text(0.97, 0.965, "", va="center", ha="right", family="monospace", color=theme.QUIET)
    strip = figure.add_axes((0.03, 0.022, 0.94, 0.012), xlim=(0, 1), ylim=(0, 1))
    strip.set_axis_off()
    times = orbit.time[shown]
    colors = theme.TIME(theme.time_scale(orbit)(np.linspace(times[0], times[-1], 256)))
    strip.imshow(colors[None], extent=(0, 1, 0, 1), aspect="auto", alpha=0.9)
    cover = strip.axvspan(0.0, 1.0, color=theme.LEVEL, linewidth=0)

    def set_clock(frame: int) -> None:
        done = (frame + 1) / len(shown)
        cover.set(x=done, width=1 - done)
        clock.set_text(f"t = {times[frame]:.4g}")

    return figure, axes, set_clock


_SLENDER = 1.6  # length of the drawn body over its width
_TURN, _WAY = np.radians(15.0), 0.12  # most of a turn, and of the body's length, between two frames
_MOST_PIECES = 1500


def sleigh_motion(orbit: Orbit) -> float:
    """Return how far the sleigh moves between saved states, in units of what the eye can follow from frame to frame."""
    if len(orbit) < 2:
        return 0.0
    sample = some_states(orbit, 1000)
    blade = _blade(orbit)
    way = np.abs(blade.speed(sample)).max() * np.abs(np.diff(orbit.time)).max()
    return float(max(turn_per_state(orbit) / _TURN, way / (_WAY * 2 * _half_length(blade))))


def sleigh_scene(orbit: Orbit, shown: Int[np.ndarray, "F"]) -> tuple[Figure, Callable[[int], None]]:
    """Return the figure and what shows a frame in it."""
    figure, axes, set_clock = stage("Chaplygin sleigh", orbit, shown)
    blade = _blade(orbit)
    covered = np.arange(shown[0], shown[-1] + 1)
    track = orbit.chosen(covered)
    kept = evenly_spread(blade.contact(track), _MOST_PIECES)
    points, times = blade.contact(track)[kept], track.time[kept]
    poses = blade.poses(orbit.chosen(shown))
    outline = _outline(blade)
    _ground(axes, points, poses, outline)
    trail = LineCollection([], cmap=theme.TIME, norm=theme.time_scale(orbit), linewidth=2, zorder=2)
    axes.add_collection(trail)
    body, stroke, center = _parts(axes)
    ends = 0.4 * _half_length(blade) * np.array([[-1.0, 0.0], [1.0, 0.0]])  # of the stroke

    def show(frame: int) -> None:
        set_clock(frame)
        past = points[: np.searchsorted(kept + shown[0], shown[frame], side="right")]
        trail.set_segments(theme.pieces(past))
        trail.set_array(times[1 : len(past)])
        g = poses[frame]
        body.set_xy(_moved(g, outline))
        stroke.set_data(*_moved(g, ends).T)
        center.set_data(*_moved(g, blade.center[None]).T)

    return figure, show


def _moved(g: Float[np.ndarray, "3 3"], points: Float[np.ndarray, "K 2"]) -> Float[np.ndarray, "K 2"]:
    return points @ g[:2, :2].T + g[:2, 2]


def _blade(orbit: Orbit) -> Blade:
    return cast(Blade, blade_of_system(orbit.system))


def _half_length(blade: Blade) -> float:
    """Half length of the uniform ellipse with the mass and moment of inertia of the sleigh: J = m (p^2 + q^2) / 4."""
    width = np.sqrt(4 * blade.inertia / blade.mass / (1 + _SLENDER**2))
    return float(_SLENDER * width)


def _outline(blade: Blade) -> Float[np.ndarray, "K 2"]:
    angle = np.linspace(0, 2 * np.pi, 121)
    length = _half_length(blade)
    ellipse = np.stack([length * np.cos(angle), length / _SLENDER * np.sin(angle)], axis=-1)
    return ellipse + blade.center


def _ground(
    axes: Axes, points: Float[np.ndarray, "L 2"], poses: Float[np.ndarray, "F 3 3"], outline: Float[np.ndarray, "K 2"]
) -> None:
    bodies = outline[::10] @ np.swapaxes(poses[:, :2, :2], 1, 2) + poses[:, None, :2, 2]
    view = square_about(np.concatenate([points, bodies.reshape(-1, 2)]))
    axes.set(xlim=view[0], ylim=view[1], aspect="equal")
    axes.grid(color=theme.LEVEL, linewidth=0.8, alpha=0.3)
    axes.tick_params(length=0, labelleft=False, labelbottom=False)
    axes.spines[:].set_visible(False)
    axes.set_axisbelow(True)


def _parts(axes: Axes) -> tuple[Polygon, Line2D, Line2D]:
    look = {"facecolor": "#56b4e9", "edgecolor": theme.DISCRETE, "alpha": 0.4, "linewidth": 1.2}
    body = Polygon(np.zeros((1, 2)), closed=True, zorder=3, **look)
    axes.add_patch(body)
    blade = axes.plot([], [], color=theme.INK, linewidth=4, zorder=5)[0]
    center = axes.plot([], [], "o", markersize=6, markerfacecolor=theme.PAPER, markeredgecolor=theme.INK, zorder=6)[0]
    return body, blade, center


_TURN_OF_TOP = np.radians(22.0)  # most between two frames
_PIECE = np.radians(4.0)
_THINNEST = 0.12  # of the drawn box, over its longest side
_BOX = "#a8d4f2"
_LIGHT = np.array([-0.4, 0.6, 0.7]) / np.linalg.norm([-0.4, 0.6, 0.7])  # right, up, toward the eye
_BODY_AXES: tuple[dict[str, Any], ...] = (
    {"color": "MUTED", "linewidth": 1.6},
    {"color": "MUTED", "linewidth": 1.6},
    {"color": "INK", "linewidth": 3.0, "marker": "o", "markersize": 6, "label": "forbidden axis"},
)
_SPIN = {"color": "UNSTABLE", "linewidth": 2.0, "marker": "D", "markersize": 4, "label": "angular velocity"}


def top_motion(orbit: Orbit) -> float:
    """Return how far the top turns between saved states, in units of what the eye can follow from frame to frame."""
    return turn_per_state(orbit) / float(_TURN_OF_TOP)


def top_scene(orbit: Orbit, shown: Int[np.ndarray, "F"]) -> tuple[Figure, Callable[[int], None]]:
    """Return the figure and what shows a frame in it."""
    figure, axes, set_clock = stage("Suslov top", orbit, shown)
    show_trace, view = _trace(axes, orbit, shown)
    moving = orbit.chosen(shown)
    poses = moving.configuration
    spin = np.einsum("kij,kj->ki", poses, moving.body_velocity)
    spin *= 1.12 / (np.linalg.norm(spin, axis=1).max() or 1.0)
    half, principal = _box(cast(np.ndarray, orbit.system.homogeneous_mass_tensor))
    show_box = _faces(axes, view, half)
    show_axes = [_stick(axes, view, look) for look in _BODY_AXES]
    show_spin = _stick(axes, view, _SPIN)
    theme.legend(axes, loc="lower left", borderaxespad=0.0)
    frame_axes = np.column_stack([orbit.system.form_frame[:, :2], cast(np.ndarray, forbidden_axis(orbit.system))])

    def show(frame: int) -> None:
        g = poses[frame]
        set_clock(frame)
        show_trace(frame)
        show_box(g @ principal)
        for index, show_axis in enumerate(show_axes):
            axis = frame_axes[:, index]
            inside = _way_out(half, principal.T @ axis)
            length = 1.0 if index == 2 else inside + 0.25
            show_axis(inside * (g @ axis), length * (g @ axis))
        way_out = _way_out(half, (g @ principal).T @ spin[frame])
        show_spin(min(way_out, 1.0) * spin[frame], spin[frame])

    return figure, show


def _trace(axes: Axes, orbit: Orbit, shown: Int[np.ndarray, "F"]) -> tuple[Callable[[int], None], View]:
    """Draw the sphere; return what shows the path of the forbidden axis up to a frame, and the view."""
    part = orbit[int(shown[0]) : int(shown[-1]) + 1]
    points = part.configuration @ cast(np.ndarray, forbidden_axis(orbit.system))
    view = best_view(points, known_axes(*rotation_axes(orbit)))
    draw_globe(axes, view)
    step = np.linalg.norm(np.diff(points, axis=0), axis=1).max(initial=0.0)
    pieces = max(1, int(np.ceil(step / _PIECE)))
    path = arcs(points, pieces)
    colors = np.repeat(theme.TIME(theme.time_scale(orbit)(part.time[1:])), pieces, axis=0).reshape(-1, 4)
    sides = {-1: LineCollection([], zorder=2), 1: LineCollection([], zorder=6)}
    for collection in sides.values():
        axes.add_collection(collection, autolim=False)

    def show(frame: int) -> None:
        past = pieces * int(shown[frame] - shown[0])
        for side, collection in sides.items():
            set_curve(collection, view, path[: past + 1], colors[:past], width=1.8, side=side)

    return show, view


def _box(mass_tensor: Float[np.ndarray, "3 3"]) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3 3"]]:
    """Return half sides and principal axes of the uniform box with this mass tensor up to a factor: J_i ~ side_i^2."""
    moments, principal = np.linalg.eigh(np.asarray(mass_tensor))
    half = np.sqrt(np.maximum(moments / moments[-1], _THINNEST**2))
    return 0.72 * half / np.linalg.norm(half), principal


def _way_out(half: Float[np.ndarray, "3"], direction: Float[np.ndarray, "3"]) -> float:
    """Return how many times a vector, in principal axes, goes from the center to the surface of the box."""
    size = np.abs(direction)
    return float(np.min(np.divide(half, size, out=np.full(3, np.inf), where=size > 1e-12 * size.max(initial=1e-300))))


def _faces(axes: Axes, view: View, half: Float[np.ndarray, "3"]) -> Callable[[Float[np.ndarray, "3 3"]], None]:
    normals = np.concatenate([np.eye(3), -np.eye(3)])
    corners = np.array([_face(half, normal) for normal in normals])
    drawn = PolyCollection([], edgecolors="#4a6f8a", linewidths=0.9, zorder=4)
    axes.add_collection(drawn, autolim=False)

    def show(axes_in_space: Float[np.ndarray, "3 3"]) -> None:
        facing = normals @ axes_in_space.T @ view.frame.T
        front = facing[:, 2] > 0
        light = 0.62 + 0.38 * np.clip(facing[front] @ _LIGHT, 0.0, 1.0)
        drawn.set_verts(list(view(corners[front] @ axes_in_space.T)[0]))
        drawn.set_facecolor([tuple(shade * np.array(to_rgb(_BOX))) for shade in light])

    return show


def _face(half: Float[np.ndarray, "3"], normal: Float[np.ndarray, "3"]) -> Float[np.ndarray, "4 3"]:
    along, across = (np.eye(3)[i] for i in range(3) if normal[i] == 0)
    return half * np.array([normal + i * along + j * across for i, j in ((1, 1), (1, -1), (-1, -1), (-1, 1))])


def _stick(
    axes: Axes, view: View, look: dict[str, Any]
) -> Callable[[Float[np.ndarray, "3"], Float[np.ndarray, "3"]], None]:
    """Return what shows a stick from one point of space to another, under the box if it points away from the eye."""
    own = look | {"color": getattr(theme, look["color"])}
    line = axes.plot([], [], solid_capstyle="round", markevery=[1], **own)[0]

    def show(foot: Float[np.ndarray, "3"], tip: Float[np.ndarray, "3"]) -> None:
        flat, depth = view(np.stack([foot, tip]))
        line.set_data(*flat.T)
        line.set(zorder=7 if depth[1] >= 0 else 3, alpha=1.0 if depth[1] >= 0 else 0.55)

    return show
