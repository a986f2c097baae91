"""The path of a body axis on the sphere in space: a top's forbidden axis between its two permanent rotations.

[fedorov-zenkov-2004], section 4: the theorem on bi-asymptotics.
"""

import dataclasses
from typing import Any, TypeAlias, Unpack

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.colors import to_rgb

from nonholo.base.checks import array, error, shown
from nonholo.base.types import Float
from nonholo.groups import SO
from nonholo.orbit import Orbit
from nonholo.plot import parts, theme

Axis: TypeAlias = Float[np.ndarray, "3"] | None  # a unit vector

_MOST_DOTS = 1200
_FINEST = np.radians(4.0)  # no need to draw states that are closer than this
_REMEDY = "Use `blade_track` for a sleigh, `point_track` for other motions of SE(n)."


@dataclasses.dataclass(frozen=True)
class BodyAxisTrack:
    """The artists of `body_axis_track`; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        view: The projection.
        points: The drawn points of the path in space.
        path: The path, colored by time, what lies behind the sphere fainter.
        dots: The states of a discrete orbit.
        axis_before: Unit vector in space of the angular velocity that the motion comes from, if the orbit starts there.
        axis_after: Unit vector in space of the angular velocity that the motion settles to, if the orbit gets there.
        fixed_axis: Unit vector in space about which a right-invariant constraint allows no rotation, or along the
            spatial momentum of a free body.
        flow: The path of the continuous motion.
    """

    axes: Axes
    view: parts.View
    points: Float[np.ndarray, "L 3"]
    path: LineCollection
    dots: PathCollection | None
    axis_before: Axis
    axis_after: Axis
    fixed_axis: Axis
    flow: LineCollection | None


@theme.styled
def body_axis_track(
    orbit: Orbit,
    axes: Axes | None = None,
    flow: Orbit | None = None,
    view: tuple[float, float] | None = None,
    body_axis: Any = None,
    **look: Unpack[theme.Look],
) -> BodyAxisTrack:
    r"""Draw the path of a body axis, $R_k\gamma$, on the unit sphere in space.

    A permanent rotation carries the axis along a circle about its angular velocity. If the orbit of a Suslov top starts
    or ends close to one, that angular velocity $R_k\omega$ is drawn as an axis, with its great circle dashed. For a
    right-invariant constraint the axis about which there is no rotation is drawn, fixed in space; for a free body its
    spatial momentum. Of an orbit too long to draw, the part about the transition is shown.

    Reference: [fedorov-zenkov-2004], section 4.

    Args:
        orbit: An orbit on SO(3), with poses.
        axes: Where to draw (plain two-dimensional axes; the projection is orthographic); a new figure by default.
        flow: The continuous motion from the same initial data, drawn over it.
        view: Azimuth and elevation of the eye in degrees; by default chosen so that most of the path is in front.
        body_axis: $\gamma$ in body coordinates, scaled to length 1; by default the body axis about which there is
            no rotation, as for a Suslov top, otherwise body axis 3.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: An orbit on another group, or without poses; a body axis of length 0.

    Example:
        >>> top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
        >>> orbit = nh.simulate(nh.discretize(top, 0.1), body_velocity=(0.4, 0.9, 0.0), steps=600)
        >>> track = nh.plot.body_axis_track(orbit)
        >>> np.allclose(track.points[-1], orbit.configuration[-1] @ [0, 0, 1]), track.axis_before is None
        (True, True)
    """
    where = "body_axis_track(orbit=...)"
    orbit = parts.posed(where, orbit)
    if orbit.system.group != SO(3):
        raise error(where, "be an orbit on SO(3)", shown(orbit), _REMEDY)
    flow = parts.same_group("body_axis_track(flow=...)", flow, orbit)
    gamma = _body_axis(orbit, body_axis)
    axes = theme.axes_or_new(axes, (6.0, 6.0))
    part = _part(orbit)
    points = orbit[part].configuration @ gamma
    before, after = rotation_axes(orbit)
    fixed = _fixed_axis(orbit)
    eye = parts.view_of("body_axis_track(view=...)", view, points, known_axes(before, after, fixed))
    parts.draw_globe(axes, eye)
    curve = None if flow is None else _flow(axes, eye, flow, gamma)
    path, dots = parts.draw_path(axes, eye, orbit[part], points, orbit)
    parts.draw_named_axes(axes, eye, _named(before, after, fixed, orbit))
    parts.mark_ends(axes, eye, points, part, orbit)
    theme.write_title(axes, _title(orbit, body_axis))
    theme.legend_above(axes)
    return BodyAxisTrack(axes, eye, points, path, dots, before, after, fixed, curve)


def _body_axis(orbit: Orbit, chosen: Any) -> Float[np.ndarray, "3"]:
    if chosen is None:
        forbidden = parts.forbidden_axis(orbit.system)
        chosen = (0.0, 0.0, 1.0) if forbidden is None else forbidden
    where, remedy = "body_axis_track(body_axis=...)", "Pass a vector in body coordinates."
    axis = array(where, chosen, (3,), remedy)
    if not axis.any():
        raise error(where, "have a direction", "the vector 0", remedy)
    return axis / np.linalg.norm(axis)


def _title(orbit: Orbit, chosen: Any) -> str:
    if chosen is not None:
        return "Body axis in space"
    return "Body axis 3 in space" if parts.forbidden_axis(orbit.system) is None else "Forbidden body axis in space"


def _fixed_axis(orbit: Orbit) -> Axis:
    """Return the direction in space that the constraint, or the lack of one, singles out."""
    system = orbit.system
    if parts.is_free(system):
        axis = orbit[:1].spatial_momentum[0]
    elif system.is_spatial and len(system.annihilator) == 1:
        axis = system.annihilator[0]
    else:
        return None
    length = np.linalg.norm(axis)
    return axis / length if length > 0 else None


def _part(orbit: Orbit) -> slice:
    return parts.window(orbit, parts.turn_per_state(orbit), _FINEST, _MOST_DOTS)


def rotation_axes(orbit: Orbit) -> tuple[Axis, Axis]:
    """Return unit vectors in space of the permanent rotations left and reached; None where the orbit is not close."""
    return _rotation_axis(orbit, int(orbit.time.argmin()), 1), _rotation_axis(orbit, int(orbit.time.argmax()), -1)


def _rotation_axis(orbit: Orbit, state: int, repelling: int) -> Axis:
    velocity, equilibria = parts.permanent_velocity(orbit, state), parts.known_equilibria(orbit.system)
    attracting = None if equilibria is None else equilibria.attracting
    if velocity is None or (attracting is not None and repelling * (velocity @ attracting) > 0):
        return None
    return orbit[state : state + 1].configuration[0] @ velocity / np.linalg.norm(velocity)


def known_axes(*axes: Axis) -> Float[np.ndarray, "A 3"]:
    """Return those of the axes that are known, in rows."""
    return np.array([axis for axis in axes if axis is not None]).reshape(-1, 3)


def _flow(axes: Axes, eye: parts.View, flow: Orbit, gamma: Float[np.ndarray, "3"]) -> LineCollection:
    points = flow[_part(flow)].configuration @ gamma
    axes.plot([], [], color=theme.CONTINUOUS, linewidth=1.0, label="continuous")  # the curve's own first piece is faint
    return parts.draw_curve(axes, eye, points, np.array(to_rgb(theme.CONTINUOUS)), width=1.0, zorder=5.5)


def _named(before: Axis, after: Axis, fixed: Axis, orbit: Orbit) -> list[tuple[Float[np.ndarray, "3"], str, str]]:
    """Return the axes to draw, with their names and colors."""
    names = ("rotation axis\nbefore", "rotation axis\nafter")
    if before is not None and after is not None and np.linalg.norm(before - after) < 1e-6:
        before, names = None, ("", "rotation axis")
    third = "spatial\nmomentum" if parts.is_free(orbit.system) else "no rotation\nabout this axis"
    colors = (theme.UNSTABLE, theme.STABLE, theme.STABLE)
    every = zip((before, after, fixed), (*names, third), colors, strict=True)
    return [(axis, name, color) for axis, name, color in every if axis is not None]
