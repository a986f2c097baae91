"""Figure Suslov: momentum dynamics of the Suslov problem."""

import functools
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure as MatplotlibFigure

import nonholo as nh
from nonholo.plot import theme
from nonholo_paper._finding import Measured, finding
from nonholo_paper._suslov_twin import BODIES
from nonholo_paper.figures._figure import Figure
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


def draw() -> Any:
    """Return the figure."""
    return picture()[0].figure


def limits(system: Any, restricted: Float[np.ndarray, "2"], plane: Float[np.ndarray, "2 2"]) -> np.ndarray:
    """Return where a flow comes from and where it goes, on the plane."""
    ends = [nh.flow(system, times=[0.0, t], momentum=restricted, method="closed_form") for t in (-_SETTLED, _SETTLED)]
    return np.stack([plane @ orbit.restricted_momentum[-1] for orbit in ends])


@finding(
    "Suslov.fig",
    "figure",
    "Section 4, figure of the momentum dynamics",
    "The trajectories of $(M_1, M_2)$ are elliptic arches from unstable (empty dots) to stable equilibria (filled).",
    tolerance=1e-12,
)
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


FIGURE = Figure(
    "Suslov",
    ("Suslov.fig", "sus_int_1", "ep3.26"),
    r"Momenta of the Suslov top with $J_{11} = 1.4$, $J_{22} = 1$, $J_{33} = 0.9$, $J_{12} = 0.2$, $J_{13} = 0.5$, "
    r"$J_{23} = -0.3$, forbidden axis $e_3$, at the energies 0.4, 1.2 and 2.4. All motions run along their ellipse in "
    "the direction of the arrows, from an unstable equilibrium (empty) to a stable one (filled).",
    draw,
    momentum_dynamics,
)
