"""Figure Chsleigh: the sleigh, its pose and its center of mass."""

import dataclasses
import functools
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure as MatplotlibFigure
from matplotlib.lines import Line2D
from matplotlib.patches import Arc, Polygon

import nonholo as nh
from nonholo.plot import theme
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper.figures._figure import figure
from nonholo_paper.formulas import sleigh_continuous as formulas

THETA, X, Y = 0.55, 2.0, 1.3
A, B = 1.5, 0.65
_BODY = np.array([[-0.9, -0.55], [2.1, -0.75], [2.9, 0.35], [2.0, 1.25], [0.3, 1.05], [-0.9, 0.55]])
_BLADE = 0.55  # half its length
_FRAME = 3.4  # length of a body axis


@dataclasses.dataclass(frozen=True)
class Sketch:
    """The drawing of `picture`.

    Attributes:
        axes: The axes.
        blade: The stroke of the blade.
        contact: The contact point.
        mass: The center of mass.
        legs: From the contact point along the blade, then across it, to the center of mass.
    """

    axes: Axes
    blade: Line2D
    contact: PathCollection
    mass: PathCollection
    legs: Line2D


@functools.cache
@theme.in_style
def picture() -> Sketch:
    """Draw it; points of the body are moved by a matrix of SE(2)."""
    axes = MatplotlibFigure(figsize=(7.2, 5.4), layout="constrained").add_subplot()
    axes.add_patch(Polygon(_moved(_BODY), closed=True, facecolor="#e4ebf2", edgecolor=theme.MUTED, linewidth=1.2))
    for end, name in (((_FRAME, 0.0), "body axis 1"), ((0.0, 0.62 * _FRAME), "body axis 2")):
        _axis(axes, _moved([(0.0, 0.0), end]), name)
    blade = axes.plot(*_moved([(-_BLADE, 0), (_BLADE, 0)]).T, color=theme.INK, linewidth=5, zorder=5)[0]
    legs = axes.plot(*_moved([(0, 0), (A, 0), (A, B)]).T, color=theme.UNSTABLE, linewidth=1.6, zorder=4)[0]
    contact = axes.scatter(X, Y, s=60, color="white", edgecolors=theme.INK, linewidths=1.8, zorder=7)
    mass = axes.scatter(*_moved([(A, B)]).T, s=80, color=theme.UNSTABLE, zorder=7)
    _words(axes)
    axes.set(xlabel="$x$", ylabel="$y$", xlim=(0, 6.2), ylim=(0, 4.4), title="The Chaplygin sleigh", aspect="equal")
    return Sketch(axes, blade, contact, mass, legs)


def _pose() -> np.ndarray:
    c, s = np.cos(THETA), np.sin(THETA)
    return np.array([[c, -s, X], [s, c, Y], [0.0, 0.0, 1.0]])


def _moved(points: Any) -> np.ndarray:
    """Return points of the body in space."""
    g = _pose()
    return np.asarray(points, dtype=float) @ g[:2, :2].T + g[:2, 2]


def _axis(axes: Axes, ends: np.ndarray, name: str) -> None:
    look = {"arrowstyle": "-|>", "color": theme.MUTED, "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", ends[1], ends[0], arrowprops=look, zorder=3)
    axes.annotate(name, ends[1], (6, 4), textcoords="offset points", color=theme.MUTED, ha="center", va="bottom")


def _words(axes: Axes) -> None:
    axes.plot([X, X + 1.6], [Y, Y], color=theme.MUTED, linewidth=1.0, dashes=(4, 3), zorder=3)
    axes.add_patch(Arc((X, Y), 2.2, 2.2, theta2=np.degrees(THETA), color=theme.DISCRETE, linewidth=1.8, zorder=6))
    half = THETA / 2
    named: Any = {"zorder": 8, "fontsize": 13, "path_effects": theme.HALO, "ha": "center", "va": "center"}
    axes.text(X + 1.32 * np.cos(half), Y + 1.32 * np.sin(half), r"$\theta$", color=theme.DISCRETE, **named)
    plain = named | {"fontsize": 11}
    for point, word, look in (
        ((0.5 * A + 0.25, 0.17), "$a$", named | {"color": theme.UNSTABLE}),
        ((A + 0.17, B / 2), "$b$", named | {"color": theme.UNSTABLE}),
        ((A, B + 0.28), "center of mass", plain),
        ((-_BLADE - 0.05, 0.22), "blade", plain),
        ((0.02, -0.34), "$(x, y)$", plain),
    ):
        x, y = _moved([point])[0]
        axes.text(x, y, word, **look)


@statement
def sketch() -> Measured:
    """Compare drawn points with the formula of the center of mass, and with a pose and displacement of the library."""
    drawn = picture()
    contact, mass = (np.asarray(dots.get_offsets())[0] for dots in (drawn.contact, drawn.mass))
    along = np.diff(np.asarray(drawn.blade.get_xydata()), axis=0)[0]
    legs = np.diff(np.asarray(drawn.legs.get_xydata()), axis=0)
    pose = nh.SE(2).exp([0.0, X, Y]) @ nh.SE(2).exp([THETA, 0.0, 0.0])
    gaps = [
        *(mass - np.array(formulas.center_of_mass(A, B, (THETA, X, Y)), dtype=float)),
        *(mass - (pose @ [A, B, 1.0])[:2]),
        *(contact - [X, Y]),
        np.arctan2(along[1], along[0]) - THETA,
        np.linalg.norm(legs[0]) - A,
        np.linalg.norm(legs[1]) - B,
        legs[0] @ legs[1],
    ]
    return Measured(float(np.abs(gaps).max()), note="points, lengths and angles of the drawing")


FIGURE = figure(lambda: picture().axes.figure, sketch)
