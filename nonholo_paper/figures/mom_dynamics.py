"""Figure mom_dynamics: momentum dynamics of the sleigh, for b not zero and for b = 0."""

import functools
from typing import Any

import numpy as np
from matplotlib.figure import Figure as MatplotlibFigure

import nonholo as nh
from nonholo.plot import theme
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper.figures._figure import figure
from nonholo_paper.figures._portrait import Portrait, portrait
from nonholo_paper.figures.suslov import limits
from nonholo_paper.formulas import sleigh_continuous as formulas

BODIES = ((1.0, 1.0, 1.0, 1.0), (1.0, 1.0, 1.0, 0.0))  # m, J, a, b
ENERGIES = [0.25, 1.0, 2.25]
TITLES = (r"$a \neq 0$, $b \neq 0$", r"$a \neq 0$, $b = 0$")


@functools.cache
@theme.in_style
def picture() -> tuple[MatplotlibFigure, tuple[Portrait, ...]]:
    """Draw both panels."""
    figure = MatplotlibFigure(figsize=(10.0, 4.9), layout="constrained")
    panels: Any = figure.subplots(1, 2)
    drawn = []
    for axes, body, title in zip(panels, BODIES, TITLES, strict=True):
        drawn.append(portrait(axes, nh.ChaplyginSleigh(*body), ENERGIES, np.eye(2)))
        axes.set(xlabel=r"$p_\theta$", ylabel="$p_1$", title=title)
        axes.set_aspect("equal", adjustable="datalim")
        theme.legend_above(axes)
    return figure, tuple(drawn)


@statement
def momentum_dynamics() -> Measured:
    """Put drawn dots into the line, drawn ellipses into the integral, and follow flows from dot to dot."""
    gaps = []
    for body, drawn in zip(BODIES, picture()[1], strict=True):
        dots = [np.asarray(kind.get_offsets()) for kind in (drawn.unstable, drawn.stable)]
        gaps += [np.abs(ends @ [1.0, body[3]]).max() for ends in dots]
        gaps.append(np.sum(dots[0][:, 1] >= 0) + np.sum(dots[1][:, 1] <= 0))
        for level, unstable, stable in zip(drawn.levels, *dots, strict=True):
            points = np.asarray(level.get_xydata())
            values = formulas.energy_integral(body, *points.T)
            gaps.append(np.ptp(values) / values.max())
            for number in (40, 130, 220, 310):
                result = limits(nh.ChaplyginSleigh(*body), points[number], np.eye(2))
                gaps.append(np.abs(result - [unstable, stable]).max())
    return Measured(float(max(gaps)), note="two sleighs, 3 ellipses each, 4 flows on each ellipse")


FIGURE = figure(lambda: picture()[0], momentum_dynamics)
