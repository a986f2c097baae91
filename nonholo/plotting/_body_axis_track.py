"""The path of a top's forbidden body axis on the sphere in space, between its two permanent rotations.

[fedorov-zenkov-2004], section 4: the theorem on bi-asymptotics.
"""

import dataclasses
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.colors import to_rgb

from nonholo._types import Float
from nonholo.orbit import Orbit
from nonholo.plotting import _theme as theme
from nonholo.plotting._sphere import View, arcs, best_view, draw_curve, draw_globe, great_circle, opacity
from nonholo.plotting._subject import is_discrete, permanent_velocity, system_of
from nonholo.plotting._thinning import turn_per_state, window
from nonholo.systems import SuslovTop

_MOST_DOTS = 1200
_FINEST = np.radians(4.0)  # no need to draw states that are closer than this
_PIECE = np.radians(3.0)  # longer steps are joined by arcs of pieces like this
_SPARSE = np.radians(40.0)  # the eye cannot join states that are farther apart: dots come first
_REMEDY = "Use `blade_track` for a sleigh."


@dataclasses.dataclass(frozen=True)
class BodyAxisTrack:
    """What `body_axis_track` drew; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        view: The projection.
        points: The drawn points of the path in space.
        path: The path, coloured by time, what lies behind the sphere fainter.
        dots: The states of a discrete orbit.
        axis_before: Unit vector in space of the angular velocity that the motion comes from, if the orbit starts there.
        axis_after: Unit vector in space of the angular velocity that the motion settles to, if the orbit gets there.
        flow: The path of the continuous motion.
    """

    axes: Axes
    view: View
    points: Float[np.ndarray, "L 3"]
    path: LineCollection
    dots: PathCollection | None
    axis_before: Float[np.ndarray, "3"] | None
    axis_after: Float[np.ndarray, "3"] | None
    flow: LineCollection | None


@theme.styled
def body_axis_track(
    orbit: Orbit, axes: Axes | None = None, flow: Orbit | None = None, view: tuple[float, float] | None = None
) -> BodyAxisTrack:
    r"""Draw the path of the forbidden body axis, $R_k\gamma$, on the unit sphere in space.

    A permanent rotation carries the axis along the great circle about its angular velocity. If the orbit starts or ends
    close to one, that angular velocity $R_k\omega$ is drawn as an axis, with its circle dashed. Of an orbit too long to
    draw, the part about the transition is shown.

    Reference: [fedorov-zenkov-2004], section 4.

    Args:
        orbit: An orbit of a `SuslovTop`, with poses.
        axes: Where to draw (plain two-dimensional axes; the projection is orthographic); a new figure by default.
        flow: The continuous motion from the same initial data, drawn over it.
        view: Azimuth and elevation of the eye in degrees; by default chosen so that most of the path is in front.

    Raises:
        ValueError: An orbit of another system, or without poses.

    Example:
        >>> top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
        >>> orbit = nh.simulate(nh.discretize(top, 0.1), body_velocity=(0.4, 0.9, 0.0), steps=600)
        >>> track = nh.plot.body_axis_track(orbit)
        >>> np.allclose(track.points[-1], orbit.configuration[-1] @ [0, 0, 1]), track.axis_before is None
        (True, True)
    """
    gamma = system_of("body_axis_track(orbit=...)", orbit, SuslovTop, _REMEDY).axis
    if flow is not None:
        system_of("body_axis_track(flow=...)", flow, SuslovTop, _REMEDY)
    axes = theme.axes_or_new(axes, (6.0, 6.0))
    part = _part(orbit)
    shown = orbit[part]
    points = shown.configuration @ gamma
    before, after = rotation_axes(orbit)
    eye = best_view(points, known_axes(before, after)) if view is None else View(*view)
    draw_globe(axes, eye)
    curve = None if flow is None else _flow(axes, eye, flow, gamma)
    path, dots = _path(axes, eye, shown, points, orbit)
    _rotation_axes(axes, eye, before, after)
    words = ("start" if part.start == 0 else "", "end" if part.stop == len(orbit) else "")
    _ends(axes, eye, points, words, theme.end_colours(orbit))
    axes.set_title("Forbidden body axis in space")
    theme.legend_above(axes)
    return BodyAxisTrack(axes, eye, points, path, dots, before, after, curve)


def _part(orbit: Orbit) -> slice:
    turn = turn_per_state(orbit)
    stride = max(1, int(_FINEST / turn)) if turn > 0 else max(1, len(orbit) // _MOST_DOTS)
    return window(orbit, stride, _MOST_DOTS)


def rotation_axes(orbit: Orbit) -> tuple[Float[np.ndarray, "3"] | None, Float[np.ndarray, "3"] | None]:
    """Return unit vectors in space of the permanent rotations left and reached; None where the orbit is not close."""
    return _rotation_axis(orbit, int(orbit.time.argmin()), 1), _rotation_axis(orbit, int(orbit.time.argmax()), -1)


def _rotation_axis(orbit: Orbit, state: int, repelling: int) -> Float[np.ndarray, "3"] | None:
    velocity, attracting = permanent_velocity(orbit, state), orbit.system.equilibria().attracting
    if velocity is None or (attracting is not None and repelling * (velocity @ attracting) > 0):
        return None
    return orbit[state : state + 1].configuration[0] @ velocity / np.linalg.norm(velocity)


def known_axes(*axes: Float[np.ndarray, "3"] | None) -> Float[np.ndarray, "A 3"]:
    """Return those of the axes that are known, in rows."""
    return np.array([axis for axis in axes if axis is not None]).reshape(-1, 3)


def _path(
    axes: Axes, eye: View, shown: Orbit, points: Float[np.ndarray, "L 3"], whole: Orbit
) -> tuple[LineCollection, PathCollection | None]:
    scale = theme.time_scale(whole)
    step = np.linalg.norm(np.diff(points, axis=0), axis=1).max(initial=0.0)
    pieces = max(1, int(np.ceil(step / _PIECE)))
    colours = np.repeat(theme.TIME(scale(shown.time[1:])), pieces, axis=0)
    sparse = step > _SPARSE
    width = 0.6 if sparse else 1.5
    path = draw_curve(axes, eye, arcs(points, pieces), colours.reshape(-1, 4), width=width, zorder=4)
    if not is_discrete(whole):
        return path, None
    flat, depth = eye(points)
    faces = theme.TIME(scale(shown.time))
    faces[:, 3] = opacity(depth)
    order = np.argsort(depth)
    return path, axes.scatter(*flat[order].T, s=18 if sparse else 7, color=faces[order], linewidths=0, zorder=5)


def _flow(axes: Axes, eye: View, flow: Orbit, gamma: Float[np.ndarray, "3"]) -> LineCollection:
    points = flow[_part(flow)].configuration @ gamma
    axes.plot([], [], color=theme.CONTINUOUS, linewidth=1.0, label="continuous")  # the curve's own first piece is faint
    return draw_curve(axes, eye, points, np.array(to_rgb(theme.CONTINUOUS)), width=1.0, zorder=5.5)


def _rotation_axes(
    axes: Axes, eye: View, before: Float[np.ndarray, "3"] | None, after: Float[np.ndarray, "3"] | None
) -> None:
    if before is not None and after is not None and np.linalg.norm(before - after) < 1e-6:
        before, names = None, ("", "rotation axis")
    else:
        names = ("rotation axis\nbefore", "rotation axis\nafter")
    axis_and_look = zip((before, after), names, (theme.UNSTABLE, theme.STABLE), strict=True)
    drawn = [(axis, name, colour) for axis, name, colour in axis_and_look if axis is not None]
    tips = [eye(1.26 * axis)[0] for axis, _, _ in drawn]
    for (axis, name, colour), tip in zip(drawn, tips, strict=True):
        _rotation_axis_line(axes, eye, axis, colour)
        _name_beside(axes, name, tip, away=tip - np.mean(tips, axis=0), colour=colour)


def _name_beside(axes: Axes, name: str, tip: Float[np.ndarray, "2"], away: Float[np.ndarray, "2"], colour: str) -> None:
    """Write beside the tip of an arrow from the centre, on the side away from its neighbour or from the centre."""
    aside = np.array([-tip[1], tip[0]]) / (np.linalg.norm(tip) or 1.0)
    towards = away if np.linalg.norm(away) > 1e-9 else np.array([0.0, np.copysign(1.0, tip[1])])
    aside = aside if aside @ towards >= 0 else -aside
    horizontal = "left" if aside[0] > 0.3 else "right" if aside[0] < -0.3 else "center"
    vertical = "bottom" if aside[1] > 0.3 else "top" if aside[1] < -0.3 else "center"
    look: dict[str, Any] = {"color": colour, "ha": horizontal, "va": vertical, "linespacing": 1.0, "zorder": 9}
    axes.text(tip[0] + 0.04 * aside[0], tip[1] + 0.04 * aside[1], name, path_effects=theme.HALO, **look)


def _rotation_axis_line(axes: Axes, eye: View, axis: Float[np.ndarray, "3"], colour: str) -> None:
    circle = great_circle(axis)
    draw_curve(axes, eye, circle, np.array(to_rgb(colour)), width=0.9, zorder=2, linestyles=(0, (5, 4)))
    (tip, pole, foot), depth = eye(np.array([1.26, 1.0, -1.0])[:, None] * axis)
    axes.plot(*np.stack([foot, pole], axis=1), color=colour, linewidth=0.9, alpha=0.45, zorder=2.5)
    look: dict[str, Any] = {"arrowstyle": "-|>", "linewidth": 1.8, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 14}
    look |= {"color": colour, "alpha": float(opacity(depth[:1])[0])}
    axes.annotate("", tip, xytext=pole, zorder=6, annotation_clip=False, arrowprops=look)


def _ends(axes: Axes, eye: View, points: Float[np.ndarray, "L 3"], words: tuple[str, str], rim: list[Any]) -> None:
    flat, depth = eye(points[[0, -1]])
    for place, alpha, edge, face, word in zip(flat, opacity(depth), rim, ("white", rim[1]), words, strict=True):
        if word and not (word == "end" and np.allclose(flat[0], flat[1])):
            axes.scatter(*place, s=40, facecolors=[face], edgecolors=[edge], linewidths=1.6, alpha=alpha, zorder=7)
            axes.annotate(word, place, xytext=(7, 7), textcoords="offset points", zorder=8, path_effects=theme.HALO)
