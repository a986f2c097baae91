"""Figure four_branches: a top with four real values, where section 6 allows two."""

import functools

import numpy as np

import nonholo as nh
from nonholo.plot import BranchesPicture, theme
from nonholo.plot import branches as draw_branches
from nonholo_paper import _suslov_twin as data
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper.figures._figure import figure

START = (-0.25, -0.375)  # the half-angle tangents of an equilibrium


@functools.cache
@theme.in_style
def picture() -> BranchesPicture:
    """Draw it."""
    top = nh.discretize(nh.SuslovTop(data.BODIES["four branches"]), 1.0)
    return draw_branches(top, displacement=data.array(data.cayley(START)))


@statement
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


FIGURE = figure(lambda: picture().axes.figure, four_values)
