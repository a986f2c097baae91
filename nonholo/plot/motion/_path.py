"""A path in the plane or in space: its axes and the names of its ends."""

from typing import Any

import numpy as np
from matplotlib.ticker import MaxNLocator

from nonholo.base.types import Float
from nonholo.orbit import AbstractOrbit
from nonholo.plot import parts, theme

_THIN = 0.35  # shortest side of the box in space, in parts of its longest


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


def mark_path_ends(axes: Any, points: Float[np.ndarray, "L d"], orbit: AbstractOrbit) -> None:
    """Mark and name the first and the last point of a path."""
    parts.draw_ends(axes, points, orbit)
    axes.text(*points[0], "  start", zorder=9, path_effects=theme.HALO)
    if not np.allclose(points[0], points[-1]):
        axes.text(*points[-1], "  end", zorder=9, path_effects=theme.HALO)
