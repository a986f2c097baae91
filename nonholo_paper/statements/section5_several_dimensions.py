"""Section 5: the multidimensional sleigh, its momenta and its constraint."""

from typing import NamedTuple

import numpy as np

import nonholo as nh
from nonholo.groups import SE
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._sleigh_twin import Point, homogeneous, kinetic, paired, rates, solid
from nonholo_paper._twin import Matrix, Number, ctx, worst
from nonholo_paper.formulas import sleigh_continuous as formulas


class Solid(NamedTuple):
    """A body in n dimensions: mass, center, mass tensor about it as a diagonal turned by an orthogonal matrix."""

    m: Number
    a: list
    moments: list
    turn: Matrix

    @property
    def points(self) -> list[Point]:
        """Return its mass points."""
        return solid(self.m, self.a, self.moments, self.turn)

    @property
    def tensor(self) -> Matrix:
        """Return its mass tensor about the center of mass."""
        return self.turn * ctx.diag(self.moments) * self.turn.T


def _skew(n: int, seed: int) -> Matrix:
    drawn = ctx.matrix(n, n)
    for k, value in enumerate(twin.numbers(seed, n * n, -2, 2)):
        drawn[k // n, k % n] = value
    return drawn - drawn.T


def _solid(n: int, turned: bool) -> Solid:
    drawn = twin.numbers(600 + n, 2 * n, 0.3, 1.7)
    turn = twin.exp(_skew(n, 610 + n)) if turned else ctx.eye(n)
    return Solid(ctx.mpf("1.4"), [drawn[0], *(-x for x in drawn[1:n])], drawn[n:], turn)


SOLIDS = [_solid(n, turned) for n in (2, 3, 4) for turned in (False, True)]
DIAGONAL = SOLIDS[::2]


def _velocity(n: int, seed: int) -> tuple[Matrix, Matrix, Matrix]:
    """Return a random angular velocity, a linear one and the matrix of both."""
    omega, v = _skew(n, seed), ctx.matrix(twin.numbers(seed + 1, n, -2, 2))
    xi = ctx.zeros(n + 1)
    xi[:n, :n], xi[:n, n] = omega, v
    return omega, v, xi


def _plane(n: int, i: int, j: int) -> Matrix:
    E = ctx.zeros(n + 1)
    E[i, j], E[j, i] = 1, -1
    return E


def _along(n: int, i: int) -> Matrix:
    E = ctx.zeros(n + 1)
    E[i, n] = 1
    return E


@statement
def se_n_bracket() -> Measured:
    """Compare with the commutator of the matrices."""
    gaps = []
    for n in (2, 3, 5):
        (xi1, v1, X), (xi2, v2, Y) = _velocity(n, 620), _velocity(n, 625)
        turning, moving = formulas.bracket(xi1, v1, xi2, v2)
        commutator = X * Y - Y * X
        gaps += [*(commutator[:n, :n] - turning), *(commutator[:n, n] - moving), *commutator[n, :]]
    return Measured(worst(gaps), note="n = 2, 3, 5")


@statement
def one_letter_for_two() -> Measured:
    """Count coordinates: of se(n) less those of omega and v; printed: of se(n) less those of so(n), one letter."""
    wrong = [SE(n).dim - nh.SO(n).dim for n in (3, 4)]
    return Measured(max(SE(n).dim - nh.SO(n).dim - n for n in (3, 4)), float(min(wrong)), "n = 3, 4")


@statement
def cont_sl_lagr() -> Measured:
    """Compare with the kinetic energy of mass points."""
    right, wrong, wrong_trace = [], [], []
    for k, body in enumerate(DIAGONAL):
        n, center = len(body.a), ctx.matrix(body.a)
        omega, v, xi = _velocity(n, 630 + k)
        energy = kinetic(body.points)(xi)
        tensor = formulas.homogeneous_mass_tensor(body.m, center, body.moments)
        right += [*(tensor - homogeneous(body.points)), formulas.trace_energy(xi, tensor) - energy]
        right.append(formulas.block_energy(body.m, center, body.tensor, omega, v) - energy)
        wrong_trace.append(formulas.printed_trace_energy(xi, tensor) - energy)
        wrong.append(formulas.printed_block_energy(body.m, center, body.tensor, omega, v) - energy)
    return Measured(worst(right), worst(wrong) + worst(wrong_trace), "n = 2, 3, 4; both forms")


@statement
def cont_mom_se_n() -> Measured:
    """Compare with the derivatives of the kinetic energy of mass points, for diagonal and full mass tensors."""
    gaps = []
    for k, body in enumerate(SOLIDS):
        n, center = len(body.a), ctx.matrix(body.a)
        omega, v, xi = _velocity(n, 640 + k)
        M = formulas.angular_momentum(body.m, center, body.tensor, omega, v)
        p = formulas.linear_momentum(body.m, center, omega, v)
        gaps += [paired(body.points, xi, _plane(n, i, j)) - M[i, j] for i in range(n) for j in range(i + 1, n)]
        gaps += [*(M + M.T), *(paired(body.points, xi, _along(n, i)) - p[i] for i in range(n))]
    return Measured(worst(gaps), note="6 bodies, n = 2, 3, 4")


def _spin(body: list[Point], xi: Matrix, about: list) -> Matrix:
    """Return the angular momentum of mass points about a body point."""
    n = len(about)
    total = ctx.zeros(n)
    for m, r in body:
        speed, arm = (xi * r)[:n, 0], r[:n, 0] - ctx.matrix(about)
        total += m * (speed * arm.T - arm * speed.T)
    return total


@statement
def meaning_of_M() -> Measured:
    """Sum the moments of mass points about both."""
    right, wrong = [], []
    for k, body in enumerate(SOLIDS):
        n = len(body.a)
        omega, v, xi = _velocity(n, 650 + k)
        M = formulas.angular_momentum(body.m, ctx.matrix(body.a), body.tensor, omega, v)
        right.append(worst(_spin(body.points, xi, [0] * n) - M))
        wrong.append(worst(_spin(body.points, xi, body.a) - M))
    return Measured(max(right), min(wrong), "6 bodies, n = 2, 3, 4")


def _sleigh(body: Solid) -> nh.MultidimensionalSleigh:
    tensor = np.array(body.tensor.tolist(), dtype=float)
    return nh.MultidimensionalSleigh(float(body.m), [float(x) for x in body.a], (tensor + tensor.T) / 2)


@statement
def d_for_se_n() -> Measured:
    """Test the matrix on vectors of the body frame and the origin, and compare the library's basis of the subspace."""
    gaps, library = [], []
    for body in SOLIDS[2:]:
        n = len(body.a)
        row = twin.numbers(660 + n, n, -2, 2)
        X = formulas.admissible_velocity(row[:-1], row[-1])
        gaps += [X[i, j] for i in range(1, n + 1) for j in range(1, n + 1)]
        gaps += [*(X[:n, :n] + X[:n, :n].T), *(X[0, j] - row[j - 1] for j in range(1, n + 1))]
        rows = _sleigh(body).constraint_subspace
        library += [*(np.array([*map(float, row)]) @ rows - [*map(float, twin.vee(SE(n), X))]), len(rows) - n]
    return Measured(twin.both(worst(gaps), worst(library)), note="n = 3, 4")


@statement
def full_mass_tensor() -> Measured:
    """Compare the equations of bodies with full mass tensors with the formula, and with the formula without c."""
    right, wrong = [], []
    for body in SOLIDS[3::2]:
        n = len(body.a)
        row = twin.numbers(670 + n, n, -2, 2)
        X, rows = formulas.admissible_velocity(row[:-1], row[-1]), _sleigh(body).constraint_subspace.tolist()
        rate = rates(SE(n), body.points, rows, X)
        rate = [rate[j] - body.a[j + 1] * rate[-1] for j in range(n - 1)] + [rate[-1]]
        foot = row[-1] + ctx.fdot(row[:-1], body.a[1:])
        for c, gaps in (([body.tensor[0, j] for j in range(1, n)], right), ([0] * (n - 1), wrong)):
            result = formulas.rates_in_space(body.m, body.a[0], c, row[:-1], foot)
            gaps.append(worst([x - y for x, y in zip(rate, result, strict=True)]))
    return Measured(max(right), min(wrong), "n = 3, 4")


@statement
def se2_constr() -> Measured:
    """Compare with the general form at n = 2, and with the velocities that the library admits."""
    gaps, library = [], []
    for omega, v1 in ((ctx.mpf("0.3"), ctx.mpf("-1.2")), (ctx.mpf(2), ctx.zero)):
        X = formulas.admissible_velocity_in_plane(omega, v1)
        gaps += [*(X - formulas.admissible_velocity([-omega], v1))]
        coordinates = twin.vee(SE(2), X)
        gaps += [coordinates[0] - omega, coordinates[1] - v1, coordinates[2]]
        library += [*(nh.ChaplyginSleigh(1.0, 1.0, 0.3).annihilator @ np.array([*map(float, coordinates)]))]
    return Measured(twin.both(worst(gaps), worst(library)), note="2 velocities")
