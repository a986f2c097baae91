"""The body at some places of its path in the plane: its outline, to scale, and an arrow along its heading."""

import dataclasses
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from nonholo.base.types import Float
from nonholo.orbit import AbstractOrbit
from nonholo.plot import parts, theme

_MOST = 9  # bodies
_APART = 2.2  # of neighbors along the path, in radii of the body
_SMALL, _ENLARGED = 0.02, 0.035  # radius of a body that is too small to be seen, and as it is drawn then, of the path
_ARROW = 0.6  # from the front of the body, in its radii


@dataclasses.dataclass(frozen=True)
class Bodies:
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
        ink: Any = theme.asked("color", theme.INK)
        look: Any = {"edgecolors": [ink], "linewidths": 0.9}
        bodies, carried = ([part for outline in self.outlines for part in outline[chosen]] for chosen in _LAYERS)
        size = f"body, {self.larger:.2g} times as large" if self.larger > 1 else None
        drawn: list[Artist] = [
            axes.add_collection(PolyCollection(bodies, facecolors=theme.INSIDE, zorder=2.0, label=size, **look)),
            axes.add_collection(PolyCollection(carried, facecolors=[ink], zorder=2.2, **look)),
        ]
        arrow: Any = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "width": 0.0028, "color": [ink], "zorder": 4.5}
        return *drawn, axes.quiver(*self.place.T, *self.arrows.T, **arrow)


_LAYERS = slice(0, 1), slice(1, None)


def bodies_of(
    orbit: AbstractOrbit, points: Float[np.ndarray, "K d"], states: AbstractOrbit | None = None
) -> Bodies | None:
    """Return the bodies to draw along the points of a path in the plane; None of a system that shows no heading.

    They are at some of the points, or at all states that are given.
    """
    system = orbit.system
    if not orbit.coordinates or system.heading is None:
        return None
    extent = float(np.ptp(points, axis=0).max())
    corners = np.concatenate([np.zeros((1, 2)), *system.parts(orbit.configuration[0])])
    radius = float(np.linalg.norm(corners, axis=1).max())
    shown = (radius if radius > _SMALL * extent else _ENLARGED * extent) or 1.0
    q = (states or _some(orbit, points, shown)).configuration
    angle, larger = q[:, orbit.coordinates.index(system.heading)], shown / radius if radius else 1.0
    ahead = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    place = q[:, [orbit.coordinates.index(name) for name in ("x", "y")]]
    turns = np.stack([ahead, ahead[:, ::-1] * [-1.0, 1.0]], axis=1)  # body axes, a row each
    outlines = [
        [foot + larger * part @ turn for part in system.parts(row)]
        for foot, turn, row in zip(place, turns, q, strict=True)
    ]
    return Bodies(place, ahead, outlines, shown, larger)


def _some(orbit: AbstractOrbit, points: Float[np.ndarray, "K d"], radius: float) -> AbstractOrbit:
    """Return states along the points of a path at which bodies stay apart."""
    way = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    return orbit.chosen(parts.evenly_spread(points, int(np.clip(way / (_APART * radius), 1, _MOST - 1))))
