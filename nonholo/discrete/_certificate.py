r"""Enclosures of all displacements over a momentum, in ball arithmetic, from the exact polynomials.

This file and the two that it builds on need python-flint, the extra `certify`. Reference: docs/theory/branches.md,
"Certificates".
"""

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple, cast

import numpy as np
from flint import acb, ctx

from nonholo.discrete._certificate_families import Family, UncertainError, families
from nonholo.discrete._certificate_problem import Body, Lever, Problem, problem_of
from nonholo.discrete._discretization import Discretization

_PRECISIONS = (64, 128, 256, 1024, 4096)  # bits
_SHARP = 2.0**-48  # relative radius that ends the search for more digits
_ROUNDING = 2.0**-51  # of a sum rounded to doubles and of the radii themselves, relative and generous


class Enclosures(NamedTuple):
    """Displacements minus the identity in doubles, how far they may be off in any entry, and exact facts of them."""

    increment: np.ndarray
    radius: np.ndarray
    multiplicity: np.ndarray
    is_real: np.ndarray


def enclosures(discrete: Discretization, canonical: np.ndarray) -> Enclosures | str:
    """Enclose all isolated displacements over canonical restricted momenta, or say what is not decided."""
    body = cast(Body, discrete.system.canonical)
    problem = problem_of(body, float(discrete.time_step), canonical)
    try:
        exact = [family for family in families(problem) if family.polynomial.degree() > 0]
        if not exact:
            return "no displacement is isolated"
        for bits in _PRECISIONS:
            found = _at(bits, problem, exact, discrete)
            if found is not None:
                return found
    except UncertainError as reason:
        return str(reason)
    return f"{_PRECISIONS[-1]} bits do not separate the values from infinity"


def _at(bits: int, problem: Problem, exact: list[Family], discrete: Discretization) -> Enclosures | None:
    """Return enclosures from a number of bits, None if it is too small."""
    rows = []
    for family in exact:
        for mu, multiplicity, is_real in _roots(family, bits):
            with ctx.workprec(2 * bits):
                products, off = _rounded(_products(problem, family, mu))
            if not off <= _SHARP * max(1.0, float(np.abs(products).max())):
                return None
            rows.append((products, off, multiplicity, is_real))
            if not is_real:
                rows.append((products.conj(), off, multiplicity, False))
    middles, radii, multiplicities, real = (np.array(column) for column in zip(*rows, strict=True))
    X = _increments(middles, len(problem.excess), problem.lever is not None)
    system = discrete.system
    if not np.array_equal(system.frame, system.group.identity):
        X, radii = _turned(X, radii, np.asarray(system.frame), np.asarray(system.group.inverse(system.frame)))
    return Enclosures(X, radii + _ROUNDING * (1 + _largest(X)), multiplicities, real)


def _roots(family: Family, bits: int) -> Iterator[tuple[acb, int, bool]]:
    """Yield the real roots and one of each conjugate pair, with multiplicities."""
    for factor, multiplicity in family.polynomial.factor_squarefree()[1]:
        with ctx.workprec(bits):
            roots: Any = factor.complex_roots()
        found = [acb(mu) for mu, _ in roots]
        real, upper = [mu for mu in found if mu.imag == 0], [mu for mu in found if mu.imag > 0]
        if len(real) + 2 * len(upper) != factor.degree():
            raise UncertainError("the roots are not isolated from the real axis")
        yield from ((mu, multiplicity, True) for mu in real)
        yield from ((mu, multiplicity, False) for mu in upper)


def _products(problem: Problem, family: Family, mu: acb) -> list[acb]:
    """Return the upper triangle of twice (z_0, z)(z_0, z)^T, its corner 2z.z, and of a sleigh 2(u - a.z)(z_0, z)."""
    q, norm = [row(mu) for row in family.q], family.norm(mu)
    k, lever = len(q) - 1, problem.lever
    S: list[list[acb]] = [[acb(0)] * (k + 1) for _ in q]
    for i, x in enumerate(q):
        scaled = 2 * x / norm
        for j in range(i, k + 1):
            S[i][j] = S[j][i] = scaled * q[j]
    square = _sum(S[i][i] for i in range(1, k + 1))
    products = [square, *S[0][1:], *(S[i][j] for i in range(1, k + 1) for j in range(i, k + 1))]
    if lever is None:
        return products
    return products + [x - y for x, y in zip(_stretch(problem, lever, S, square), _across(lever, S), strict=True)]


def _stretch(problem: Problem, lever: Lever, S: list[list[acb]], square: acb) -> list[acb]:
    r"""Return $u\,(z_0, z)$, from $uz_0 = hp_1/m + 2a_1z\cdot z$; at a half-turn $ma_1uz = 2zz^Tr$."""
    if S[0][0] == 0:
        r = [c + d for c, d in zip(problem.coupling, problem.excess, strict=True)]
        return [acb(0), *(_sum(x * y for x, y in zip(row[1:], r, strict=True)) / lever.moment for row in S[1:])]
    first = lever.push + lever.arm * square
    along = first / S[0][0]
    return [first, *(along * x for x in S[0][1:])]


def _across(lever: Lever, S: list[list[acb]]) -> list[acb]:
    r"""Return $2(a_\perp\cdot z)\,(z_0, z)$."""
    return [_sum(o * x for o, x in zip(lever.offset, row[1:], strict=True)) for row in S]


def _sum(terms: Iterable[acb]) -> acb:
    return sum(terms, acb(0))


def _rounded(balls: list[acb]) -> tuple[np.ndarray, float]:
    """Return the middles in doubles and a bound of how far any of them may be off."""
    middles = [complex(x) for x in balls]
    off = max(float((x - acb(y)).abs_upper()) for x, y in zip(balls, middles, strict=True))
    return np.array(middles), off * (1 + _ROUNDING)


def _increments(products: np.ndarray, k: int, sleigh: bool) -> np.ndarray:
    """Return the canonical displacements minus the identity; only signs are changed."""
    upper = np.triu_indices(k + 1)
    S = np.zeros((len(products), k + 1, k + 1), dtype=complex)
    S[:, upper[0], upper[1]] = S[:, upper[1], upper[0]] = products[:, : len(upper[0])]
    X = np.zeros((len(products), k + 1 + sleigh, k + 1 + sleigh), dtype=complex)
    n = k + 1
    if sleigh:
        length = products[:, len(upper[0]) :]
        X[:, 0, 1:n], X[:, 1:n, 0], X[:, 1:n, 1:n], X[:, 0, 0] = S[:, 0, 1:], -S[:, 1:, 0], -S[:, 1:, 1:], -S[:, 0, 0]
        X[:, 0, n], X[:, 1:n, n] = length[:, 0], -length[:, 1:]
    else:
        X[:, :k, :k], X[:, :k, k], X[:, k, :k], X[:, k, k] = -S[:, 1:, 1:], S[:, 1:, 0], -S[:, 0, 1:], -S[:, 0, 0]
    return X


def _turned(X: np.ndarray, radii: np.ndarray, frame: np.ndarray, back: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return displacements seen from the user's frame, whose entries are taken as exact, and their radii."""
    sizes = np.abs(frame).sum(axis=1).max() * np.abs(back).sum(axis=0).max()
    return frame @ X @ back, sizes * (radii + 4 * _ROUNDING * _largest(X))


def _largest(X: np.ndarray) -> np.ndarray:
    return np.abs(X).max(axis=(1, 2))
