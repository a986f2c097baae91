"""The 50-digit data for statements about any group agree with each other and with the library."""

import pytest

from nonholo.groups import SE, SO, AbstractMatrixGroup
from nonholo_paper import _sequences as sequences
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import BODIES, TOP, TOP_4, Body, apart, in_double
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


def test_derivative_of_the_exponential() -> None:
    """The block of a larger exponential is the derivative along a direction that does not commute."""
    X, Y = (twin.hat(SO(3), twin.numbers(seed, 3, -3, 3)) for seed in (1, 2))
    assert twin.worst(twin.exp_derivative(X, Y) - twin.rate(lambda t: twin.exp(X + t * Y))) < ROUNDING


@pytest.mark.parametrize("group", [SO(3), SE(2), SO(4), SE(3)], ids=str)
def test_coadjoint_bracket(group: AbstractMatrixGroup) -> None:
    """The transposed bracket is that of the library, to a few ulp."""
    x, p = (twin.column(twin.numbers(seed, group.dim)) for seed in (3, 4))
    assert apart(group.coad(in_double(x), in_double(p)), twin.coad(group, list(x), list(p))) < 1e-15


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
    poses, result = sequences.poses(body), sequences.displacements(body)
    assert len(poses) == len(result) + 1 == sequences.STEPS + 1
    assert twin.worst(*(g**-1 * r - W for g, r, W in zip(poses, poses[1:], result, strict=False))) < ROUNDING
