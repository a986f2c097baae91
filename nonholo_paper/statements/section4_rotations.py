"""Section 4, the Suslov problem on SO(n): Lagrangian, constraint, equations, count of multipliers."""

import numpy as np

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import in_double
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, ctx
from nonholo_paper.formulas import general
from nonholo_paper.formulas import suslov_continuous as suslov

_DIMENSIONS = (3, 4, 5)


def _points(n: int) -> list[tuple[Number, Matrix]]:
    """Return masses and places of the points of a body, short binary fractions."""
    places = [[round(8 * float(x)) / 8 for x in twin.numbers(10 * n + i, n, -2, 2)] for i in range(n + 2)]
    return [(ctx.mpf(1 + i) / 4, twin.column(place)) for i, place in enumerate(places)]


def _mass_tensor(n: int) -> Matrix:
    return sum((m * r * r.T for m, r in _points(n)), ctx.zeros(n))


def _velocities(n: int) -> list[list[Number]]:
    return [twin.numbers(seed, n - 1, -size, size) for seed, size in ((1, 1), (2, 8), (3, 2**-20))] + [[0] * (n - 1)]


def _skew(n: int, seed: int) -> Matrix:
    return twin.hat(nh.SO(n), twin.numbers(seed, nh.SO(n).dim, -2, 2))


@statement
def lagrangian() -> Measured:
    """Compare with the kinetic energy of mass points, and the inertia operator with the library."""
    defects = []
    for n in _DIMENSIONS:
        J, group = _mass_tensor(n), nh.SO(n)
        library = nh.SuslovTop(in_double(J)).inertia_operator
        for seed in (5, 6):
            w = _skew(n, seed)
            kinetic = ctx.fsum(m * twin.dot(w * r, w * r) for m, r in _points(n)) / 2
            momentum = suslov.inertia(J, w)
            result = library @ np.array(twin.vee(group, w), dtype=float)
            apart = abs(result - np.array(twin.vee(group, momentum), dtype=float)).max()
            defects.append(twin.both(abs(suslov.pairing(momentum, w) / 2 - kinetic), apart / 8))
    return Measured(max(defects), note="6 to 7 mass points, n = 3, 4, 5")


@statement
def admissible_velocities() -> Measured:
    """Compare with combinations of planes and the library's subspace; for n = 3 the third component vanishes."""
    defects = []
    for n in _DIMENSIONS:
        group, rows = nh.SO(n), nh.SuslovTop(in_double(_mass_tensor(n))).constraint_subspace
        for x in _velocities(n):
            w = suslov.admissible(x)
            planes = sum((c * suslov.plane(n, i, n - 1) for i, c in enumerate(x)), ctx.zeros(n))
            library = abs(group.hat(np.array(x, dtype=float) @ rows) - in_double(w)).max()
            last = twin.vee(group, w)[2] if n == 3 else 0
            defects.append(twin.both(twin.worst(w - planes, w + w.T, [last, len(rows) - (n - 1)]), library))
    return Measured(max(defects), note="n = 3, 4, 5")


@statement
def constraints() -> Measured:
    """Compare both forms on any velocity, test them on admissible ones, and count them in the library."""
    defects = []
    for n in _DIMENSIONS:
        top = nh.SuslovTop(in_double(_mass_tensor(n)))
        pairs = [(i, j) for i in range(n - 1) for j in range(i + 1, n - 1)]
        any_velocity, allowed = _skew(n, 7), suslov.admissible(twin.numbers(8, n - 1))
        defects += [suslov.pairing(any_velocity, suslov.plane(n, i, j)) - any_velocity[i, j] for i, j in pairs]
        defects += [suslov.pairing(allowed, suslov.plane(n, i, j)) for i, j in pairs]
        forbidden = abs(top.annihilator @ np.array(twin.vee(top.group, allowed), dtype=float)).max()
        defects.append(twin.both(abs(len(top.annihilator) - len(pairs)), forbidden))
    return Measured(twin.worst(defects), note="n = 3, 4, 5")


def _momentum(J: Matrix, w: Matrix) -> list[Number]:
    """Return the derivative of the kinetic energy tr(w J w^T)/2."""
    return [twin.inner(E * J, w) for E in twin.basis(nh.SO(J.rows))]


def _momentum_rate(J: Matrix, x: list[Number]) -> Matrix:
    """Return the rate of the momentum by its definition: its part along the allowed planes is that of ad* p."""
    n, w = J.rows, suslov.admissible(x)
    group, planes = nh.SO(n), [suslov.plane(n, i, n - 1) for i in range(n - 1)]
    free = twin.coad(group, twin.vee(group, w), _momentum(J, w))
    along = twin.column([twin.dot(free, twin.column(twin.vee(group, e))) for e in planes])
    inertia = ctx.matrix([[twin.inner(e * J, f) for f in planes] for e in planes])
    return twin.hat(group, _momentum(J, suslov.admissible(list(ctx.lu_solve(inertia, along)))))


@statement
def equations() -> Measured:
    """Take the force of constraint from the definition: it lies in all planes of the sum, not in the printed ones."""
    right, forces, others = [], [], []
    for n in _DIMENSIONS:
        J = _mass_tensor(n)
        for x in _velocities(n):
            w = suslov.admissible(x)
            force = _momentum_rate(J, x) - suslov.torque(suslov.inertia(J, w), w)
            right += [*force[n - 1, :], _library_defect(J, x)]
            forces.append(twin.worst(force[0, :]))
        g = twin.exp(_skew(n, 9))
        constant, moving = general.body_velocity(g, g), general.body_velocity(g, g * _skew(n, 6))
        right += [*(moving + moving.T), suslov.multiplier_count(n) - len(nh.SuslovTop(in_double(J)).annihilator)]
        others += [twin.worst(constant + constant.T), suslov.multiplier_count(n) - suslov.printed_multiplier_count(n)]
    slips = max(forces) + sum(others)
    return Measured(twin.worst(right), float(slips), "n = 3, 4, 5, 4 velocities each; printed: sum of the three slips")


def _library_defect(J: Matrix, x: list[Number]) -> float:
    """Return the scaled difference of the library's rate of the momenta along the allowed planes."""
    top = nh.SuslovTop(in_double(J))
    velocity = np.array(x, dtype=float)
    state = np.concatenate([top.constrained_inertia @ velocity, top.group.identity.ravel()])
    # the rows are e_i ^ e_n for n = 3 too: momenta along them are the entries of the last column
    result = nh.vector_field(top)(0.0, state)[: len(x)]
    exact = in_double(_momentum_rate(J, x))[:-1, -1]
    return twin.both(0.0, float(abs(result - exact).max()) / (8 + 8 * float(velocity @ velocity)))
