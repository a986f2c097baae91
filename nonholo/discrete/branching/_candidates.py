r"""Approximate roots of the equations of `_branch_equations`: companion eigenvalues of the secular polynomial.

Reference: docs/theory/branches.md.
"""

import functools

import numpy as np

from nonholo.base.types import Array, Inexact
from nonholo.discrete.branching._equations import Equations


def candidates(equations: Equations) -> Inexact[Array, "B m"]:
    """Return approximate roots, only finite ones."""
    with np.errstate(all="ignore"):
        if equations.is_balanced:
            found = _balanced(equations)
        elif len(equations.stiffness) == 1:
            found = _planar(equations)
        else:
            found = _generic(equations)
        points = equations.points([_with_length(equations, v) for v in found])
    return points[np.isfinite(points).all(axis=1)]


def _generic(equations: Equations) -> Array:
    """Return the points (z_0, z) over the roots of the secular polynomial."""
    N1, N2, Y = _secular(equations)
    products = [np.convolve(N2, np.append(N1[:1], N1[1:] - N2)), *(-np.convolve(row, row) for row in Y)]
    length = len(products[0])
    polynomial = sum(np.pad(row, (length - len(row), 0)) for row in products)
    if not np.all(np.isfinite(polynomial)) or not np.any(polynomial):
        return np.zeros((0, len(Y) + 1))
    mu = np.roots(polynomial)
    points = np.array([np.polyval(row, mu) for row in (N2, *Y)]).T
    return points / np.sqrt((points * points).sum(axis=1, keepdims=True) + 0j)


def _secular(equations: Equations) -> tuple[Array, Array, list[Array]]:
    r"""Return polynomials in $\mu$: $y\cdot y + 1 = N_1/N_2$ and $y = Y/N_2$ where $N_2(N_1 - N_2) = Y\cdot Y$.

    The cancellation of $b_i + \mu$ in $Y_i$ is done by hand, so equal eigenvalues do no harm. N_1 has one coefficient
    more than N_2 and the components of Y.
    """
    b, c, k = equations.stiffness, equations.coupling, len(equations.stiffness)
    d, half = equations.target - c, _half_of_p(equations)

    def product(*left_out: int) -> Array:
        factors = [np.array([1.0, b[i]]) for i in range(k) if i not in left_out]
        return functools.reduce(np.convolve, factors, np.ones(1))

    whole, without = product(), np.array([product(i) for i in range(k)])
    N1 = np.append(whole, 0.0) + np.pad((c * c) @ without, (2, 0))
    N2 = half * whole - np.pad((c * d) @ without, (1, 0))
    pairs = {(i, j): np.pad(product(i, j), (2, 0)) for i in range(k) for j in range(i)}
    Y = []
    for i in range(k):
        row = np.convolve(without[i], np.array([d[i], c[i] * half]))
        for j in set(range(k)) - {i}:
            row = row + c[j] * (c[j] * d[i] - c[i] * d[j]) * pairs[max(i, j), min(i, j)]
        Y.append(row)
    return N1, N2, Y


def _planar(equations: Equations) -> list[Array]:
    r"""Return the roots of the cubic $(1 + y^2)(\tfrac12\hat p\,y - r) + by = 0$; y infinite if $\hat p = 0$."""
    b, r = equations.stiffness[0], equations.target[0]
    half = _half_of_p(equations)
    finite = [np.array([1.0, y]) / np.sqrt(1 + y * y + 0j) for y in np.roots([half, -r, half + b, -r])]
    return finite + ([np.array([0j, 1.0])] if half == 0 else [])


def _half_of_p(equations: Equations) -> Array:
    r"""Return $\hat p/2$, $\hat p = \alpha p + 2\alpha^2$."""
    return equations.arm * (equations.push / 2 + equations.arm)


def _balanced(equations: Equations) -> list[Array]:
    """Return the two roots z_0 z = B^-1 r; one if r = 0, where the other is a whole sphere of half-turns."""
    w = equations.target / equations.stiffness
    spread = np.sqrt(1 - 4 * (w @ w) + 0j)
    larger = (1 + spread) / 2
    squares = [larger, (w @ w) / larger] if w @ w else [larger]
    return [np.array([z0, *(w / z0)]) for z0 in np.sqrt(np.array(squares))]


def _with_length(equations: Equations, v: Array) -> Array:
    """Append u, from whichever equation determines it better."""
    if equations.lever is None:
        return v
    z0, z, a = v[0], v[1:], equations.arm
    if abs(z0) ** 2 > 1e-6 * (abs(z) ** 2).sum() or a == 0:
        return np.append(v, (equations.push + 2 * a * (z @ z)) / z0)
    b, c = equations.stiffness + a * a, equations.coupling
    rest = equations.target - z0 * b * z - (z @ z) * c + (c @ z) * z
    return np.append(v, 2 * (z @ rest) / (a * (z @ z)))
