"""Section 2, discrete systems: principle, multipliers, regularity, consistency.

Evaluated on a particle with the constraint z' = y x' that falls along y.
"""

import itertools
from typing import cast

import numpy as np

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import BALANCED_TOP, SLEIGH, TILTED_TOP, TOP, Body, displacements, velocities
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, ctx
from nonholo_paper.formulas import general

_WEIGHT = ctx.mpf("0.25")


def _action(q: Matrix, q_next: Matrix) -> Number:
    d = q_next - q
    return twin.dot(d, d) / 2 - _WEIGHT * (q[1] + q_next[1]) / 2


def _constraint(q: Matrix, q_next: Matrix) -> Number:
    return q_next[2] - q[2] - (q[1] + q_next[1]) / 2 * (q_next[0] - q[0])


def _form(q: Matrix) -> Matrix:
    return twin.column([-q[1], 0, 1])


def _motion(steps: int) -> tuple[list[Matrix], list[Number]]:
    """Return a solution and its multipliers; with this constraint they are explicit."""
    path, multipliers = [twin.column([0, 0.5, 0]), twin.column([0.25, 0.75, 0.15625])], []
    for _ in range(steps):
        before, q = path[-2:]
        u, fall, w = q - before
        y_next = q[1] + fall - _WEIGHT
        middle = (q[1] + y_next) / 2
        multiplier = (w - middle * u) / (1 + middle * q[1])
        multipliers.append(multiplier)
        path.append(twin.column([q[0] + u + multiplier * q[1], y_next, q[2] + w - multiplier]))
    return path, multipliers


def _units() -> list[Matrix]:
    return [ctx.eye(3)[:, i] for i in range(3)]


def _slopes(q: Matrix, q_next: Matrix) -> tuple[Matrix, Matrix]:
    """Return D1 L_d and D2 L_d by their definition."""
    first = [twin.rate(lambda t, e=e: _action(q + t * e, q_next)) for e in _units()]
    second = [twin.rate(lambda t, e=e: _action(q, q_next + t * e)) for e in _units()]
    return twin.column(first), twin.column(second)


@statement
def principle() -> Measured:
    """Differentiate the action sum of a solution along random admissible variations of its inner points."""
    path, _ = _motion(6)
    defects = [_constraint(q, q_next) for q, q_next in itertools.pairwise(path)]
    for seed in range(4):
        inner = [a * twin.column([1, 0, q[1]]) + b * twin.column([0, 1, 0]) for q, a, b in _weights(path[1:-1], seed)]
        variation = [ctx.zeros(3, 1), *inner, ctx.zeros(3, 1)]

        def total(t: Number, variation: list[Matrix] = variation) -> Number:
            moved = [q + t * d for q, d in zip(path, variation, strict=True)]
            return ctx.fsum(_action(q, q_next) for q, q_next in itertools.pairwise(moved))

        defects.append(twin.rate(total))
    return Measured(twin.worst(defects), note="7 steps of a falling particle, 4 variations; the term k = 0 is zero")


def _weights(points: list[Matrix], seed: int) -> list[tuple[Matrix, Number, Number]]:
    return list(zip(points, twin.numbers(seed, len(points)), twin.numbers(seed + 9, len(points)), strict=True))


@statement
def first_term() -> Measured:
    """Sum the balances of a solution from k = 1; printed: what an admissible variation of the first point adds."""
    (path, _), right = _motion(6), []
    wrong = [abs(twin.dot(_slopes(path[0], path[1])[0], d)) for d in _admissible(path[0])]
    for before, q, after in zip(path, path[1:], path[2:], strict=False):
        left = general.coordinate_balance(_slopes(q, after)[0], _slopes(before, q)[1])
        right += [twin.dot(left, d) for d in _admissible(q)]
    return Measured(twin.worst(right), float(min(wrong)), "6 steps of a falling particle, two variations each")


def _admissible(q: Matrix) -> list[Matrix]:
    """Return a basis of the admissible velocities at a point."""
    return [twin.column([1, 0, q[1]]), twin.column([0, 1, 0])]


@statement
def dimensions() -> Measured:
    """Find them from the ranks of slopes at random points; printed: the dimension of D_d less that of the spaces."""
    right, wrong = [], []
    for seed in range(4):
        q, v, r = (twin.column(twin.numbers(seed + k, 3, -2, 2)) for k in (0, 20, 40))
        moved = [(twin.column([*e[:3]]), twin.column([*e[3:]])) for e in (ctx.eye(6)[:, i] for i in range(6))]
        pairs = [twin.rate(lambda t, d=d, q=q, r=r: _constraint(q + t * d[0], r + t * d[1])) for d in moved]
        whole = [twin.rate(lambda t, d=d, q=q, v=v: twin.dot(_form(q + t * d[0]), v + t * d[1])) for d in moved]
        discrete, continuous = (6 - twin.rank(ctx.matrix([slope])) for slope in (pairs, whole))
        spaces = 3 - twin.rank(_form(q).T)
        right += [discrete - continuous, spaces - 2, continuous - 5]
        wrong.append(discrete - spaces)
    return Measured(twin.worst(right), float(min(wrong)), "a particle with n = 3, s = 1 at 4 random points")


@statement
def constraint_functions() -> Measured:
    """Test the value on the diagonal, the rank, and that the slope there is the form of the constraint."""
    defects = []
    for seed in range(4):
        q = twin.column(twin.numbers(seed, 3, -2, 2))
        for q_next in (q, twin.column(twin.numbers(seed + 9, 3, -9, 9))):
            slope = [twin.rate(lambda t, e=e, q=q, r=q_next: _constraint(q, r + t * e)) for e in _units()]
            defects.append(abs(twin.rank(ctx.matrix([slope])) - 1))
        at_rest = [twin.rate(lambda t, e=e, q=q: _constraint(q, q + t * e)) for e in _units()]
        defects += [_constraint(q, q), *(twin.column(at_rest) - _form(q))]
    return Measured(twin.worst(defects), note="4 random points, near and far")


def _sheared_action(q: Matrix, q_next: Matrix) -> Number:
    """Return a discrete Lagrangian that does not change with shifts along y."""
    d = q_next - q
    return twin.dot(d, d) / 2 + (q[0] + q_next[0]) / 4 * d[0] * d[1]


def _sheared_slope(q: Matrix, q_next: Matrix, direction: Matrix, *, last: bool) -> Number:
    """Return its derivative by one of its points, by the definition."""
    shifts = (0, 1) if last else (1, 0)
    return twin.rate(lambda t: _sheared_action(q + shifts[0] * t * direction, q_next + shifts[1] * t * direction))


def _sheared_step(before: Matrix, q: Matrix) -> Matrix:
    """Return the next point by the principle: two balances and the constraint."""

    def missed(*place: Number) -> list[Number]:
        after, arrived = twin.column(place), [_sheared_slope(before, q, d, last=True) for d in _admissible(q)]
        left = [_sheared_slope(q, after, d, last=False) for d in _admissible(q)]
        return [*(x + y for x, y in zip(left, arrived, strict=True)), _constraint(q, after)]

    return twin.column(ctx.findroot(missed, list(2 * q - before), tol=1e-90, maxsteps=12, verify=False))


@statement
def horizontal_symmetry() -> Measured:
    """Move a particle by the principle: shifts along y are an admissible symmetry, those along x are not."""
    path = [twin.column([0, 0.5, 0]), twin.column([0.25, 0.75, 0.15625])]
    for _ in range(3):
        path.append(_sheared_step(*path[-2:]))
    along = [
        [_sheared_slope(q, after, e, last=True) for q, after in itertools.pairwise(path)]
        for e in (_units()[1], _units()[0])
    ]
    shift, moved = ([p - momenta[0] for p in momenta] for momenta in along)
    return Measured(max(twin.worst(shift), float(twin.worst(moved) < 0.01)), note="a particle with z' = y x', 3 steps")


@statement
def consistency() -> Measured:
    """Evaluate the forms on log W and on the part of W - I in the algebra, for W in exp d."""
    right, wrong = [], []
    for body in (TOP, TILTED_TOP, BALANCED_TOP):
        right += [_forbidden(body, W - ctx.eye(3)) for W in displacements(body)]
    for body in (TOP, SLEIGH):
        small = zip(displacements(body)[:4], velocities(body)[:4], strict=True)
        right += [twin.worst(twin.hat(body.group, w) - ctx.logm(W)) for W, w in small]
    wrong = [_forbidden(SLEIGH, W - ctx.eye(3)) for W in displacements(SLEIGH)[2:]]
    return Measured(twin.worst(right), float(min(wrong)), "3 tops, a sleigh, steps of all sizes")


def _forbidden(body: Body, X: Matrix) -> Number:
    x = twin.column(twin.vee(body.group, X))
    return max(abs(twin.dot(a, x)) for a in body.forms)


@statement
def other_discretizations() -> Measured:
    """Compare two of this library at a step of 1e-60: momenta agree to second order, and differ at the third."""
    defects = []
    for body in (TOP, SLEIGH):
        with ctx.workdps(250):
            h, w = ctx.mpf(10) ** -60, body.velocity(twin.numbers(3, len(body.subspace)))
            gap = body.momentum(body.displacement(h * w)) - _logarithmic_momentum(body, h * w)
            third = twin.worst(gap / h**3)
        defects += [twin.worst(gap / h**2), float(third < 1e-3)]
    return Measured(max(defects), note="matrix and logarithmic difference, top and sleigh")


def _logarithmic_momentum(body: Body, x: Matrix) -> Matrix:
    """Return the derivative of <log W, I log W>/2 to third order in x: p - ad* p / 2 + ad* ad* p / 12, p = I x."""
    p = body.inertia * x
    once = twin.coad(body.group, x, p)
    return p - once / 2 + twin.coad(body.group, x, once) / 12


@statement
def discrete_multipliers() -> Measured:
    """Evaluate both sides on a solution that was found by elimination."""
    path, multipliers = _motion(6)
    defects = []
    for before, q, after, multiplier in zip(path, path[1:], path[2:], multipliers, strict=False):
        left = general.coordinate_balance(_slopes(q, after)[0], _slopes(before, q)[1])
        defects += [left - general.reaction([multiplier], [_form(q)]), [_constraint(q, after)]]
    return Measured(twin.worst(*defects), note="6 steps of a falling particle")


@statement
def indices() -> Measured:
    """Count rows and columns of the multipliers of an orbit; the two printed readings exchange them."""
    steps, forms = 7, len(TOP.forms)
    discrete = nh.discretize(nh.SuslovTop(TOP.mass_tensor), 1.0)
    result = nh.simulate(discrete, restricted_velocity=(0.25, 0.125), steps=steps).multipliers.shape
    wrong = np.abs(np.subtract(result, (forms, steps))).max()
    return Measured(float(np.abs(np.subtract(result, (steps, forms))).max()), float(wrong), "a count")


@statement
def regularity() -> Measured:
    """Compare it with the derivative of the equations; its determinant vanishes where no next point exists."""
    defects = []
    for seed in range(3):
        q, after = (twin.column(twin.numbers(seed + shift, 3, -2, 2)) for shift in (0, 20))
        defects.append(_regularity_matrix(q, after) - _newton_matrix(q, after))
    fold = ctx.det(_regularity_matrix(twin.column([0, 1, 0]), twin.column([1, -3, 0])))
    near = ctx.det(_regularity_matrix(twin.column([0, 1, 0]), twin.column([0, 1, 0])))
    particle = cast(nh.LagrangeDAlembert, nh.examples.particle().system)
    library = particle.regularity([0.0, 1.0, 0.0], [1.0, -3.0, 0.0])
    return Measured(twin.both(twin.worst(*defects, [fold, abs(near) - 2]), library), note="3 random pairs and a fold")


def _regularity_matrix(q: Matrix, after: Matrix) -> Matrix:
    mixed = ctx.zeros(3)
    for j, e in enumerate(_units()):
        mixed[:, j] = twin.rate(lambda t, e=e: _slopes(q, after + t * e)[0])
    slope = twin.column([twin.rate(lambda t, e=e: _constraint(q, after + t * e)) for e in _units()])
    return general.bordered(mixed, [_form(q)], [slope])


def _newton_matrix(q: Matrix, after: Matrix) -> Matrix:
    """Return the derivative of the equations in (q_{k+1}, -lambda)."""

    def equations(unknowns: Matrix) -> Matrix:
        left = _slopes(q, unknowns[:3])[0] + unknowns[3] * _form(q)
        return twin.column([*left, _constraint(q, unknowns[:3])])

    start, matrix = twin.column([*after, 0]), ctx.zeros(4)
    for j in range(4):
        matrix[:, j] = twin.rate(lambda t, j=j: equations(start + t * ctx.eye(4)[:, j]))
    return matrix
