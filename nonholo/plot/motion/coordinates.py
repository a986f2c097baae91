"""Orbits in coordinates, or on groups with forms that depend on the pose: path, outline of the body, coordinates."""

import re
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.ticker import MaxNLocator

from nonholo.base.types import Float
from nonholo.groups import SE, SO, AbstractMatrixGroup
from nonholo.orbit import AbstractOrbit
from nonholo.plot import parts, theme
from nonholo.plot.motion.time_series import draw_components, velocity_names

_THIN = 0.35  # shortest side of the box in space, in parts of its longest


def dress_path(axes: Any, points: Float[np.ndarray, "L d"], names: list[str]) -> Float[np.ndarray, "d 2"]:
    """Set up axes of the plane or of space, with one unit, about the points of a path; return what they show."""
    if len(names) == 2:
        return parts.fit_view(axes, points, names)
    square = parts.square_about(points)  # with a margin, no side much shorter than the longest
    half = np.maximum(0.57 * np.ptp(points, axis=0), _THIN * np.ptp(square[0]) / 2)
    limits = square.mean(axis=1)[:, None] + half[:, None] * [-1.0, 1.0]
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


def mark_path_ends(axes: Any, points: Float[np.ndarray, "L d"], orbit: AbstractOrbit) -> None:
    """Mark and name the first and the last point of a path."""
    parts.draw_ends(axes, points, orbit)
    axes.text(*points[0], "  start", zorder=9, path_effects=theme.HALO)
    if not parts.is_closed(points):
        axes.text(*points[-1], "  end", zorder=9, path_effects=theme.HALO)


_MOST = 9  # bodies
_APART = 2.2  # of neighbors along the path, in radii of the body
_SMALL, _ENLARGED = 0.02, 0.035  # radius of a body that is too small to be seen, and as it is drawn then, of the path
_ARROW = 0.6  # from the front of the body, in its radii


class Bodies(NamedTuple):
    """A body at some of its poses, each seen from its reference point.

    Attributes:
        place: The reference points.
        ahead: Unit vectors along the heading.
        outlines: For each of them the corners of its parts, the body first.
        radius: Distance of the farthest corner from the reference point, as drawn.
        larger: How many times larger than it is the body is drawn.
    """

    place: Float[np.ndarray, "B 2"]
    ahead: Float[np.ndarray, "B 2"]
    outlines: list[list[Float[np.ndarray, "P 2"]]]
    radius: float
    larger: float

    def with_corners(self, points: Float[np.ndarray, "L 2"]) -> Float[np.ndarray, "M 2"]:
        """Return the points of a path with the ends of boxes about the bodies, and of their arrows."""
        return np.concatenate([points, self.place - self.radius, self.place + self.radius, self.place + self.arrows])

    @property
    def arrows(self) -> Float[np.ndarray, "B 2"]:
        """The arrows, from the reference points."""
        return self.ahead * self.radius * (1 + _ARROW)

    def draw(self, axes: Axes) -> tuple[Artist, ...]:
        """Draw them: the body in a light shade, the parts that it carries in a dark one."""
        ink: Any = theme.option("color", theme.INK)
        look: Any = {"edgecolors": [ink], "linewidths": 0.9}
        bodies, cargo = ([part for outline in self.outlines for part in outline[layer]] for layer in _LAYERS)
        size = f"body, {self.larger:.2g} times as large" if self.larger > 1 else None
        light = axes.add_collection(PolyCollection(bodies, facecolors=theme.INSIDE, zorder=2.0, label=size, **look))
        dark = axes.add_collection(PolyCollection(cargo, facecolors=[ink], zorder=2.2, **look))
        arrow: Any = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "width": 0.0028, "color": [ink], "zorder": 4.5}
        return light, dark, axes.quiver(*self.place.T, *self.arrows.T, **arrow)


_LAYERS = slice(0, 1), slice(1, None)


def bodies_of(orbit: AbstractOrbit, points: Float[np.ndarray, "K d"], states: Any = None) -> Bodies | None:
    """Return the bodies to draw along the points of a path in the plane; None of a system that shows no heading.

    They are at some of the points, or at all states that are given.
    """
    system = orbit.system
    if not orbit.coordinates or system.heading is None:
        return None
    extent = float(np.ptp(points, axis=0).max())
    corners = np.concatenate([np.zeros((1, 2)), *system.parts(orbit.configuration[0])])
    radius = float(np.linalg.norm(corners, axis=1).max())
    size = (radius if radius > _SMALL * extent else _ENLARGED * extent) or 1.0
    way = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    at = parts.evenly_spread(points, int(np.clip(way / (_APART * size), 1, _MOST - 1)))  # where bodies stay apart
    q = (states or orbit.chosen(at)).configuration
    angle, larger = q[:, orbit.coordinates.index(system.heading)], size / radius if radius else 1.0
    ahead = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    place = q[:, [orbit.coordinates.index(name) for name in ("x", "y")]]
    turns = np.stack([ahead, ahead[:, ::-1] * [-1.0, 1.0]], axis=1)  # body axes, a row each
    poses = zip(place, turns, q, strict=True)
    outlines = [[foot + larger * part @ turn for part in system.parts(row)] for foot, turn, row in poses]
    return Bodies(place, ahead, outlines, size, larger)


_GREEK = ("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu")
_GREEK += ("nu", "xi", "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega")
_PLACES = ("x", "y", "z")
Drawn = tuple[Artist, tuple[Artist, ...], Artist | None]
"""The path, the body now and then, the path of a flow."""


class Track(NamedTuple):
    """A path that an orbit draws.

    Attributes:
        title: Its title.
        names: The names of its axes, two or three.
        points: Gives the points of an orbit, (K, d).
        is_place: Whether its axes have one unit.
    """

    title: str
    names: list[str]
    points: Callable[[Any], Float[np.ndarray, "K d"]]
    is_place: bool = True


def track_of(orbit: AbstractOrbit) -> Track | None:
    """Return the path of an orbit: where a body is, if its coordinates or its group have it; two coordinates else."""
    if not (space := orbit.coordinates):
        return _track_on(orbit.space)
    if len(space) == 1:
        names = [symbol(space[0]), symbol(space[0], is_rate=True)]
        return Track("Phase plane", names, lambda of: np.hstack([of.configuration, of.body_velocity]), False)
    columns = _names_of_path(space)
    is_place, names = columns[:2] == ["x", "y"], [symbol(name) for name in columns]
    title = "Path" if is_place else f"Plane of {names[0]} and {names[1]}"
    at = [space.index(name) for name in columns]
    return Track(title, names, lambda of: of.configuration[:, at], is_place)


def _names_of_path(names: tuple[str, ...]) -> list[str]:
    """Return the coordinates of a path: those of a place if they have both of the plane, else the first two."""
    places = [name for name in _PLACES if name in names]
    return places if places[:2] == ["x", "y"] else list(names[:2])


def momentum_track(orbit: AbstractOrbit) -> Track:
    """Return the path in the plane of the two largest momenta along the constraint; of one, against time."""
    largest = np.sort(np.argsort(-np.abs(orbit.restricted_momentum).max(axis=0, initial=0.0), kind="stable")[:2])
    if len(names := [f"$r_{{{i + 1}}}$" for i in largest]) == 2:
        return Track("Plane of momenta", names, lambda of: of.restricted_momentum[:, largest], is_place=False)

    def against_time(of: AbstractOrbit) -> Float[np.ndarray, "K 2"]:
        return np.column_stack([of.time, of.restricted_momentum.sum(axis=1)])

    return Track("Momentum", ["time", *names, ""][:2], against_time, is_place=False)


def draw_track(track: Track, orbit: AbstractOrbit, flow: AbstractOrbit | None, axes: Any) -> Drawn:
    """Draw the path in the colors of time, its ends, the body now and then, and the path of a flow beside it."""
    points = track.points(orbit)
    at = parts.evenly_in_box(points)
    bodies = bodies_of(orbit, points) if track.is_place else None
    if track.is_place:
        dress_path(axes, points[at] if bodies is None else bodies.with_corners(points), track.names)
    else:
        axes.set(xlabel=track.names[0], ylabel=track.names[1])
        axes.margins(0.1)
    path = parts.draw_in_time(axes, orbit, points, at, zorder=3)
    curve = None if flow is None else parts.draw_flow(axes, track.points(flow))
    artists = () if bodies is None else bodies.draw(axes)
    mark_path_ends(axes, points, orbit)
    theme.legend_above(axes, track.title)
    return path, artists, curve


draw_path = theme.in_style(draw_track)
"""The same as a part of another picture, whose title it does not have."""


@theme.in_style
def draw_shape(orbit: AbstractOrbit, flow: AbstractOrbit | None, axes: Axes) -> None:
    """Draw the coordinates that the path does not show against time; all if it shows all."""
    names = orbit.coordinates
    first = _names_of_path(names)
    others = [i for i, name in enumerate(names) if name not in first] or list(range(len(names)))
    symbols = [symbol(names[i]) for i in others]
    draw_components(axes, orbit, flow, lambda of: of.configuration[:, others], symbols, "Coordinates", "coordinates")


@theme.in_style
def draw_velocity(orbit: AbstractOrbit, flow: AbstractOrbit | None, axes: Axes) -> None:
    """Draw the velocities against time."""
    symbols = [symbol(name, is_rate=True) for name in orbit.coordinates]
    names, title = symbols or velocity_names(orbit.space), "Velocity" if symbols else "Body velocity"
    draw_components(axes, orbit, flow, lambda states: states.body_velocity, names, title, "velocity")


def symbol(name: str, *, is_rate: bool = False) -> str:
    r"""Return the name of a coordinate as a formula: Greek letters, one letter with an index, words upright.

    Example:
        >>> symbol("theta"), symbol("y2"), symbol("left", is_rate=True)
        ('$\\theta$', '$y_{2}$', '$\\dot{\\mathrm{left}}$')
    """
    letters, index = re.fullmatch(r"(.*?)_?(\d*)", name).groups()  # pyright: ignore[reportOptionalMemberAccess]
    base = rf"\{letters}" if letters in _GREEK else letters if len(letters) == 1 else rf"\mathrm{{{letters}}}"
    base = base.replace("_", r"\_")
    formula = rf"\dot{{{base}}}" if is_rate else base
    return f"${formula}_{{{index}}}$" if index else f"${formula}$"


def _track_on(group: AbstractMatrixGroup) -> Track | None:
    if group == SO(3):
        return Track("Body axis 3", [*map(symbol, _PLACES)], lambda orbit: orbit.configuration[:, :, 2])
    n = group.size - 1
    if n not in (2, 3) or group != SE(n):
        return None
    return Track("Reference point", [*map(symbol, _PLACES[:n])], lambda orbit: orbit.configuration[:, :n, n])
