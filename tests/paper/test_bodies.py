"""The 50-digit data for statements about any group agree with each other and with the library."""

import numpy as np
import pytest

from nonholo.groups import SE, SO, AbstractMatrixGroup
from nonholo_paper import _sequences as sequences
from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import BODIES, TOP, TOP_4, Body, apart, displacements, in_double, slopes
from nonholo_paper._twin import ctx

ROUNDING = 1e-47  # some hundred operations of 50 digits
IDS = ["top", "tilted top", "balanced top", "sleigh", "balanced sleigh", "top in 4", "any in 4"]


@pytest.mark.parametrize("body", BODIES, ids=IDS)
def test_annihilator_vanishes_on_the_subspace(body: Body) -> None:
    """The two are given apart, and together they span the algebra."""
    assert all(twin.dot(a, e) == 0 for a in body.forms for e in body.directions)
    assert twin.rank(ctx.matrix([list(row) for row in (*body.subspace, *body.annihilator)])) == body.group.dim


@pytest.mark.parametrize("body", BODIES, ids=IDS)
def test_inertia_is_that_of_the_library(body: Body) -> None:
    """The bilinear form of the kinetic energy is the inertia operator; all numbers are exact."""
    assert apart(body.system.inertia_operator, body.inertia) == 0


@pytest.mark.parametrize("body", BODIES, ids=IDS)
def test_momentum_is_a_derivative(body: Body) -> None:
    """The differences with shared exponentials are the derivatives that define the momenta."""
    W = displacements(body)[-1]
    defined = twin.column(twin.momentum(body.group, body.lagrangian, W))
    arriving = twin.column(twin.arriving(body.group, body.lagrangian, W))
    assert twin.worst(body.momentum(W) - defined, body.arriving(W) - arriving) < ROUNDING


def test_slopes_are_those_of_a_known_function() -> None:
    """The trace of A exp(e E) has the derivative tr(A E)."""
    A = ctx.matrix([[1, 2, 3], [4, 5, 6], [7, 8, 10]])
    found = slopes(lambda nudge: twin.trace(A * nudge), SO(3))
    assert twin.worst(found - twin.column([twin.trace(A * E) for E in twin.basis(SO(3))])) < ROUNDING


def test_rate_of_a_matrix() -> None:
    """The derivative of exp(t X) at t = 2 is X exp(2 X)."""
    X = twin.hat(SE(2), [1, -2, 3])
    assert twin.worst(twin.rate(lambda t: twin.exp(t * X), 2) - X * twin.exp(2 * X)) < ROUNDING


def test_derivative_of_the_exponential() -> None:
    """The block of a larger exponential is the derivative along a direction that does not commute."""
    X, Y = (twin.hat(SO(3), twin.numbers(seed, 3, -3, 3)) for seed in (1, 2))
    assert twin.worst(twin.exp_derivative(X, Y) - twin.rate(lambda t: twin.exp(X + t * Y))) < ROUNDING


@pytest.mark.parametrize("group", [SO(3), SE(2), SO(4), SE(3)], ids=str)
def test_coadjoint_bracket(group: AbstractMatrixGroup) -> None:
    """The transposed bracket is that of the library, to a few ulp."""
    x, p = (twin.column(twin.numbers(seed, group.dim)) for seed in (3, 4))
    assert apart(group.coad(in_double(x), in_double(p)), twin.coad(group, list(x), list(p))) < 1e-15


@pytest.mark.parametrize(
    ("rows", "rank"),
    [([[0, 0], [0, 0]], 0), ([[1, 2, 3], [2, 4, 6]], 1), ([[1, 0], [0, 1], [1, 1]], 2), ([[0, 1, 2], [1, 0, 3]], 2)],
)
def test_rank(rows: list[list[int]], rank: int) -> None:
    """The rank of matrices of all shapes."""
    assert twin.rank(ctx.matrix(rows)) == rank


@pytest.mark.parametrize("defects", [[1.0, ctx.nan, 2.0], [ctx.nan], [ctx.matrix([[0, 1], [ctx.nan, 0]])]], ids=str)
def test_undefined_difference_is_the_worst(defects: list) -> None:
    """A difference that is not a number is worse than every number, wherever it stands."""
    assert twin.worst(*defects) == float("inf")


def test_both_puts_two_precisions_under_one_tolerance() -> None:
    """A defect of 1e-12 in the library counts as 1e-45, one at 50 digits as it is."""
    assert twin.both(0.0, 1e-12) == pytest.approx(1e-45)
    assert twin.both(3e-44, 1e-12) == 3e-44


@pytest.mark.parametrize("body", [TOP, TOP_4], ids=["top", "top in 4"])
def test_poses_are_products_of_displacements(body: Body) -> None:
    """There is one pose more than displacements."""
    poses, found = sequences.poses(body), sequences.displacements(body)
    assert len(poses) == len(found) + 1 == sequences.STEPS + 1
    assert twin.worst(*(g**-1 * r - W for g, r, W in zip(poses, poses[1:], found, strict=False))) < ROUNDING


def test_partial_derivatives() -> None:
    """The matrix of partial derivatives of the discrete Lagrangian is its rate along each entry."""
    W, unit = sequences.displacements(TOP)[0], ctx.zeros(3)
    unit[1, 2] = 1
    rate = twin.rate(lambda t: TOP.lagrangian(W + t * unit))
    assert abs(sequences.slope(TOP, W)[1, 2] - rate) < ROUNDING


def test_orbit_keeps_every_digit() -> None:
    """Displacements of the library enter as they are."""
    W = sequences.orbit(TOP).displacement[0]
    assert np.array_equal(in_double(sequences.exactly(W)), W)


@pytest.mark.parametrize("index", range(12))
def test_half_angle_of_a_rotation(index: int) -> None:
    """The trace of the rotation of a point of the sphere has the cosine q0 of half of the angle."""
    q = data.points()[index]
    assert abs(twin.trace(data.rotation(q)) - (4 * q[0] ** 2 - 1)) < ROUNDING


def test_two_ways_to_a_displacement() -> None:
    """Cayley's formula with half-angle tangents gives the same rotation as the exponential."""
    y = [ctx.mpf("0.7"), ctx.mpf("-1.9")]
    assert twin.worst(data.cayley(y) - data.rotation(data.point_of(y))) < ROUNDING


def test_momentum_of_the_twin_is_a_derivative() -> None:
    """The products of matrices are the derivatives of the discrete Lagrangian that define the momentum."""
    J, W = data.body("generic"), data.attitude(1, 3)
    defined = twin.momentum(SO(3), twin.trace_lagrangian(J), W)
    assert twin.worst(a - b for a, b in zip(data.momentum(J, W), defined, strict=True)) < ROUNDING


@pytest.mark.parametrize(("name", "y"), data.STEPS)
def test_successors_solve_the_equations(name: str, y: tuple[float, float]) -> None:
    """Every value of the map has the momenta along the constraint that arrive."""
    J = data.body(name)
    target = data.turned(J, data.cayley(y))[:2]
    found = [data.momentum(J, data.cayley(after))[:2] for after in data.successors(name, y)]
    assert len(found) == 4
    assert twin.worst(a - b for M in found for a, b in zip(M, target, strict=True)) < ROUNDING


def test_slope_of_a_curve() -> None:
    """The derivative of a curve of rotations at the identity is its generator, to far more than 50 digits."""
    X = twin.hat(SO(3), [1, -2, 3])
    assert twin.worst(data.slope(lambda e: twin.exp(e * X)) - X) < ROUNDING
