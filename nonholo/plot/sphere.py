"""The unit sphere in orthographic projection, paths, axes and words on it: what lies behind is faded, not hidden."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import Circle

from nonholo.base.checks import number, pair
from nonholo.base.types import Float
from nonholo.orbit import Orbit
from nonholo.plot import theme

Points = Float[np.ndarray, "K 3"]
_SHADES = 256
_BEHIND = 0.22  # opacity of what lies behind the sphere


class View(NamedTuple):
    """An orthographic view of space with e3 upwards, from an azimuth and an elevation in degrees.

    Example:
        >>> flat, depth = View(0.0, 0.0)(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.5]]))
        >>> flat.tolist(), depth.tolist()
        ([[0.0, 0.0], [1.0, 0.5]], [1.0, 0.0])
    """

    azimuth: float
    elevation: float

    @property
    def frame(self) -> Float[np.ndarray, "3 3"]:
        """Rows: to the right, upwards, toward the eye."""
        azimuth, elevation = np.radians([self.azimuth, self.elevation])
        ca, sa, ce, se = np.cos(azimuth), np.sin(azimuth), np.cos(elevation), np.sin(elevation)
        return np.array([[-sa, ca, 0.0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]])

    def __call__(self, points: Float[np.ndarray, "... 3"]) -> tuple[np.ndarray, np.ndarray]:
        """Return the flat points and their distances toward the eye."""
        rotation = points @ self.frame.T
        return rotation[..., :2], rotation[..., 2]


def view_of(where: str, angles: Any, points: Points, axes: Float[np.ndarray, "A 3"]) -> View:
    """Return the view that a caller asks for, by default the best one."""
    if angles is None:
        return best_view(points, axes)
    return View(*(float(number(where, angle)) for angle in pair(where, angles)))


def best_view(points: Points, axes: Float[np.ndarray, "A 3"]) -> View:
    """Return the view that has most of a path in front and sees axes, or that of the path, obliquely."""
    if not len(axes):
        axes = np.linalg.eigh(points.T @ points)[1][:, :1].T
    candidates = [View(azimuth, elevation) for elevation in (20, 30, 40) for azimuth in range(0, 360, 15)]
    tips = np.concatenate([axes, -axes])

    def merit(view: View) -> float:
        in_front = np.tanh(3 * view(points)[1]).mean()
        flat, depth = view(axes)
        oblique = np.abs(np.linalg.norm(flat, axis=1) - 0.85).sum()
        flat_tips = view(tips)[0]
        apart = np.linalg.norm(flat_tips[:, None] - flat_tips, axis=-1) + 2 * np.eye(len(tips))
        return float(in_front - oblique + 0.3 * np.sign(depth).sum() + min(apart.min(initial=1.0), 0.5))

    return max(candidates, key=merit)


def draw_globe(axes: Axes, view: View) -> None:
    """Draw the shaded sphere with its wireframe and set up the axes for it."""
    x, y = np.meshgrid(*2 * (np.linspace(-1, 1, _SHADES),))
    light = np.clip((-0.45 * x + 0.55 * y + 0.7 * np.sqrt(np.clip(1 - x * x - y * y, 0, 1))), 0, 1)
    ground, range_ = (0.12, 0.13) if theme.is_dark() else (0.90, 0.095)
    shade = axes.imshow(ground + range_ * light, cmap="gray", vmin=0, vmax=1, extent=(-1, 1, -1, 1), origin="lower")
    shade.set(zorder=0, interpolation="bilinear")
    rim = Circle((0, 0), 1.0, facecolor="none", edgecolor=theme.MUTED, linewidth=0.9, zorder=3)
    axes.add_patch(rim)
    shade.set_clip_path(rim)
    turn = np.linspace(0, 2 * np.pi, 181)
    cos, sin, zero = np.cos(turn), np.sin(turn), np.zeros_like(turn)
    parallels = [(np.cos(v) * cos, np.cos(v) * sin, np.sin(v) + zero) for v in np.radians([-60, -30, 0, 30, 60])]
    meridians = [(np.cos(v) * cos, np.sin(v) * cos, sin) for v in np.radians([0, 30, 60, 90, 120, 150])]
    for circle in (np.stack(each, axis=-1) for each in parallels + meridians):
        draw_curve(axes, view, circle, to_rgb(theme.MUTED if theme.is_dark() else "#aab0ba"), width=0.6, zorder=1)
    axes.set(xlim=(-1.27, 1.27), ylim=(-1.15, 1.15), aspect="equal")
    axes.set_axis_off()


def draw_curve(axes: Axes, view: View, points: Points, colors: Any, width: float, **options: Any) -> LineCollection:
    """Draw a curve on the sphere; parts behind are fainter and thinner, nearer parts are drawn last."""
    collection = LineCollection([], **options)
    axes.add_collection(collection, autolim=False)
    set_curve(collection, view, points, colors, width)
    return collection


def set_curve(collection: LineCollection, view: View, points: Points, colors: Any, width: float, side: int = 0) -> None:
    """Give a collection a new curve.

    Args:
        collection: The lines to change.
        view: The projection.
        points: The curve.
        colors: One color, or one for each piece.
        width: Width of what lies in front.
        side: 1 for the pieces in front only, -1 for those behind only, 0 for all.
    """
    ends, depths = view(points)
    depth = (depths[:-1] + depths[1:]) / 2
    order = np.argsort(depth)
    order = order[depth[order] * side >= 0]
    front = _in_front(depth)[order]
    rgb = np.broadcast_to(np.asarray(colors)[..., :3], (len(depth), 3))[order]
    alpha = (_BEHIND + (1 - _BEHIND) * front)[:, None]
    segments = np.stack([ends[:-1], ends[1:]], axis=1)[order]
    collection.set(segments=segments, colors=np.hstack([rgb, alpha]), linewidths=width * (0.6 + 0.4 * front))


def _in_front(depth: Float[np.ndarray, "K"]) -> Float[np.ndarray, "K"]:
    """Return 0 behind, 1 in front, with a smooth change at the rim."""
    return np.clip(0.5 + depth / 0.16, 0.0, 1.0)


def opacity(depth: Float[np.ndarray, "K"]) -> Float[np.ndarray, "K"]:
    """Return the opacity of points at these distances toward the eye."""
    return _BEHIND + (1 - _BEHIND) * _in_front(depth)


def arcs(points: Points, pieces: int) -> Float[np.ndarray, "L 3"]:
    """Join points of the sphere by arcs of great circles, each of this many pieces."""
    share = np.arange(pieces)[:, None] / pieces
    chords = (1 - share) * points[:-1, None] + share * points[1:, None]
    curve = np.concatenate([chords.reshape(-1, 3), points[-1:]])
    length = np.linalg.norm(curve, axis=1, keepdims=True)
    return curve / np.where(length > 0, length, 1.0)


def great_circle(axis: Float[np.ndarray, "3"]) -> Points:
    """Return the great circle about an axis."""
    seed = np.eye(3)[np.argmin(np.abs(axis))]
    first = np.cross(axis, seed) / np.linalg.norm(np.cross(axis, seed))
    second = np.cross(axis, first) / np.linalg.norm(axis)
    turn = np.linspace(0, 2 * np.pi, 241)[:, None]
    return np.cos(turn) * first + np.sin(turn) * second


_PIECE = np.radians(3.0)  # longer steps are joined by arcs of pieces like this
_SPARSE = np.radians(40.0)  # the eye cannot join states that are farther apart: dots come first


def draw_path(
    axes: Axes, eye: View, states: Orbit, points: Float[np.ndarray, "L 3"], whole: Orbit
) -> tuple[LineCollection, PathCollection | None]:
    """Draw points of the sphere that belong to the states shown, with the colors of time of the whole orbit."""
    step = np.linalg.norm(np.diff(points, axis=0), axis=1).max(initial=0.0)
    pieces = max(1, int(np.ceil(step / _PIECE)))
    colors = np.repeat(theme.time_colors(whole, states.time[1:]), pieces, axis=0)
    sparse = step > _SPARSE
    name, color = theme.option("label", None), theme.option("color", colors[len(colors) // 2] if len(colors) else None)
    axes.plot([], [], color=color, label=name)  # the curve's own first piece may be faint
    path = draw_curve(axes, eye, arcs(points, pieces), colors.reshape(-1, 4), width=0.6 if sparse else 1.5, zorder=4)
    if not whole.is_discrete:
        return path, None
    flat, depth = eye(points)
    faces = theme.time_colors(whole, states.time)
    faces[:, 3] = opacity(depth)
    order = np.argsort(depth)
    return path, axes.scatter(*flat[order].T, s=18 if sparse else 7, color=faces[order], linewidths=0, zorder=5)


def name_beside(axes: Axes, name: str, tip: Float[np.ndarray, "2"], away: Float[np.ndarray, "2"], color: str) -> None:
    """Write beside the tip of an arrow from the center, on the side away from its neighbor or from the center."""
    aside = np.array([-tip[1], tip[0]]) / (np.linalg.norm(tip) or 1.0)
    toward = away if np.linalg.norm(away) > 1e-9 else np.array([0.0, np.copysign(1.0, tip[1])])
    aside = aside if aside @ toward >= 0 else -aside
    horizontal = "left" if aside[0] > 0.3 else "right" if aside[0] < -0.3 else "center"
    vertical = "bottom" if aside[1] > 0.3 else "top" if aside[1] < -0.3 else "center"
    look: dict[str, Any] = {"color": color, "ha": horizontal, "va": vertical, "linespacing": 1.0, "zorder": 9}
    axes.text(tip[0] + 0.04 * aside[0], tip[1] + 0.04 * aside[1], name, path_effects=theme.HALO, **look)


def draw_named_axes(axes: Axes, eye: View, vectors: list[tuple[Float[np.ndarray, "3"], str, str]]) -> None:
    """Draw unit vectors as arrows out of the sphere, their great circles dashed, their names away from each other."""
    tips = [eye(1.26 * axis)[0] for axis, _, _ in vectors]
    for (axis, name, color), end in zip(vectors, tips, strict=True):
        draw_curve(axes, eye, great_circle(axis), np.array(to_rgb(color)), width=0.9, zorder=2, linestyles=(0, (5, 4)))
        (tip, pole, foot), depth = eye(np.array([1.26, 1.0, -1.0])[:, None] * axis)
        axes.plot(*np.stack([foot, pole], axis=1), color=color, linewidth=0.9, alpha=0.45, zorder=2.5)
        look: dict[str, Any] = {"arrowstyle": "-|>", "linewidth": 1.8, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 14}
        look |= {"color": color, "alpha": float(opacity(depth[:1])[0])}
        axes.annotate("", tip, xytext=pole, zorder=6, annotation_clip=False, arrowprops=look)
        name_beside(axes, name, end, away=end - np.mean(tips, axis=0), color=color)


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
