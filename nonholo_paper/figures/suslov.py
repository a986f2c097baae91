"""Figure Suslov: momentum dynamics of the Suslov problem."""

import functools
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure as MatplotlibFigure

import nonholo as nh
from nonholo.plot import theme
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._suslov_twin import BODIES
from nonholo_paper.figures._figure import figure
from nonholo_paper.figures._portrait import Portrait, portrait
from nonholo_paper.formulas import suslov_continuous as formulas

TOP = nh.SuslovTop(BODIES["generic"])
PLANE = np.array([[0.0, -1.0], [1.0, 0.0]])  # M_1 = -M_23, M_2 = M_13
ENERGIES = [0.4, 1.2, 2.4]
_SETTLED = 300.0  # time after which a motion of these energies has come to rounding of its limit


@functools.cache
@theme.in_style
def picture() -> tuple[Axes, Portrait]:
    """Draw it."""
    axes = MatplotlibFigure(figsize=(6.2, 5.6), layout="constrained").add_subplot()
    drawn = portrait(axes, TOP, ENERGIES, PLANE)
    axes.set(xlabel="$M_1$", ylabel="$M_2$", title="Momentum dynamics")
    axes.set_aspect("equal", adjustable="datalim")
    theme.legend_above(axes)
    return axes, drawn


def limits(system: Any, restricted: Float[np.ndarray, "2"], plane: Float[np.ndarray, "2 2"]) -> np.ndarray:
    """Return where a flow comes from and where it goes, on the plane."""
    ends = [nh.flow(system, times=[0.0, t], momentum=restricted, method="closed_form") for t in (-_SETTLED, _SETTLED)]
    return np.stack([plane @ orbit.restricted_momentum[-1] for orbit in ends])


@statement
def momentum_dynamics() -> Measured:
    """Follow flows from points of the drawn ellipses to the drawn dots, and put the ellipses into the integral."""
    inertia, (_, drawn) = np.asarray(TOP.inertia_operator), picture()
    gaps = []
    for level, stable, unstable in zip(drawn.levels, _dots(drawn.stable), _dots(drawn.unstable), strict=True):
        points = np.asarray(level.get_xydata())
        values = formulas.reduced_integral(inertia, *points.T)
        gaps.append(np.ptp(values) / values.max())
        for number in (40, 130, 220, 310):
            gaps.append(np.abs(limits(TOP, PLANE.T @ points[number], PLANE) - [unstable, stable]).max())
    return Measured(float(max(gaps)), note="3 ellipses, 4 flows on each, from the empty to the filled dot")


def _dots(dots: Any) -> np.ndarray:
    return np.asarray(dots.get_offsets())


FIGURE = figure(lambda: picture()[0].figure, momentum_dynamics)
