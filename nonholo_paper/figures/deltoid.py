"""Figure deltoid, described in the lemma of section 7: how many real displacements have given momenta."""

import functools
from typing import Any

import numpy as np

import nonholo as nh
from nonholo.plot import BranchCounts, branch_counts, theme
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper.figures._figure import figure
from nonholo_paper.formulas import sleigh_discrete as formulas

BODY = (1.0, 1.5, 1.0, 0.0)  # m, J, a, b
SLEIGH = nh.discretize(nh.ChaplyginSleigh(*BODY), 1.0)
_SHIFT = 2 * BODY[0] * BODY[2] ** 2  # of p_hat, a p_1 + 2 m a^2


@functools.cache
@theme.in_style
def picture() -> BranchCounts:
    """Draw it, with the scale of p_hat at the right."""
    drawn = branch_counts(SLEIGH)
    axes = drawn.axes
    axes.set(xlabel=r"$p_\theta$", ylabel="$p_1$", title="Number of real displacements")
    axes.set_aspect("equal", adjustable="datalim")
    scale = axes.secondary_yaxis("right", functions=(_hatted, _plain))
    scale.set_ylabel(r"$\hat p_1 = ap_1 + 2ma^2$")
    return drawn


def _hatted(p_1: Any) -> Any:
    return BODY[2] * p_1 + _SHIFT


def _plain(p_hat: Any) -> Any:
    return (p_hat - _SHIFT) / BODY[2]


@statement
def counts() -> Measured:
    """Put the drawn curve and cusps into the discriminant; count real displacements on either side of the curve."""
    drawn, J = picture(), BODY[1]
    boundary, cusps = np.asarray(drawn.boundary.get_xydata()), np.asarray(drawn.cusps.get_offsets())
    c1, c2 = (float(c) for c in formulas.upper_cusp(J))
    expected = np.array([[0.0, -2 * J], [c1, c2], [-c1, c2]])
    hat = np.stack([cusps[:, 0], _hatted(cusps[:, 1])], axis=1)
    nearest = np.abs(hat[:, None] - expected).max(axis=2).min(axis=1)
    wrong = 0
    middle = cusps.mean(axis=0)
    for point in boundary[25:600:50]:
        for factor, count in ((0.96, 3), (1.04, 1)):
            real = nh.displacements_over(SLEIGH, middle + factor * (point - middle)).is_real
            wrong += int(np.count_nonzero(real) != count)
    values = formulas.discriminant_curve(J, boundary[:, 0], _hatted(boundary[:, 1]))
    return Measured(float(max(np.abs(values).max(), nearest.max(), wrong)), note="601 points, 3 cusps, 24 counts")


FIGURE = figure(lambda: picture().axes.figure, counts)
