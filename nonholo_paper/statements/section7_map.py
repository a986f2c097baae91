"""Section 7: the equations of the discrete sleigh, its integral, its stationary solutions and the balanced case."""

import itertools

import numpy as np

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._sleigh_twin import (
    ALONG,
    BODIES,
    PLANE,
    TURNS,
    UNBALANCED,
    Body,
    admissible,
    arriving,
    kinetic,
    momentum,
    points,
    pose,
    poses,
    real_tangents,
    tangents,
    velocity_of,
)
from nonholo_paper._twin import Matrix, Number, ctx, worst
from nonholo_paper.formulas import sleigh_continuous as continuous
from nonholo_paper.formulas import sleigh_discrete as formulas

CASES = list(zip(BODIES, TURNS, strict=False))
SLOW = list(zip(UNBALANCED, TURNS, strict=False))


def _matrix(t: Number, V_1: Number, V_2: Number) -> Matrix:
    """Return the displacement with the tangent t of half its angle."""
    sine, cosine = 2 * t / (1 + t**2), (1 - t**2) / (1 + t**2)
    return ctx.matrix([[cosine, -sine, V_1], [sine, cosine, V_2], [0, 0, 1]])


def _after(body: Body, turn: tuple) -> tuple[list, list[Matrix]]:
    """Make the three steps of the map: return the first two new momenta and the displacements that have them."""
    angle, V_1 = turn[0], admissible(turn)[0, 2]
    V_2 = ctx.tan(angle / 2) * V_1
    p = formulas.momentum(body, angle, V_1, V_2)
    p_theta, p_1 = formulas.next_momenta(body, p[0], p[1], angle, V_2)
    result = tangents(body.J, p_theta + body.b * p_1, body.a * p_1 + 2 * body.m * body.a**2)
    return [p_theta, p_1], [_matrix(t, *formulas.third_step(body, p_1, t)[1:]) for t in result]


def _discrete(body: Body) -> nh.Discretization:
    return nh.discretize(nh.ChaplyginSleigh(*map(float, body)), 1.0)


def _double(W: Matrix) -> np.ndarray:
    return np.array(W.tolist(), dtype=float)


@statement
def ep_sleigh() -> Measured:
    """Vary the pose between two steps of every branch, complex ones too; and take a step of the library."""
    gaps, library = [], []
    for body, turn in SLOW:
        carried = arriving(body, admissible(turn))
        for following in _after(body, turn)[1]:
            p = momentum(body, following)
            gaps += [(carried[i] - p[i]) / (1 + abs(p[i])) for i in range(2)]
    for body, turn in SLOW[:4]:
        orbit = nh.simulate(_discrete(body), displacement=_double(admissible(turn)), steps=1)
        W, p, following = orbit.displacement[0], orbit.momentum[0], orbit.momentum[1]
        forced = PLANE.coadjoint(W, p) + orbit.multipliers[0] * np.array([0, 0, 1])
        library += list(following - forced)
    return Measured(twin.both(worst(gaps), worst(library)), note="7 bodies and steps, 3 branches each")


@statement
def transported_in_space() -> Measured:
    """Compare with the momentum that arrives at the end of admissible steps."""
    right, wrong = [], []
    for (body, turn), (start, _) in zip(CASES, poses(761, 6), strict=True):
        moved = pose(*start) * admissible(turn)
        after = [start[0] + turn[0], moved[0, 2], moved[1, 2]]
        carried = arriving(body, admissible(turn))[:2]
        printed = formulas.next_in_space(body, start, after)
        right += [printed[0] - carried[0], formulas.printed_next_in_space(body, start, after)[0] - carried[0]]
        right.append(formulas.next_in_space(body, start, after)[1] - carried[1])
        wrong.append(formulas.printed_next_in_space(body, start, after)[1] - carried[1])
    return Measured(worst(right), float(ctx.fsum(map(abs, wrong))), "8 bodies and steps; printed: sum")


@statement
def discrete_constr() -> Measured:
    """Compare with the momentum that arrives at the end of admissible steps, and with a step of the library."""
    gaps, library = [], []
    for body, turn in CASES:
        W = admissible(turn)
        p, carried = momentum(body, W), arriving(body, W)
        result = formulas.next_momenta(body, p[0], p[1], turn[0], W[1, 2])
        gaps += [x - y for x, y in zip(result, carried, strict=False)]
        if body.a != 0 and abs(turn[0]) < 1.5:
            orbit = nh.simulate(_discrete(body), displacement=_double(W), steps=1)
            library += [orbit.momentum[1, i] - float(result[i]) for i in range(2)]
    return Measured(twin.both(worst(gaps), worst(library)), note="8 bodies and steps; library: 4 steps")


@statement
def three_steps() -> Measured:
    """Make the three steps and compare the momenta of all displacements found; printed counts wrong letters."""
    gaps = []
    for body, turn in SLOW:
        wanted, result = _after(body, turn)
        gaps += [(p - q) / (1 + abs(q)) for W in result for p, q in zip(momentum(body, W), wanted, strict=False)]
    letters = {"V_x", "p_x"} - {"V_1", "V_2", "p_theta", "p_1", "p_2"}
    wrong = letters | ({"p_theta", "p_2"} - {"p_theta", "p_1"})
    return Measured(worst(gaps), float(len(wrong)), "7 bodies, 3 branches each")


@statement
def without_quotient() -> Measured:
    """Evaluate the cubic at momenta of steps, also half turns; printed counts steps that the quotient misses."""
    gaps, missed = [], 0
    for body in BODIES[:5]:
        for turn in TURNS:
            W = admissible(turn)
            p = formulas.momentum(body, turn[0], W[0, 2], W[1, 2])
            gaps.append(_unit_gap(body, turn[0], p))
            if abs(turn[0]) > 0.1:
                printed = formulas.printed_third_step(body, turn[0], W[0, 2])
                gaps += [(x - y) / 1e5 for x, y in zip(printed, p, strict=False)]
        for angle, V_1, V_2 in ((ctx.zero, ctx.one, ctx.zero), (ctx.pi, ctx.zero, ctx.mpf(2))):
            p = formulas.momentum(body, angle, V_1, V_2)
            gaps.append(_unit_gap(body, angle, p))
            missed += _misses(body, angle, V_1, p)
    return Measured(worst(gaps), float(missed), "5 bodies, 11 steps each")


def _unit_gap(body: Body, angle: Number, p: tuple) -> Number:
    turning, p_hat = p[0] + body.b * p[1], body.a * p[1] + 2 * body.m * body.a**2
    return formulas.unit_cubic(body.J, turning, p_hat, ctx.expj(angle)) / (1 + abs(turning) + abs(p_hat)) * body.J


def _misses(body: Body, angle: Number, V_1: Number, p: tuple) -> bool:
    """Return whether the equations with the quotient have no value or a wrong one."""
    try:
        printed = formulas.printed_third_step(body, angle, V_1)
    except ZeroDivisionError:
        return True
    return worst([printed[0] - p[0], printed[1] - p[1]]) > 0.1


@statement
def int_chapl() -> Measured:
    """Compare it at a momentum and at the next one, and along 40 steps of the library."""
    gaps, library = [], []
    for body, turn in CASES:
        W = admissible(turn)
        p = formulas.momentum(body, turn[0], W[0, 2], W[1, 2])
        before = continuous.energy_integral(body, p[0], p[1])
        after = continuous.energy_integral(body, *formulas.next_momenta(body, p[0], p[1], turn[0], W[1, 2]))
        gaps.append((after - before) / (1 + before))
    for body in UNBALANCED[:4]:
        orbit = nh.simulate(_discrete(body), momentum=[0.2, 0.1], steps=40)
        library += [orbit.energy[-1] / orbit.energy[0] - 1]
    return Measured(twin.both(worst(gaps), worst(library)), note="8 bodies and steps; library: 4 orbits")


@statement
def dis_chapl_int() -> Measured:
    """Compare it at the start and end of real and complex steps, by derivatives of L_d, with the energy of the flow."""
    gaps = []
    for body, turn in SLOW:
        scale = 2 * body.m * (body.J + body.m * body.a**2)
        _, branches = _after(body, turn)
        for W in branches:
            before, after = momentum(body, W), arriving(body, W)
            value = continuous.energy_integral(body, before[0], before[1])
            gaps.append((continuous.energy_integral(body, after[0], after[1]) - value) / (1 + worst(after) ** 2))
        p = momentum(body, admissible(turn))
        energy = kinetic(points(body))(velocity_of(PLANE, points(body), ALONG, p[:2]))
        gaps.append((scale * energy - continuous.energy_integral(body, p[0], p[1])) / (1 + scale * energy))
    return Measured(worst(gaps), note="7 bodies, 3 branches each; relative to the squares of the momenta")


@statement
def invariant_ellipses() -> Measured:
    r"""Compare the determinant of the form with $m(J + ma^2) > 0$."""
    gaps = []
    for body in BODIES:
        first, last = continuous.energy_integral(body, 1, 0), continuous.energy_integral(body, 0, 1)
        mixed = (continuous.energy_integral(body, 1, 1) - first - last) / 2
        gaps += [first * last - mixed**2 - body.m * (body.J + body.m * body.a**2), float(first <= 0)]
    return Measured(worst(gaps), note="8 bodies")


@statement
def stationary_line() -> Measured:
    """Put shifts along the blade into the map and into the library."""
    gaps, library = [], []
    for body in UNBALANCED:
        p = momentum(body, admissible((0, ctx.mpf("0.4"))))
        carried = arriving(body, admissible((0, ctx.mpf("0.4"))))
        gaps += [p[0] + body.b * p[1], p[2], *(x - y for x, y in zip(carried, p, strict=True))]
        gaps += [x - y for x, y in zip(formulas.next_momenta(body, p[0], p[1], 0, 0), p, strict=False)]
        orbit = nh.simulate(_discrete(body), displacement=_double(admissible((0, ctx.mpf("0.4")))), steps=5)
        library += list(orbit.position[-1] - orbit.position[0] - np.array([2.0, 0.0]))
    return Measured(twin.both(worst(gaps), worst(library)), note="7 bodies; library: 5 steps")


@statement
def multiplier_of_branch() -> Measured:
    """Compare with the third component of the equations; printed is the change of p_2 on another branch over rest."""
    gaps = []
    for body, turn in SLOW:
        W = admissible(turn)
        p, carried = momentum(body, W), arriving(body, W)
        for following in _after(body, turn)[1]:
            p_2 = momentum(body, following)[2]
            gaps.append((p_2 - carried[2] - formulas.multiplier(body, turn[0], p[2], p_2)) / (1 + abs(p_2)))
    body = BODIES[3]
    p_1 = -(body.J + 2 * body.m * body.a**2) / body.a
    t = max(real_tangents(body.J, 0, -body.J), key=abs)
    other = _matrix(t, *formulas.third_step(body, p_1, t)[1:])
    p = momentum(body, other)
    gaps += [p[0] + body.b * p[1], p[1] - p_1]
    return Measured(worst(gaps), float(abs(p[2])), "7 bodies, 3 branches each")


BALANCED = [body._replace(a=ctx.zero) for body in BODIES[:5]]


@statement
def balanced_branches() -> Measured:
    """Compare momenta of steps with supplementary angles; printed is the difference of their angles."""
    gaps, failures = [], 0
    for body in BALANCED:
        angle = ctx.mpf("0.8")
        W = admissible((angle, ctx.mpf("0.5")))
        p, carried = momentum(body, W), arriving(body, W)
        t = ctx.tan((ctx.pi - angle) / 2)
        other = momentum(body, _matrix(t, *formulas.third_step(body, p[1], t)[1:]))
        for momenta in (carried, other, formulas.next_momenta(body, p[0], p[1], angle, W[1, 2])):
            gaps += [x - y for x, y in zip(momenta[:2], p, strict=False)]
        gaps.append(body.J * ctx.sin(angle) - p[0] - body.b * p[1])
        result = twin.roots(formulas.cubic(body.J, 1.5 * body.J, 0)[1:])
        failures += sum(abs(ctx.im(t)) < 0.1 for t in result)
    return Measured(max(worst(gaps), failures), float(ctx.pi - 2 * angle), "5 bodies with a = 0")


@statement
def balanced_circle() -> Measured:
    """Repeat a step five times, and let the library run."""
    gaps, library = [], []
    for body, turn in zip(BALANCED, ((0.8, 0.5), (-0.3, 1), (1.2, -2), (0.1, 1), (-1.4, 0.7)), strict=True):
        W = admissible((ctx.mpf(turn[0]), ctx.mpf(turn[1])))
        radius, place = formulas.radius(ctx.mpf(turn[0]), W[0, 2]), ctx.eye(3)
        for _ in range(5):
            place *= W
            gaps.append(place[0, 2] ** 2 + (place[1, 2] - radius) ** 2 - radius**2)
        orbit = nh.simulate(_discrete(body), displacement=_double(W), steps=5)
        library += list((orbit.position - np.array([0.0, float(radius)])) ** 2 @ np.ones(2) / float(radius) ** 2 - 1)
    return Measured(twin.both(worst(gaps), worst(library)), note="5 bodies with a = 0, 5 steps each")


@statement
def footnote_spiral() -> Measured:
    """Test for a = b = 0 that steps of constant angle, each cosine of it shorter, solve the equations; add them up."""
    gaps = []
    for body, angle in zip(BODIES[:3], (ctx.mpf("0.6"), ctx.mpf("-1.2"), ctx.mpf("2.5")), strict=True):
        centered = Body(body.m, body.J, ctx.zero, ctx.zero)
        shifts = [ctx.mpf("0.7") * ctx.cos(angle) ** k for k in range(6)]
        steps = [pose(angle, shift, 0) for shift in shifts]
        for W, following in itertools.pairwise(steps):
            pairs = zip(arriving(centered, W)[:2], momentum(centered, following), strict=False)
            gaps += [x - y for x, y in pairs]
        place = ctx.eye(3)
        for k, W in enumerate(steps):
            gaps.append(place[0, 2] + 1j * place[1, 2] - formulas.spiral(angle, shifts[0], k))
            place *= W
    return Measured(worst(gaps), note="3 bodies with a = b = 0, 6 steps: a logarithmic spiral")
