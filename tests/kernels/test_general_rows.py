"""Pieces of the general step against their definitions: closed displacements, Jacobians, solutions side by side."""

import numpy as np
import pytest
from bodies import mass_tensor, random_rows

import nonholo as nh
from nonholo.discrete.routes import make_route
from nonholo.kernels.general._rows import decompose, solve_rows
from nonholo.kernels.general._step import (
    displace,
    displace_by_elimination,
    displace_by_squares,
    jacobian,
    residual,
    workspace,
)

LANES = 8


@pytest.mark.parametrize("size", [1e-9, 0.1, 1.0, 30.0, 3000.0])
@pytest.mark.parametrize("group", [nh.SO(2), nh.SO(3), nh.SO(4), nh.SE(2), nh.SE(3), nh.SE(4)], ids=str)
def test_displacements_in_closed_form(group: nh.SO, size: float) -> None:
    """They are those by elimination to rounding times the condition, up to angles of nearly pi, also two equal ones."""
    rng, n = np.random.default_rng(3), group.size - (not np.any(group.basis[:, -1]))
    for y in (*rng.normal(size=(20, group.dim)), *np.eye(group.dim), np.ones(group.dim)):
        Y, closed, X = group.hat(size * y), np.zeros((group.size,) * 2), np.zeros((group.size,) * 2)
        displace_by_squares(Y, n, (Y[:n, :n] ** 2).sum() / 2, closed)
        assert displace_by_elimination(Y.copy(), X) > 0
        np.testing.assert_allclose(closed, X, rtol=0, atol=1e-15 * (1 + np.abs(Y).max()) * np.abs(X).max())


@pytest.mark.parametrize("group", [nh.SO(3), nh.SO(4), nh.SO(5), nh.SE(2), nh.SE(3), nh.SE(4)], ids=str)
def test_jacobian_is_the_derivative_of_the_residual(group: nh.SO) -> None:
    """Against difference quotients, for a general d and for the whole algebra."""
    rng = np.random.default_rng(5)
    for k in (2, group.dim):
        system = nh.LLSystem(group, mass_tensor(group, rng), random_rows(group, k, rng))
        body = make_route(nh.discretize(system, 1.0), "matrix").body
        w, m, y = workspace(body), rng.normal(size=k), 0.3 * rng.normal(size=len(body.stretch))
        displace(body, w, y)
        residual(body, w, 0.7, m)
        jacobian(body, w)
        found, at = w.slope.copy(), []
        for a in range(len(y)):
            for sign in (1, -1):
                displace(body, w, y + sign * 1e-5 * np.eye(len(y))[a])
                residual(body, w, 0.7, m)
                at.append(w.sums[0].copy())
        quotients = (np.array(at[::2]) - np.array(at[1::2])) / 2e-5
        np.testing.assert_allclose(found, quotients, rtol=0, atol=1e-8 * np.abs(found).max())


@pytest.mark.parametrize("size", [1, 3, 8, 11])
def test_solutions_side_by_side(size: int) -> None:
    """The solution and the determinant are NumPy's, with pivots; a second right side needs no second elimination."""
    rng = np.random.default_rng(size)
    J, width = rng.normal(size=(size, size)), (size + LANES - 1) // LANES * LANES
    J[0, 0] = 0.0 if size > 1 else 2.0
    A, x = np.zeros((size, width)), np.zeros(size)
    A[:, :size] = J.T
    order, inverses, others = np.zeros(size, dtype=np.int64), np.zeros(size), 1.0 - np.eye(LANES)
    np.testing.assert_allclose(decompose(A, order, inverses, others), np.linalg.det(J), rtol=1e-12)
    for b in rng.normal(size=(2, size)):
        sums = np.zeros((1, width))
        sums[0, :size] = b
        solve_rows(A, order, inverses, sums, x)
        np.testing.assert_allclose(x, np.linalg.solve(J, b), rtol=1e-10)


def test_singular_jacobians_have_no_determinant() -> None:
    """Equations that depend on each other, and those with NaN."""
    order, inverses, others = np.zeros(2, dtype=np.int64), np.zeros(2), 1.0 - np.eye(LANES)
    A = np.zeros((2, LANES))
    A[:, :2] = [[1.0, 2.0], [2.0, 4.0]]
    assert decompose(A, order, inverses, others) == 0
    assert np.isnan(decompose(np.full((2, LANES), np.nan), order, inverses, others))
