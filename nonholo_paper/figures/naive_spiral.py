"""Figure naive_spiral, described in a footnote of section 7: the track of a sleigh with the naive constraint."""

import functools

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure as MatplotlibFigure
from matplotlib.lines import Line2D

import nonholo as nh
from nonholo.plot import theme
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper.figures._figure import figure
from nonholo_paper.formulas import sleigh_discrete as formulas

SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.0, b=0.0)
ANGLE, FIRST = 0.35, 1.0  # step angle and length of the first step
STEPS = 60
_TURN = 18  # points of one turn


@functools.cache
def positions(constraint: str) -> Float[np.ndarray, "K 2"]:
    """Return the contact points with a discrete constraint; the first steps have the same angle and length."""
    direction = 0.0 if constraint == "naive" else ANGLE / 2
    c, s = np.cos(ANGLE), np.sin(ANGLE)
    W = [[c, -s, FIRST * np.cos(direction)], [s, c, FIRST * np.sin(direction)], [0.0, 0.0, 1.0]]
    return nh.simulate(nh.discretize(SLEIGH, 1.0, constraint=constraint), displacement=W, steps=STEPS).position


@functools.cache
@theme.in_style
def picture() -> tuple[Axes, PathCollection, Line2D]:
    """Draw points of both constraints, and the spiral through those of the naive one."""
    axes = MatplotlibFigure(figsize=(6.4, 6.2), layout="constrained").add_subplot()
    time = np.linspace(0.0, STEPS, 60 * STEPS + 1)
    ratio = np.cos(ANGLE) * np.exp(1j * ANGLE)
    curve = FIRST / (1 - ratio) * (1 - np.exp(time * np.log(ratio)))
    spiral = axes.plot(curve.real, curve.imag, color=theme.UNSTABLE, linewidth=1.0, zorder=2)[0]
    dots = axes.scatter(*positions("naive").T, s=24, color=theme.UNSTABLE, zorder=4, label="naive constraint")
    axes.scatter(*positions("skew")[:_TURN].T, s=24, color=theme.DISCRETE, zorder=3, label="constraint of the paper")
    axes.scatter(0, 0, s=60, facecolors="white", edgecolors=theme.INK, zorder=5)
    axes.annotate("start", (0, 0), (0, -16), textcoords="offset points", ha="center", path_effects=theme.HALO)
    axes.set(xlabel="$x$", ylabel="$y$", title="Track for $a = 0$", aspect="equal")
    axes.margins(0.1)
    axes.legend(loc="upper left", frameon=True, framealpha=0.9, edgecolor="none")
    return axes, dots, spiral


@statement
def spiral() -> Measured:
    """Compare drawn points with the logarithmic spiral, one by one, and with the drawn curve; the end is its pole."""
    _, dots, line = picture()
    points, curve = np.asarray(dots.get_offsets()), np.asarray(line.get_xydata())
    expected = [complex(formulas.spiral(ANGLE, FIRST, k)) for k in range(STEPS + 1)]
    gaps = [np.abs(points @ [1, 1j] - expected).max(), np.abs(points - curve[::60]).max()]
    return Measured(float(max(gaps)), note=f"{STEPS + 1} points of a run with the naive constraint")


FIGURE = figure(lambda: picture()[0].figure, spiral)
