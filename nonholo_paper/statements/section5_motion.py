"""Section 5: the motion of the sleigh in the plane, and its closed form."""

from collections.abc import Callable, Sequence

import numpy as np

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._sleigh_twin import ALONG, BODIES, PLANE, UNBALANCED, Body, momenta, points, pose, poses, rates
from nonholo_paper._twin import Number, ctx, worst
from nonholo_paper.formulas import sleigh_continuous as formulas

TIMES = [ctx.mpf(t) for t in ("-2.5", "0.3", "7")]
MOTIONS = [(body, ctx.mpf(peak)) for body in UNBALANCED for peak in ("0.8",)]


def _velocity_of(motion: Callable[[Number], Sequence], time: Number) -> list:
    """Return the body velocity of a motion (theta, x, y)(t) by differentiation."""
    at = motion(time)
    speed = [ctx.diff(lambda t, i=i: motion(t)[i], time) for i in range(3)]
    turned = pose(-at[0], 0, 0) * ctx.matrix([speed[1], speed[2], 1])
    return [speed[0], turned[0], turned[1]]


@statement
def xyth() -> Measured:
    """Compare with the matrix equation for the derivative of the pose."""
    gaps = []
    for (_, at), v in zip(poses(561, 3), [twin.numbers(571 + k, 2, -3, 3) for k in range(5)], strict=True):
        speed = pose(*at) * twin.hat(PLANE, [*v, 0])
        along, across = formulas.reconstruction(at[0], speed[0, 2], speed[1, 2])
        gaps += [along - v[1], across, speed[1, 0] - v[0] * ctx.cos(at[0])]
    return Measured(worst(gaps), note="5 poses, random velocities")


@statement
def balanced_flow() -> Measured:
    """Look for rates of the momenta at a = 0, and differentiate the circle; (x_0, y_0) is its center."""
    gaps = []
    for body, (omega, v1) in zip(BODIES, [twin.numbers(581 + k, 2, -3, 3) for k in range(8)], strict=True):
        balanced = points(body._replace(a=ctx.zero))
        gaps += rates(PLANE, balanced, ALONG, twin.hat(PLANE, [omega, v1, 0]))
        start = [ctx.mpf(1), ctx.mpf(2), ctx.mpf(-3)]
        for time in TIMES:
            velocity = _velocity_of(lambda t, w=omega, v=v1, s=start: formulas.circle(s, w, v, t), time)
            _, x, y = formulas.circle(start, omega, v1, time)
            gaps += [velocity[0] - omega, velocity[1] - v1, velocity[2]]
            gaps.append((x - start[1]) ** 2 + (y - start[2]) ** 2 - (v1 / omega) ** 2)
    return Measured(worst(gaps), note="8 bodies with a = 0, 3 times")


@statement
def straight_motion() -> Measured:
    """Differentiate the right one; printed is the distance of the other from it."""
    right, wrong = [], []
    for (_, at), time in zip(poses(591, 1), TIMES, strict=True):
        v1 = ctx.mpf("-1.7")
        velocity = _velocity_of(lambda t, s=at, v=v1: formulas.straight(s, v, t), time)
        right += [velocity[0], velocity[1] - v1, velocity[2]]
        pairs = zip(formulas.printed_straight(at, v1, time), formulas.straight(at, v1, time), strict=True)
        wrong.append(ctx.fsum(abs(x - y) for x, y in pairs))
    return Measured(worst(right), worst(wrong), "3 poses")


@statement
def cusp() -> Measured:
    """Evaluate both lines at momenta with v1 = 0, and the right one, which is m (J + m a^2) v1, at others."""
    right, wrong = [], []
    for body in UNBALANCED:
        scale = body.m * (body.J + body.m * body.a**2)
        for omega, v1 in ((1, 0), (-3, 0), (2, 5), (0, 1)):
            p = momenta(PLANE, points(body), twin.hat(PLANE, [omega, v1, 0]))
            right.append(formulas.cusp_line(body, p) - scale * v1)
            wrong += [formulas.printed_cusp_line(body, p)] if v1 == 0 else []
    return Measured(worst(right), worst(wrong), "7 bodies, 4 velocities")


@statement
def generic_cusp() -> Measured:
    r"""Evaluate v1 at $\sinh(\kappa t) = -b\omega_0/u_\infty$; it changes its sign there, and not at 40 other times."""
    gaps, failures = [], 0
    for body, peak in MOTIONS:
        m, J, a, b = body
        kappa, fastest = formulas.rate(body, peak), ctx.sign(a) * peak * ctx.sqrt((J + m * a**2) / m)
        at = ctx.asinh(-b * peak / fastest) / kappa
        gaps.append(formulas.arch(body, peak, at)[1])
        for k in range(-20, 21):
            speed = formulas.arch(body, peak, at + ctx.mpf(k) / 4 / kappa)[1] * ctx.sign(a)
            failures += k != 0 and ctx.sign(speed) != ctx.sign(k)
    return Measured(max(worst(gaps), failures), note="7 bodies")


@statement
def heteroclinic() -> Measured:
    """Compare the arch at 130 units of its time with the two straight motions of its energy."""
    gaps = []
    for body, peak in MOTIONS:
        m, _, a, _ = body
        energy = formulas.lagrangian(body, [*formulas.arch(body, peak, ctx.mpf("0.3")), 0])
        fastest = ctx.sign(a) * ctx.sqrt(2 * energy / m)
        for side in (1, -1):
            omega, v1 = formulas.arch(body, peak, side * 130 / formulas.rate(body, peak))
            gaps += [omega, v1 - side * fastest]
    return Measured(worst(gaps), note="7 bodies; arch: see elementary-heading")


@statement
def shape() -> Measured:
    """Compare paths of different speed, and the equations at velocities multiplied by 3 and by -1."""
    gaps = []
    for body, peak in MOTIONS:
        place = [formulas.path(body, peak * s, time / s) for s in (1, 3) for time in TIMES]
        gaps += [place[k + 3] - place[k] for k in range(3)]
        velocity = twin.hat(PLANE, [peak, 1 - peak, 0])
        rate = rates(PLANE, points(body), ALONG, velocity)
        for s in (3, -1):
            faster = rates(PLANE, points(body), ALONG, s * velocity)
            gaps += [x - s**2 * y for x, y in zip(faster, rate, strict=True)]
    return Measured(worst(gaps), note="7 bodies; reversed velocities run the same path backwards")


def _closed_form_gaps(body: Body, peak: Number, time: Number) -> list:
    """Put the closed form into the equations of the momenta and of the pose."""
    omega, v1 = formulas.arch(body, peak, time)
    theta = formulas.heading(body, peak, time)
    gaps = [ctx.diff(lambda t: formulas.heading(body, peak, t), time) - omega]
    gaps.append(ctx.diff(lambda t: formulas.path(body, peak, t), time) - v1 * ctx.expj(theta))
    for i, rate in enumerate(rates(PLANE, points(body), ALONG, twin.hat(PLANE, [omega, v1, 0]))):
        along = ctx.diff(lambda t, i=i: formulas.momentum(body, [*formulas.arch(body, peak, t), 0])[i], time)
        gaps.append(along - rate)
    return gaps


def _flow_gaps(body: Body, peak: Number) -> list:
    """Compare the closed form of the library with the one in 50 digits."""
    start = formulas.arch(body, peak, 0)
    system = nh.ChaplyginSleigh(*map(float, body))
    velocity = [*map(float, start), 0.0]
    orbit = nh.flow(system, body_velocity=velocity, times=np.array([0.0, 1.5]), method="closed_form")
    moved = formulas.path(body, peak, ctx.mpf("1.5")) - formulas.path(body, peak, 0)
    x, y = orbit.position[1] - orbit.position[0]
    turned = orbit.heading[1] - orbit.heading[0]
    return [complex(x, y) - complex(moved), turned - float(formulas.heading(body, peak, ctx.mpf("1.5")))]


@statement
def closed_form() -> Measured:
    """Differentiate the closed forms, and compare the library with them."""
    gaps = [gap for body, peak in MOTIONS for time in TIMES[:2] for gap in _closed_form_gaps(body, peak, time)]
    library = [gap for body, peak in MOTIONS for gap in _flow_gaps(body, peak)]
    return Measured(twin.both(worst(gaps), worst(library)), note="7 bodies, 2 times; library: 1 time")


@statement
def asymptotic_angle() -> Measured:
    """Integrate the angular velocity of the closed form over all time, and ask the library."""
    gaps, library = [], []
    for body in (BODIES[0], BODIES[3], BODIES[4]):
        turn, kappa = formulas.heading_turn(body), formulas.rate(body, 1)
        gaps.append(
            ctx.quad(lambda s, f=body, k=kappa: formulas.arch(f, 1, s / k)[0] / k, [-130, -20, 0, 20, 130]) - turn
        )
        result = nh.asymptotics(nh.ChaplyginSleigh(*map(float, body)))
        library += [abs(result.heading_turn or 0) - float(turn), abs(result.motion_turn or 0) - float(turn - ctx.pi)]
    return Measured(twin.both(worst(gaps), worst(library)), note="3 bodies, one with a < 0")
