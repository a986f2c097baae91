"""Paths on spheres: of a body axis in space, and of three momenta on their energy ellipsoid, drawn as a sphere.

[fedorov-zenkov-2004], section 4: the theorem on bi-asymptotics.
"""

from typing import Any, NamedTuple, TypeAlias, Unpack, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.colors import to_rgb

from nonholo.base.checks import array, error, shown
from nonholo.base.types import Float
from nonholo.groups import SO
from nonholo.orbit import Orbit
from nonholo.plot import parts, sphere, theme
from nonholo.systems import AbstractLLSystem

Axis: TypeAlias = Float[np.ndarray, "3"] | None  # a unit vector

_MOST_DOTS = 1200
_FINEST = np.radians(4.0)  # no need to draw states that are closer than this
_NEAR = 0.03  # sine, in the metric of the energy, of the angle to the line of equilibria
_REMEDY = "Use `blade_track` for a sleigh, `point_track` for other motions of SE(n)."


class BodyAxisTrack(NamedTuple):
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
    view: sphere.View
    points: Float[np.ndarray, "L 3"]
    path: LineCollection
    dots: PathCollection | None
    axis_before: Axis
    axis_after: Axis
    fixed_axis: Axis
    flow: LineCollection | None


@theme.in_style
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
    orbit = parts.orbit_with_poses(where, orbit)
    if orbit.system.group != SO(3):
        raise error(where, "be an orbit on SO(3)", shown(orbit), _REMEDY)
    flow = parts.same_space("body_axis_track(flow=...)", flow, orbit, parts.orbit_with_poses)
    gamma = _body_axis(orbit, body_axis)
    axes = theme.axes_or_new(axes, (6.0, 6.0))
    part = _part(orbit)
    points = orbit[part].configuration @ gamma
    before, after = rotation_axes(orbit)
    third = _fixed_axis(orbit)
    eye = sphere.view_of("body_axis_track(view=...)", view, points, known_axes(before, after, third))
    sphere.draw_globe(axes, eye)
    curve = None
    if flow is not None:
        thin: Any = {"width": 1.0, "zorder": 5.5}
        axes.plot([], [], color=theme.CONTINUOUS, linewidth=1.0, label="continuous")  # its first piece is faint
        curve = sphere.draw_curve(axes, eye, flow[_part(flow)].configuration @ gamma, to_rgb(theme.CONTINUOUS), **thin)
    path, dots = sphere.draw_path(axes, eye, orbit[part], points, orbit)
    sphere.draw_named_axes(axes, eye, _axes_to_draw(before, after, third, orbit))
    sphere.mark_ends(axes, eye, points, part, orbit)
    title = "Body axis 3 in space" if parts.forbidden_axis(orbit.system) is None else "Forbidden body axis in space"
    theme.legend_above(axes, title if body_axis is None else "Body axis in space")
    return BodyAxisTrack(axes, eye, points, path, dots, before, after, third, curve)


def _body_axis(orbit: Orbit, vector: Any) -> Float[np.ndarray, "3"]:
    if vector is None:
        forbidden = parts.forbidden_axis(orbit.system)
        vector = (0.0, 0.0, 1.0) if forbidden is None else forbidden
    where, remedy = "body_axis_track(body_axis=...)", "Pass a vector in body coordinates."
    axis = array(where, vector, (3,), remedy)
    if not axis.any():
        raise error(where, "have a direction", "the vector 0", remedy)
    return axis / np.linalg.norm(axis)


def _fixed_axis(orbit: Orbit) -> Axis:
    """Return the direction in space that the constraint, or the lack of one, singles out."""
    if parts.is_free(system := orbit.system):
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
    """Return the axis of the permanent rotation that a state is close to, in the metric of the kinetic energy."""
    system, equilibria, here = orbit.system, parts.known_equilibria(orbit.system), orbit[state : state + 1]
    velocity, inertia = here.body_velocity[0], np.asarray(system.inertia_operator)
    if equilibria is None or len(equilibria.subspace) == 0 or not velocity @ inertia @ velocity > 0:
        return None
    if len(equilibria.subspace) < len(system.constraint_subspace):
        line = equilibria.subspace[0]
        along = (velocity @ inertia @ line) / (line @ inertia @ line) * line
        across = velocity - along
        if not across @ inertia @ across <= _NEAR**2 * (velocity @ inertia @ velocity):
            return None
        velocity = along
    if equilibria.attracting is not None and repelling * (velocity @ equilibria.attracting) > 0:
        return None
    return here.configuration[0] @ velocity / np.linalg.norm(velocity)


def known_axes(*axes: Axis) -> Float[np.ndarray, "A 3"]:
    """Return those of the axes that are known, in rows."""
    return np.array([axis for axis in axes if axis is not None]).reshape(-1, 3)


def _axes_to_draw(before: Axis, after: Axis, still: Axis, orbit: Orbit) -> list[tuple[Any, str, str]]:
    """Return the axes to draw, with their names and colors."""
    names = ("rotation axis\nbefore", "rotation axis\nafter")
    if before is not None and after is not None and np.linalg.norm(before - after) < 1e-6:
        before, names = None, ("", "rotation axis")
    third = "spatial\nmomentum" if parts.is_free(orbit.system) else "no rotation\nabout this axis"
    every = zip((before, after, still), (*names, third), (theme.UNSTABLE, theme.STABLE, theme.STABLE), strict=True)
    return [(axis, name, color) for axis, name, color in every if axis is not None]


_MOST_MOMENTA = 1500
_FINEST_MOMENTA = np.radians(3.0)  # no need to draw states that are closer than this


class MomentumSphere(NamedTuple):
    """The artists of `momentum_sphere`; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        view: The projection.
        points: The drawn points, on the unit sphere where the energy is that of the first state.
        path: The path, colored by time, what lies behind the sphere fainter.
        dots: The states of a discrete orbit.
        stable: The attracting equilibrium, filled.
        unstable: The repelling equilibrium, empty.
    """

    axes: Axes
    view: sphere.View
    points: Float[np.ndarray, "L 3"]
    path: LineCollection
    dots: PathCollection | None
    stable: PathCollection | None
    unstable: PathCollection | None


@theme.in_style
def momentum_sphere(
    orbit: Orbit, axes: Axes | None = None, view: tuple[float, float] | None = None, **look: Unpack[theme.Look]
) -> MomentumSphere:
    r"""Draw the momenta along a three-dimensional constraint subspace on the sphere of their energy.

    The ellipsoid of constant energy is drawn as the unit sphere,

    $$ u = B^{-1/2}\,r/\sqrt{2E_0}, \qquad |u|^2 = E/E_0, \qquad B = \mathbb{I}|_{\mathfrak{d}}, $$

    in the canonical body frame. For a free body on SO(3) these are the polhodes. Of an orbit too long to draw, the part
    about the transition is shown. Equilibria are drawn where the library knows an attracting one.

    Args:
        orbit: An orbit with a left-invariant constraint whose subspace has dimension 3.
        axes: Where to draw (plain two-dimensional axes; the projection is orthographic); a new figure by default.
        view: Azimuth and elevation of the eye in degrees; by default chosen so that most of the path is in front.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: No orbit, one without states, a right-invariant constraint, or a subspace of another dimension.

    Example:
        >>> body = nh.RigidBody(np.diag([1.0, 3.0, 2.0]))
        >>> orbit = nh.simulate(nh.discretize(body, 0.1), body_velocity=(0.02, 0.0, 1.0), steps=200)
        >>> np.allclose(np.linalg.norm(nh.plot.momentum_sphere(orbit).points, axis=1), 1.0)
        True
    """
    where, remedy = "momentum_sphere(orbit=...)", "Use `phase_portrait` in two dimensions, `overview` in others."
    smooth = parts.drawable(where, orbit)
    system = cast(AbstractLLSystem, smooth.system)
    parts.check_directions(where, orbit, system, (3, "three"), remedy)
    orbit = smooth
    values, directions = np.linalg.eigh(np.asarray(system.canonical.constrained_inertia))
    to_sphere = directions @ np.diag(values**-0.5) @ directions.T
    size = np.sqrt(2 * orbit[:1].energy[0]) or 1.0
    part = slice(0, len(orbit), 1)
    if len(orbit) > _MOST_MOMENTA:
        every = orbit.reduced_momentum @ to_sphere / size
        step = np.linalg.norm(np.diff(every, axis=0), axis=1).max(initial=0.0)
        part = parts.window(orbit, step, _FINEST_MOMENTA, _MOST_MOMENTA)
    points = orbit[part].reduced_momentum @ to_sphere / size
    attracting = _attracting(system, to_sphere)
    eye = sphere.view_of("momentum_sphere(view=...)", view, points, attracting)
    axes = theme.axes_or_new(axes, (6.0, 6.0))
    sphere.draw_globe(axes, eye)
    path, dots = sphere.draw_path(axes, eye, orbit[part], points, orbit)
    for index, direction in enumerate(to_sphere / np.linalg.norm(to_sphere, axis=1)[:, None]):
        (pole, tip), depth = eye(np.array([[1.0], [1.16]]) * direction)  # where each component alone points, outwards
        alpha = float(sphere.opacity(depth[:1])[0])
        axes.plot(*np.stack([pole, tip], axis=1), color=theme.MUTED, linewidth=1.4, alpha=alpha, zorder=6)
        sphere.name_beside(axes, f"$r_{index + 1}$", tip, away=tip, color=theme.MUTED)
    sphere.mark_ends(axes, eye, points, part, orbit)
    stable, unstable = _equilibria(axes, eye, attracting)
    theme.write_title(axes, "Momentum on its energy sphere")
    if axes.get_legend_handles_labels()[0]:
        # beside narrow axes, otherwise in the corner beside the sphere
        place = ("lower left", (1.0, 0.0)) if theme.is_narrow(axes) else ("lower right", None)
        theme.legend(axes, loc=place[0], bbox_to_anchor=place[1])
    return MomentumSphere(axes, eye, points, path, dots, stable, unstable)


def _attracting(system: AbstractLLSystem, to_sphere: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "A 3"]:
    """Return the attracting equilibrium as a row, no row where there is none or more than one."""
    canonical = system.canonical
    equilibria = parts.known_equilibria(canonical)
    if equilibria is None or equilibria.attracting is None or len(equilibria.subspace) != 1:
        return np.empty((0, 3))
    point = to_sphere @ canonical.restrict(canonical.inertia_operator @ equilibria.attracting)
    return (point / np.linalg.norm(point))[None, :]


def _equilibria(axes: Axes, eye: sphere.View, attracting: Float[np.ndarray, "A 3"]) -> tuple[Any, Any]:
    if not len(attracting):
        return None, None
    (here, there), depth = eye(np.concatenate([attracting, -attracting]))
    alpha = sphere.opacity(depth)
    look: Any = {"s": 60, "linewidths": 1.6, "zorder": 8}
    stable = axes.scatter(*here, color=theme.STABLE, alpha=alpha[0], label="stable", **look)
    look |= {"facecolors": theme.PAPER, "edgecolors": theme.UNSTABLE, "alpha": alpha[1]}
    return stable, axes.scatter(*there, label="unstable", **look)
