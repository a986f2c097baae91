"""Paths, axes and words on the sphere of `_sphere`. No mechanics."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.colors import to_rgb

from nonholo.base.types import Float
from nonholo.orbit import Orbit
from nonholo.plot import theme
from nonholo.plot.parts._sphere import View, arcs, draw_curve, great_circle, opacity

_PIECE = np.radians(3.0)  # longer steps are joined by arcs of pieces like this
_SPARSE = np.radians(40.0)  # the eye cannot join states that are farther apart: dots come first


def draw_path(
    axes: Axes, eye: View, shown: Orbit, points: Float[np.ndarray, "L 3"], whole: Orbit
) -> tuple[LineCollection, PathCollection | None]:
    """Draw points of the sphere that belong to the states shown, with the colors of time of the whole orbit."""
    step = np.linalg.norm(np.diff(points, axis=0), axis=1).max(initial=0.0)
    pieces = max(1, int(np.ceil(step / _PIECE)))
    colors = np.repeat(theme.time_colors(whole, shown.time[1:]), pieces, axis=0)
    sparse = step > _SPARSE
    width = 0.6 if sparse else 1.5
    name, color = theme.asked("label", None), theme.asked("color", colors[len(colors) // 2] if len(colors) else None)
    axes.plot([], [], color=color, label=name)  # the curve's own first piece may be faint
    path = draw_curve(axes, eye, arcs(points, pieces), colors.reshape(-1, 4), width=width, zorder=4)
    if not whole.is_discrete:
        return path, None
    flat, depth = eye(points)
    faces = theme.time_colors(whole, shown.time)
    faces[:, 3] = opacity(depth)
    order = np.argsort(depth)
    return path, axes.scatter(*flat[order].T, s=18 if sparse else 7, color=faces[order], linewidths=0, zorder=5)


def draw_axis(axes: Axes, eye: View, axis: Float[np.ndarray, "3"], color: str) -> None:
    """Draw a unit vector as an arrow out of the sphere, with the great circle about it dashed."""
    circle = great_circle(axis)
    draw_curve(axes, eye, circle, np.array(to_rgb(color)), width=0.9, zorder=2, linestyles=(0, (5, 4)))
    (tip, pole, foot), depth = eye(np.array([1.26, 1.0, -1.0])[:, None] * axis)
    axes.plot(*np.stack([foot, pole], axis=1), color=color, linewidth=0.9, alpha=0.45, zorder=2.5)
    look: dict[str, Any] = {"arrowstyle": "-|>", "linewidth": 1.8, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 14}
    look |= {"color": color, "alpha": float(opacity(depth[:1])[0])}
    axes.annotate("", tip, xytext=pole, zorder=6, annotation_clip=False, arrowprops=look)


def name_beside(axes: Axes, name: str, tip: Float[np.ndarray, "2"], away: Float[np.ndarray, "2"], color: str) -> None:
    """Write beside the tip of an arrow from the center, on the side away from its neighbor or from the center."""
    aside = np.array([-tip[1], tip[0]]) / (np.linalg.norm(tip) or 1.0)
    toward = away if np.linalg.norm(away) > 1e-9 else np.array([0.0, np.copysign(1.0, tip[1])])
    aside = aside if aside @ toward >= 0 else -aside
    horizontal = "left" if aside[0] > 0.3 else "right" if aside[0] < -0.3 else "center"
    vertical = "bottom" if aside[1] > 0.3 else "top" if aside[1] < -0.3 else "center"
    look: dict[str, Any] = {"color": color, "ha": horizontal, "va": vertical, "linespacing": 1.0, "zorder": 9}
    axes.text(tip[0] + 0.04 * aside[0], tip[1] + 0.04 * aside[1], name, path_effects=theme.HALO, **look)


def draw_named_axes(axes: Axes, eye: View, drawn: list[tuple[Float[np.ndarray, "3"], str, str]]) -> None:
    """Draw unit vectors with their names and colors, the names away from each other."""
    tips = [eye(1.26 * axis)[0] for axis, _, _ in drawn]
    for (axis, name, color), tip in zip(drawn, tips, strict=True):
        draw_axis(axes, eye, axis, color)
        name_beside(axes, name, tip, away=tip - np.mean(tips, axis=0), color=color)


def mark_ends(axes: Axes, eye: View, points: Float[np.ndarray, "L 3"], part: slice, orbit: Orbit) -> None:
    """Mark the first and the last point of a part of an orbit, where they are those of the orbit."""
    flat, depth = eye(points[[0, -1]])
    rim = theme.end_colors(orbit)
    has_end = part.stop == len(orbit) and not np.allclose(flat[0], flat[1])
    words = ("start" if part.start == 0 else "", "end" if has_end else "")
    for place, alpha, edge, face, word in zip(flat, opacity(depth), rim, (theme.PAPER, rim[1]), words, strict=True):
        if word:
            axes.scatter(*place, s=40, facecolors=[face], edgecolors=[edge], linewidths=1.6, alpha=alpha, zorder=7)
            axes.annotate(word, place, xytext=(7, 7), textcoords="offset points", zorder=8, path_effects=theme.HALO)
