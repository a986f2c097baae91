"""Section 7: displacements of the sleigh, discrete Lagrangian, discrete momentum and its coadjoint transport."""

from collections.abc import Callable

import numpy as np

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._sleigh_twin import BODIES, PLANE, TURNS, Body, admissible, lagrangian, momentum, points, pose, poses
from nonholo_paper._twin import Matrix, Number, ctx, differences, worst
from nonholo_paper.formulas import sleigh_continuous as continuous
from nonholo_paper.formulas import sleigh_discrete as formulas

PAIRS = poses(701, 4)


def _between(before: list, after: list) -> Matrix:
    """Return the displacement by its definition."""
    return pose(*before) ** -1 * pose(*after)


@statement
def om_k() -> Measured:
    """Compare with the product of the matrices."""
    right, wrong = [], []
    for before, after in PAIRS:
        W = _between(before, after)
        right += [*(formulas.displacement(before, after, formulas.step_angle(before, after)) - W)]
        wrong += [*(formulas.displacement(before, after, formulas.printed_step_angle(before, after)) - W)]
    return Measured(worst(right), worst(wrong), "6 pairs of poses, one of equal ones, one half a turn apart")


@statement
def trace_form() -> Measured:
    """Compare with half the sum of m |(W - 1) r|^2 over mass points."""
    right, wrong, identity = [], [], ctx.eye(3)
    for body in BODIES:
        tensor, printed, defined = (
            formulas.mass_tensor(body),
            formulas.printed_mass_tensor(body),
            lagrangian(points(body)),
        )
        for pair in PAIRS:
            W = _between(*pair)
            value = formulas.trace_lagrangian(W, tensor) - formulas.trace_lagrangian(identity, tensor)
            right.append(value - defined(W))
            value = formulas.printed_trace_lagrangian(W, printed) - formulas.printed_trace_lagrangian(identity, printed)
            wrong.append(value - defined(W))
    return Measured(worst(right), worst(wrong), "8 bodies, 6 displacements")


@statement
def discr_L2() -> Measured:
    """Compare with half the sum of m |(W - 1) r|^2 over mass points."""
    gaps = []
    for body in BODIES:
        defined = lagrangian(points(body))
        gaps += [formulas.scalar_lagrangian(body, *pair) - defined(_between(*pair)) for pair in PAIRS]
    return Measured(worst(gaps), note="8 bodies, 6 pairs of poses")


@statement
def cont_lim() -> Measured:
    """Differentiate the discrete Lagrangian along poses that start with a velocity."""
    right, wrong = [], []
    for body, (at, velocity) in zip(BODIES, poses(711, 6), strict=True):
        moved = _line(at, velocity)
        turned = pose(-at[0], 0, 0) * ctx.matrix([velocity[1], velocity[2], 1])
        limit = continuous.lagrangian(body, [velocity[0], turned[0], turned[1]])
        right.append(
            ctx.diff(lambda e, f=body, s=at, m=moved: formulas.scalar_lagrangian(f, s, m(e)), 0, 2) / 2 - limit
        )
        wrong.append(ctx.diff(lambda e, f=body, s=at, m=moved: formulas.scalar_lagrangian(f, s, m(e)), 0) - limit)
    return Measured(worst(right), worst(wrong), "8 bodies, second and first derivatives")


def _line(at: list, velocity: list) -> Callable[[Number], list]:
    return lambda e: [x + e * v for x, v in zip(at, velocity, strict=True)]


@statement
def disc_mom_sl() -> Measured:
    """Compare with the derivatives of L_d along the group and in coordinates, and with the library on the variety."""
    gaps, library = [], []
    for k, body in enumerate(BODIES):
        before, after = PAIRS[k % len(PAIRS)]
        velocities = formulas.discrete_velocities(before, after)
        p = formulas.momentum(body, formulas.step_angle(before, after), *velocities)
        gaps += differences(p, momentum(body, _between(before, after))) + differences(
            p, _in_coordinates(body, before, after)
        )
        discrete = nh.discretize(nh.ChaplyginSleigh(*map(float, body)), 1.0)
        W = admissible(TURNS[k])
        p = formulas.momentum(body, TURNS[k][0], W[0, 2], W[1, 2])
        result = nh.discrete_legendre(discrete, np.array(W.tolist(), dtype=float))
        library += differences([*map(float, p)], result)
    return Measured(twin.both(worst(gaps), worst(library) / 100), note="8 bodies and displacements; momenta up to 100")


def _in_coordinates(body: Body, before: list, after: list) -> list:
    """Return the momentum by the three derivatives that the paper prints."""
    cosine, sine = ctx.cos(before[0]), ctx.sin(before[0])
    moves = ([1, 0, 0], [0, cosine, sine], [0, -sine, cosine])
    ways = [_line(before, move) for move in moves]
    return [-ctx.diff(lambda e, way=way: formulas.scalar_lagrangian(body, way(e), after), 0) for way in ways]


@statement
def discr_vel() -> Measured:
    """Compare with the entries of the product of the matrices."""
    gaps = []
    for before, after in PAIRS:
        W = _between(before, after)
        gaps += differences(formulas.discrete_velocities(before, after), [W[0, 2], W[1, 2]])
    return Measured(worst(gaps), note="6 pairs of poses")


@statement
def discr_ad_sl() -> Measured:
    """Compare with the transpose of Ad and with the library; printed counts letters that P does not have."""
    gaps, library = [], []
    for k, (before, after) in enumerate(PAIRS):
        W, p = _between(before, after), twin.numbers(721 + k, 3, -2, 2)
        result = formulas.coadjoint(p, formulas.step_angle(before, after), W[0, 2], W[1, 2])
        gaps += differences(result, twin.coadjoint(PLANE, W, p))
        double = PLANE.coadjoint(np.array(W.tolist(), dtype=float), np.array(p, dtype=float))
        library += differences([*map(float, result)], double)
    unknown = {"p_omega", "p_1", "p_2"} - {"p_theta", "p_1", "p_2"}
    return Measured(twin.both(worst(gaps), worst(library)), float(len(unknown)), "6 displacements, random momenta")


@statement
def discrete_free() -> Measured:
    """Vary the middle pose of two steps, and carry the momenta before and after a step to space."""
    gaps = []
    for body, (before, after) in zip(BODIES[:6], PAIRS, strict=True):
        value, W, following = lagrangian(points(body)), _between(before, after), admissible(TURNS[0])
        carried = twin.coadjoint(PLANE, W, momentum(body, W))
        for E, left, right in zip(twin.basis(PLANE), carried, momentum(body, following), strict=True):
            gaps.append(ctx.diff(_action(value, W, following, E), 0) - (left - right))
        spatial = [twin.coadjoint(PLANE, pose(*before) ** -1, momentum(body, W))]
        spatial.append(twin.coadjoint(PLANE, pose(*after) ** -1, carried))
        gaps += differences(*spatial)
    return Measured(worst(gaps), note="6 bodies and displacements")


def _action(value: Callable, W: Matrix, following: Matrix, E: Matrix) -> Callable[[Number], Number]:
    """Return the action of two steps whose middle pose is moved along E."""

    def moved(e: Number) -> Number:
        return value(W * twin.exp(e * E)) + value(twin.exp(-e * E) * following)

    return moved


@statement
def free_motion() -> Measured:
    """Compare transported momenta with the printed right sides, and with the momenta of the same step made again."""
    gaps = []
    for body, (before, after) in zip(BODIES[:6], PAIRS, strict=True):
        centered = Body(body.m, body.J, ctx.zero, ctx.zero)
        carried = twin.coadjoint(PLANE, _between(before, after), momentum(centered, _between(before, after)))
        along, back = formulas.tangent_velocities(before, after)
        gaps += differences(carried, [body.J * ctx.sin(after[0] - before[0]), body.m * along, -body.m * back])
        following = [2 * y - x for x, y in zip(before, after, strict=True)]
        gaps += differences(carried, momentum(centered, _between(after, following)))
    return Measured(worst(gaps), note="6 bodies and steps; for large angles the supplementary angle solves it too")
