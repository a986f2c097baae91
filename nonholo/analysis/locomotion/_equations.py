r"""Connection, curvature and momentum equation from constraints, inertia and their derivatives: small matrices.

$K(s)\,\xi + N(s)\,\dot s = (p, 0)$: the momenta $p = E^T(M_{\xi\xi}\xi + M_{\xi s}\dot s)$, then the constraints
$B\xi + C\dot s = 0$. Columns of E span the kernel of B. Axes of points come first, that of derivatives is the last.
"""

from typing import NamedTuple

import numpy as np

from nonholo.base.types import Array
from nonholo.groups import AbstractMatrixGroup

_SINGULAR = 1e-10  # determinant of rows of length one


class Terms(NamedTuple):
    """The equations at shapes: K and N in one matrix, E, M, and their derivatives; without momenta no E and M."""

    matrix: Array
    slopes: Array
    coasting: Array
    coasting_slopes: Array
    inertia: Array
    units: Array


def terms(free: tuple[int, ...], units: Array, W: Array, dW: Array, M: Array, dM: Array) -> Terms:
    """Return the equations from W = (B, C) and the inertia. Rows `free` of E are the identity."""
    k, d = len(free), len(free) + W.shape[-2]
    units = np.broadcast_to(units, (*W.shape[:-2], d))
    E, dE = np.zeros((*W.shape[:-2], d, k)), np.zeros((*W.shape[:-2], d, k, dW.shape[-1]))
    pivots, B, dB = np.setdiff1d(np.arange(d), free), W[..., :d], dW[..., :d, :]
    E[..., list(free), :] = np.eye(k)
    own = units[..., pivots]
    E[..., pivots, :] = -solve(B[..., pivots], B[..., list(free)], own)
    change = np.einsum("...caj,...ab->...cbj", dB, E)  # B E = 0, so B dE = -dB E
    dE[..., pivots, :, :] = -_solve_each(B[..., pivots], change, own)
    P = np.swapaxes(E, -1, -2) @ M[..., :d, :]
    dP = np.einsum("...abj,...ac->...bcj", dE, M[..., :d, :]) + np.einsum("...ab,...acj->...bcj", E, dM[..., :d, :, :])
    return Terms(np.concatenate([P, W], -2), np.concatenate([dP, dW], -3), E, dE, M, units)


def singularity(at: Terms) -> Array:
    """Return what is zero at singular shapes."""
    return regularity(_of_pose(at.matrix), at.units)


def _of_pose(matrix: Array) -> Array:
    """Return the columns of the body velocity: as many as there are rows."""
    return matrix[..., : matrix.shape[-2]]


def unit_rows(matrix: Array) -> Array:
    """Return a matrix with its rows at length one; those that are zero stay."""
    return matrix / np.maximum(np.linalg.norm(matrix, axis=-1, keepdims=True), np.finfo(float).tiny)


def regularity(matrix: Array, units: Array) -> Array:
    """Return the determinant of a matrix with its rows at length one, in units: zero where it is singular."""
    return np.linalg.det(unit_rows(matrix * units[..., None, :]))


def solve(matrix: Array, right: Array, units: Array) -> Array:
    """Solve linear equations; NaN where the matrix is singular in units of its columns."""
    is_regular = np.abs(regularity(matrix, units)) > _SINGULAR
    return np.linalg.solve(np.where(is_regular[..., None, None], matrix, np.nan), right)


def _solve_each(matrix: Array, right: Array, units: Array) -> Array:
    """Solve for each derivative, along the last axis."""
    return np.moveaxis(solve(matrix[..., None, :, :], np.moveaxis(right, -1, -3), units[..., None, :]), -3, -1)


def connection(at: Terms) -> Array:
    r"""Return A of $\xi = -A\dot s$ for p = 0."""
    return solve(_of_pose(at.matrix), at.matrix[..., at.matrix.shape[-2] :], at.units)


def curvature(group: AbstractMatrixGroup, at: Terms) -> Array:
    """Return F[:, i, j] = d_i A_j - d_j A_i - [A_i, A_j]."""
    A, d = connection(at), group.dim
    right = at.slopes[..., d:, :] - np.einsum("...abj,...bc->...acj", at.slopes[..., :d, :], A)
    dA = _solve_each(_of_pose(at.matrix), right, at.units)  # its axes: xi, j, i
    a = np.swapaxes(A, -1, -2)
    brackets = group.bracket(a[..., :, None, :], a[..., None, :, :])
    return np.swapaxes(dA, -1, -2) - dA - np.moveaxis(brackets, -1, -3)


def motion(group: AbstractMatrixGroup, at: Terms, ds: Array, p: Array) -> tuple[Array, Array]:
    r"""Return $\xi$ and $\dot p_a = \langle\partial l/\partial\xi, [\xi, e_a] + \dot e_a\rangle$."""
    d = group.dim
    right = -np.einsum("...ai,...i->...a", at.matrix[..., d:], ds)
    right[..., : p.shape[-1]] += p
    xi = solve(_of_pose(at.matrix), right[..., None], at.units)[..., 0]
    if not p.shape[-1]:
        return xi, np.zeros((*xi.shape[:-1], 0))
    mu = np.einsum("...ab,...b->...a", at.inertia[..., :d, :], np.concatenate([xi, ds], -1))
    rates = np.swapaxes(np.einsum("...abj,...j->...ab", at.coasting_slopes, ds), -1, -2)
    transport = rates + group.bracket(xi[..., None, :], np.swapaxes(at.coasting, -1, -2))
    return xi, np.einsum("...ba,...a->...b", transport, mu)
