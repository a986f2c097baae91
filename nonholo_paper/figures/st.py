"""Figure st: the surface of discrete momenta of the top."""

import functools
from typing import Any

import numpy as np

import nonholo as nh
from nonholo.analysis import MomentumLocus
from nonholo.plot import MomentumLocusPicture, momentum_locus, theme
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._suslov_twin import BODIES
from nonholo_paper.figures._figure import figure
from nonholo_paper.figures._space import along
from nonholo_paper.formulas import suslov_momenta as formulas

TOP = nh.discretize(nh.SuslovTop(BODIES["generic"]), 1.0)


@functools.cache
def locus() -> MomentumLocus:
    """Return the mesh."""
    return nh.momentum_locus(TOP, 60)


@functools.cache
@theme.in_style
def picture() -> MomentumLocusPicture:
    """Draw it."""
    drawn = momentum_locus(locus())
    drawn.axes.set(xlabel="$M_1$", ylabel="$M_2$", zlabel="$M_3$")
    drawn.surface.set_rasterized(True)
    return drawn


def quaternions(result: MomentumLocus) -> Any:
    """Return q0, q1, q2 of the displacements of a mesh."""
    z0, z1, z2 = np.moveaxis(result.points, -1, 0)
    return np.stack([z0, -z2, z1])


@statement
def surface() -> Measured:
    """Compare the mesh with (full) and with the implicit equation, and count what is drawn on it."""
    result, drawn = locus(), picture()
    full = np.stack(formulas.momentum(np.array(BODIES["generic"]), quaternions(result)), axis=-1)
    ends = np.concatenate([along(line) for line in drawn.double_lines])
    gaps = [
        np.abs(result.momentum - full).max(),
        np.abs(result.implicit(result.momentum)).max(),
        np.abs(ends - result.pinch_points).max(),
        float(len(drawn.double_lines) != 3 or drawn.triple_point is None),
    ]
    return Measured(float(max(gaps)), note="7260 points; 3 segments, 6 pinch points, a triple point")


FIGURE = figure(lambda: picture().axes.figure, surface)
