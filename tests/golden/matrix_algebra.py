"""Matrices of mpmath numbers in NumPy arrays, and bases of so(n) and se(n), for the scripts that make reference data.

Conventions of the algebras: docs/conventions.md. Nothing of the library is imported here.
"""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
from mpmath import mp, mpf

Array = Any  # a NumPy array of mpmath numbers (dtype object), of integers, or of float64
Number = Any  # an mpf, or an int that is exact


def wedge(i: int, j: int, size: int) -> Array:
    """Return e_i e_j^T - e_j e_i^T, indices counted from 0."""
    unit = np.eye(size, dtype=int)
    return np.outer(unit[i], unit[j]) - np.outer(unit[j], unit[i])


def algebra(group: str) -> Array:
    """Return the basis of so(n), n > 2, or se(n): rotations first, then translations.

    Rotations are the vector basis for n = 3, the usual one for n = 2, else e_i ^ e_j, i < j, lexicographic.
    """
    n = int(group[3:-1])
    turns = [wedge(i, j, n) for i, j in itertools.combinations(range(n), 2)]
    if n <= 3:
        turns = [(-1) ** (j - i) * wedge(i, j, n) for i, j in reversed([*itertools.combinations(range(n), 2)])]
    if group[1] == "O":
        return np.array(turns)
    basis = np.zeros((len(turns) + n, n + 1, n + 1), dtype=int)
    basis[: len(turns), :n, :n] = turns
    basis[len(turns) :, :n, n] = np.eye(n)
    return basis


def exact(nested: Any) -> Array:
    """Turn nested lists of floats or ints into an array of the same numbers in mpmath."""
    return np.vectorize(mpf, otypes=[object])(np.array(nested, dtype=object)) if np.size(nested) else np.array(nested)


def coordinates(basis: Array, x: Array) -> Array:
    """Return the coordinates of a matrix, or of a stack of matrices, in an orthogonal basis."""
    flat = basis.reshape(len(basis), -1)
    result = x.reshape(*x.shape[:-2], -1) @ flat.T
    return result / (flat * flat).sum(axis=1)


def inverse_of(g: Array) -> Array:
    """Return the inverse matrix."""
    return np.array((mp.matrix(g.tolist()) ** -1).tolist(), dtype=object)


def exponential(x: Array) -> Array:
    """Return expm(x) by scaling, Taylor series and squaring."""
    halvings, order = 10, 0
    with mp.workdps(mp.dps + 10):
        scaled = x * mp.ldexp(1, -halvings)
        result = term = exact(np.eye(len(x)))
        while order == 0 or np.abs(term).max() > mp.eps:
            order += 1
            term = term @ scaled / order
            result = result + term
        for _ in range(halvings):
            result = result @ result
    return exact(result)


def inertia_operator(basis: Array, mass_tensor: Array) -> Array:
    """Return the matrix tr(E_i JJ E_j^T)."""
    return (basis @ mass_tensor).reshape(len(basis), -1) @ basis.reshape(len(basis), -1).T


def require(defect: Number, what: str, tolerance: Number) -> None:
    """Raise if a defect exceeds its tolerance."""
    if not abs(defect) <= tolerance:
        raise ArithmeticError(f"{what}: {mp.nstr(defect, 3)} exceeds {mp.nstr(tolerance, 3)}")


def decimals(value: Array | list[Any], digits: int = 25) -> str | list[Any]:
    """Turn an array of numbers into nested lists of decimal strings; below 1e-50 is written as zero."""
    if isinstance(value, list | np.ndarray):
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
