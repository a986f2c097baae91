"""Many vectors: products with a matrix, also with twice the digits (what rounding takes beside them); unit length."""

import math

import numpy as np

from nonholo.base.compiled import njit
from nonholo.base.types import Array, Float, Inexact

_SPLIT = 2.0**27 + 1  # halves the digits of a 64-bit number


def applied(matrix: Inexact[Array, "... i j"], vectors: Inexact[Array, "... j"]) -> Inexact[Array, "... i"]:
    """Return the products of a matrix, or of one for each vector, with vectors: the same bits in any company.

    BLAS adds in another order where there are more vectors, and einsum where they lie otherwise in memory than row by
    row. Arrays of JAX have the bits of XLA.

    Example:
        >>> from nonholo.base.numerics import applied
        >>> applied(np.array([[1.0, 2.0], [0.0, 1.0]]), np.array([[1.0, 1.0], [0.0, 3.0]]))
        array([[3., 1.],
               [6., 3.]])
    """
    if isinstance(matrix, np.ndarray) and isinstance(vectors, np.ndarray):
        kind = matrix.dtype if matrix.dtype is vectors.dtype else np.result_type(matrix, vectors)
        matrix, vectors = np.ascontiguousarray(matrix, kind), np.ascontiguousarray(vectors, kind)
        return np.einsum("...ij,...j->...i", matrix, vectors)
    return vectors @ matrix.T if matrix.ndim == 2 else (matrix @ vectors[..., None])[..., 0]


Factors = tuple[Float[np.ndarray, "... k k"], Float[np.ndarray, "... k"]]
"""T and d with $T A T^T$ the diagonal matrix of d, T lower triangular with ones on the diagonal."""


def factors_of(matrix: Float[np.ndarray, "... k k"]) -> Factors | None:
    """Return the factors of a positive definite matrix, or of many; None where one is not."""
    try:
        L = np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        return None
    k, U = L.shape[-1], L / L.diagonal(axis1=-2, axis2=-1)[..., None, :]
    T, d = np.broadcast_to(np.eye(k), L.shape).copy(), np.empty(L.shape[:-1])
    for i in range(k):
        row = np.ascontiguousarray(U[..., i, :i])
        d[..., i] = matrix[..., i, i] - np.einsum("...j,...j->...", row**2, np.ascontiguousarray(d[..., :i]))
        T[..., i, :] -= np.einsum("...j,...jl->...l", row, np.ascontiguousarray(T[..., :i, :]))
    return T, d


def solve_by_factors(factors: Factors, vectors: Float[np.ndarray, "... k"]) -> Float[np.ndarray, "... k"]:
    r"""Return the solutions x of A x = v, of one matrix or of one for each: the same bits in any company.

    $x = T^T D^{-1} T v$ loses less than the inverse where A is uneven, and nothing where it is diagonal.

    Example:
        >>> from nonholo.base.numerics import factors_of, solve_by_factors
        >>> solve_by_factors(factors_of(np.array([[4.0, 2.0], [2.0, 2.0]])), np.array([[6.0, 4.0], [2.0, 0.0]]))
        array([[ 1.,  1.],
               [ 1., -1.]])
    """
    T, d = factors
    return applied(T.swapaxes(-1, -2), applied(T, vectors) / d)


def product_and_remainder(
    A: Float[np.ndarray, "... n m"], B: Float[np.ndarray, "m p"]
) -> tuple[Float[np.ndarray, "... n p"], Float[np.ndarray, "... n p"]]:
    r"""Return A B rounded, and what rounding took off, as if A B had been computed with twice the digits.

    Source: T. J. Dekker, A floating-point technique for extending the available precision, Numer. Math. 18 (1971);
    T. Ogita, S. M. Rump, S. Oishi, Accurate sum and dot product, SIAM J. Sci. Comput. 26 (2005).

    Args:
        A: Any matrices, entries below 1e300.
        B: A matrix.

    Returns:
        The product and the remainder.

    Example:
        >>> from nonholo.base.numerics import product_and_remainder
        >>> product, rest = product_and_remainder(np.array([[0.1, 1.0]]), np.array([[10.0], [-1.0]]))
        >>> float(product[0, 0]), float(rest[0, 0])
        (5.551115123125783e-17, 0.0)
    """
    high = low = np.zeros((*A.shape[:-1], B.shape[1]))
    for j in range(len(B)):
        term, error = _product(A[..., j, None], B[j])
        high, sum_error = _sum(high, term)
        low = low + (error + sum_error)
    return _sum(high, low)


def _sum(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the rounded sum and its rounding error."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


def _product(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the rounded product and its rounding error."""
    total, (a1, a2), (b1, b2) = a * b, _halves(a), _halves(b)
    return total, a2 * b2 - (((total - a1 * b1) - a2 * b1) - a1 * b2)


def _halves(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    large = _SPLIT * a
    first = large - (large - a)
    return first, a - first


def of_length_one(x: Float[Array, "... n"], count: int) -> Float[Array, "... n"]:
    """Return arrays whose first `count` numbers are divided by their length, by JAX where it traces them.

    Example:
        >>> of_length_one(np.array([3.0, 4.0, 7.0]), 2)
        array([0.6, 0.8, 7. ])
    """
    if isinstance(x, np.ndarray) and x.dtype.char == "d":
        rows = np.ascontiguousarray(x)
        quotients = np.empty(rows.shape)
        _divide_by_lengths(rows.reshape(-1, x.shape[-1]), count, quotients.reshape(-1, x.shape[-1]))
        return quotients
    xp, head = x.__array_namespace__(), x[..., :count]
    return xp.concatenate([head / xp.sqrt((head * head).sum(axis=-1, keepdims=True)), x[..., count:]], axis=-1)


@njit(nogil=True, error_model="numpy")
def _divide_by_lengths(rows: np.ndarray, count: int, quotients: np.ndarray) -> None:
    for i in range(len(rows)):
        total = rows[i, 0] * rows[i, 0]
        for m in range(1, count):
            total += rows[i, m] * rows[i, m]
        length = math.sqrt(total)
        for m in range(rows.shape[1]):
            quotients[i, m] = rows[i, m] / length if m < count else rows[i, m]
