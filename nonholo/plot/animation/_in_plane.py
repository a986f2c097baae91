"""Films of bodies in the plane: a sleigh with its blade, center of mass and track, the outline of a system, a point."""

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from nonholo.analysis.bodies import blade_axes, plate
from nonholo.base.types import Float
from nonholo.groups import SE
from nonholo.orbit import AbstractOrbit, Orbit
from nonholo.plot import theme
from nonholo.plot.animation._part import Part, Points, Show, draw_point, draw_trail, motion_of, name_of_trail, together
from nonholo.plot.motion.coordinates import Bodies, Track, bodies_of
from nonholo.plot.parts import fit_view
from nonholo.systems import System

Drawn: TypeAlias = Callable[[Any], Bodies | None]
"""A function of states that gives their bodies."""


def motion(orbit: Orbit) -> float:
    """Return the motion of the body between saved states, in units of what the eye can follow from frame to frame."""
    point = SE(2).adjoint(SE(2).inverse(_axes(orbit.system)))[1:]
    return motion_of(orbit, point, float(np.ptp(plate(orbit.system)[0][:, 0])))


def draw_body(axes: Axes, orbit: Orbit, parts: list[Part]) -> Show:
    """Draw a body on SE(2) and others beside; return what shows a frame."""
    frame, outline = _axes(orbit.system), plate(orbit.system)
    radius = max(float(np.linalg.norm(part, axis=1).max()) for part in outline)

    def points(states: Orbit) -> Float[np.ndarray, "K 2"]:
        return (states.configuration @ frame)[:, :2, 2]

    def bodies(states: Orbit) -> Bodies:
        g = states.configuration @ frame
        outlines = [[part @ pose[:2, :2].T + pose[:2, 2] for part in outline] for pose in g]
        return Bodies(g[:, :2, 2], g[:, :2, 0], outlines, radius, 1.0)

    return _draw(axes, orbit, parts, points, bodies)


def draw_path(track: Track, axes: Axes, orbit: AbstractOrbit, parts: list[Part]) -> Show:
    """Draw a path in two coordinates, with the outline of the system or as a point; return what shows a frame."""
    if not track.is_place:
        look: Any = {"transform": axes.transAxes, "color": theme.QUIET}
        axes.text(0.99, 0.01, track.names[0], ha="right", **look)
        axes.text(0.01, 0.99, track.names[1], va="top", **look)
    points = track.points(orbit)

    def bodies(states: AbstractOrbit) -> Bodies | None:
        return bodies_of(orbit, points, states) if track.is_place else None

    return _draw(axes, orbit, parts, track.points, bodies, is_place=track.is_place)


def _axes(system: System) -> Float[np.ndarray, "3 3"]:
    """Return the axes in the body that are drawn: those of its blade, if it has one."""
    axes = blade_axes(system)
    return np.eye(3) if axes is None else axes


def _draw(
    axes: Axes, orbit: AbstractOrbit, parts: list[Part], points: Points, bodies: Drawn, *, is_place: bool = True
) -> Show:
    motions = [(part, points(part.path), bodies(part.frames)) for part in parts]
    shown = np.concatenate([path if at is None else at.with_corners(path) for _, path, at in motions])
    if is_place:
        fit_view(axes, shown)
        axes.set(xlabel="", ylabel="")
    else:
        axes.margins(0.1)
        axes.update_datalim(shown)
        axes.autoscale_view()
    axes.grid(color=theme.LEVEL, linewidth=0.8, alpha=0.3)
    axes.tick_params(length=0, labelleft=False, labelbottom=False)
    axes.spines[:].set_visible(False)
    axes.set_axisbelow(True)
    shows = []
    for part, path, at in motions:
        shows.append(draw_trail(axes, orbit, part, path, label=name_of_trail(part)))
        shows.append(draw_point(axes, part, points(part.frames)) if at is None else _draw_body(axes, part, at))
    theme.legend(axes, loc="best")
    return together(shows)


def _draw_body(axes: Axes, part: Part, bodies: Bodies) -> Show:
    """Return what draws the outline of a frame: the body in a light shade, what it carries in a dark one."""
    edge: Any = theme.CONTINUOUS if part.is_flow else theme.option("color", theme.INK)
    look: Any = {"edgecolors": [edge], "linewidths": 1.2}
    faces = ("none", "none") if part.is_flow else (theme.INSIDE, edge)
    layers = (2.2, 2.2) if part.is_flow else (1.0, 3.0)  # below the trail and above it
    kinds = zip(faces, layers, strict=True)
    body, cargo = (PolyCollection([], facecolors=[face], zorder=layer, **look) for face, layer in kinds)
    for collection in (body, cargo):
        axes.add_collection(collection, autolim=False)

    def show(frame: int) -> None:
        body.set_verts(bodies.outlines[frame][:1])
        cargo.set_verts(bodies.outlines[frame][1:])

    return show
