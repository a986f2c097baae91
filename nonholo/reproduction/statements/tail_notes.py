"""Notes behind the end of the document: the coadjoint action on se*(2)."""

import numpy as np

from nonholo.reproduction import _twin as twin
from nonholo.reproduction._finding import Measured, finding
from nonholo.reproduction._sleigh_twin import PLANE, UNBALANCED, points, pose
from nonholo.reproduction._twin import ctx, worst
from nonholo.reproduction.formulas import tail as formulas


@finding(
    "Coad.se2.eqn",
    "equation",
    "Notes behind the end, equation (Coad.se2.eqn)",
    r"$\mathrm{Ad}^*_{(g, v)}(\mu, m)$ is the matrix with $\mu + a_2p_1 - a_1p_2$ in the place of $\mu$ and $(p_1, "
    r"p_2)$ in that of $m$, where $p = g^{-1}m$, $a = g^{-1}v$. (It is the formula of Section 7; the matrix only "
    r"writes elements of the dual.)",
    errata=("C40",),
    tolerance=1e-45,
)
def coad_se2() -> Measured:
    """Compare with the transpose of Ad and with the library."""
    gaps, library = [], []
    for k, angle in enumerate((ctx.mpf("0.4"), ctx.pi, ctx.mpf("-2.7"), ctx.zero)):
        v1, v2, mu, m1, m2 = twin.numbers(841 + k, 5, -2, 2)
        W = pose(angle, v1, v2)
        found, defined = formulas.coadjoint(angle, (v1, v2), mu, (m1, m2)), twin.coadjoint(PLANE, W, [mu, m1, m2])
        gaps += [*(found - twin.hat(PLANE, defined))]
        double = PLANE.coadjoint(np.array(W.tolist(), dtype=float), np.array([mu, m1, m2], dtype=float))
        library += [float(found[1, 0]) - double[0], float(found[0, 2]) - double[1], float(found[1, 2]) - double[2]]
    return Measured(twin.both(worst(gaps), worst(library)), note="4 displacements, a half turn among them")


@finding(
    "C41",
    "remark",
    "Notes behind the end, last remark",
    r"For a moving frame whose origin has the velocity $v$, $\mu + a_2p_1 - a_1p_2$ is the angular momentum relative "
    r"to the moving frame.",
    as_printed=False,
    corrected=r"It is the angular momentum about the new origin, to which the frame was displaced by $v$.",
    errata=("C41",),
    tolerance=1e-45,
)
def about_the_new_origin() -> Measured:
    """Sum moments of mass points about the new origin; printed: of their velocities less v, about the old one."""
    right, wrong = [], []
    for k, body in enumerate(UNBALANCED):
        angle, v1, v2, *velocity = twin.numbers(861 + k, 6, -2, 2)
        at = [(m, r, twin.hat(PLANE, velocity) * r) for m, r in points(body)]
        mu = ctx.fsum(m * (r[0] * s[1] - r[1] * s[0]) for m, r, s in at)
        momentum = ctx.fsum(m * s[0] for m, _, s in at), ctx.fsum(m * s[1] for m, _, s in at)
        found = formulas.coadjoint(angle, (v1, v2), mu, momentum)[1, 0]
        right.append(ctx.fsum(m * ((r[0] - v1) * s[1] - (r[1] - v2) * s[0]) for m, r, s in at) - found)
        wrong.append(ctx.fsum(m * (r[0] * (s[1] - v2) - r[1] * (s[0] - v1)) for m, r, s in at) - found)
    return Measured(worst(right), worst(wrong), "7 bodies")
