"""Figure st1: the part of the momentum surface over a circular section of the displacements."""

import functools
from typing import Any

import numpy as np
from jaxtyping import Float

import nonholo as nh
from nonholo.plot import theme
from nonholo.plot.sheets import draw_surface
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._suslov_twin import BODIES
from nonholo_paper.figures._figure import figure
from nonholo_paper.figures._space import along, space
from nonholo_paper.figures.st import TOP, locus
from nonholo_paper.formulas import suslov_momenta as formulas

LOW, HIGH = 0.4, 0.8


def displacements() -> Float[np.ndarray, "R C 3 3"]:
    """Return rotations about axes (q1, q2, 0) whose half-angle has a cosine between the bounds."""
    half, direction = np.meshgrid(np.arccos(np.linspace(HIGH, LOW, 31)), np.linspace(0, 2 * np.pi, 161), indexing="ij")
    axis = np.stack([np.cos(direction), np.sin(direction), np.zeros_like(direction)], axis=-1)
    return nh.SO(3).exp(2 * half[..., None] * axis)


@functools.cache
def momenta() -> Float[np.ndarray, "R C 3"]:
    """Return their momenta."""
    return nh.discrete_legendre(TOP, displacements())


@functools.cache
@theme.in_style
def picture() -> tuple[Any, list[Any]]:
    """Draw it, on the axes of the whole surface, with its two rims."""
    axes = space("Circular section of the momentum surface", ("$M_1$", "$M_2$", "$M_3$"), (32.0, -60.0))
    draw_surface(axes, momenta()).set_rasterized(True)
    rims = []
    for row, color, label in ((0, theme.DISCRETE, f"$q_0 = {HIGH}$"), (-1, theme.UNSTABLE, f"$q_0 = {LOW}$")):
        rims += axes.plot(*momenta()[row].T, color=color, linewidth=2.0, zorder=5, label=label)
    whole = locus().momentum.reshape(-1, 3)
    low, high = whole.min(axis=0), whole.max(axis=0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.legend(loc="upper right")
    return axes, rims


@statement
def section() -> Measured:
    """Compare the mesh with (full), its q0 with the bounds, and the drawn rims with (full) at the bounds."""
    W, J = displacements(), np.array(BODIES["generic"])
    q0 = np.sqrt((1 + np.trace(W, axis1=-2, axis2=-1)) / 4)
    q: Any = np.stack([q0, (W[..., 2, 1] - W[..., 1, 2]) / (4 * q0), (W[..., 0, 2] - W[..., 2, 0]) / (4 * q0)])
    drawn = np.stack([along(rim) for rim in picture()[1]])
    around = np.linspace(0, 2 * np.pi, drawn.shape[1])
    rims = [
        [np.full_like(around, c), s * np.cos(around), s * np.sin(around)] for c, s in ((HIGH, 0.6), (LOW, 0.84**0.5))
    ]
    gaps = [
        np.abs(momenta() - np.stack(formulas.momentum(J, q), axis=-1)).max(),
        np.abs(drawn - np.stack([np.stack(formulas.momentum(J, rim), axis=-1) for rim in rims])).max(),
        abs(q0.min() - LOW),
        abs(q0.max() - HIGH),
    ]
    return Measured(float(max(gaps)), note="4991 points, two rims of 161 points")


FIGURE = figure(lambda: picture()[0].figure, section)
