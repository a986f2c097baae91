"""Figure four_branches: a top with four real values, where section 6 allows two."""

import functools
from typing import Any

import numpy as np

import nonholo as nh
from nonholo.plot import BranchesPicture, theme
from nonholo.plot import branches as draw_branches
from nonholo_paper import _suslov_twin as data
from nonholo_paper._finding import Measured, finding
from nonholo_paper._verdict import Verdict
from nonholo_paper.figures._figure import Figure

START = (-0.25, -0.375)  # the half-angle tangents of an equilibrium


@functools.cache
@theme.in_style
def picture() -> BranchesPicture:
    """Draw it."""
    top = nh.discretize(nh.SuslovTop(data.BODIES["four branches"]), 1.0)
    return draw_branches(top, displacement=data.array(data.cayley(START)))


def draw() -> Any:
    """Return the figure."""
    return picture().axes.figure


@finding(
    "sys",
    "figure",
    "Section 6, step 2 of the map: picture of four real values",
    r"“Thus there are at most two different real solutions $(\tilde q_1^{(j)}, \tilde q_2^{(j)}, \tilde q_0^{(j)})$ "
    r"with $\tilde q_0^{(j)} > 0$.”",
    verdict=Verdict.FALSE,
    corrected="There are four for this top, all on the curve of one energy.",
    errata=("S30",),
    tolerance=1e-12,
)
def four_values() -> Measured:
    """Compare the drawn dots with values refined in 50 digits, and count them; printed is two less."""
    drawn = picture()
    groups = [np.asarray(group.get_offsets()) for group in (drawn.principal, drawn.others) if group is not None]
    dots = np.concatenate(groups)
    exact = np.array(data.successors("four branches", START), dtype=float)
    size = np.linalg.norm(exact, axis=1, keepdims=True)
    expected = exact / size * 4 * np.arctan(size) / np.pi / 2
    gaps = np.abs(dots[:, None] - expected).max(axis=2).min(axis=0)
    return Measured(float(max(gaps.max(), abs(len(dots) - 4))), len(dots) - 2, "4 dots on the disc of displacements")


FIGURE = Figure(
    "four_branches",
    ("sys",),
    r"All values of the map for the top with $J_{11} = 5/4$, $J_{22} = 1$, $J_{33} = 5/4$, $J_{12} = 0$, $J_{13} = "
    r"-1/2$, $J_{23} = -3/4$, time step 1, from the equilibrium with half-angle tangents $(-1/4, -3/8)$ (cross): "
    "itself and three others, all real, each with its index and step angle, on the curve of its energy. In the disc of "
    "displacements the radius is the step angle; opposite points of the rim, half-turns, are one.",
    draw,
    four_values,
)
