"""Displacements of the Suslov top: traces, the component of the identity, the spurious ones."""

import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.systems import euler_angle_discrete_lagrangian, in_exp_d, mass_tensor_from_inertia, trace_constraints


def _displacement(n: int, seed: int = 0) -> np.ndarray:
    top = nh.SuslovTop(np.eye(n))
    return top.group.exp(np.random.default_rng(seed).normal(size=n - 1) @ top.constraint_subspace)


@pytest.mark.parametrize("n", [3, 4, 5])
def test_traces_by_their_definition(n: int) -> None:
    """Component (i, j) is tr(R' (e_i e_j^T - e_j e_i^T) R^T), in lexicographic order."""
    rng = np.random.default_rng(n)
    R, R_next = (nh.SO(n).random(rng) for _ in range(2))
    unit = np.eye(n)
    expected = [
        np.trace(R_next @ (np.outer(unit[i], unit[j]) - np.outer(unit[j], unit[i])) @ R.T)
        for i in range(n - 1)
        for j in range(i + 1, n - 1)
    ]
    assert np.allclose(trace_constraints(R, R_next), expected, atol=1e-14)
    assert np.allclose(trace_constraints(np.stack([R, R]), np.stack([R_next, R]))[1], 0, atol=1e-14)


@pytest.mark.parametrize("n", [3, 4, 5])
def test_displacements_of_the_top_belong(n: int) -> None:
    """All of exp(d) passes both tests, up to half-turns; a rotation in a forbidden plane passes neither."""
    W = np.stack([_displacement(n, seed) for seed in range(20)])
    R = nh.SO(n).random(np.random.default_rng(0))
    assert in_exp_d(W).all()
    assert np.abs(trace_constraints(R, R @ W)).max() < 1e-14
    forbidden = nh.SO(n).exp(0.1 * nh.SuslovTop(np.eye(n)).annihilator[0])
    assert not in_exp_d(forbidden)
    assert np.abs(trace_constraints(np.eye(n), forbidden)).max() > 0.1


def test_half_turn_about_the_forbidden_axis() -> None:
    """The matrix diag(-1, -1, 1) satisfies the traces but is no exponential of a velocity; scaled ones fail too."""
    W = np.diag([-1.0, -1.0, 1.0])
    assert np.array_equal(trace_constraints(np.eye(3), W), [0.0])
    assert not in_exp_d(W)
    assert in_exp_d(np.diag([1.0, -1.0, -1.0]))
    assert not in_exp_d(1.001 * _displacement(3))


def test_spurious_sheet_in_five_dimensions() -> None:
    """Rotations of SO(5) that are reflections of codimension 3 satisfy the traces without lying in exp(d)."""
    frame = np.linalg.qr(np.random.default_rng(3).normal(size=(5, 3)))[0]
    W = np.diag([1.0, 1, 1, 1, -1]) @ (np.eye(5) - 2 * frame @ frame.T)
    assert np.linalg.det(W) == pytest.approx(1.0)
    assert np.abs(trace_constraints(np.eye(5), W)).max() < 1e-14
    assert not in_exp_d(W)
    W_on_the_variety = np.diag([1.0, 1, 1, 1, -1]) @ (np.eye(5) - 2 * frame[:, :1] @ frame[:, :1].T)
    assert in_exp_d(W_on_the_variety)


_STACK, _EYE, _SHAPE = np.stack([np.eye(3)] * 2), np.eye(3), r"configuration(_next)?=\.\.\.\)` must end in shape"
# Displacements and configurations are real matrices of one size, angles and moments triples.
test_other_shapes_are_refused = refusals(
    (lambda: in_exp_d(np.ones(3)), r"in_exp_d\(displacement=\.\.\.\)` must end in shape \(3, 3\). Got shape \(3,\)"),
    (lambda: in_exp_d(np.full((3, 3), np.nan)), r"in_exp_d\(displacement=\.\.\.\)` must be finite"),
    (lambda: trace_constraints(_EYE, np.eye(4)), _SHAPE),
    (lambda: trace_constraints(np.ones((3, 4)), _EYE), _SHAPE),
    (lambda: trace_constraints(1.0, 2.0), _SHAPE),
    (lambda: trace_constraints(_EYE + 0j, _EYE), r"trace_constraints\(configuration=...\)` must be real"),
    (lambda: trace_constraints(_STACK, _STACK + 0j), r"trace_constraints\(configuration_next=...\)` must be real"),
    (
        lambda: euler_angle_discrete_lagrangian((1, 1, 1), (0, 0, 0), (0, 0)),
        r"s_next=\.\.\.\)` must end in shape \(3,\)",
    ),
)


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
