"""Functions of matrices against SciPy, series and mpmath."""

import mpmath
import numpy as np
import pytest
import scipy.linalg

from nonholo.base.numerics._functions import (
    block_diagonal,
    cotangent_deficit,
    exponential_increment,
    integrated_exponential,
    of_skew,
    principal_logarithm,
)


@pytest.mark.parametrize("angle", [0.0, 1e-6, 0.1, 0.999999, 1.000001, 2.0, np.pi, 6.0])
def test_cotangent_deficit(angle: float) -> None:
    """(1 - (t/2) cot(t/2)) / t^2 in double precision against forty digits."""
    with mpmath.workdps(40):
        t = mpmath.mpf(angle)
        exact = float((1 - t / 2 * mpmath.cot(t / 2)) / t**2) if angle else 1 / 12
    assert abs(float(cotangent_deficit(np.float64(angle**2))) / exact - 1) < 4e-15


@pytest.mark.parametrize("size", [1e-8, 0.4, 0.6, 3.0, 20.0])
def test_integrated_exponential(size: float) -> None:
    """phi_1(X) is the upper right block of an augmented exponential, here to forty digits."""
    X = size * np.random.default_rng(0).normal(size=(3, 4, 4)) / 4
    augmented = np.block([[X, np.broadcast_to(np.eye(4), X.shape)], [np.zeros((3, 4, 8))]])
    with mpmath.workdps(40):
        tables = [mpmath.expm(mpmath.matrix(A.tolist()), method="taylor").tolist() for A in augmented]
    exact = np.array(tables, dtype=float)[:, :4, 4:]
    assert np.abs(integrated_exponential(X) - exact).max() <= 4e-15 * np.abs(exact).max()


def test_exponentials_of_one_stack_do_not_disturb_each_other() -> None:
    """A matrix of norm 30 makes all be halved together; the small one keeps its relative accuracy."""
    small = 1e-10 * np.array([[0.0, 1.0], [2.0, 0.5]])
    found = exponential_increment(np.stack([small, 30 * np.eye(2)]))
    assert np.abs(found[0] - (small + small @ small / 2)).max() < 1e-24
    assert np.abs(found[1] / np.expm1(30.0) - np.eye(2)).max() < 1e-14


@pytest.mark.parametrize("halvings", [1, 2, 3])
def test_principal_logarithm_of_a_general_matrix(halvings: int) -> None:
    """The logarithm of matrices without structure, with real and complex eigenvalues."""
    X = np.random.default_rng(1).normal(size=(20, 5, 5)) / 2
    assert np.abs(principal_logarithm(scipy.linalg.expm(X), halvings) - X).max() < 1e-12


def test_function_of_skew_matrices() -> None:
    """Exp through eigenvectors is Pade's, with angles that coincide and a zero matrix."""
    X = np.zeros((2, 4, 4))
    X[0, 0, 1], X[0, 2, 3] = 1.5, 1.5
    X = X - np.swapaxes(X, 1, 2)
    assert np.abs(of_skew(X, lambda angle: np.exp(1j * angle)) - scipy.linalg.expm(X)).max() < 1e-15 * 4


def test_block_diagonal_broadcasts() -> None:
    """Stacks of blocks become stacks of matrices."""
    a, b = np.ones((3, 1, 1)), np.full((3, 2, 2), 2.0)
    assert np.array_equal(block_diagonal([a, b])[1], scipy.linalg.block_diag(a[1], b[1]))
