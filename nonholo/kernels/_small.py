"""Linear algebra of matrices without calls of libraries and without allocations.

Libraries may cut a product otherwise in other numbers of threads. Every sum here runs over rising indices, whatever
the order of the loops.
"""

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import BORROWING

_WIDE = 8  # rows from which a sandwich is made of two products
_SPLIT = 2.0**27 + 1  # halves the digits of a number


@njit(**BORROWING)
def multiply(A: np.ndarray, B: np.ndarray, out: np.ndarray) -> None:
    """Write A B, for square matrices."""
    if len(A) == 4:  # a constant bound lets the compiler unroll: three times as fast
        _product(A, B, out, 4)
    else:
        _wide_product(A, B, out, len(A))


@njit(inline="always", **BORROWING)
def _product(A: np.ndarray, B: np.ndarray, out: np.ndarray, n: int) -> None:
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += A[i, k] * B[k, j]
            out[i, j] = total


@njit(inline="always", **BORROWING)
def _wide_product(A: np.ndarray, B: np.ndarray, out: np.ndarray, n: int) -> None:
    """Write A B row by row, which runs in vector registers; four terms at a time spare the memory."""
    fours = n - n % 4
    for i in range(n):
        for j in range(n):
            out[i, j] = 0.0
        for k in range(0, fours, 4):
            a, b, c, d = A[i, k], A[i, k + 1], A[i, k + 2], A[i, k + 3]
            for j in range(n):
                out[i, j] = out[i, j] + a * B[k, j] + b * B[k + 1, j] + c * B[k + 2, j] + d * B[k + 3, j]
        for k in range(fours, n):
            for j in range(n):
                out[i, j] += A[i, k] * B[k, j]


@njit(**BORROWING)
def sandwich(G: np.ndarray, Q: np.ndarray, half: np.ndarray, out: np.ndarray) -> None:
    """Write G^T Q G^T; `half` is scratch."""
    n = len(G)
    if n == 4:
        _sandwich(G, Q, half, out, 4)
    elif n < _WIDE:
        _sandwich(G, Q, half, out, n)
    else:
        transpose(G, out)
        _wide_product(Q, out, half, n)
        _wide_product(G.T, half, out, n)


@njit(inline="always", **BORROWING)
def _sandwich(G: np.ndarray, Q: np.ndarray, half: np.ndarray, out: np.ndarray, n: int) -> None:
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += Q[i, k] * G[j, k]
            half[i, j] = total
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += G[k, i] * half[k, j]
            out[i, j] = total


@njit(**BORROWING)
def assign(target: np.ndarray, source: np.ndarray) -> None:
    """Write the numbers of a row to another one; numba compiles `target[:] = source` for seconds."""
    for i in range(len(source)):
        target[i] = source[i]


@njit(**BORROWING)
def assign_rows(target: np.ndarray, source: np.ndarray) -> None:
    """Write the numbers of a matrix to another one."""
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[i, j] = source[i, j]


@njit(**BORROWING)
def transpose(A: np.ndarray, out: np.ndarray) -> None:
    """Write the transpose of a square matrix."""
    for i in range(len(A)):
        for j in range(len(A)):
            out[i, j] = A[j, i]


@njit(**BORROWING)
def paired(A: np.ndarray, B: np.ndarray) -> float:
    """Return the sum of products of entries."""
    total = 0.0
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            total += A[i, j] * B[i, j]
    return total


@njit(**BORROWING)
def paired_twice(A: np.ndarray, rest: np.ndarray, B: np.ndarray, less: float) -> float:
    """Return the sum of products of entries of A + rest with B, less a number, as if with twice the digits.

    Dot2 of Ogita, Rump and Oishi, Accurate sum and dot product, SIAM J. Sci. Comput. 26 (2005).
    """
    total, lost = -less, 0.0
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            term, error = _product_and_error(A[i, j], B[i, j])
            before = total
            total = before + term
            part = total - before
            lost += (error + rest[i, j] * B[i, j]) + ((before - (total - part)) + (term - part))
    return total + lost


@njit(inline="always", **BORROWING)
def _product_and_error(a: float, b: float) -> tuple[float, float]:
    """Return the rounded product and its rounding error, by Dekker's halves."""
    large_a, large_b, product = _SPLIT * a, _SPLIT * b, a * b
    a1, b1 = large_a - (large_a - a), large_b - (large_b - b)
    a2, b2 = a - a1, b - b1
    return product, a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2)


@njit(**BORROWING)
def eliminate(A: np.ndarray, B: np.ndarray) -> float:
    """Replace B by the solution of A X = B and return the determinant of A, zero or NaN if there is none.

    A is destroyed.
    """
    det, n = 1.0, len(A)
    for k in range(n):
        det *= _swap(A, B, k) * A[k, k]
        if not (np.isfinite(det) and det != 0):
            return det
        for i in range(k + 1, n):
            factor = A[i, k] / A[k, k]
            _subtract(A, i, factor, k, k + 1)
            _subtract(B, i, factor, k, 0)
    for k in range(n - 1, -1, -1):
        for j in range(B.shape[1]):
            B[k, j] /= A[k, k]
        for i in range(k):
            _subtract(B, i, A[i, k], k, 0)
    return det


@njit(inline="always", **BORROWING)
def _swap(A: np.ndarray, B: np.ndarray, k: int) -> float:
    """Bring the largest entry of column k to row k; return the sign of the exchange."""
    pivot = k
    for i in range(k + 1, len(A)):
        if abs(A[i, k]) > abs(A[pivot, k]):
            pivot = i
    if pivot == k:
        return 1.0
    for j in range(A.shape[1]):
        A[k, j], A[pivot, j] = A[pivot, j], A[k, j]
    for j in range(B.shape[1]):
        B[k, j], B[pivot, j] = B[pivot, j], B[k, j]
    return -1.0


@njit(inline="always", **BORROWING)
def _subtract(A: np.ndarray, row: int, factor: float, other: int, begin: int) -> None:
    """Subtract a multiple of another row, from a column on."""
    for j in range(begin, A.shape[1]):
        A[row, j] -= factor * A[other, j]
