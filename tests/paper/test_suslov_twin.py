"""The 50-digit data of the discrete Suslov top agree with each other."""

import pytest

from nonholo.groups import SO
from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._twin import ctx

ROUNDING = 1e-47  # some hundred operations of 50 digits


@pytest.mark.parametrize("index", range(12))
def test_half_angle_of_a_rotation(index: int) -> None:
    """The trace of the rotation of a point of the sphere has the cosine q0 of half of the angle."""
    q = data.points()[index]
    assert abs(twin.trace(data.rotation(q)) - (4 * q[0] ** 2 - 1)) < ROUNDING


def test_two_ways_to_a_displacement() -> None:
    """Cayley's formula with half-angle tangents gives the same rotation as the exponential."""
    y = [ctx.mpf("0.7"), ctx.mpf("-1.9")]
    assert twin.worst(data.cayley(y) - data.rotation(data.point_of(y))) < ROUNDING


def test_momentum_is_a_derivative() -> None:
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
