r"""Connection, curvature and momentum equation from constraints, inertia and their derivatives: small matrices.

$K(s)\,\xi + N(s)\,\dot s = (p, 0)$: the momenta $p = E^T(M_{\xi\xi}\xi + M_{\xi s}\dot s)$, then the constraints
$B\xi + C\dot s = 0$. Columns of E span the kernel of B. Axes of points come first, that of derivatives is the last.
"""

from typing import NamedTuple

import numpy as np

from nonholo.base.types import Array
from nonholo.groups import SE

_SINGULAR = 1e-10  # determinant of rows of length one
_bracket = SE(2).bracket


class Terms(NamedTuple):
    """The equations at shapes: K and N in one matrix, E, M, and their derivatives; without momenta no E and M."""

    matrix: Array
    slopes: Array
    coasting: Array
    coasting_slopes: Array
    inertia: Array


def terms(free: tuple[int, ...], W: Array, dW: Array, M: Array, dM: Array) -> Terms:
    """Return the equations from W = (B, C) and the inertia. Rows `free` of E are the identity."""
    k = len(free)
    E, dE = np.zeros((*W.shape[:-2], 3, k)), np.zeros((*W.shape[:-2], 3, k, dW.shape[-1]))
    if not k:
        return Terms(W, dW, E, dE, M)
    pivots, B, dB = np.setdiff1d(np.arange(3), free), W[..., :3], dW[..., :3, :]
    E[..., list(free), :] = np.eye(k)
    E[..., pivots, :] = -solve(B[..., pivots], B[..., list(free)])
    turned = np.einsum("...caj,...ab->...cbj", dB, E)  # B E = 0, so B dE = -dB E
    dE[..., pivots, :, :] = -_solve_each(B[..., pivots], turned)
    P = np.swapaxes(E, -1, -2) @ M[..., :3, :]
    dP = np.einsum("...abj,...ac->...bcj", dE, M[..., :3, :]) + np.einsum("...ab,...acj->...bcj", E, dM[..., :3, :, :])
    return Terms(np.concatenate([P, W], -2), np.concatenate([dP, dW], -3), E, dE, M)


def regularity(matrix: Array) -> Array:
    """Return the determinant of a matrix with its rows at length one: zero where it is singular."""
    return np.linalg.det(matrix / np.maximum(np.linalg.norm(matrix, axis=-1, keepdims=True), np.finfo(float).tiny))


def solve(matrix: Array, right: Array) -> Array:
    """Solve linear equations; NaN where the matrix is singular."""
    is_regular = np.abs(regularity(matrix)) > _SINGULAR
    return np.linalg.solve(np.where(is_regular[..., None, None], matrix, np.nan), right)


def _solve_each(matrix: Array, right: Array) -> Array:
    """Solve for each derivative, along the last axis."""
    return np.moveaxis(solve(matrix[..., None, :, :], np.moveaxis(right, -1, -3)), -3, -1)


def connection(at: Terms) -> Array:
    r"""Return A of $\xi = -A\dot s$ for p = 0."""
    return solve(at.matrix[..., :3], at.matrix[..., 3:])


def curvature(at: Terms) -> Array:
    """Return F[:, i, j] = d_i A_j - d_j A_i - [A_i, A_j]."""
    A = connection(at)
    right = at.slopes[..., 3:, :] - np.einsum("...abj,...bc->...acj", at.slopes[..., :3, :], A)
    dA = _solve_each(at.matrix[..., :3], right)  # its axes: xi, j, i
    a = np.swapaxes(A, -1, -2)
    brackets = _bracket(a[..., :, None, :], a[..., None, :, :])
    return np.swapaxes(dA, -1, -2) - dA - np.moveaxis(brackets, -1, -3)


def motion(at: Terms, ds: Array, p: Array) -> tuple[Array, Array]:
    r"""Return $\xi$ and $\dot p_a = \langle\partial l/\partial\xi, [\xi, e_a] + \dot e_a\rangle$."""
    right = -np.einsum("...ai,...i->...a", at.matrix[..., 3:], ds)
    right[..., : p.shape[-1]] += p
    xi = solve(at.matrix[..., :3], right[..., None])[..., 0]
    if not p.shape[-1]:
        return xi, np.zeros((*xi.shape[:-1], 0))
    mu = np.einsum("...ab,...b->...a", at.inertia[..., :3, :], np.concatenate([xi, ds], -1))
    moved = np.swapaxes(np.einsum("...abj,...j->...ab", at.coasting_slopes, ds), -1, -2)
    return xi, np.einsum("...ba,...a->...b", moved + _bracket(xi[..., None, :], np.swapaxes(at.coasting, -1, -2)), mu)
