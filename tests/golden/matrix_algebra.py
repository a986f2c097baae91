"""Matrices of mpmath numbers, bases of so(n) and se(n), and two bodies, for the scripts that make reference data.

Conventions of the algebras: docs/conventions.md. Nothing of the library is imported here.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mpmath import mp, mpf

Number = Any  # an mpf, or an int that is exact
Vector = list[Number]
Matrix = list[list[Number]]

SO3 = [[[0, 0, 0], [0, 0, -1], [0, 1, 0]], [[0, 0, 1], [0, 0, 0], [-1, 0, 0]], [[0, -1, 0], [1, 0, 0], [0, 0, 0]]]
SE2 = [[[0, -1, 0], [1, 0, 0], [0, 0, 0]], [[0, 0, 1], [0, 0, 0], [0, 0, 0]], [[0, 0, 0], [0, 0, 1], [0, 0, 0]]]


def identity(size: int) -> Matrix:
    """Return the unit matrix."""
    return [[int(i == j) for j in range(size)] for i in range(size)]


def wedge(i: int, j: int, size: int) -> Matrix:
    """Return e_i e_j^T - e_j e_i^T, indices counted from 0."""
    return [[int((r, c) == (i, j)) - int((r, c) == (j, i)) for c in range(size)] for r in range(size)]


def special_orthogonal(n: int) -> list[Matrix]:
    """Return the basis of so(n): the vector basis for n = 3, else e_i ^ e_j, i < j, lexicographic."""
    return SO3 if n == 3 else [wedge(i, j, n) for i in range(n) for j in range(i + 1, n)]


def special_euclidean(n: int) -> list[Matrix]:
    """Return the basis of se(n): rotations of so(n) first, then translations."""
    if n == 2:
        return SE2
    rotations = [[*([*row, 0] for row in element), [0] * (n + 1)] for element in special_orthogonal(n)]
    return rotations + [[[int((r, c) == (i, n)) for c in range(n + 1)] for r in range(n + 1)] for i in range(n)]


def transpose(x: Matrix) -> Matrix:
    """Return the transpose."""
    return [list(column) for column in zip(*x, strict=True)]


def multiply(x: Matrix, y: Matrix) -> Matrix:
    """Return the matrix product x y."""
    columns = transpose(y)
    return [[mp.fdot(row, column) for column in columns] for row in x]


def subtract(x: Matrix, y: Matrix) -> Matrix:
    """Return x - y."""
    return [[p - q for p, q in zip(r, s, strict=True)] for r, s in zip(x, y, strict=True)]


def trace_product(x: Matrix, y: Matrix) -> Number:
    """Return tr(x y)."""
    return mp.fsum(mp.fdot(row, column) for row, column in zip(x, transpose(y), strict=True))


def largest(x: Matrix) -> Number:
    """Return the largest modulus of an entry."""
    return max(abs(entry) for row in x for entry in row)


def combine(coefficients: Vector, matrices: Sequence[Matrix]) -> Matrix:
    """Return the linear combination of matrices."""
    size = range(len(matrices[0]))
    return [[mp.fdot(coefficients, [matrix[i][j] for matrix in matrices]) for j in size] for i in size]


def coordinates(basis: Sequence[Matrix], x: Matrix) -> Vector:
    """Return the coordinates of x in an orthogonal basis; raise if x is not in the algebra."""
    found = [trace_product(element, transpose(x)) / trace_product(element, transpose(element)) for element in basis]
    require(largest(subtract(x, combine(found, basis))), "algebra element", mpf(10) ** (8 - mp.dps))
    return found


def exponential(x: Matrix) -> Matrix:
    """Return expm(x) by scaling, Taylor series and squaring."""
    halvings = 10
    with mp.workdps(mp.dps + 10):
        scaled = [[mp.ldexp(entry, -halvings) for entry in row] for row in x]
        result = term = identity(len(x))
        order = 0
        while order == 0 or largest(term) > mp.eps:
            order += 1
            term = [[entry / order for entry in row] for row in multiply(term, scaled)]
            result = [[p + q for p, q in zip(r, s, strict=True)] for r, s in zip(result, term, strict=True)]
        for _ in range(halvings):
            result = multiply(result, result)
    return result


def inertia_operator(basis: Sequence[Matrix], mass_tensor: Matrix) -> Matrix:
    """Return the matrix tr(E_i JJ E_j^T)."""
    products = [multiply(element, mass_tensor) for element in basis]
    return [[trace_product(x, transpose(y)) for y in basis] for x in products]


def require(defect: Number, what: str, tolerance: Number) -> None:
    """Raise if a defect exceeds its tolerance."""
    if not abs(defect) <= tolerance:
        raise ArithmeticError(f"{what}: {mp.nstr(defect, 3)} exceeds {mp.nstr(tolerance, 3)}")


def decimals(value: Number | list[Any], digits: int = 25) -> str | list[Any]:
    """Turn nested lists of numbers into decimal strings; below 1e-50 is written as zero."""
    if isinstance(value, list):
        return [decimals(entry, digits) for entry in value]
    number = mpf(value)
    return "0.0" if abs(number) < mpf(10) ** -50 else str(mp.nstr(number, digits, min_fixed=-3))


def write_cases(path: Path, cases: list[dict[str, Any]]) -> None:
    """Write the cases, one key a line."""
    blocks = []
    for case in cases:
        lines = [f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in case.items()]
        blocks.append("{\n" + ",\n".join(lines) + "\n}")
    path.write_text("[\n" + ",\n".join(blocks) + "\n]\n", encoding="utf-8")
