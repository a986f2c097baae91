"""An orbit in coordinates, or on a group with forms that depend on the pose: its path, coordinates and velocities."""

import functools
import re
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from nonholo.base.types import Float
from nonholo.groups import SE, SO, AbstractMatrixGroup
from nonholo.orbit import AbstractOrbit
from nonholo.plot import parts, theme
from nonholo.plot.motion._bodies import bodies_of
from nonholo.plot.motion._path import dress_path, mark_path_ends
from nonholo.plot.motion._time_series import draw_components, velocity_names

_GREEK = (
    *("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu"),
    *("nu", "xi", "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega"),
)
_PLACES = ("x", "y", "z")
Drawn = tuple[Artist, tuple[Artist, ...], Artist | None]
"""The path, the body now and then, the path of a flow."""


class Track(NamedTuple):
    """A path that an orbit draws.

    Attributes:
        title: What it is.
        names: What its axes are, two or three.
        points: Gives the points of an orbit, (K, d).
        is_place: Whether its axes have one unit.
    """

    title: str
    names: list[str]
    points: Callable[[Any], Float[np.ndarray, "K d"]]
    is_place: bool = True


def track_of(orbit: AbstractOrbit) -> Track | None:
    """Return the path of an orbit: where a body is, if its coordinates or its group say so; two coordinates else."""
    space = orbit.coordinates
    if not space:
        return _track_on(orbit.space)
    if len(space) == 1:
        names = [symbol(space[0]), symbol(space[0], is_rate=True)]
        return Track(
            "Phase plane", names, lambda of: np.concatenate([of.configuration, of.body_velocity], axis=1), False
        )
    places = [name for name in _PLACES if name in space]
    is_place = places[:2] == ["x", "y"]
    shown = places if is_place else list(space[:2])
    names = [symbol(name) for name in shown]
    title = "Path" if is_place else f"Plane of {names[0]} and {names[1]}"
    return Track(title, names, functools.partial(_columns, [space.index(name) for name in shown]), is_place)


def draw_track(track: Track, orbit: AbstractOrbit, flow: AbstractOrbit | None, axes: Any) -> Drawn:
    """Draw the path in the colors of time, its ends, the body now and then, and the path of a flow beside it."""
    points = track.points(orbit)
    chosen = parts.evenly_in_box(points)
    theme.write_title(axes, track.title)
    bodies = bodies_of(orbit, points) if track.is_place else None
    if track.is_place:
        dress_path(axes, points[chosen] if bodies is None else bodies.with_corners(points), track.names)
    else:
        axes.set(xlabel=track.names[0], ylabel=track.names[1])
        axes.margins(0.1)
    drawn = parts.draw_in_time(axes, orbit, points, chosen, zorder=3)
    curve = None if flow is None else parts.draw_flow(axes, track.points(flow))
    artists = () if bodies is None else bodies.draw(axes)
    mark_path_ends(axes, points, orbit)
    theme.legend_above(axes)
    return drawn, artists, curve


draw_path = theme.styled(draw_track)
"""The same as a part of another picture, whose title it does not have."""


@theme.styled
def draw_shape(orbit: AbstractOrbit, flow: AbstractOrbit | None, axes: Axes) -> None:
    """Draw the coordinates that the path does not show against time; all if it shows all."""
    names = orbit.coordinates
    places = [name for name in _PLACES if name in names]
    shown = places if places[:2] == ["x", "y"] else list(names[:2])
    others = [i for i, name in enumerate(names) if name not in shown] or list(range(len(names)))
    theme.write_title(axes, "Coordinates")
    draw_components(axes, orbit, flow, functools.partial(_columns, others), [symbol(names[i]) for i in others])
    axes.set_ylabel("coordinates")


@theme.styled
def draw_velocity(orbit: AbstractOrbit, flow: AbstractOrbit | None, axes: Axes) -> None:
    """Draw the velocities against time."""
    named = [symbol(name, is_rate=True) for name in orbit.coordinates]
    names = named or velocity_names(orbit.space)
    theme.write_title(axes, "Velocity" if named else "Body velocity")
    draw_components(axes, orbit, flow, lambda states: states.body_velocity, names)
    axes.set_ylabel("velocity")


def symbol(name: str, *, is_rate: bool = False) -> str:
    r"""Return the name of a coordinate as a formula: Greek letters, one letter with an index, words upright.

    Example:
        >>> symbol("theta"), symbol("y2"), symbol("left", is_rate=True)
        ('$\\theta$', '$y_{2}$', '$\\dot{\\mathrm{left}}$')
    """
    letters, index = re.fullmatch(r"(.*?)_?(\d*)", name).groups()  # pyright: ignore[reportOptionalMemberAccess]
    base = rf"\{letters}" if letters in _GREEK else letters if len(letters) == 1 else rf"\mathrm{{{letters}}}"
    base = base.replace("_", r"\_")
    dotted = rf"\dot{{{base}}}" if is_rate else base
    return f"${dotted}_{{{index}}}$" if index else f"${dotted}$"


def _columns(chosen: list[int], orbit: Any) -> np.ndarray:
    return orbit.configuration[:, chosen]


def _track_on(group: AbstractMatrixGroup) -> Track | None:
    if group == SO(3):
        names = [symbol(name) for name in _PLACES]
        return Track("Body axis 3", names, lambda orbit: orbit.configuration[:, :, 2])
    n = group.size - 1
    if n not in (2, 3) or group != SE(n):
        return None
    return Track("Reference point", [symbol(name) for name in _PLACES[:n]], lambda orbit: orbit.configuration[:, :n, n])
