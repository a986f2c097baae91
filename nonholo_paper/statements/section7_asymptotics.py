"""Section 7: the theorem for b = 0, a != 0, where the map is single-valued and where its orbits go."""

import numpy as np

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._sleigh_twin import Body, real_tangents
from nonholo_paper._twin import Number, ctx, worst
from nonholo_paper.formulas import sleigh_continuous as continuous
from nonholo_paper.formulas import sleigh_discrete as formulas

SHAPES = ((2, 1.5, 0.4), (1, 0.3, 1.1), (1.3, 4, 0.5), (1, 0.05, 0.7), (0.7, 6, 0.2))
SLEIGHS = [Body(ctx.mpf(m), ctx.mpf(J), ctx.mpf(a), ctx.zero) for m, J, a in SHAPES]
ANGLES = [2 * ctx.pi * k / 9 + ctx.mpf("0.1") for k in range(9)]


def _at(body: Body, level: Number, angle: Number) -> tuple[Number, Number]:
    """Return the point (p_theta, p_1) of a level of the integral, b = 0."""
    size = ctx.sqrt(level)
    return size * ctx.sin(angle) / ctx.sqrt(body.m), size * ctx.cos(angle) / ctx.sqrt(body.J + body.m * body.a**2)


def _hat(body: Body, p_1: Number) -> Number:
    return body.a * p_1 + 2 * body.m * body.a**2


def _steps(body: Body, p_theta: Number, p_1: Number) -> list[tuple]:
    """Return for every real displacement over a momentum: its tangent, V_1, V_2 and the next two momenta."""
    result = []
    for t in real_tangents(body.J, p_theta, _hat(body, p_1)):
        _, V_1, V_2 = formulas.third_step(body, p_1, t)
        result.append((t, V_1, V_2, *formulas.next_momenta(body, p_theta, p_1, 2 * ctx.atan(t), V_2)))
    return result


def _inside(body: Body, p_theta: Number, p_1: Number) -> bool:
    """Return whether a point lies inside the ellipse of V_1 = 0."""
    m, J, a, _ = body
    return (p_theta / (J + m * a**2)) ** 2 + (_hat(body, p_1) / (m * a**2) - 1) ** 2 < 1


def _limits(body: Body) -> list[float]:
    """Run to both ends with the library; return the defects of the two limits and of the sign of p_theta."""
    discrete = nh.discretize(nh.ChaplyginSleigh(*map(float, body)), 1.0)
    level = formulas.bound_of_the_theorem(body) * ctx.mpf("0.95")
    limit = float(ctx.sqrt(level / (body.J + body.m * body.a**2)))
    gaps = [max(0.0, limit / float(body.m * body.a) - 1)]
    for start in ((1, 2), (-1, 5)):
        p_theta, p_1 = _at(body, level, ctx.mpf(start[1]) / 2)
        onward = nh.simulate(discrete, momentum=[start[0] * float(abs(p_theta)), float(p_1)], steps=4000)
        back = nh.simulate(discrete, displacement=np.linalg.inv(onward.displacement[0]), steps=4000)
        for orbit, sign in ((onward, start[0]), (back, -start[0])):
            gaps += [orbit.momentum[-1, 0], (orbit.momentum[-1, 1] - limit) / limit]
            # below 1e-150 the library counts a state as an equilibrium
            gaps.append(float(np.any(sign * orbit.momentum[:, 0] < -1e-140)))
    return gaps


@statement
def bi_asymptotic() -> Measured:
    """Make one step from many points in 50 digits, and run to both ends with the library."""
    failures = 0
    for body in SLEIGHS:
        bound = formulas.bound_of_the_theorem(body)
        for share in ("0.02", "0.5", "0.98"):
            for angle in ANGLES:
                p_theta, p_1 = _at(body, bound * ctx.mpf(share), angle)
                result = _steps(body, p_theta, p_1)
                failures += len(result) != 1 or result[0][3] * p_theta <= 0 or result[0][4] <= p_1
    library = [gap for body in SLEIGHS[:4] for gap in _limits(body)]
    return Measured(
        twin.both(failures, worst(library) / 10), note="5 bodies, 135 points; library: 8 orbits and their pasts"
    )


@statement
def single_valued() -> Measured:
    """Compare with the least value of the integral on the deltoid, at many of its points, and with the library."""
    gaps, failures, library = [], 0, []
    for body in SLEIGHS:
        sharp = formulas.sharp_bound(body)
        contacts = [(ctx.zero, ctx.zero), formulas.upper_cusp(body.J)]
        gaps.append((min(_level(body, *point) for point in contacts) - sharp) / sharp)
        for k in range(60):
            failures += _level(body, *formulas.deltoid(body.J, ctx.tan(ctx.pi * k / 60))) < sharp * (
                1 - ctx.mpf("1e-40")
            )
        failures += not 3.79 < sharp / formulas.bound_of_the_theorem(body) <= 4 + ctx.mpf("1e-40")
        region = nh.single_valued_region(nh.discretize(nh.ChaplyginSleigh(*map(float, body)), 1.0))
        scale = float(2 * body.m * (body.J + body.m * body.a**2))
        library += [region.energy * scale / float(sharp) - 1]
        library += [region.bound_of_the_paper * scale / float(formulas.bound_of_the_theorem(body)) - 1]
    return Measured(
        max(twin.both(worst(gaps), worst(library)), failures), note="5 bodies, 60 points of the deltoid each"
    )


def _level(body: Body, turning: Number, p_hat: Number) -> Number:
    """Return the integral at a point of the plane (p_theta, p_hat)."""
    return continuous.energy_integral(body, turning, (p_hat - 2 * body.m * body.a**2) / body.a)


@statement
def inequality_of_the_proof() -> Measured:
    """Look for points where the printed inequality holds, and for points left over; printed is its largest failure."""
    against, left_over, excess = 0, 0, []
    for body in SLEIGHS:
        for share in ("0.1", "0.6", "0.97"):
            for angle in ANGLES:
                p_theta, p_1 = _at(body, formulas.bound_of_the_theorem(body) * ctx.mpf(share), angle)
                ((_, _, V_2, next_theta, _),) = _steps(body, p_theta, p_1)
                sign = ctx.sign(p_theta)
                left_over += p_1 < 0 and not _inside(body, p_theta, p_1)
                against += sign * next_theta <= 0
                if p_1 > 0:
                    excess.append(sign * (p_theta - 2 * body.a * body.m * V_2) / abs(p_theta))
    return Measured(float(against + (left_over == 0) + (min(excess) <= 0)), float(min(excess)), "5 bodies, 135 points")


@statement
def half_plane() -> Measured:
    """Compare signs of p_theta before and after a step, on all real branches, in the region and elsewhere."""
    failures, elsewhere = 0, 0
    for body in SLEIGHS:
        bound = 4 * formulas.bound_of_the_theorem(body)
        shares = [ctx.mpf(share) for share in ("0.3", "0.99", "2", "9", "60")]
        cases = [(share < 1, _at(body, bound * share, angle)) for share in shares for angle in ANGLES]
        below = -(body.J * ctx.mpf("2.5") + 2 * body.m * body.a**2) / body.a  # p_hat = -5/2 J
        for inside, (p_theta, p_1) in [*cases, (False, (body.J / 100, below))]:
            for t, _, _, next_theta, _ in _steps(body, p_theta, p_1):
                stays = next_theta * p_theta > 0
                failures += stays != (min(formulas.half_plane(body, _hat(body, p_1), t)) > 0)
                failures += inside and not stays
                elsewhere += not stays
    return Measured(float(failures + (elsewhere == 0)), note="5 bodies, 230 points; beyond the region signs do change")
