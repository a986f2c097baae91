"""Section 6: the momentum locus of the top of three dimensions."""

import numpy as np

import nonholo as nh
from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Vector, ctx
from nonholo_paper.formulas import suslov_momenta as formulas

NOTE = "8 bodies, balanced, tilted, with J1 = J2 among them; 12 displacements, half-turns among them"
FLAT = [1.25, 1.25, 0.5]
PRIME = 2**61 - 1


def _masses() -> list[Vector]:
    return [[ctx.mpf(x) for x in masses] for masses in data.MASSES]


@statement
def diagonal_momentum() -> Measured:
    """Compare with the product of matrices."""
    missed = []
    for masses in [*_masses(), FLAT]:
        for q, W in data.turns():
            X = W * ctx.diag(masses) - ctx.diag(masses) * W.T
            vector = [-X[1, 2], X[0, 2], -X[0, 1]]
            missed += twin.differences(vector, formulas.diagonal_momentum(masses, q))
    return Measured(twin.worst(missed), note="4 diagonal bodies, 12 displacements")


@statement
def superfluous_transposition() -> Measured:
    """Count the transpositions printed that change nothing, if the diagonal matrix is its own transpose."""
    same = [ctx.diag(masses) - ctx.diag(masses).T for masses in _masses()]
    return Measured(twin.worst(*same), float(twin.worst(*same) == 0), "printed: transpositions that are not needed")


@statement
def steiner() -> Measured:
    """Evaluate the quartic at momenta of matrices, the library's too; printed: dimensions that a flat locus lacks."""
    exact, library, disc = [], [], []
    for masses in _masses():
        J = ctx.diag(masses)
        momenta = [data.momentum(J, W) for _, W in data.turns()]
        exact += [formulas.steiner(masses, M) for M in momenta]
        if min(masses) > 0:
            library += list(nh.momentum_locus(data.discrete(J), 4).implicit(data.array(ctx.matrix(momenta))))
    for q, W in data.turns():
        M = data.momentum(ctx.diag(FLAT), W)
        disc += [M[2], formulas.elliptic_disc(FLAT, M) - 4 * q[0] ** 2 * (1 - q[0] ** 2)]
    flat = [data.momentum(ctx.diag(FLAT), W) for _, W in data.turns()[:6]]
    missing = 3 - sum(twin.worst([M[i] for M in flat]) > 1e-3 for i in range(3))
    return Measured(twin.both(twin.worst(exact, disc), twin.worst(library)), missing, "3 bodies; one with J1 = J2")


@statement
def full() -> Measured:
    """Compare with the product of matrices and with the library's Legendre transformation."""
    exact, library = [], []
    for J, q, W in data.samples():
        M = formulas.momentum(J, q)
        exact += twin.differences(data.momentum(J, W), M)
        library += list(nh.discrete_legendre(data.discrete(J), data.array(W)) - [float(x) for x in M])
    return Measured(twin.both(twin.worst(exact), twin.worst(library)), note=NOTE)


@statement
def degree() -> Measured:
    """Count relations between monomials at 45 random points of the sphere: ranks of integers modulo a prime."""
    J = [[3, 1, 2], [1, 5, -1], [2, -1, 4]]
    entries = {(i, j): J[i][j] for i in range(3) for j in range(3)}
    rows = []
    for seed in range(45):
        q = [int(1e6 * x) for x in twin.numbers(seed, 3)]
        inverse = pow(sum(x * x for x in q), -1, PRIME)
        rows.append([int(value) * inverse % PRIME for value in formulas.momentum(entries, q)])
    relations = [_monomials(degree) - _rank([_powers(row, degree) for row in rows]) for degree in (1, 2, 3, 4)]
    return Measured(float(max(*relations[:3], abs(relations[3] - 1))), note="one body with integer entries")


def _monomials(degree: int) -> int:
    return len(_powers([1, 1, 1], degree))


def _powers(values: list[int], degree: int) -> list[int]:
    """Return all monomials up to a degree modulo the prime."""
    x, y, z = values
    total = range(degree + 1)
    powers = [(i, j, k) for i in total for j in total for k in total if i + j + k <= degree]
    return [pow(x, i, PRIME) * pow(y, j, PRIME) * pow(z, k, PRIME) % PRIME for i, j, k in powers]


def _rank(rows: list[list[int]]) -> int:
    """Return the rank modulo the prime."""
    rank = 0
    for column in range(len(rows[0])):
        pivot = next((i for i in range(rank, len(rows)) if rows[i][column]), None)
        if pivot is None:
            continue
        rows[rank], rows[pivot] = rows[pivot], rows[rank]
        inverse = pow(rows[rank][column], -1, PRIME)
        for i in range(rank + 1, len(rows)):
            factor = rows[i][column] * inverse % PRIME
            rows[i] = [(a - factor * b) % PRIME for a, b in zip(rows[i], rows[rank], strict=True)]
        rank += 1
    return rank


@statement
def singularities() -> Measured:
    """Exchange two coordinates where the third is zero: the same momentum; where they are equal the rank is one."""
    exact, library = [], []
    for masses in _masses()[:2]:
        J, root = ctx.diag(masses), ctx.sqrt(ctx.mpf(1) / 2)
        inertia = twin.trace(J) * ctx.eye(3) - J
        for i, j in ((0, 1), (0, 2), (1, 2)):
            first, second, pinch, across = ([ctx.mpf(0)] * 3 for _ in range(4))
            first[i], first[j], second[i], second[j] = ctx.mpf("0.6"), ctx.mpf("0.8"), ctx.mpf("0.8"), ctx.mpf("0.6")
            pinch[i], pinch[j], across[i], across[j] = root, root, root, -root
            exact += twin.differences(formulas.momentum(J, first), formulas.momentum(J, second))
            turned = data.slope(lambda e, p=pinch, d=across, J=J: ctx.matrix(_along(J, p, d, e)))
            exact += list(turned)
            library.append(_distances(J, formulas.momentum(J, pinch)).min())
        exact.append(formulas.momentum(J, [root, root, 0])[0] - inertia[0, 0])
    return Measured(
        twin.both(twin.worst(exact), twin.worst(library)), note="two diagonal bodies, all three double lines"
    )


def _along(J: twin.Matrix, point: Vector, direction: Vector, e: twin.Number) -> Vector:
    return formulas.momentum(J, [ctx.cos(e) * p + ctx.sin(e) * d for p, d in zip(point, direction, strict=True)])


def _distances(J: twin.Matrix, M: Vector) -> np.ndarray:
    """Return the largest differences of a momentum from the pinch points that the library finds."""
    result = nh.momentum_locus(data.discrete(J), 4).pinch_points
    return abs(result - data.array(ctx.matrix(M)).ravel()).max(axis=1)


@statement
def four_images() -> Measured:
    """Refine the library's values to 50 digits: four different real ones; two are the rational ones given."""
    name, y = data.STEPS[2]
    J, result = data.body(name), data.successors(name, y)
    target = data.momentum(J, data.cayley(y))
    rational = [[ctx.mpf(-1) / 4, ctx.mpf(-3) / 8], [ctx.mpf(-16) / 13, ctx.mpf(-24) / 13]]
    momenta = [formulas.momentum(J, data.point_of(v)) for v in result + rational]
    missed = [x for M in momenta for x in twin.differences(M[:2], target[:2])]
    B = (twin.trace(J) * ctx.eye(3) - J)[:2, :2]
    different = all(twin.worst([a[i] - b[i] for i in (0, 1)]) > 0.1 for k, a in enumerate(result) for b in result[:k])
    real = sum(ctx.im(v[0]) == 0 and ctx.im(v[1]) == 0 for v in result)
    lacking = data.lacking(different, real == 4, B[0, 0] > 0, ctx.det(B) > 0)
    return Measured(max(twin.worst(missed), lacking), real - 2, "printed: real images above two")


@statement
def legendre() -> Measured:
    """Take four rotations with momentum zero, and compare the last momenta of the values over a pair."""
    J = ctx.diag(data.MASSES[0])
    diagonal = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
    free = [x for signs in diagonal for x in data.momentum(J, ctx.diag(signs))]
    apart = []
    for name, y in data.STEPS[1:]:
        last = [formulas.momentum(data.body(name), data.point_of(v))[2] for v in data.successors(name, y)]
        apart += [abs(a - b) > 1e-3 for k, a in enumerate(last) for b in last[:k]]
    return Measured(max(twin.worst(free), data.lacking(*apart)), note="4 free rotations; 4 values over 2 pairs")
