"""An animated sleigh: its body, blade, center of mass and track on the plane."""

from collections.abc import Callable
from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from nonholo.base.types import Float, Int
from nonholo.orbit import Orbit
from nonholo.plotting import theme
from nonholo.plotting.animation._scene import stage
from nonholo.plotting.parts import evenly_spread, some_states, square_about, turn_per_state
from nonholo.plotting.sheets import Blade, blade_of_system

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
    axes.grid(color="#eceef1", linewidth=0.8)
    axes.tick_params(length=0, labelleft=False, labelbottom=False)
    axes.spines[:].set_visible(False)
    axes.set_axisbelow(True)


def _parts(axes: Axes) -> tuple[Polygon, Line2D, Line2D]:
    look = {"facecolor": "#56b4e9", "edgecolor": theme.DISCRETE, "alpha": 0.4, "linewidth": 1.2}
    body = Polygon(np.zeros((1, 2)), closed=True, zorder=3, **look)
    axes.add_patch(body)
    blade = axes.plot([], [], color=theme.INK, linewidth=4, zorder=5)[0]
    center = axes.plot([], [], "o", markersize=6, markerfacecolor="white", markeredgecolor=theme.INK, zorder=6)[0]
    return body, blade, center
