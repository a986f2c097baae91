"""Section 1, claims of the introduction: the surfaces of displacements and momenta, and why energy is kept."""

from collections.abc import Callable

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import (
    BALANCED_SLEIGH,
    BALANCED_TOP,
    SLEIGH,
    TOP,
    TOP_4,
    Body,
    displacements,
    in_double,
    velocities,
)
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, ctx
from nonholo_paper.formulas import energy_theorem, symmetric_pairs


@statement
def nonholonomic() -> Measured:
    """Test the first of the three: brackets of admissible velocities span the algebra, so no constraint integrates."""
    defects = []
    for body in (TOP, SLEIGH, TOP_4):
        d = [twin.hat(body.group, e) for e in body.directions]
        brackets = [symmetric_pairs.bracket(x, y) for x in d for y in d]
        spanned = twin.rank(ctx.matrix([twin.vee(body.group, X) for X in (*d, *brackets)]))
        defects += [body.group.dim - spanned, int(spanned == len(d))]
    return Measured(float(max(defects)), note="tops n = 3, 4 and a sleigh: dimensions")


@statement
def nonlinear_locus() -> Measured:
    """Count: the locus has tangent planes of dimension k at the identity, and its points span more dimensions."""
    defects = []
    for body, spanned in ((TOP, 3), (SLEIGH, 3), (TOP_4, 6)):
        k = len(body.directions)
        tangents = [body.inertia * e for e in body.directions]
        points = [body.momentum(body.displacement(body.velocity(twin.numbers(s, k, -2, 2)))) for s in range(8)]
        ranks = [twin.rank(ctx.matrix([list(row) for row in rows])) for rows in (tangents, points)]
        defects += [abs(ranks[0] - k), abs(ranks[1] - spanned)]
    return Measured(float(max(defects)), note="tops n = 3, 4 and a sleigh: dimensions")


@statement
def non_orientable() -> Measured:
    """Carry a frame around a closed curve on each: it comes back as its mirror image."""
    defects = []
    for body, surface, velocity in ((TOP, _top_surface, _top_velocity), (SLEIGH, _sleigh_surface, _sleigh_velocity)):
        start, end = _frame(surface, ctx.mpf(0)), _frame(surface, ctx.pi)
        defects += [surface(ctx.pi, 0) - surface(0, 0), start[0] - end[0], start[1] + end[1]]
        for s, u in ((ctx.mpf("0.5"), ctx.mpf("0.25")), (ctx.mpf("1.25"), ctx.mpf(-1)), (ctx.mpf("0.25"), ctx.mpf(3))):
            defects.append(surface(s, u) - body.displacement(body.velocity(velocity(s, u))))
        defects.append([twin.rank(ctx.matrix([list(part) for part in start])) - 2])
    return Measured(twin.worst(*defects), note="one closed curve on each surface, and 3 points of it")


def _top_surface(s: Number, u: Number) -> Matrix:
    return symmetric_pairs.quaternion_rotation(ctx.cos(s), ctx.sin(s), u)


def _sleigh_surface(s: Number, u: Number) -> Matrix:
    return symmetric_pairs.slide_and_turn(ctx.cos(s), ctx.sin(s), u)


def _frame(surface: Callable[[Number, Number], Matrix], s: Number) -> tuple[Matrix, Matrix]:
    return twin.rate(lambda t: surface(s + t, 0)), twin.rate(lambda t: surface(s, t))


def _top_velocity(s: Number, u: Number) -> list[Number]:
    """Return the rotation vector of the quaternion (cos s, sin s, u, 0), of any length."""
    length = ctx.hypot(ctx.sin(s), u)
    angle = 2 * ctx.atan2(length, ctx.cos(s))
    return [angle * ctx.sin(s) / length, angle * u / length]


def _sleigh_velocity(s: Number, u: Number) -> list[Number]:
    """Return angle and slide of the displacement with half-angle s whose chord has the signed length u."""
    return [2 * s, u * s / ctx.sin(s)]


@statement
def measure_preserving() -> Measured:
    """Evaluate rates and steps of the momenta along the constraint of balanced bodies: none of them moves."""
    defects, facts = [], []
    for body in (BALANCED_TOP, BALANCED_SLEIGH, TOP, SLEIGH):
        moved = []
        for W, w in zip(displacements(body), velocities(body), strict=True):
            moved.append(body.restrict(body.arriving(W)) - body.restrict(body.momentum(W)))
            moved.append(body.restrict(twin.coad(body.group, list(w), list(body.inertia * w))))
        if body in (BALANCED_TOP, BALANCED_SLEIGH):
            defects += moved
        else:
            facts.append(twin.worst(*moved) > 0.01)
    return Measured(max(twin.worst(*defects), float(facts.count(False))), note="balanced bodies; others move")


@statement
def mirror_image() -> Measured:
    """Compare the step of the definition with the mirror image, for both discrete Lagrangians."""
    right, wrong = [], []
    for body in (TOP, SLEIGH, TOP_4):
        logarithmic = nh.discretize(body.system, 1.0, difference="logarithmic")
        for W in displacements(body)[2:]:
            r, after = body.restrict(body.momentum(W)), body.restrict(body.arriving(W))
            right.append(after - energy_theorem.mirrored(r, _axis(body, W), body.restricted_inertia()))
        W = body.displacement(body.velocity([0.75, -0.5, 0.25][: len(body.subspace)]))
        before, after = (_library(body, logarithmic, W, side) for side in ("left", "right"))
        wrong.append(twin.worst(after - energy_theorem.mirrored(before, _axis(body, W), body.restricted_inertia())))
    return Measured(twin.worst(*right), min(wrong), "tops n = 3, 4 and a sleigh; logarithm: angles below one")


def _axis(body: Body, W: Matrix) -> Matrix:
    """Return I|_d of the coordinates of (W - W^-1)/2 in d."""
    x = twin.column(twin.vee(body.group, energy_theorem.skew_part(W)))
    return body.restrict(body.inertia * x)


def _library(body: Body, discrete: nh.Discretization, W: Matrix, side: str) -> Matrix:
    return body.restrict(twin.column(nh.discrete_legendre(discrete, in_double(W), side=side).tolist()))
