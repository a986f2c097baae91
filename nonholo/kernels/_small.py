"""Linear algebra of matrices without calls of libraries and without allocations.

Libraries may cut a product otherwise in other numbers of threads. Every sum here runs over rising indices, in
any order of the loops.
"""

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import BORROWING
from nonholo.kernels.lanes import FOUR, load, spread, store


@njit(**BORROWING)
def multiply(A: np.ndarray, B: np.ndarray, out: np.ndarray) -> None:
    """Write A B, for square matrices."""
    if len(A) == 4:  # a constant bound lets the compiler unroll: three times as fast
        _four_columns(A, B, out, 4)
    elif len(A) == 5:
        _four_columns(A, B, out, 5)
        _product(A, B, out, 4, 5)
    elif len(A) == 3:
        _product(A, B, out, 0, 3)
    else:
        _wide_product(A, B, out, len(A))


@njit(inline="always", **BORROWING)
def _four_columns(A: np.ndarray, B: np.ndarray, out: np.ndarray, n: int) -> None:
    for i in range(n):
        row = spread(A[i, 0], FOUR) * load(B, 0, 0, FOUR)
        for k in range(1, n):
            row = row + spread(A[i, k], FOUR) * load(B, k, 0, FOUR)
        store(out, i, 0, FOUR, row)


@njit(inline="always", **BORROWING)
def _product(A: np.ndarray, B: np.ndarray, out: np.ndarray, first: int, n: int) -> None:
    for i in range(n):
        for j in range(first, n):
            total = 0.0
            for k in range(n):
                total += A[i, k] * B[k, j]
            out[i, j] = total


@njit(**BORROWING)
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
def assign(target: np.ndarray, source: np.ndarray | tuple[float, ...]) -> None:
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
def pair(A: np.ndarray, B: np.ndarray) -> float:
    """Return the sum of products of entries."""
    total = 0.0
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            total += A[i, j] * B[i, j]
    return total


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
