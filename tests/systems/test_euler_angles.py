"""The discrete Lagrangian in Euler angles against the trace that defines it."""

import numpy as np
import pytest

import nonholo as nh
from nonholo.systems import euler_angle_discrete_lagrangian, mass_tensor_from_inertia


def _rotation(angles: np.ndarray) -> np.ndarray:
    phi, theta, psi = angles
    exp = nh.SO(3).exp
    return exp(np.array([0, 0, phi])) @ exp(np.array([theta, 0, 0])) @ exp(np.array([0, 0, psi]))


def test_against_the_trace() -> None:
    """L_d = tr J - tr(R^T R' J) at random angles and moments, one triple at a time and as a stack."""
    rng = np.random.default_rng(0)
    moments, first, second = rng.uniform(1.0, 2.0, size=(50, 3)), rng.normal(size=(50, 3)), rng.normal(size=(50, 3)) * 2
    stacked = euler_angle_discrete_lagrangian(moments, first, second)
    for A, x, y, value in zip(moments, first, second, stacked, strict=True):
        J = mass_tensor_from_inertia(np.diag(A))
        expected = np.trace(J) - np.trace(_rotation(x).T @ _rotation(y) @ J)
        assert value == pytest.approx(expected, abs=1e-13)
        assert euler_angle_discrete_lagrangian(A, x, y) == pytest.approx(expected, abs=1e-13)


def test_it_is_the_discrete_lagrangian_of_the_library() -> None:
    """Divided by the time step it is l_d(W) of the matrix difference, whose half-step momentum the library uses."""
    top, h = nh.SuslovTop(mass_tensor_from_inertia(np.diag([3.0, 2.5, 2.0]))), 0.2
    x, turn, step = np.array([0.3, 0.8, -0.4]), np.array([0.2, -0.1, 0.3]), 1e-6
    W = nh.SO(3).exp(turn)
    R = _rotation(x)

    def value(displacement: np.ndarray) -> float:
        moved = R @ displacement
        angles = np.array(
            [np.arctan2(moved[0, 2], -moved[1, 2]), np.arccos(moved[2, 2]), np.arctan2(moved[2, 0], moved[2, 1])]
        )
        return euler_angle_discrete_lagrangian((3.0, 2.5, 2.0), x, angles) / h

    momentum = [
        (value(nh.SO(3).exp(step * e) @ W) - value(nh.SO(3).exp(-step * e) @ W)) / (2 * step) for e in np.eye(3)
    ]
    assert np.allclose(nh.discrete_legendre(nh.discretize(top, h), W), momentum, atol=1e-7)  # rounding eps/step


def test_other_than_triples_are_refused() -> None:
    """Angles and moments come as triples."""
    with pytest.raises(ValueError, match=r"angles_next=\.\.\.\)` must end in shape \(3,\)"):
        euler_angle_discrete_lagrangian((1, 1, 1), (0, 0, 0), (0, 0))
