r"""Enclosures of all displacements over a momentum, in ball arithmetic, from exact polynomials.

Polynomials with integer coefficients have the displacements over a momentum as roots, with exact multiplicities: the
secular polynomial, and what it misses: angle $\pi$, balanced bodies, roots hidden in a common factor. Each family
writes its displacements as $(z_0, z)(z_0, z)^T = qq^T/\nu$ with polynomials q and $\nu$. Why the count is complete is
proved in docs/theory/branches.md, "Certificates".

This file and `_roots` need python-flint, the extra `certify`.
"""

import functools
from collections.abc import Iterable, Iterator
from itertools import zip_longest
from typing import Any, NamedTuple, cast

import numpy as np
from flint import acb, acb_poly, ctx, fmpq, fmpq_mat, fmpq_poly, fmpz, fmpz_mat, fmpz_poly

from nonholo.discrete._discretization import Discretization
from nonholo.discrete.certificate._roots import PRECISIONS, Lever, Problem, isolate, problem_of, sharpen
from nonholo.systems import NormalForm

_X = fmpz_poly([0, 1])
_ONE = fmpz_poly([1])


class UncertainError(Exception):
    """A case that is not decided; the message names it."""


class Family(NamedTuple):
    """Displacements, one for each root of a polynomial, with its multiplicity; real for a real root."""

    polynomial: fmpz_poly
    q: list[fmpz_poly]
    norm: fmpz_poly


def families(problem: Problem) -> Iterator[Family]:
    """Yield polynomials that have every isolated displacement over the momentum as a root, each once."""
    if len(problem.excess) == 1:
        yield from _planar(problem)
    elif not any(problem.coupling) and problem.half == 0:
        yield from _quadratic(problem)
    elif not any(problem.excess) and problem.half == 0:
        yield from _at_the_coupling(problem)
    else:
        yield from _generic(problem)


def _planar(problem: Problem) -> Iterator[Family]:
    r"""The cubic of the plane in y; its missing roots are half-turns."""
    b, r, half = problem.stiffness[0, 0], problem.excess[0], problem.half
    cubic = fmpz_poly([-r, half + b, -r, half])
    yield Family(cubic, [_ONE, _X], _ONE + _X * _X)
    if half == 0 and problem.lever is not None and problem.lever.arm != 0:
        yield Family(_X ** (3 - cubic.degree()), [fmpz_poly(), _ONE], _ONE)


def _quadratic(problem: Problem) -> Iterator[Family]:
    r"""The quadratic of $z_0^2$: $z_0z = w = B^{-1}r$, $z_0^4 - z_0^2 + w\cdot w = 0$; if w = 0 only the identity."""
    numerators, unit = fmpq_mat(problem.stiffness).solve(fmpq_mat(_column(problem.excess))).numer_denom()
    w = numerators.entries()
    if not any(w):
        yield Family(_X, [_ONE, *(fmpz_poly() for _ in w)], _ONE)
        return
    square = unit * unit
    q = [fmpz_poly([0, unit]), *(fmpz_poly([x]) for x in w)]
    yield Family(fmpz_poly([_dot(w, w), -square, square]), q, square * _X)
    if problem.lever is not None and problem.lever.arm != 0:
        yield _half_turn(problem, 1)


def _at_the_coupling(problem: Problem) -> Iterator[Family]:
    r"""The roots of $N_1$ where r = c; $y = Gc$. Half-turns have $c\cdot z = 0$: one of a top with n = 3."""
    determinant, adjugate_c, n1, _, _ = _secular(problem)
    if n1.gcd(determinant).degree() > 0:
        raise UncertainError("the restricted momentum equals the coupling, which is special to the axes of the body")
    q = [determinant, *_polynomials(adjugate_c)]
    norm = _dot(q, q)
    finite = _without(n1, norm)
    yield Family(finite, q, norm)
    if problem.lever is None and len(problem.excess) == 2:
        if finite.degree() < 3:
            raise UncertainError("a half-turn and a displacement at infinity coincide")
        c1, c2 = problem.coupling
        yield Family(_X, [fmpz_poly(), fmpz_poly([-c2]), fmpz_poly([c1])], fmpz_poly([_dot([c1, c2], [c1, c2])]))


def _generic(problem: Problem) -> Iterator[Family]:
    _, _, n1, n2, y = _secular(problem)
    polynomial = n2 * (n1 - n2) - _dot(y, y)
    if polynomial == 0:
        raise UncertainError("the secular polynomial vanishes")
    common = polynomial.gcd(n2)
    regular = _without(_without(polynomial, common), n1)
    if regular.degree() > 0:
        yield Family(regular, [n2, *y], n1 * n2)
    for row in [n1, *y]:
        common = common.gcd(row)
    for factor, _ in common.factor()[1]:
        if factor.degree() > 1:
            raise UncertainError("two roots share an irrational value of mu")
        yield from _on_line(problem, factor)
    lever, k = problem.lever, len(y)
    missing = 2 * k + (lever is not None) - polynomial.degree()
    if problem.half == 0 and (lever is None or lever.arm != 0) and missing > 0:
        yield _half_turn(problem, missing)


def _secular(problem: Problem) -> tuple[fmpz_poly, list[fmpz_mat], fmpz_poly, fmpz_poly, list[fmpz_poly]]:
    r"""Return polynomials in $\mu$: $\Delta = \det(B + \mu)$, adj(B + mu) c by powers, N_1, N_2 and Y."""
    B, c, d = problem.stiffness, _column(problem.coupling), _column(problem.excess)
    determinant = (-B).charpoly()
    Ac, Ad = (_solve(B, [x * side for x in determinant.coeffs()]) for side in (c, d))
    along = c.transpose()
    n1 = determinant * _X + _polynomials(along * x for x in Ac)[0]
    n2 = determinant * problem.half - _polynomials(along * x for x in Ad)[0]
    sides = [x * d + y * c for x, y in zip_longest(n1.coeffs(), n2.coeffs(), fillvalue=0)]
    return determinant, Ac, n1, n2, _polynomials(_solve(B, sides))


def _solve(B: fmpz_mat, sides: list[fmpz_mat]) -> list[fmpz_mat]:
    r"""Return the coefficients of $(B + \mu)^{-1}$ times a polynomial vector, if they are those of a polynomial."""
    coefficients = [sides[-1]]
    for side in sides[-2:0:-1]:
        coefficients.append(side - B * coefficients[-1])
    return coefficients[::-1]


def _column(vector: list[fmpz]) -> fmpz_mat:
    return fmpz_mat(len(vector), 1, vector)


def _polynomials(coefficients: Iterable[fmpz_mat]) -> list[fmpz_poly]:
    """Return the entries of a polynomial vector."""
    return [fmpz_poly(list(row)) for row in zip(*(x.entries() for x in coefficients), strict=True)]


def _on_line(problem: Problem, factor: fmpz_poly) -> Iterator[Family]:
    r"""The isolated solutions on the line of (y, s) that solve the linear equations at a rational $\mu$.

    The equations are singular there and yet may have solutions.
    """
    M, right = _equations_at(problem, *factor.coeffs())
    if M.rank() + 1 < M.ncols() or _augment(M, right).rank() >= M.ncols():
        return  # no solution, or whole curves of them
    *y, s = [fmpq_poly([p, v]) for p, v in _line(M, right)]
    compatible = s - 1 - _dot(y, y)
    if compatible == 0:
        return
    left = [v for _, v in _line(M.transpose(), fmpz_mat(M.ncols(), 1))]
    if _shares_root(compatible, compatible.derivative()) or _shares_root(compatible, _dot(left[:-1], y) + left[-1]):
        raise UncertainError("the multiplicity of a root that the secular polynomial hides is not known")
    compatible = compatible // compatible.gcd(s)
    if compatible.degree() > 0:
        unit = functools.reduce(fmpz.lcm, map(fmpq_poly.denom, (*y, s)))
        *numerators, last = [(row * unit).numer() for row in (*y, s)]
        yield Family(compatible.numer(), [fmpz_poly([unit]), *numerators], unit * last)


def _equations_at(problem: Problem, low: fmpz, high: fmpz) -> tuple[fmpz_mat, fmpz_mat]:
    """Return the matrix and the right-hand side of the linear equations for (y, s) at mu = -low/high."""
    k = len(problem.excess)
    B, c, d, half = problem[:4]
    rows = [[high * B[i, j] - (low if i == j else 0) for j in range(k)] + [-high * d[i]] for i in range(k)]
    rows.append([high * x for x in c] + [-high * half])
    return fmpz_mat(rows), fmpz_mat([[high * x] for x in c] + [[low]])


def _augment(M: fmpz_mat, right: fmpz_mat) -> fmpz_mat:
    return fmpz_mat([[*row, *side] for row, side in zip(M.tolist(), right.tolist(), strict=True)])


def _shares_root(polynomial: fmpq_poly, other: fmpq_poly) -> bool:
    return polynomial.gcd(other).degree() > 0


def _line(M: fmpz_mat, right: fmpz_mat) -> list[tuple[fmpq, fmpq]]:
    """Return one solution of compatible equations of corank one and a null vector, as pairs of components."""
    reduced, size = fmpq_mat(_augment(M, right)).rref()[0], M.ncols()
    pivots = [next(j for j in range(size) if reduced[i, j] != 0) for i in range(size - 1)]
    free = next(j for j in range(size) if j not in pivots)
    pairs = {free: (fmpq(0), fmpq(1))} | {j: (reduced[i, size], -reduced[i, free]) for i, j in enumerate(pivots)}
    return [pairs[j] for j in range(size)]


def _half_turn(problem: Problem, multiplicity: int) -> Family:
    """The half-turn in the plane of d, which is the root mu = infinity."""
    d = problem.excess
    return Family(_X**multiplicity, [fmpz_poly(), *(fmpz_poly([x]) for x in d)], fmpz_poly([_dot(d, d)]))


def _without(polynomial: fmpz_poly, other: fmpz_poly) -> fmpz_poly:
    """Return the polynomial without the roots that it shares with another."""
    common = polynomial.gcd(other)
    while common.degree() > 0:
        polynomial = polynomial // common
        common = polynomial.gcd(common)
    return polynomial


def _dot(u: list, v: list) -> Any:
    return sum((x * y for x, y in zip(u[1:], v[1:], strict=True)), u[0] * v[0])


_SHARP = 2.0**-48  # relative radius that ends the search for more digits
_ROUNDING = 2.0**-51  # of a sum rounded to doubles and of the radii themselves, relative and generous


Enclosures = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Displacements minus the identity in doubles, a bound of the error of any entry, multiplicities and which are real."""


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
        if (values := _values(problem, places, bits)) is not None:
            return _as_matrices(discrete, problem, *values)
    return f"{PRECISIONS[-1]} bits do not separate the values from infinity"


def locate(problem: Problem) -> list[Located]:
    """Locate all isolated displacements: how many there are, which are real, with which multiplicities."""
    places = []
    for family in families(problem):
        for factor, multiplicity in family.polynomial.factor_squarefree()[1]:
            if (balls := isolate(factor)) is None:
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


def _as_matrices(discrete: Discretization, problem: Problem, products: Any, radii: Any, *facts: Any) -> Enclosures:
    """Return the displacements seen from the user's frame, whose entries are taken as exact, and their radii."""
    index, sign = _places(1 + len(problem.excess), problem.lever is not None)
    X = sign * products[:, index]  # only signs are changed
    group, frame = discrete.system.group, np.asarray(discrete.system.frame)
    if not np.array_equal(frame, group.identity):
        back = np.asarray(group.inverse(frame))
        sizes = np.abs(frame).sum(axis=1).max() * np.abs(back).sum(axis=0).max()
        X, radii = frame @ X @ back, sizes * (radii + 4 * _ROUNDING * _largest(X))
    return X, radii + _ROUNDING * (1 + _largest(X)), *facts


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
    return products if lever is None else products + _slides(problem, lever, S, square)


def _slides(problem: Problem, lever: Lever, S: list[list[acb]], square: acb) -> list[acb]:
    r"""Return $2(u - a_\perp\cdot z)(z_0, z)$, $uz_0 = hp_1/m + 2a_1z\cdot z$; at a half-turn $ma_1uz = 2zz^Tr$."""
    across = [_sum(o * x for o, x in zip(lever.offset, row[1:], strict=True)) for row in S]
    if S[0][0] == 0:
        r = [c + d for c, d in zip(problem.coupling, problem.excess, strict=True)]
        lengths = [acb(0), *(_sum(x * y for x, y in zip(row[1:], r, strict=True)) / lever.moment for row in S[1:])]
    else:
        first = lever.push + lever.arm * square
        lengths = [first, *(first / S[0][0] * x for x in S[0][1:])]
    return [x - y for x, y in zip(lengths, across, strict=True)]


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


def _largest(X: np.ndarray) -> np.ndarray:
    return np.abs(X).max(axis=(1, 2))
