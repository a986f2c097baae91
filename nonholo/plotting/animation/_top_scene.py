"""An animated top: a box with its body axes inside the sphere on which the forbidden axis leaves its trace."""

from collections.abc import Callable
from typing import Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from nonholo.base.types import Float, Int
from nonholo.orbit import Orbit
from nonholo.plotting import theme
from nonholo.plotting.animation._scene import stage
from nonholo.plotting.motion import known_axes, rotation_axes
from nonholo.plotting.parts import View, arcs, best_view, draw_globe, forbidden_axis, set_curve, turn_per_state

_TURN = np.radians(22.0)  # most between two frames
_PIECE = np.radians(4.0)
_THINNEST = 0.12  # of the drawn box, over its longest side
_BOX = "#a8d4f2"
_LIGHT = np.array([-0.4, 0.6, 0.7]) / np.linalg.norm([-0.4, 0.6, 0.7])  # right, up, toward the eye
_BODY_AXES: tuple[dict[str, Any], ...] = (
    {"color": theme.MUTED, "linewidth": 1.6},
    {"color": theme.MUTED, "linewidth": 1.6},
    {"color": theme.INK, "linewidth": 3.0, "marker": "o", "markersize": 6, "label": "forbidden axis"},
)
_SPIN = {"color": theme.UNSTABLE, "linewidth": 2.0, "marker": "D", "markersize": 4, "label": "angular velocity"}


def top_motion(orbit: Orbit) -> float:
    """Return how far the top turns between saved states, in units of what the eye can follow from frame to frame."""
    return turn_per_state(orbit) / float(_TURN)


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
    axes.legend(loc="lower left", fontsize=9, borderaxespad=0.0)
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
    line = axes.plot([], [], solid_capstyle="round", markevery=[1], **look)[0]

    def show(foot: Float[np.ndarray, "3"], tip: Float[np.ndarray, "3"]) -> None:
        flat, depth = view(np.stack([foot, tip]))
        line.set_data(*flat.T)
        line.set(zorder=7 if depth[1] >= 0 else 3, alpha=1.0 if depth[1] >= 0 else 0.55)

    return show
