"""Figure circ: the geometry of an admissible displacement of the sleigh."""

import dataclasses
import functools
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure as MatplotlibFigure
from matplotlib.lines import Line2D
from matplotlib.patches import Arc

import nonholo as nh
from nonholo.plot import theme
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper.figures._figure import figure
from nonholo_paper.formulas import sleigh_discrete as formulas

THETA, DELTA, RADIUS = 0.15, 1.3, 3.0
_REACH = 1.7  # of the lines of the blades ahead
_BLADE = 0.3  # half its length


@dataclasses.dataclass(frozen=True)
class Geometry:
    """The drawing of `picture`.

    Attributes:
        axes: The axes.
        circle: The circle that both lines of the blade touch.
        chord: From the first contact point to the second.
        blades: The lines of the blade, each from its contact point on.
        contacts: The two contact points.
    """

    axes: Axes
    circle: Line2D
    chord: Line2D
    blades: tuple[Line2D, ...]
    contacts: PathCollection


def poses() -> tuple[Float[np.ndarray, "3 3"], Float[np.ndarray, "3 3"]]:
    """Return a pose and the next: the exponential of an admissible velocity."""
    first = nh.SE(2).exp([THETA, 0.0, 0.0])
    return first, first @ nh.SE(2).exp([DELTA, RADIUS * DELTA, 0.0])


@functools.cache
@theme.in_style
def picture() -> Geometry:
    """Draw it."""
    axes = MatplotlibFigure(figsize=(7.6, 6.2), layout="constrained").add_subplot()
    first, second = poses()
    around, center = np.linspace(0, 2 * np.pi, 361), first[:2, 2] + RADIUS * first[:2, 1]
    circle = axes.plot(
        *(center[:, None] + RADIUS * np.array([np.cos(around), np.sin(around)])), color=theme.LEVEL, linewidth=1.4
    )[0]
    ends = np.stack([first[:2, 2], second[:2, 2]])
    for end in ends:
        axes.plot(*np.stack([center, end], axis=1), color=theme.LEVEL, linewidth=1.0, dashes=(4, 3))
    chord = axes.plot(*ends.T, color=theme.UNSTABLE, linewidth=1.8, zorder=3)[0]
    blades = tuple(_blade(axes, g, name) for g, name in ((first, "$X_k$"), (second, "$X_{k+1}$")))
    contacts = axes.scatter(*ends.T, s=46, facecolors="white", edgecolors=theme.INK, linewidths=1.6, zorder=8)
    axes.scatter(*center, s=16, color=theme.MUTED, zorder=3)
    _angles(axes, ends)
    _words(axes, ends, center)
    axes.set(
        xlabel="$x$",
        ylabel="$y$",
        title="Geometry of a displacement",
        xlim=(-1.4, 5.0),
        ylim=(-0.75, 4.6),
        aspect="equal",
    )
    return Geometry(axes, circle, chord, blades, contacts)


def _blade(axes: Axes, g: Float[np.ndarray, "3 3"], name: str) -> Line2D:
    """Draw the blade and the line on which it lies."""
    point, along = g[:2, 2], g[:2, 0]
    stroke = np.stack([point - _BLADE * along, point + _BLADE * along])
    axes.plot(*stroke.T, color=theme.INK, linewidth=5, zorder=6)
    axes.plot(*np.stack([point - along, point]).T, color=theme.DISCRETE, linewidth=1.2, zorder=4)
    axes.annotate(name, tuple(point + _REACH * along), (6, 6), textcoords="offset points", color=theme.DISCRETE)
    return axes.plot(*np.stack([point, point + _REACH * along]).T, color=theme.DISCRETE, linewidth=1.2, zorder=4)[0]


def _angles(axes: Axes, ends: Float[np.ndarray, "2 2"]) -> None:
    """Mark the two equal angles between the chord and the blades; beyond the second point the chord is dashed."""
    along = ends[1] - ends[0]
    beyond = ends[1] + 0.42 * along
    axes.plot(*np.stack([ends[1], beyond]).T, color=theme.UNSTABLE, linewidth=1.0, dashes=(4, 3), zorder=3)
    half, named = np.degrees(DELTA / 2), {"color": theme.UNSTABLE, "fontsize": 12, "ha": "center", "va": "center"}
    for point, start in ((ends[0], np.degrees(THETA)), (ends[1], np.degrees(THETA) + half)):
        axes.add_patch(
            Arc(tuple(point), 1.7, 1.7, theta1=start, theta2=start + half, color=theme.UNSTABLE, linewidth=1.4)
        )
        middle = np.radians(start + half / 2)
        x, y = point + 1.22 * np.array([np.cos(middle), np.sin(middle)])
        axes.text(x, y, r"$\frac{\Delta\theta_k}{2}$", **named)


def _words(axes: Axes, ends: Float[np.ndarray, "2 2"], center: Float[np.ndarray, "2"]) -> None:
    place: Any = {"textcoords": "offset points", "path_effects": theme.HALO, "zorder": 9}
    axes.annotate("$(x_k, y_k)$", ends[0], (-6, -20), ha="center", **place)
    axes.annotate("$(x_{k+1}, y_{k+1})$", ends[1], (12, -14), ha="left", **place)
    axes.annotate(r"$\rho$", (ends[0] + center) / 2, (-10, 0), ha="center", color=theme.MUTED, **place)


@statement
def geometry() -> Measured:
    """Measure angles and distances of the drawn lines, and put the drawn poses into the constraint and (discr.vel1)."""
    drawn = picture()
    contacts, circle = (np.asarray(points) for points in (drawn.contacts.get_offsets(), drawn.circle.get_xydata()))
    chord = np.diff(np.asarray(drawn.chord.get_xydata()), axis=0)[0]
    lines = [np.diff(np.asarray(blade.get_xydata()), axis=0)[0] for blade in drawn.blades]
    headings = [float(np.arctan2(line[1], line[0])) for line in lines]
    center = circle[:-1].mean(axis=0)
    before, after = ((heading, *contact) for heading, contact in zip(headings, contacts, strict=True))
    moved, tangents = formulas.discrete_velocities(before, after), formulas.tangent_velocities(before, after)
    gaps = [
        *(
            np.arctan2(chord[1], chord[0]) - heading - sign * DELTA / 2
            for heading, sign in zip(headings, (1, -1), strict=True)
        ),
        *(np.linalg.norm(contacts - center, axis=1) - np.linalg.norm(circle - center, axis=1).mean()),
        *(line @ (contact - center) for line, contact in zip(lines, contacts, strict=True)),
        *(float(x - y) for x, y in zip(moved, tangents, strict=True)),
        float(formulas.constraint_in_space(before, after)),
        float(formulas.radius(headings[1] - headings[0], moved[0])) - RADIUS,
    ]
    return Measured(float(np.abs(gaps).max()), note="angles, distances and tangency of the drawing")


FIGURE = figure(lambda: picture().axes.figure, geometry)
