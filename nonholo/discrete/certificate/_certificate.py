r"""Enclosures of all displacements over a momentum, in ball arithmetic, from the exact polynomials.

This file and the three that it builds on need python-flint, the extra `certify`. Reference: docs/theory/branches.md,
"Certificates".
"""

import functools
from collections.abc import Iterable
from typing import NamedTuple, cast

import numpy as np
from flint import acb, acb_poly, ctx, fmpz_poly

from nonholo.discrete._discretization import Discretization
from nonholo.discrete.certificate._families import Family, UncertainError, families
from nonholo.discrete.certificate._roots import PRECISIONS, Lever, Problem, isolate, problem_of, sharpen
from nonholo.systems import NormalForm

_SHARP = 2.0**-48  # relative radius that ends the search for more digits
_ROUNDING = 2.0**-51  # of a sum rounded to doubles and of the radii themselves, relative and generous


class Enclosures(NamedTuple):
    """Displacements minus the identity in doubles, a bound of the error of any entry, and exact facts of them."""

    increment: np.ndarray
    radius: np.ndarray
    multiplicity: np.ndarray
    is_real: np.ndarray


class Located(NamedTuple):
    """The displacements over the roots of one square-free factor: a ball for each real root and one of each pair."""

    family: Family
    factor: fmpz_poly
    multiplicity: int
    balls: list[acb]


def enclosures(discrete: Discretization, canonical: np.ndarray) -> Enclosures | str:
    """Enclose all isolated displacements over canonical restricted momenta, or name what is not decided."""
    form = cast(NormalForm, discrete.system.canonical.normal_form)
    if form.frame is not None:
        return "the axes of the constraint are not those of the body, whose doubles would be rounded"
    problem = problem_of(form, float(discrete.time_step), canonical)
    try:
        places = locate(problem)
    except UncertainError as reason:
        return str(reason)
    if not places:
        return "no displacement is isolated"
    for bits in PRECISIONS:
        places = [x._replace(balls=sharpen(x.factor, x.balls, bits) or x.balls) for x in places]
        values = _values(problem, places, bits)
        if values is not None:
            return _as_matrices(discrete, problem, values)
    return f"{PRECISIONS[-1]} bits do not separate the values from infinity"


def locate(problem: Problem) -> list[Located]:
    """Locate all isolated displacements: how many there are, which are real, with which multiplicities."""
    places = []
    for family in families(problem):
        for factor, multiplicity in family.polynomial.factor_squarefree()[1]:
            balls = isolate(factor)
            if balls is None:
                raise UncertainError("the roots are not isolated from the real axis")
            places.append(Located(family, factor, multiplicity, balls))
    return places


def _values(problem: Problem, places: list[Located], bits: int) -> tuple[np.ndarray, ...] | None:
    """Return the products of all roots, their error, multiplicity, reality; None if the number of bits is too small."""
    rows = []
    with ctx.workprec(bits):
        for family, _, multiplicity, balls in places:
            q, norm = [acb_poly(row) for row in family.q], acb_poly(family.norm)
            for mu in balls:
                exact = _products(problem, [row(mu) for row in q], 2 / norm(mu))
                middles, width = [complex(x) for x in exact], float(_sum(exact).rad())  # the sum is wider than any
                rows.append((middles, width, multiplicity, mu.imag == 0))
                if mu.imag != 0:
                    rows.append(([x.conjugate() for x in middles], width, multiplicity, False))
    products, widths, multiplicities, real = (np.array(column) for column in zip(*rows, strict=True))
    largest = np.abs(products).max(axis=1)
    radii = widths + _ROUNDING * largest
    sharp = (radii <= _SHARP * np.maximum(1.0, largest)) & np.isfinite(largest)
    return (products, radii, multiplicities, real) if sharp.all() else None


def _as_matrices(discrete: Discretization, problem: Problem, values: tuple[np.ndarray, ...]) -> Enclosures:
    """Return the displacements in the user's frame."""
    products, radii, multiplicity, is_real = values
    index, sign = _places(1 + len(problem.excess), problem.lever is not None)
    X = sign * products[:, index]  # only signs are changed
    group, frame = discrete.system.group, np.asarray(discrete.system.frame)
    if not np.array_equal(frame, group.identity):
        X, radii = _turn(X, radii, frame, np.asarray(group.inverse(frame)))
    return Enclosures(X, radii + _ROUNDING * (1 + _largest(X)), multiplicity, is_real)


def _products(problem: Problem, q: list[acb], scale: acb) -> list[acb]:
    """Return the upper triangle of twice (z_0, z)(z_0, z)^T, its corner 2z.z, and of a sleigh 2(u - a.z)(z_0, z)."""
    k, lever = len(q) - 1, problem.lever
    S: list[list[acb]] = [[acb(0)] * (k + 1) for _ in q]
    for i, x in enumerate(q):
        multiple = scale * x
        for j in range(i, k + 1):
            S[i][j] = S[j][i] = multiple * q[j]
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


@functools.cache
def _places(n: int, sleigh: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return which product stands at each place of a displacement minus the identity, and its sign, 0 for none."""
    upper, count = np.triu_indices(n), n * (n + 1) // 2
    square = np.zeros((n, n), dtype=int)
    square[upper] = square.T[upper] = np.arange(count)
    if not sleigh:
        sign = -np.ones((n, n))
        sign[:-1, -1] = 1.0
        return np.roll(square, -1, axis=(0, 1)), sign
    index, sign = np.zeros((n + 1, n + 1), dtype=int), np.zeros((n + 1, n + 1))
    index[:n, :n], index[:n, n] = square, count + np.arange(n)
    sign[:n] = -1.0
    sign[0, 1:] = 1.0
    return index, sign


def _turn(X: np.ndarray, radii: np.ndarray, frame: np.ndarray, back: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return displacements seen from the user's frame, whose entries are taken as exact, and their radii."""
    sizes = np.abs(frame).sum(axis=1).max() * np.abs(back).sum(axis=0).max()
    return frame @ X @ back, sizes * (radii + 4 * _ROUNDING * _largest(X))


def _largest(X: np.ndarray) -> np.ndarray:
    return np.abs(X).max(axis=(1, 2))
