"""Displacements of the Suslov top: traces, the component of the identity, the spurious ones."""

import numpy as np
import pytest

import nonholo as nh
from nonholo.systems import SuslovTop, in_exp_d, trace_constraints


def _displacement(n: int, seed: int = 0) -> np.ndarray:
    top = SuslovTop(np.eye(n))
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
    forbidden = nh.SO(n).exp(0.1 * SuslovTop(np.eye(n)).annihilator[0])
    assert not in_exp_d(forbidden)
    assert np.abs(trace_constraints(np.eye(n), forbidden)).max() > 0.1


def test_half_turn_about_the_forbidden_axis() -> None:
    """The matrix diag(-1, -1, 1) satisfies the traces but is not the exponential of an admissible velocity."""
    W = np.diag([-1.0, -1.0, 1.0])
    assert np.array_equal(trace_constraints(np.eye(3), W), [0.0])
    assert not in_exp_d(W)
    assert in_exp_d(np.diag([1.0, -1.0, -1.0]))


def test_spurious_sheet_in_five_dimensions() -> None:
    """Rotations of SO(5) that are reflections of codimension 3 satisfy the traces without lying in exp(d)."""
    frame = np.linalg.qr(np.random.default_rng(3).normal(size=(5, 3)))[0]
    W = np.diag([1.0, 1, 1, 1, -1]) @ (np.eye(5) - 2 * frame @ frame.T)
    assert np.linalg.det(W) == pytest.approx(1.0)
    assert np.abs(trace_constraints(np.eye(5), W)).max() < 1e-14
    assert not in_exp_d(W)
    W_on_the_variety = np.diag([1.0, 1, 1, 1, -1]) @ (np.eye(5) - 2 * frame[:, :1] @ frame[:, :1].T)
    assert in_exp_d(W_on_the_variety)


def test_matrices_that_are_no_rotations_are_refused() -> None:
    """A scaled displacement is refused by the test, and a vector by an error."""
    assert not in_exp_d(1.001 * _displacement(3))
    with pytest.raises(ValueError, match=r"in_exp_d\(displacement=\.\.\.\)` must be a square matrix. Got shape \(3,\)"):
        in_exp_d(np.ones(3))


@pytest.mark.parametrize("pair", [(np.eye(3), np.eye(4)), (np.ones((3, 4)), np.eye(3)), (1.0, 2.0)])
def test_traces_of_other_than_two_matrices_of_one_size_are_refused(pair: tuple) -> None:
    """Other shapes are refused by the name of the argument."""
    with pytest.raises(ValueError, match=r"trace_constraints\(configuration(_next)?=\.\.\.\)` must end in shape"):
        trace_constraints(*pair)


@pytest.mark.parametrize("stack", [False, True])
def test_constraints_of_complex_matrices_are_refused(stack: bool) -> None:
    """Both configurations are rotations, which are real, as `in_exp_d` demands."""
    R = np.stack([np.eye(3)] * 2) if stack else np.eye(3)
    for name, pair in (("configuration", (R.astype(complex), R)), ("configuration_next", (R, R.astype(complex)))):
        with pytest.raises(ValueError, match=rf"trace_constraints\({name}=...\)` must be real"):
            trace_constraints(*pair)
