"""Certified counts: discs that prove which roots are real against Sturm's theorem, on close, huge, hidden roots."""

from fractions import Fraction

import numpy as np
import pytest
from flint import acb, ctx, fmpq_mat, fmpz, fmpz_mat, fmpz_poly
from sturm import real_roots

from nonholo.discrete.certificate import _roots as certificate_roots
from nonholo.discrete.certificate._families import _secular
from nonholo.discrete.certificate._roots import Problem, isolate, sharpen

_X = fmpz_poly([0, 1])
_HUGE = fmpz(10) ** 40


def _with_roots(*roots: str) -> fmpz_poly:
    """Return the polynomial with given rational roots."""
    found = fmpz_poly([1])
    for root in map(Fraction, roots):
        found *= fmpz_poly([-root.numerator, root.denominator])
    return found


_POLYNOMIALS = {
    "one root": _with_roots("3/7"),
    "a root zero": _X * (_X * _X + 1),
    "far apart": _with_roots("1/100000000000000000000", "-3", "500000000000000000000") * (_X * _X + _HUGE),
    "Wilkinson's": _with_roots(*map(str, range(1, 21))),
    "close real roots": _with_roots("1", "1000000001/1000000000", "3"),
    "real, 20 digits alike": _HUGE * (_X - 1) ** 2 * (_X - 3) + 1,
    "a pair, real to 20 digits": _HUGE * (_X - 1) ** 2 * (_X - 3) - 1,
    "Mignotte's, real": _X**7 - 2 * (1000 * _X - 1) ** 2,
    "Mignotte's, complex": _X**8 + 2 * (1000 * _X - 1) ** 2,
    "close complex pairs": _HUGE * (_X * _X + 1) ** 2 + _X,
    "three close roots": _HUGE * (_X - 1) ** 3 - _X,
    "leading coefficient below doubles": _X**3 - _HUGE**30 * _X**2 + _HUGE**31 * _X - 1,
}
_NEED_NO_SEARCH = ["one root", "far apart", "close real roots", "real, 20 digits alike", "a pair, real to 20 digits"]


@pytest.mark.parametrize("polynomial", _POLYNOMIALS.values(), ids=_POLYNOMIALS)
def test_balls_are_counted_by_sturm_and_hold_one_root_each(polynomial: fmpz_poly) -> None:
    """As many are real as Sturm's theorem says; each root of FLINT, to 600 bits, lies in one alone."""
    balls = isolate(polynomial)
    real = [x for x in balls if x.imag == 0]
    assert len(real) == real_roots(polynomial)
    assert 2 * len(balls) - len(real) == polynomial.degree()
    with ctx.workprec(600):
        roots = [acb(z) for z, _ in polynomial.complex_roots()]
        holders = [[i for i, x in enumerate(balls) if x.overlaps(z)] for z in roots if z.imag >= 0]
    assert sorted(holders) == [[i] for i in range(len(balls))]


@pytest.mark.parametrize("name", _NEED_NO_SEARCH)
def test_close_pairs_need_no_search(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The parabola at the middle of two close eigenvalues says whether they are real, and the discs prove it."""
    monkeypatch.setattr(certificate_roots, "_search", lambda *_: [])
    assert isolate(_POLYNOMIALS[name]) is not None


@pytest.mark.parametrize("name", ["one root", "close real roots", "Mignotte's, complex", "three close roots"])
def test_bad_guesses_cost_time_only(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without guesses the roots are searched, and counted the same."""
    polynomial = _POLYNOMIALS[name]
    monkeypatch.setattr(certificate_roots, "_guess", lambda _: [acb(1)] * polynomial.degree())
    balls = isolate(polynomial)
    assert sum(x.imag == 0 for x in balls) == real_roots(polynomial)


_CUBIC = (_X - 2) * (_X * _X + 1)
_BAD_CENTERS = {
    "a root missing": (_CUBIC, [acb(2)]),
    "a root three times": (_CUBIC, [acb(2), acb(2), acb(2)]),
    "a pair taken for real roots": (_CUBIC, [acb(2), acb(0.5), acb(-0.5)]),
    "both of a pair": (_CUBIC, [acb(2), acb(0, 1), acb(0, -1)]),
    "the lower one of a pair": (_CUBIC, [acb(2), acb(0, -1)]),
    "a real root as a pair": (_X * _X - 2, [acb(1.5, 0.1)]),
    "not a number": (3 * _X - 1, [acb("nan")]),
}


@pytest.mark.parametrize(("polynomial", "centers"), _BAD_CENTERS.values(), ids=_BAD_CENTERS)
def test_a_wrong_guess_is_refused(polynomial: fmpz_poly, centers: list[acb]) -> None:
    """Discs prove nothing unless they are disjoint, complete, finite, and those of pairs off the real axis."""
    assert sharpen(polynomial, centers, 128) is None


def test_rough_guesses_are_improved() -> None:
    """From guesses with one digit Newton's method finds balls that are small, and proves the same as from good ones."""
    balls = sharpen(_CUBIC, [acb(2.1), acb(0.1, 0.9)], 128)
    assert [x.imag == 0 for x in balls] == [True, False]
    assert all(x.rad() < 2.0**-60 for x in balls)


def test_a_double_root_is_refused() -> None:
    """Two discs at a double root are never disjoint: what is not square-free has no proof."""
    assert isolate((_X - 1) ** 2 * (_X + 3)) is None


@pytest.mark.parametrize("coupled", [True, False])
@pytest.mark.parametrize("k", [2, 3, 5, 7])
def test_secular_polynomials_are_those_of_their_definition(k: int, coupled: bool) -> None:
    r"""At more points than there are degrees, $\Delta$, N_1, N_2 and Y are what linear algebra says they are."""
    rng = np.random.default_rng(k)
    c, d = rng.integers(-99, 99, (2, k)) * [[coupled], [1]]
    spread = rng.integers(-9, 9, (k, k))
    B, half = (spread @ spread.T).tolist(), 7
    whole = [[fmpz(x) for x in row] for row in (c.tolist(), d.tolist())]
    secular = _secular(Problem(fmpz_mat(B), *whole, fmpz(half), None))
    for mu in range(1, 2 * k + 3):  # no eigenvalue of B is negative
        shifted = fmpz_mat([[x + mu * (i == j) for j, x in enumerate(row)] for i, row in enumerate(B)])
        sides = fmpz_mat([[int(x), int(y)] for x, y in zip(c, d, strict=True)])
        solved = (fmpq_mat(shifted).solve(fmpq_mat(sides)) * shifted.det()).numer_denom()[0].tolist()
        Ac, Ad = (np.array(column) for column in zip(*solved, strict=True))
        n1, n2 = shifted.det() * mu + c @ Ac, shifted.det() * half - c @ Ad
        assert (secular.determinant(mu), secular.n1(mu), secular.n2(mu)) == (shifted.det(), n1, n2)
        assert [y(mu) * shifted.det() for y in secular.y] == list(n1 * Ad + n2 * Ac)
