r"""Definitions in 50 digits: displacements as mpmath matrices, momenta as derivatives of the discrete Lagrangian.

Pairings and bases are those of the library (docs/conventions.md), time step 1 as in the paper.
"""

import random
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import mpmath

from nonholo.groups import AbstractMatrixGroup

ctx: Any = mpmath.MPContext()
ctx.dps = 50

Number = Any
Matrix = Any
Vector = list


def basis(group: AbstractMatrixGroup) -> list[Matrix]:
    """Return the basis of the algebra as exact matrices."""
    return [ctx.matrix(E.tolist()) for E in group.basis]


def hat(group: AbstractMatrixGroup, x: Sequence[Number]) -> Matrix:
    """Return the algebra element with coordinates x."""
    total = ctx.zeros(group.size)
    for coordinate, E in zip(x, basis(group), strict=True):
        total += ctx.convert(coordinate) * E
    return total


def vee(group: AbstractMatrixGroup, X: Matrix) -> Vector:
    """Return the coordinates of an algebra element; the basis matrices are orthogonal."""
    return [inner(E, X) / inner(E, E) for E in basis(group)]


def inner(X: Matrix, Y: Matrix) -> Number:
    """Return tr(X^T Y)."""
    return ctx.fsum(X[i, j] * Y[i, j] for i in range(X.rows) for j in range(X.cols))


def exp(X: Matrix) -> Matrix:
    """Return the matrix exponential."""
    return ctx.expm(X, method="taylor")


def trace(X: Matrix) -> Number:
    """Return the trace."""
    return ctx.fsum(X[i, i] for i in range(X.rows))


def adjoint(group: AbstractMatrixGroup, g: Matrix) -> Matrix:
    """Return the matrix of Ad_g."""
    inverse = g**-1
    columns = [vee(group, g * E * inverse) for E in basis(group)]
    return ctx.matrix(columns).T


def coadjoint(group: AbstractMatrixGroup, g: Matrix, p: Sequence[Number]) -> Vector:
    """Return Ad*_g p, the transpose of Ad_g applied to p."""
    return list(adjoint(group, g).T * ctx.matrix(list(p)))


def trace_lagrangian(mass_tensor: Matrix) -> Callable[[Matrix], Number]:
    r"""Return $l_d(W) = \tfrac12\mathrm{tr}((W - I)\,\mathbb{J}\,(W - I)^T)$."""

    def value(W: Matrix) -> Number:
        X = W - ctx.eye(W.rows)
        return trace(X * mass_tensor * X.T) / 2

    return value


def momentum(group: AbstractMatrixGroup, lagrangian: Callable[[Matrix], Number], W: Matrix) -> Vector:
    """Return P(W) by its definition, the derivatives of l_d(exp(e E) W) at e = 0."""
    return [ctx.diff(lambda e, E=E: lagrangian(exp(e * E) * W), 0) for E in basis(group)]


def arriving(group: AbstractMatrixGroup, lagrangian: Callable[[Matrix], Number], W: Matrix) -> Vector:
    """Return Ad*_W P(W) by its definition, the derivatives of l_d(W exp(e E)) at e = 0."""
    return [ctx.diff(lambda e, E=E: lagrangian(W * exp(e * E)), 0) for E in basis(group)]


def differences(first: Iterable[Number], second: Iterable[Number]) -> list[Number]:
    """Return the differences of the entries."""
    return [a - b for a, b in zip(first, second, strict=True)]


def worst(*differences: Any) -> float:
    """Return the largest absolute value among numbers, lists and matrices; infinite where one is not a number."""
    largest = 0.0
    for difference in differences:
        entries = difference if hasattr(difference, "__iter__") else [difference]
        for entry in entries:
            size = float(abs(entry))
            if not size <= largest:
                largest = size if size == size else float("inf")
    return largest


def numbers(seed: int, count: int, low: float = -1.0, high: float = 1.0) -> Vector:
    """Return reproducible random numbers."""
    generator = random.Random(seed)  # noqa: S311 (test data)
    return [ctx.mpf(generator.uniform(low, high)) for _ in range(count)]


def both(exact: float, library: float) -> float:
    """Put a defect at 50 digits and one of double precision under one tolerance: 1e-45 asks 1e-12 of the library."""
    return max(float(exact), 1e-33 * float(library))


def column(coordinates: Sequence[Number]) -> Matrix:
    """Return coordinates as a column, which has the arithmetic of vectors."""
    return ctx.matrix([ctx.convert(coordinate) for coordinate in coordinates])


def dot(p: Matrix, x: Matrix) -> Number:
    """Return the pairing of two columns."""
    return ctx.fsum(p[i] * x[i] for i in range(p.rows))


def coad(group: AbstractMatrixGroup, x: Sequence[Number], p: Sequence[Number]) -> Matrix:
    """Return ad*_x p by its definition, the values of p on the brackets [x, E]."""
    X = hat(group, x)
    return column([dot(column(p), column(vee(group, X * E - E * X))) for E in basis(group)])


def exp_derivative(X: Matrix, Y: Matrix) -> Matrix:
    """Return the derivative of exp(X + e Y) at e = 0, a block of the exponential of [[X, Y], [0, X]]."""
    n = X.rows
    block = ctx.zeros(2 * n)
    for i in range(n):
        for j in range(n):
            block[i, j] = block[n + i, n + j] = X[i, j]
            block[i, n + j] = Y[i, j]
    return exp(block)[0:n, n : 2 * n]


def rank(rows: Matrix) -> int:
    """Return the rank of a matrix with entries of size one, by elimination with full pivoting."""
    left, result = rows.copy(), 0
    while left.rows and left.cols:
        size, i, j = max((abs(left[i, j]), i, j) for i in range(left.rows) for j in range(left.cols))
        if size < ctx.mpf(10) ** (-ctx.dps // 2):
            break
        keep = [(r, c) for r in range(left.rows) if r != i for c in range(left.cols) if c != j]
        entries = [left[r, c] - left[r, j] * left[i, c] / left[i, j] for r, c in keep]
        width = left.cols - 1
        result += 1
        left = (
            ctx.matrix([entries[r * width : (r + 1) * width] for r in range(left.rows - 1)])
            if entries
            else ctx.zeros(0)
        )
    return result


def rate(path: Callable[[Number], Matrix], at: Number = 0) -> Matrix:
    """Return the derivative of a number, column or matrix by a central difference in three times as many digits."""
    digits = ctx.dps
    with ctx.workdps(3 * digits):
        h = ctx.mpf(10) ** -digits
        return (path(at + h) - path(at - h)) / (2 * h)


def polynomial(coefficients: Sequence[Number], x: Number) -> Number:
    """Return the value of a polynomial, highest power first."""
    value = ctx.zero
    for coefficient in coefficients:
        value = value * x + coefficient
    return value


def roots(coefficients: Sequence[Number]) -> Vector:
    """Return the complex roots of a polynomial, highest power first, by Weierstrass's iteration for all of them."""
    with ctx.workdps(160):
        monic = [ctx.convert(coefficient) / coefficients[0] for coefficient in coefficients]
        reach = 1 + max(abs(coefficient) for coefficient in monic)
        result = [reach * ctx.mpc("0.4", "0.9") ** k for k in range(len(monic) - 1)]
        for _ in range(2000):
            moves = [polynomial(monic, x) / ctx.fprod(x - y for y in result if y is not x) for x in result]
            result = [x - move for x, move in zip(result, moves, strict=True)]
            if max(map(abs, moves)) < ctx.mpf("1e-150") * reach:
                break
    return [+x for x in result]
