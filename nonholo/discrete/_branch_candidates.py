r"""Approximate roots of the equations of `_branch_equations`: companion eigenvalues of the secular polynomial.

Reference: docs/theory/branches.md.
"""

from collections.abc import Iterable

import numpy as np

from nonholo._types import Array
from nonholo.discrete._branch_equations import Equations


def candidates(equations: Equations) -> Iterable[Array]:
    """Return approximate roots of the secular polynomial."""
    with np.errstate(all="ignore"):
        if equations.is_balanced:
            return _balanced(equations)
        if len(equations.stiffness) == 1:
            return _planar(equations)
        N1, N2, Y = _secular(equations)
        squares = np.zeros(1)
        for row in Y:
            squares = np.polyadd(squares, np.polymul(row, row))
        polynomial = np.polysub(np.polymul(N2, np.polysub(N1, N2)), squares)
        if not np.all(np.isfinite(polynomial)) or not np.any(polynomial):
            return []
        homogeneous = [np.array([np.polyval(row, mu) for row in (N2, *Y)]) for mu in np.roots(polynomial)]
        return [_with_length(equations, v / np.sqrt(v @ v + 0j)) for v in homogeneous]


def _secular(equations: Equations) -> tuple[Array, Array, list[Array]]:
    r"""Return polynomials in $\mu$: $y\cdot y + 1 = N_1/N_2$ and $y = Y/N_2$ where $N_2(N_1 - N_2) = Y\cdot Y$.

    The cancellation of $b_i + \mu$ in $Y_i$ is done by hand, so equal eigenvalues do no harm.
    """
    b, c, k = equations.stiffness, equations.coupling, len(equations.stiffness)
    d = equations.target - c
    half = _half_of_p(equations)

    def product(*left_out: int) -> Array:
        return np.atleast_1d(np.poly([-b[i] for i in range(k) if i not in left_out]))

    without = [product(i) for i in range(k)]
    N1, N2 = np.polymul(product(), [1.0, 0.0]), half * product()
    for i in range(k):
        N1 = np.polyadd(N1, c[i] ** 2 * without[i])
        N2 = np.polysub(N2, c[i] * d[i] * without[i])
    Y = []
    for i in range(k):
        row = np.polymul(without[i], [d[i], c[i] * half])
        for j in set(range(k)) - {i}:
            row = np.polyadd(row, c[j] * (c[j] * d[i] - c[i] * d[j]) * product(i, j))
        Y.append(row)
    return N1, N2, Y


def _planar(equations: Equations) -> list[Array]:
    r"""Return the roots of the cubic $(1 + y^2)(\tfrac12\hat p\,y - r) + by = 0$; y infinite if $\hat p = 0$."""
    b, r = equations.stiffness[0], equations.target[0]
    half = _half_of_p(equations)
    finite = [np.array([1.0, y]) / np.sqrt(1 + y * y + 0j) for y in np.roots([half, -r, half + b, -r])]
    infinite = [np.array([0j, 1.0])] if half == 0 else []
    return [_with_length(equations, v) for v in finite + infinite]


def _half_of_p(equations: Equations) -> Array:
    r"""Return $\hat p/2$, $\hat p = \alpha p + 2\alpha^2$."""
    return equations.arm * (equations.push / 2 + equations.arm)


def _balanced(equations: Equations) -> list[Array]:
    """Return the two roots z_0 z = B^-1 r; one if r = 0, where the other is a whole sphere of half-turns."""
    w = equations.target / equations.stiffness
    spread = np.sqrt(1 - 4 * (w @ w) + 0j)
    larger = (1 + spread) / 2
    squares = [larger, (w @ w) / larger] if w @ w else [larger]
    return [_with_length(equations, np.array([z0, *(w / z0)])) for z0 in np.sqrt(np.array(squares))]


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
