"""Rows of the equations side by side, eight at a time: residuals, Jacobian, solutions.

Entry i, j of the matrices of all rows stands in row i N + j of an array, so that processors work at eight equations at
once. A row of a Jacobian here is the derivative of all equations by one unknown.
"""

from typing import Any

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import BORROWING
from nonholo.kernels.lanes import EIGHT, load, spread, store

_SPLIT = 2.0**27 + 1  # halves the digits of a number


@njit(**BORROWING)
def put(matrix: np.ndarray, r: int, rows: np.ndarray) -> None:
    """Write a matrix to a column."""
    for i in range(len(matrix)):
        for j in range(len(matrix)):
            rows[i * len(matrix) + j, r] = matrix[i, j]


@njit(**BORROWING)
def pair_twice(
    rows: np.ndarray, rests: np.ndarray, kinds: np.ndarray, n: int, X: np.ndarray, K: np.ndarray, sums: np.ndarray
) -> None:
    """Add the sums of products of entries of rows + rests, with X or K by their kinds, as if with twice the digits.

    The first n rows of the matrices count: for motions, the others vanish in X and K, or in all D_i J.
    Dot2 of Ogita, Rump and Oishi, Accurate sum and dot product, SIAM J. Sci. Comput. 26 (2005).
    """
    N = len(X)
    for b in range(sums.shape[1] // len(EIGHT)):
        first, second = load(kinds, 0, b, EIGHT), load(kinds, 1, b, EIGHT)
        total, error_sum = load(sums, 0, b, EIGHT), spread(0.0, EIGHT)
        for i in range(n):
            for j in range(N):
                B = first * spread(X[i, j], EIGHT) + second * spread(K[i, j], EIGHT)
                term, error = _product_and_error(load(rows, i * N + j, b, EIGHT), B)
                before = total
                total = before + term
                part = total - before
                rest = error + load(rests, i * N + j, b, EIGHT) * B
                error_sum = error_sum + (rest + ((before - (total - part)) + (term - part)))
        store(sums, 0, b, EIGHT, total + error_sum)


@njit(inline="always", **BORROWING)
def _product_and_error(a: Any, b: Any) -> tuple[Any, Any]:
    """Return the rounded product and its rounding error, by Dekker's halves."""
    split = spread(_SPLIT, EIGHT)
    large_a, large_b, product = split * a, split * b, a * b
    a1, b1 = large_a - (large_a - a), large_b - (large_b - b)
    a2, b2 = a - a1, b - b1
    return product, a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2)


@njit(**BORROWING)
def add_slopes(
    rows: np.ndarray,
    kinds: np.ndarray,
    kind: int,
    n: int,
    G: np.ndarray,
    places: np.ndarray,
    entries: np.ndarray,
    halves: np.ndarray,
    slope: np.ndarray,
) -> None:
    """Add the pairings of rows Q with G C_a G, those of G^T Q G^T with C_a, times factors by kind.

    The first n rows of Q count: for motions, the others vanish in all G C_a G.
    """
    N = len(G)
    for b in range(slope.shape[1] // len(EIGHT)):
        factor = load(kinds, kind, b, EIGHT)
        for i in range(n):
            for j in range(N):
                total = spread(G[j, 0], EIGHT) * load(rows, i * N, b, EIGHT)
                for k in range(1, N):
                    total = total + spread(G[j, k], EIGHT) * load(rows, i * N + k, b, EIGHT)
                store(halves, i * N + j, 0, EIGHT, total)
        for e in range(len(entries)):
            a, i, j = places[e, 0], places[e, 1], places[e, 2]
            total = spread(G[0, i], EIGHT) * load(halves, j, 0, EIGHT)
            for k in range(1, n):
                total = total + spread(G[k, i], EIGHT) * load(halves, k * N + j, 0, EIGHT)
            store(slope, a, b, EIGHT, load(slope, a, b, EIGHT) + factor * spread(entries[e], EIGHT) * total)


@njit(**BORROWING)
def decompose(A: np.ndarray, order: np.ndarray, inverses: np.ndarray, others: np.ndarray) -> float:
    """Replace a Jacobian by what `solve_rows` needs; return its determinant, zero or NaN if there is no solution.

    Gauss and Jordan: each unknown leaves all equations but the one where it is largest among those left. These stay
    where they are; `order` is the permutation.
    """
    det, n, blocks = 1.0, len(A), A.shape[1] // len(EIGHT)
    for c in range(n):
        order[c] = c
    for c in range(n):
        best: int = _largest(A, order, c)
        pivot = order[best]
        if best != c:
            order[best], order[c], det = order[c], pivot, -det
        det *= A[c, pivot]
        if not (np.isfinite(det) and det != 0):
            return det
        inverses[c] = 1.0 / A[c, pivot]
        for b in range(blocks):
            factor = load(A, c, b, EIGHT) * spread(inverses[c], EIGHT)
            if b == pivot // len(EIGHT):
                factor = factor * load(others, pivot % len(EIGHT), 0, EIGHT)
            store(A, c, b, EIGHT, factor)
        for j in range(c + 1, n):
            _leave(A, c, A, j, A[j, pivot])
    return det


@njit(inline="always", **BORROWING)
def _largest(A: np.ndarray, order: np.ndarray, c: int) -> int:
    """Return which of the equations left has the largest coefficient of an unknown."""
    best = c
    for i in range(c + 1, len(A)):
        if abs(A[c, order[i]]) > abs(A[c, order[best]]):
            best = i
    return best


@njit(inline="always", **BORROWING)
def _leave(A: np.ndarray, c: int, B: np.ndarray, row: int, size: float) -> None:
    """Subtract a multiple of a row of factors."""
    for b in range(A.shape[1] // len(EIGHT)):
        store(B, row, b, EIGHT, load(B, row, b, EIGHT) - load(A, c, b, EIGHT) * spread(size, EIGHT))


@njit(**BORROWING)
def solve_rows(A: np.ndarray, order: np.ndarray, inverses: np.ndarray, B: np.ndarray, x: np.ndarray) -> None:
    """Write the solution for the right sides B, (1, R), which is destroyed."""
    for c in range(len(A)):
        _leave(A, c, B, 0, B[0, order[c]])
    for c in range(len(A)):
        x[c] = B[0, order[c]] * inverses[c]
