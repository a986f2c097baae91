r"""The sleigh in 50 digits by its mass points: bodies, kinetic energy, Euler-Poincare-Suslov equations, displacements.

A body is (m, J, a, b) with J about the center of mass; of n dimensions it is a list of mass points. Only the
roots of the cubic come from a formula.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from nonholo.groups import SE, AbstractMatrixGroup
from nonholo_paper import _twin as twin
from nonholo_paper._twin import Matrix, Number, Vector, basis, ctx, exp, hat, numbers, roots
from nonholo_paper.formulas import sleigh_discrete as formulas

PLANE = SE(2)
ALONG = ([1, 0, 0], [0, 1, 0])
Point = tuple[Number, Matrix]


class Body(NamedTuple):
    """A sleigh: mass, moment of inertia about the center of mass, and where the center of mass is."""

    m: Number
    J: Number
    a: Number
    b: Number


def _bodies() -> list[Body]:
    drawn = numbers(501, 12, 0.3, 1.8)
    random = [Body(*drawn[i : i + 4]) for i in range(0, 12, 4)]
    nasty = [(2, 1.5, 0.4, 0), (1.3, 0.7, -0.6, 0.9), (0.8, 1.1, 0, -0.5), (1, 1e-6, 0.7, 0.2), (1.7, 40, 0.3, 1.1)]
    return random + [Body(*map(ctx.mpf, entry)) for entry in nasty]


BODIES = _bodies()
UNBALANCED = [body for body in BODIES if body.a != 0]
TURNS = [
    tuple(map(ctx.mpf, turn))
    for turn in [(0.7, 0.4), (-1.3, 1.1), (0, 0.6), (0, 0), (1e-20, 0.3), (3.1415, 0.5), (2.2, 0), (5.1, -7), (-2.9, 2)]
]  # omega and v1 of exp(omega, v1, 0); half turns exactly are added where they matter


def points(body: Body) -> list[Point]:
    """Return two mass points with the mass, center of mass and moment of inertia of a sleigh."""
    m, J, a, b = body
    arm, angle = ctx.sqrt(J / m), ctx.mpf("0.7")
    dx, dy = arm * ctx.cos(angle), arm * ctx.sin(angle)
    return [(m / 2, ctx.matrix([a + sign * dx, b + sign * dy, 1])) for sign in (1, -1)]


def solid(mass: Number, center: Sequence[Number], moments: Sequence[Number], turn: Matrix) -> list[Point]:
    """Return mass points whose mass tensor about their center has given moments along the columns of `turn`."""
    n = len(center)
    result = []
    for j, moment in enumerate(moments):
        arm = ctx.sqrt(n * moment / mass)
        for sign in (1, -1):
            place = [center[i] + sign * arm * turn[i, j] for i in range(n)]
            result.append((mass / (2 * n), ctx.matrix([*place, 1])))
    return result


def homogeneous(body: list[Point]) -> Matrix:
    """Return the sum of m r r^T over the points."""
    total = ctx.zeros(body[0][1].rows)
    for m, r in body:
        total += m * (r * r.T)
    return total


def kinetic(body: list[Point]) -> Callable[[Matrix], Number]:
    """Return the kinetic energy as a function of the velocity matrix."""
    return lambda X: ctx.fsum(m * ctx.norm(X * r) ** 2 for m, r in body) / 2


def lagrangian(body: list[Point]) -> Callable[[Matrix], Number]:
    """Return the discrete Lagrangian, the kinetic energy of W - I, the sum of squared moves of the points."""

    def value(W: Matrix) -> Number:
        X = W - ctx.eye(W.rows)
        moved = ((m, X * r) for m, r in body)
        return ctx.fsum(m * move[i] ** 2 for m, move in moved for i in range(W.rows)) / 2

    return value


def momentum(body: Body, W: Matrix) -> Vector:
    """Return the discrete momentum of a displacement."""
    return twin.momentum(PLANE, lagrangian(points(body)), W)


def arriving(body: Body, W: Matrix) -> Vector:
    """Return the discrete momentum that arrives at its end."""
    return twin.arriving(PLANE, lagrangian(points(body)), W)


def paired(body: list[Point], X: Matrix, Y: Matrix) -> Number:
    """Return the derivative of the kinetic energy at X in the direction Y, the sum of m (X r).(Y r)."""
    return ctx.fsum(m * (X * r)[i] * (Y * r)[i] for m, r in body for i in range(X.rows))


def momenta(group: AbstractMatrixGroup, body: list[Point], velocity: Matrix) -> Vector:
    """Return the body momentum at a velocity."""
    return [paired(body, velocity, E) for E in basis(group)]


def velocity_of(group: AbstractMatrixGroup, body: list[Point], rows: Sequence, restricted: Sequence[Number]) -> Matrix:
    """Return the admissible velocity with given momenta along the rows."""
    allowed = [hat(group, row) for row in rows]
    inertia = ctx.matrix([[paired(body, X, Y) for Y in allowed] for X in allowed])
    result = ctx.lu_solve(inertia, ctx.matrix(list(restricted)))
    return sum((result[i] * X for i, X in enumerate(allowed)), ctx.zeros(group.size))


def rates(group: AbstractMatrixGroup, body: list[Point], rows: Sequence, velocity: Matrix) -> Vector:
    """Return the derivatives of the momenta along the rows: <p, [xi, e]>, the multipliers drop out."""
    brackets = [velocity * E - E * velocity for E in (hat(group, row) for row in rows)]
    return [paired(body, velocity, bracket) for bracket in brackets]


def pose(theta: Number, x: Number, y: Number) -> Matrix:
    """Return the matrix of a pose in the plane."""
    cosine, sine = ctx.cos(theta), ctx.sin(theta)
    return ctx.matrix([[cosine, -sine, x], [sine, cosine, y], [0, 0, 1]])


def admissible(turn: Sequence[Number]) -> Matrix:
    """Return exp(omega, v1, 0)."""
    return exp(hat(PLANE, [turn[0], turn[1], 0]))


def tangents(J: Number, turning: Number, p_hat: Number) -> Vector:
    """Return the tangents of half the step angles over a momentum, complex ones too; p_hat must not be 0."""
    return roots(formulas.cubic(J, turning, p_hat))


def real_tangents(J: Number, turning: Number, p_hat: Number) -> Vector:
    """Return the real ones."""
    return [ctx.re(t) for t in tangents(J, turning, p_hat) if abs(ctx.im(t)) < ctx.mpf("1e-35") * (1 + abs(t))]


def poses(seed: int, count: int) -> list[tuple[Vector, Vector]]:
    """Return pairs of poses (theta, x, y): random, one of equal poses, one of headings half a turn apart."""
    drawn = numbers(seed, 6 * count, -2, 2)
    pairs = [(drawn[i : i + 3], drawn[i + 3 : i + 6]) for i in range(0, 6 * count, 6)]
    first = drawn[:3]
    return [*pairs, (first, first), (first, [first[0] + ctx.pi, first[1] - 1, first[2] + 2])]
