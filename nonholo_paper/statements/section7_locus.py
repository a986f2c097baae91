"""Section 7: momenta of admissible displacements, how many displacements a momentum has, and where V_1 vanishes."""

import numpy as np

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._sleigh_twin import BODIES, TURNS, UNBALANCED, Body, admissible, momentum, real_tangents, tangents
from nonholo_paper._twin import Number, ctx, worst
from nonholo_paper.formulas import sleigh_discrete as formulas

CENTERED = [body._replace(b=ctx.zero) for body in BODIES]
DRAWN = list(zip(twin.numbers(751, 70, -4, 4), twin.numbers(752, 70, -4, 4), strict=True))
SMALL = list(zip(twin.numbers(753, 90, -1, 1), twin.numbers(754, 90, -2.2, 0.4), strict=True))


def _shifted(body: Body, p: list) -> tuple[Number, Number]:
    """Return p_theta + b p_1 and a p_1 + 2 m a^2."""
    return p[0] + body.b * p[1], body.a * p[1] + 2 * body.m * body.a**2


@statement
def quartic() -> Measured:
    """Evaluate it at momenta of admissible displacements, and at zero and full turns with other momenta."""
    gaps = []
    for body in CENTERED:
        for turn in TURNS:
            p = momentum(body, admissible(turn))
            gaps.append(formulas.quartic(body, p[0], p[1], turn[0]))
        gaps += [formulas.quartic(body, ctx.mpf(3), ctx.mpf(-2), angle) for angle in (ctx.zero, 2 * ctx.pi)]
    return Measured(worst(gaps), note="8 bodies, 9 displacements")


@statement
def det_delta_phi() -> Measured:
    """Evaluate it at momenta of admissible displacements, relative to the size of its terms."""
    gaps = []
    for body in [*CENTERED[:3], *BODIES]:
        for turn in TURNS:
            turning, p_hat = _shifted(body, momentum(body, admissible(turn)))
            size = 1 + body.J**2 + turning**2 + p_hat**2
            gaps.append(formulas.cubic_in_sine(body.J, turning, p_hat, ctx.sin(turn[0])) / size)
    return Measured(worst(gaps), note="8 bodies, 3 of them also with b = 0, 9 displacements")


def _polynomial_gaps(body: Body, p_1: Number, turning: Number) -> list:
    """Compare the cubic with (1 + t^2) times the excess of momentum of the displacement that has p_1 and tangent t."""
    gaps = []
    p_hat = body.a * p_1 + 2 * body.m * body.a**2
    for t in (ctx.zero, ctx.one, -ctx.one, ctx.mpf("0.3"), ctx.mpf(7), ctx.mpc("0.4", "1.3")):
        sine, V_1, V_2 = formulas.third_step(body, p_1, t)
        cosine = (1 - t**2) / (1 + t**2)
        W = ctx.matrix([[cosine, -sine, V_1], [sine, cosine, V_2], [0, 0, 1]])
        p = momentum(body, W)
        excess = (1 + t**2) * (p[0] + body.b * p[1] - turning)
        gaps += [excess - twin.polynomial(formulas.cubic(body.J, turning, p_hat), t), p[1] - p_1]
        gaps.append(formulas.conoid(body.J, *_shifted(body, p), body.a * p[2]))
    return gaps


@statement
def three_preimages() -> Measured:
    """Find the cubic from the derivatives of L_d at 6 tangents, one complex; printed is 4 less the library's count."""
    gaps, counts = [], []
    for body, (p_1, turning) in zip(UNBALANCED, DRAWN, strict=False):
        gaps += _polynomial_gaps(body, p_1, turning)
        p = momentum(body, ctx.matrix([[1, 0, p_1], [0, 1, turning], [0, 0, 1]]))
        gaps.append(_shifted(body, p)[0] - body.a * p[2])
        discrete = nh.discretize(nh.ChaplyginSleigh(*map(float, body)), 1.0)
        result = nh.displacements_over(discrete, [float(turning - body.b * p_1), float(p_1)])
        counts.append(result.multiplicity.sum())
    return Measured(max(worst(gaps), max(abs(n - 3) for n in counts)), float(4 - max(counts)), "7 bodies")


@statement
def surface_between_planes() -> Measured:
    """Evaluate the cubic on planes and axes, find its roots at random points; printed is the distance of the line."""
    gaps, outside = [], 0
    J = ctx.mpf("1.5")
    for p_theta, p_hat in DRAWN:
        for side in (1, -1):
            value = formulas.cubic_in_sine(J, p_theta, p_hat, side)
            gaps.append(value - formulas.tangency(J, p_theta, p_hat, side))
        gaps += [formulas.cubic_in_sine(J, 0, p_hat, 0), formulas.cubic_in_sine(J, p_theta, 0, 0)]
        outside += sum(abs(z) > 1 for z in _real_sines(J, p_theta, p_hat))
    z = ctx.mpf(2)
    gaps += [formulas.cubic_in_sine(J, z * J, 0, z), ctx.diff(lambda s: formulas.cubic_in_sine(J, z * J, 0, s), z)]
    return Measured(max(worst(gaps), outside), float(abs(z) - 1), "70 random momenta, J = 1.5")


def _real_sines(J: Number, p_theta: Number, p_hat: Number) -> list:
    """Return the real roots of the cubic of the sine, from its four values at -1, 0, 1, 2."""
    at = [formulas.cubic_in_sine(J, p_theta, p_hat, z) for z in (-1, 0, 1, 2)]
    even, odd = (at[2] + at[0]) / 2 - at[1], (at[2] - at[0]) / 2
    leading = (at[3] - at[1] - 4 * even - 2 * odd) / 6
    result = twin.roots([leading, even, odd - leading, at[1]])
    return [ctx.re(z) for z in result if abs(ctx.im(z)) < ctx.mpf("1e-40")]


def _region(J: Number, p_theta: Number, p_hat: Number) -> str:
    """Return the quadrant of the lines of tangency in which a point lies."""
    if -p_hat > J + abs(p_theta):
        return "lower"
    return "upper" if p_hat > abs(p_theta) - J else "side"


def _signs(J: Number, p_theta: Number, p_hat: Number) -> str:
    """Return the signs of the cosines of the real step angles, + first."""
    return "".join(sorted("-" if abs(t) > 1 else "+" for t in real_tangents(J, p_theta, p_hat)))


ALLOWED = {"upper": ("+", "+--"), "lower": ("+", "+++"), "side": ("-", "++-", "---")}


@statement
def surface_signs() -> Measured:
    """Count points with other signs; printed counts points inside that contradict the lemma."""
    J, wrong, contradicted, patterns = ctx.mpf("0.9"), 0, 0, set()
    ends = [formulas.deltoid(J, ctx.mpf(t)) for t in (1.6, 1.9)]
    near_cusp = [(ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2]
    for p_theta, p_hat in [*DRAWN, *SMALL, near_cusp]:
        region, signs = _region(J, p_theta, p_hat), _signs(J, p_theta, p_hat)
        wrong += signs not in ALLOWED[region]
        contradicted += len(set(signs)) > 1 or signs[0] != ALLOWED[region][0]
        patterns.add((region, signs))
    missing = sum(len(signs) for signs in ALLOWED.values()) - len(patterns)
    p = formulas.momentum(BODIES[3], ctx.pi, 0, 1)
    axis = _shifted(BODIES[3], list(p))[1]
    return Measured(max(wrong, missing, worst([axis])), float(contradicted), "161 points; every pattern occurs")


@statement
def proof_of_signs() -> Measured:
    """Find the angles over a point of a line of tangency: one is a right angle, two are not. Printed counts letters."""
    J, p_theta = ctx.mpf("0.9"), ctx.mpf("0.4")
    result = real_tangents(J, p_theta, p_theta - J)
    right_angles = sum(abs(t - 1) < ctx.mpf("1e-40") for t in result)
    unknown = {"p_x", "Y"} - {"p_theta", "p_1", "p_2", "p_hat", "z"}
    return Measured(abs(right_angles - 1) + abs(len(result) - 3), float(len(unknown)), "J = 0.9, p_theta = 0.4")


@statement
def surface_deltoid() -> Measured:
    """Compare with the product of differences of roots, count real roots, and look at cusps, tangency and segment."""
    J, miscounted, gaps = ctx.mpf("0.9"), 0, []
    for p_theta, p_hat in [*DRAWN[:40], *SMALL]:
        curve = formulas.discriminant_curve(J, p_theta, p_hat)
        x, y, z = tangents(J, p_theta, p_hat)
        product = p_hat**4 * ((x - y) * (y - z) * (z - x)) ** 2
        gaps.append((product + 4 * curve) / (1 + p_theta**4 + p_hat**4) ** 2)
        miscounted += len(real_tangents(J, p_theta, p_hat)) != (3 if curve < 0 else 1)
        gaps.append(curve - formulas.discriminant_curve(J, -p_theta, p_hat))
    gaps += _curve_gaps(J)
    return Measured(max(worst(gaps), miscounted, _library_counts(J)), note="130 points, J = 0.9")


def _curve_gaps(J: Number) -> list:
    """Return the defects of parametrization, cusps, tangency at the origin, and the common sine on the segment."""
    c_1, c_2 = formulas.upper_cusp(J)
    gaps = [formulas.discriminant_curve(J, *formulas.deltoid(J, ctx.mpf(t))) for t in (-5, -1, 0, 0.3, 1, 2, 40)]
    for (p_theta, p_hat), root in (((0, -2 * J), 0), ((c_1, c_2), ctx.sqrt(3)), ((-c_1, c_2), -ctx.sqrt(3))):
        leading, *rest = formulas.cubic(J, p_theta, p_hat)
        gaps += [x - leading * y for x, y in zip(rest, (-3 * root, 3 * root**2, -(root**3)), strict=True)]
    gaps.append(ctx.diff(lambda s: formulas.discriminant_curve(J, s, 0), 0))
    gaps += [2 * t / (1 + t**2) - ctx.mpf("0.4") for t in twin.roots(formulas.cubic(J, ctx.mpf("0.4") * J, 0)[1:])]
    return gaps


def _library_counts(J: Number) -> float:
    """Count points where the library has not 3 real displacements inside or 1 outside, and compare its cusp."""
    discrete = nh.discretize(nh.ChaplyginSleigh(1.0, float(J), 0.3), 1.0)
    miscounted = 0
    for p_theta, p_hat, count in ((0.1, -0.3, 3), (0.2, 0.9, 1)):
        result = nh.displacements_over(discrete, [p_theta, (p_hat - 0.18) / 0.3])
        miscounted += int(result.is_real.sum()) != count
    cusp = nh.single_valued_region(discrete).cusps[2]
    defect = worst(np.array([cusp[0], 0.3 * cusp[1] + 0.18]) - np.array([*map(float, formulas.upper_cusp(J))]))
    return max(miscounted, 1e-33 * defect)


@statement
def ell() -> Measured:
    """Compare momenta of turns on the spot and of half turns; printed is V_1 of a displacement with the other sign."""
    gaps, wrong = [], 0
    for body in (body for body in CENTERED if body.a != 0):
        for angle in (0.3, 1.7, -2.9, 6):
            p = momentum(body, admissible((ctx.mpf(angle), 0)))
            gaps += [x - y for x, y in zip(formulas.ellipse(body, ctx.mpf(angle)), _shifted(body, p), strict=True)]
        half_turn = ctx.matrix([[-1, 0, 0], [0, -1, 3], [0, 0, 1]])
        gaps.append(_shifted(body, momentum(body, half_turn))[1])
        wrong += sum(_contradicts(body, p_theta, p_hat) for p_theta, p_hat in SMALL[:20])
    body, angle, nu = CENTERED[0], ctx.mpf("3.5"), 10
    p = formulas.momentum(body, angle, nu * ctx.cos(angle / 2), nu * ctx.sin(angle / 2))
    outside = _outside(body, *_shifted(body, list(p))) > 0
    return Measured(max(worst(gaps), wrong), float(-nu * ctx.cos(angle / 2)) if outside else 0.0, "7 bodies with b = 0")


def _outside(body: Body, p_theta: Number, p_hat: Number) -> Number:
    """Return a number that is positive outside the ellipse."""
    m, J, a, _ = body
    return (p_theta / (J + m * a**2)) ** 2 + (p_hat / (m * a**2) - 1) ** 2 - 1


def _contradicts(body: Body, across: Number, along: Number) -> bool:
    """Return whether V_1 of the one branch near the origin has another sign than the lemma says."""
    m, J, a, _ = body
    p_theta, p_1 = across * a * m, (along + ctx.mpf("0.9")) / 2 * m * a  # along is in [-2.2, 0.4]
    if m * p_theta**2 + (J + m * a**2) * p_1**2 > formulas.sharp_bound(body):
        return False
    p_hat = a * p_1 + 2 * m * a**2
    t = min(real_tangents(J, p_theta, p_hat), key=abs)
    return a * formulas.third_step(body, p_1, t)[1] * _outside(body, p_theta, p_hat) < 0


@statement
def near_origin() -> Measured:
    """Count points around O that are on the deltoid's side or have another number of real roots than one."""
    wrong = 0
    for body in CENTERED:
        ours = body.m * body.a**2
        for dx, dy in ((0, 0), (1, 0), (-1, 1), (0, -1), (1, -1)):
            if ours == 0:
                continue
            p_theta, p_hat = ours * dx / 100, 2 * ours * (1 + ctx.mpf(dy) / 100)
            wrong += formulas.discriminant_curve(body.J, p_theta, p_hat) <= 0
            wrong += len(real_tangents(body.J, p_theta, p_hat)) != 1
    return Measured(float(wrong), note="7 bodies, 5 points each")
