r"""All roots of a square-free polynomial with integer coefficients, each in a separate ball, and which are real.

Numbers only guess. The proof is $p'/p = \sum_j 1/(z - \zeta_j)$: a disc around z of radius $d\,|p(z)/p'(z)|$ holds a
root, so d disjoint discs hold one each, and a disc around a real z holds a real one, being its own mirror image.

A problem has the doubles of a system as exact rational numbers: everything of the dimension of an inertia is an integer
here, after multiplication by one power of two. Axes are those of the body: nothing is diagonalized.

Reference: docs/theory/branches.md, "Certificates".
"""

import contextlib
import math
from itertools import chain, combinations, pairwise, starmap
from typing import Any, NamedTuple, cast

import numpy as np
from flint import acb, acb_poly, arb, ctx, fmpq, fmpq_mat, fmpz, fmpz_mat, fmpz_poly

from nonholo.systems import NormalForm

_ZERO = fmpq(0)


class Lever(NamedTuple):
    """Parameters of a sleigh that a top lacks, in units of length: a_1, h p_1/m, the center of mass across axis 1."""

    arm: fmpq
    push: fmpq
    offset: list[fmpq]
    moment: fmpq  # m a_1 in the unit of inertia of the problem


class Problem(NamedTuple):
    r"""The equations $(B + \mu)y = sd + c$, $\mu = \tfrac12 s\hat p - c\cdot y$, $s = 1 + y\cdot y$ in integers."""

    stiffness: fmpz_mat
    coupling: list[fmpz]
    excess: list[fmpz]  # d = r - c
    half: fmpz  # half of p-hat
    lever: Lever | None


def problem_of(form: NormalForm, time_step: float, momentum: np.ndarray) -> Problem:
    """Return the exact problem of a body, in its own doubles, for canonical restricted momenta."""
    h = _exact(time_step)
    p = [h * _exact(x) for x in (momentum if form.frame_map is None else form.frame_map @ momentum).tolist()]
    B, c = _stiffness(form), [_exact(x) for x in form.coupling]
    if not form.is_sleigh:
        return _problem(B, c, [x / 2 for x in p])
    a, m, offset = _exact(form.arm), _exact(form.mass), [_exact(x) for x in form.offset]
    r = [(x - o * p[-1]) / 2 for x, o in zip(p[:-1], offset, strict=True)]
    return _problem(B, c, r, a * p[-1] / 2 + m * a * a, Lever(a, p[-1] / m, offset, m * a))


def _problem(B: list, c: list, r: list, half: fmpq = _ZERO, lever: Lever | None = None) -> Problem:
    d = [x - y for x, y in zip(r, c, strict=True)]
    whole_B, denominator = fmpq_mat(B).numer_denom()
    unit = max(denominator, *(x.q for x in (*c, *d, half)))

    def whole(x: fmpq) -> fmpz:
        return (x * unit).p

    lever = lever and lever._replace(moment=lever.moment * unit)
    return Problem(whole_B * (unit // denominator), [whole(x) for x in c], [whole(x) for x in d], whole(half), lever)


def _stiffness(form: NormalForm) -> list[list[fmpq]]:
    across = np.diag(form.across) if form.is_diagonal else np.asarray(form.across)
    rows, along = across.tolist(), _exact(form.along)
    return [[_exact(x) + (along if i == j else _ZERO) for j, x in enumerate(row)] for i, row in enumerate(rows)]


def _exact(x: Any) -> fmpq:
    return fmpq(*float(x).as_integer_ratio())


PRECISIONS = (192, 384, 1024, 4096)  # bits
_ROUGH = 64  # bits, enough to tell most roots apart
_CLOSE = 1e-4  # relative distance up to which rounding may have merged or split two eigenvalues
_STEPS = 8  # of Newton's method; two suffice from a good guess


def isolate(polynomial: fmpz_poly) -> list[acb] | None:
    """Return a ball for each real root and one of each conjugate pair, None if no precision separates them."""
    guess = _guess(polynomial)
    guesses = ((guess, bits) for bits in (_ROUGH, PRECISIONS[0]))
    attempts = chain(guesses, ((_search(polynomial, bits), bits) for bits in PRECISIONS))
    return next((balls for each in attempts if (balls := sharpen(polynomial, *each)) is not None), None)


def sharpen(polynomial: fmpz_poly, centers: list[acb], bits: int) -> list[acb] | None:
    """Return the balls near centers, which are real or above the real axis, or None if they do not prove anything."""
    with ctx.workprec(bits):
        value = acb_poly(polynomial)
        slope = value.derivative()
        squares = [_around(value, slope, z.mid(), bits) for z in centers]
    flat = [z.imag == 0 for z in centers]
    if 2 * len(flat) - sum(flat) != polynomial.degree() or any(starmap(acb.overlaps, combinations(squares, 2))):
        return None
    pairs = list(zip(squares, flat, strict=True))
    on_side = all(square.imag.mid() == 0 if on_axis else square.imag > 0 for square, on_axis in pairs)
    return [acb(square.real) if on_axis else square for square, on_axis in pairs] if on_side else None


def _around(value: acb_poly, slope: acb_poly, center: acb, bits: int) -> acb:
    """Return a square around a disc that holds a root, near a center, which stays real if it is."""
    fine, step = arb(2.0 ** (-bits // 2)), value(center) / slope(center)
    for _ in range(_STEPS):
        if value.degree() * step.abs_upper() <= fine * center.abs_lower():
            break
        center = (center - step).mid()
        step = value(center) / slope(center)
    radius = value.degree() * step.abs_upper()
    return center + acb(arb(0, radius), arb(0, radius))


def _guess(polynomial: fmpz_poly) -> list[acb]:
    """Return eigenvalues of the companion matrix; two that are close come from the parabola at their middle."""
    exponent, values = _eigenvalues(polynomial)
    alone, middles = _split_pairs(values)
    with ctx.workprec(PRECISIONS[0]):
        unit = arb(fmpz(1) << exponent) if exponent >= 0 else 1 / arb(fmpz(1) << -exponent)
        return [acb(z) * unit for z in alone] + [z for x in middles for z in _parabola(polynomial, x * unit)]


def _split_pairs(values: list[complex]) -> tuple[list[complex], list[float]]:
    """Return the values that lie alone, none below the real axis, and the real middles of two that are close."""
    real = sorted(z.real for z in values if z.imag == 0)
    middles = [(x + y) / 2 for x, y in pairwise(real) if y - x <= _CLOSE * abs(y)]
    alone = [complex(x) for x in real if all(abs(x - y) > _CLOSE * abs(x) for y in middles)]
    for z in values:
        if z.imag > _CLOSE * abs(z):
            alone.append(z)
        elif z.imag > 0:
            middles.append(z.real)
    return alone, middles


def _eigenvalues(polynomial: fmpz_poly) -> tuple[int, list[complex]]:
    """Return an exponent of two, and approximate roots in this unit; none where doubles do not suffice."""
    a = polynomial.coeffs()
    d, first = len(a) - 1, next(i for i, x in enumerate(a) if x != 0)
    sizes = [x.bit_length() for x in a]
    exponent = (sizes[first] - sizes[d]) // max(1, d - first)
    largest = max(size + exponent * i for i, size in enumerate(sizes))
    cut = [max(0, size - 64) for size in sizes]
    b = [math.ldexp(int(x >> c), c + exponent * i - largest) for i, (x, c) in enumerate(zip(a, cut, strict=True))]
    with contextlib.suppress(np.linalg.LinAlgError):
        if abs(b[d]) >= 1e-290:
            return exponent, np.roots(b[::-1]).astype(complex).tolist()
    return exponent, []


def _parabola(polynomial: fmpz_poly, middle: arb) -> list[acb]:
    """Return the real roots, or the upper one of a pair, of the Taylor polynomial of degree two at a point."""
    slope = polynomial.derivative()
    c, b, a = polynomial(middle).mid(), slope(middle).mid(), slope.derivative()(middle).mid() / 2
    square = (b * b - 4 * a * c).mid()
    half = (abs(square).sqrt() / (2 * a)).mid()
    center = (middle - b / (2 * a)).mid()
    return [acb(center - half), acb(center + half)] if square >= 0 else [acb(center, abs(half))]


def _search(polynomial: fmpz_poly, bits: int) -> list[acb]:
    """Return the centers that FLINT finds, however long it takes."""
    with ctx.workprec(bits):
        centers = [acb(z).mid() for z, _ in cast(Any, polynomial.complex_roots())]
    return [z for z in centers if z.imag >= 0]
