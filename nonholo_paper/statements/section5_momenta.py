"""Section 5: the equations of the body momentum of the sleigh, their integral and their phase portrait."""

import numpy as np

import nonholo as nh
from nonholo.groups import SO
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._sleigh_twin import ALONG, BODIES, PLANE, UNBALANCED, Body, points, rates, velocity_of
from nonholo_paper._sleigh_twin import momenta as momenta_at
from nonholo_paper._twin import Matrix, Number, ctx, worst
from nonholo_paper.formulas import sleigh_continuous as formulas

MOMENTA = [twin.numbers(531 + k, 2, -2, 2) for k in range(3)] + [
    [ctx.mpf(v) for v in e] for e in ((0, 1), (1, 0), (7, -9))
]
EVERY = ([1, 0, 0], [0, 1, 0], [0, 0, 1])


def _velocity(body: Body, p: list) -> Matrix:
    return velocity_of(PLANE, points(body), ALONG, p)


def _rates(body: Body, p: list) -> list:
    """Return the derivatives of p_theta and p_1 from the equations themselves."""
    return rates(PLANE, points(body), ALONG, _velocity(body, p))


def _turning_rate(body: Body, turning: Number, p_1: Number) -> Number:
    """Return the derivative of p_theta + b p_1."""
    rate = _rates(body, [turning - body.b * p_1, p_1])
    return rate[0] + body.b * rate[1]


@statement
def eps_se2() -> Measured:
    """Compare with the pairing of the momentum with the brackets of the velocity and the basis, on and off v2 = 0."""
    gaps = []
    for k, body in enumerate(BODIES):
        for v in ([*twin.numbers(541 + k, 3, -3, 3)], [*twin.numbers(551 + k, 2, -3, 3), ctx.zero]):
            velocity = twin.hat(PLANE, v)
            defined = rates(PLANE, points(body), EVERY, velocity)
            gaps += twin.differences(formulas.momentum_rates(momenta_at(PLANE, points(body), velocity), v), defined)
    return Measured(worst(gaps), note="8 bodies, 16 velocities")


@statement
def ch_sl_1() -> Measured:
    """Compare with the equations at the admissible velocity that has these momenta."""
    gaps = [twin.differences(formulas.momentum_equation(body, *p), _rates(body, p)) for body in BODIES for p in MOMENTA]
    return Measured(max(map(worst, gaps)), note="8 bodies, 6 momenta")


@statement
def cont_sl_int() -> Measured:
    """Take its derivative along the equations, and compare it with 2 m (J + m a^2) times the kinetic energy."""
    gaps, library = [], []
    for body in BODIES:
        system = nh.ChaplyginSleigh(*map(float, body))
        scale = 2 * body.m * (body.J + body.m * body.a**2)
        for p in MOMENTA:
            rate, value = _rates(body, p), formulas.energy_integral(body, *p)
            ahead = formulas.energy_integral(body, p[0] + rate[0], p[1] + rate[1])
            gaps.append((ahead - value - formulas.energy_integral(body, *rate)) / (1 + abs(ahead)))
            velocity = twin.vee(PLANE, _velocity(body, p))
            gaps.append((scale * formulas.lagrangian(body, velocity) - value) / (1 + value))
            energy = system.constrained_energy(np.array([*map(float, p), 0.0]))
            library.append((energy * float(scale) - float(value)) / (1 + float(value)))
    return Measured(twin.both(worst(gaps), worst(library)), note="8 bodies, 6 momenta")


@statement
def sleqns() -> Measured:
    """Compare with the equations of bodies whose center of mass is on the axis of the blade."""
    centered = [body._replace(b=ctx.zero) for body in BODIES]
    gaps = [
        twin.differences(formulas.momentum_equation_centered(body, *p), _rates(body, p))
        for body in centered
        for p in MOMENTA
    ]
    return Measured(max(map(worst, gaps)), note="8 bodies, 6 momenta")


@statement
def b_irrelevant() -> Measured:
    """Compare the rates of p_theta + b p_1 and p_1 with those of the body with b = 0."""
    gaps = []
    for body in BODIES:
        for turning, p_1 in MOMENTA:
            rate = _rates(body, [turning - body.b * p_1, p_1])
            centered = _rates(body._replace(b=ctx.zero), [turning, p_1])
            gaps += twin.differences([rate[0] + body.b * rate[1], rate[1]], centered)
    return Measured(worst(gaps), note="8 bodies, 6 momenta")


@statement
def suslov_portrait() -> Measured:
    """Compare the rates with those of the top with I_11 = J + m a^2, I_22 = m, I_13 = m a, I_12 = I_23 = 0."""
    group, gaps = SO(3), []
    brackets = [twin.hat(group, row) for row in EVERY[:2]]
    for body in BODIES:
        m, J, a, b = body
        inertia = ctx.matrix([[J + m * a**2, 0, m * a], [0, m, 0], [m * a, 0, 50]])
        tensor = twin.trace(inertia) / 2 * ctx.eye(3) - inertia
        for turning, p_1 in MOMENTA:
            omega = twin.hat(group, [turning / inertia[0, 0], p_1 / m, 0])
            top = [twin.inner(omega * tensor, omega * E - E * omega) for E in brackets]
            rate = _rates(body, [turning - b * p_1, p_1])
            gaps += twin.differences([rate[0] + b * rate[1], rate[1]], top)
    return Measured(worst(gaps), note="8 bodies and their tops, 6 momenta: the same equations")


@statement
def noncompact_limit() -> Measured:
    r"""Turn by small angles e v about axes in the plane and stretch the third coordinate by 1/e, with e = 1e-30."""
    group, small, gaps = SO(3), ctx.mpf("1e-30"), []
    with ctx.workdps(130):
        stretch = ctx.diag([1, 1, small])
        for omega, v1, v2 in ((0.7, 0.4, -0.9), (3.1, 1, 0), (0, 2, 1)):
            turn = twin.exp(twin.hat(group, [-small * v2, small * v1, ctx.mpf(omega)]))
            plane = twin.exp(twin.hat(PLANE, [omega, v1, v2]))
            gaps.append(worst(stretch * turn * stretch**-1 - plane))
    return Measured(max(gaps), note="3 displacements, e = 1e-30")


@statement
def footnote_arches() -> Measured:
    """Look for rates on the line, for rest off it, and for a minor of the form that is not positive."""
    gaps, failures = [], 0
    for body in UNBALANCED:
        gaps += [worst(_rates(body, [-body.b * p_1, p_1])) for _, p_1 in MOMENTA]
        moving = [worst(_rates(body, p)) for p in MOMENTA if p[0] + body.b * p[1] != 0]
        first, last = formulas.energy_integral(body, 1, 0), formulas.energy_integral(body, 0, 1)
        mixed = (formulas.energy_integral(body, 1, 1) - first - last) / 2
        failures += (min(moving) < 1e-9) + (first <= 0) + (first * last <= mixed**2)
    return Measured(max(worst(gaps), failures), note="7 bodies, 6 momenta")


@statement
def stability() -> Measured:
    """Linearize across the line of equilibria; as printed, rates of upper equilibria would be negative."""
    gaps, library, printed = [], [], []
    for body in UNBALANCED:
        m, J, a, _ = body
        rate = ctx.diff(lambda turning, body=body: _turning_rate(body, turning, 1), 0)
        gaps.append(rate + a / (J + m * a**2))
        result = nh.equilibria(nh.ChaplyginSleigh(*map(float, body)))
        library.append(np.array(result.rates)[0] / np.array(result.velocity)[1] / float(m) - float(rate))
        library.append(np.array(result.attracting)[1] - float(ctx.sign(a)))
        printed.append(max(rate, 0))
    return Measured(twin.both(worst(gaps), worst(library)), worst(printed), "7 bodies, one with a < 0")
