"""Section 6: finite rotations, the discrete Lagrangian and its momentum."""

import nonholo as nh
from nonholo.groups import SO
from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, ctx
from nonholo_paper.formulas import general
from nonholo_paper.formulas import suslov_displacements as formulas


def _tops() -> list[tuple[Matrix, Matrix]]:
    """Return bodies of dimension 3, 4, 5 with admissible rotations, almost half-turns and forbidden rotations."""
    cases = [(data.body("generic"), data.rotation(q)) for q in data.points()[4:9]]
    for n in (3, 4, 5):
        J, forbidden = data.random_body(n, n), data.attitude(n + 10, n)
        cases += [(J, twin.exp(data.wedge(twin.numbers(n, n - 1, -3, 3)))), (J, forbidden)]
    return cases


@statement
def limits() -> Measured:
    """Compare with the product, and with the derivative of the product along a motion."""
    epsilon = ctx.mpf("1e-3")
    right, wrong = [], []
    for n in (3, 4):
        R, velocity = data.attitude(n, n), twin.hat(SO(n), twin.numbers(n, SO(n).dim, -2, 2))
        definition = R.T * (R + epsilon * R * velocity)
        slope = data.slope(lambda e, R=R, X=velocity: R.T * R * twin.exp(e * X))
        right.append(definition - formulas.small_step(velocity, epsilon))
        right.append(ctx.eye(n) + slope - formulas.small_step(velocity, 1))
        wrong.append(definition - formulas.printed_small_step(velocity))
    return Measured(twin.worst(*right), twin.worst(*wrong), "random positions and velocities, n = 3, 4")


@statement
def lagrangian() -> Measured:
    """Compare with the kinetic energy, and the derivative of the printed one with the momentum."""
    right, wrong = [], []
    for J, W in _tops():
        group, M = SO(W.rows), data.momentum(J, W)
        printed = twin.momentum(group, lambda X, J=J: formulas.printed_lagrangian(X, J), W)
        right.append(formulas.lagrangian(W, J) - twin.trace_lagrangian(J)(W))
        right += [2 * p + m for p, m in zip(printed, M, strict=True)]
        wrong += twin.differences(printed, M)
    return Measured(twin.worst(right), twin.worst(wrong), "n = 3, 4, 5, admissible and other rotations")


@statement
def momentum() -> Measured:
    """Compare with the derivatives of the discrete Lagrangian, with the library, and its slope with the limit."""
    exact, library = [], []
    for J, W in _tops():
        group = SO(W.rows)
        M = twin.vee(group, general.matrix_momentum(W, J))
        P = twin.momentum(group, twin.trace_lagrangian(J), W)
        exact += twin.differences(P, M)
        library += list(nh.discrete_legendre(data.discrete(J), data.array(W)) - data.array(ctx.matrix(M)).ravel())
    return Measured(twin.both(twin.worst(exact, *_limit()), twin.worst(library)), note="n = 3, 4, 5, all rotations")


def _limit() -> list[Matrix]:
    """Return the distance of the slope of the momentum at the identity from the momentum of the continuous top."""
    missed = []
    for n in (3, 4):
        J, velocity = data.random_body(n, n), twin.hat(SO(n), twin.numbers(n + 5, SO(n).dim))
        slope = data.slope(lambda e, J=J, X=velocity: general.matrix_momentum(twin.exp(e * X), J))
        missed.append(slope - formulas.small_momentum(velocity, J))
    return missed
