"""Functions of matrices, linear systems, real roots: against SciPy, series and mpmath, alone and in company."""

from typing import Any, cast

import mpmath
import numpy as np
import pytest
import scipy.linalg

from nonholo.base import numerics
from nonholo.base.numerics import _functions, factors_of, of_length_one, real_cubic_roots, solve_by_factors


@pytest.mark.parametrize("angle", [0.0, 1e-6, 0.1, 0.999999, 1.000001, 2.0, np.pi, 6.0])
def test_cotangent_deficit(angle: float) -> None:
    """(1 - (t/2) cot(t/2)) / t^2 in double precision against forty digits."""
    with mpmath.workdps(40):
        t = mpmath.mpf(angle)
        exact = float((1 - t / 2 * mpmath.cot(t / 2)) / t**2) if angle else 1 / 12
    assert abs(float(_functions.cotangent_deficit(np.float64(angle**2))) / exact - 1) < 4e-15


@pytest.mark.parametrize("size", [1e-8, 0.4, 0.6, 3.0, 20.0])
def test_integrated_exponential(size: float) -> None:
    """phi_1(X) is the upper right block of an augmented exponential, here to forty digits."""
    X = size * np.random.default_rng(0).normal(size=(3, 4, 4)) / 4
    augmented = np.block([[X, np.broadcast_to(np.eye(4), X.shape)], [np.zeros((3, 4, 8))]])
    with mpmath.workdps(40):
        tables = [mpmath.expm(mpmath.matrix(A.tolist()), method="taylor").tolist() for A in augmented]
    exact = np.array(tables, dtype=float)[:, :4, 4:]
    assert np.abs(_functions.integrated_exponential(X) - exact).max() <= 4e-15 * np.abs(exact).max()


def test_exponentials_of_one_stack_do_not_disturb_each_other() -> None:
    """A matrix of norm 30 makes all be halved together; the small one keeps its relative accuracy."""
    small = 1e-10 * np.array([[0.0, 1.0], [2.0, 0.5]])
    result = _functions.exponential_increment(np.stack([small, 30 * np.eye(2)]))
    assert np.abs(result[0] - (small + small @ small / 2)).max() < 1e-24
    assert np.abs(result[1] / np.expm1(30.0) - np.eye(2)).max() < 1e-14


@pytest.mark.parametrize("halvings", [1, 2, 3])
def test_principal_logarithm_of_a_general_matrix(halvings: int) -> None:
    """The logarithm of matrices without structure, with real and complex eigenvalues."""
    X = np.random.default_rng(1).normal(size=(20, 5, 5)) / 2
    assert np.abs(_functions.principal_logarithm(scipy.linalg.expm(X), halvings) - X).max() < 1e-12


def test_function_of_skew_matrices() -> None:
    """Exp through eigenvectors is Pade's, with angles that coincide and a zero matrix."""
    X = np.zeros((2, 4, 4))
    X[0, 0, 1], X[0, 2, 3] = 1.5, 1.5
    X = X - np.swapaxes(X, 1, 2)
    assert np.abs(_functions.of_skew(X, lambda angle: np.exp(1j * angle)) - scipy.linalg.expm(X)).max() < 1e-15 * 4


def test_block_diagonal_broadcasts() -> None:
    """Stacks of blocks become stacks of matrices."""
    a, b = np.ones((3, 1, 1)), np.full((3, 2, 2), 2.0)
    assert np.array_equal(_functions.block_diagonal([a, b])[1], scipy.linalg.block_diag(a[1], b[1]))


def test_energies_of_uneven_bodies_have_all_their_digits() -> None:
    """Inertias over sixteen decades: the energy of substitution errs by rounding, that of an inverse by more."""
    rng, errors = np.random.default_rng(0), np.zeros((2, 40))
    for error in errors.T:
        k = int(rng.integers(2, 6))
        A, scales = rng.normal(size=(k, k)), np.diag(10.0 ** rng.uniform(-4, 4, k))
        inertia = scales @ (A @ A.T + 0.1 * np.eye(k)) @ scales
        inertia, p = (inertia + inertia.T) / 2, scales @ rng.normal(size=k)
        with mpmath.workdps(60):
            x = mpmath.lu_solve(mpmath.matrix(inertia.tolist()), mpmath.matrix(p.tolist()))
            energy = mpmath.fdot(x, mpmath.matrix(p.tolist()))
            both = p @ solve_by_factors(cast(Any, factors_of(inertia)), p[None])[0], p @ np.linalg.inv(inertia) @ p
            error[:] = [float(abs(mpmath.mpf(float(value)) - energy) / energy) for value in both]
    assert errors[0].max() < 1e-14  # a few dozen roundings
    assert errors[1].max() > 1e-14


def test_solutions_of_a_row_are_those_of_many() -> None:
    """One matrix for all rows, or one for each: the same bits as alone."""
    rng = np.random.default_rng(1)
    A, rows = rng.normal(size=(5, 5)), rng.normal(size=(30, 5))
    A = A @ A.T + np.eye(5)
    of_one = cast(Any, factors_of(A))
    alone = np.concatenate([solve_by_factors(of_one, row[None]) for row in rows])
    assert np.array_equal(solve_by_factors(of_one, rows), alone)
    assert np.array_equal(solve_by_factors(cast(Any, factors_of(np.tile(A, (30, 1, 1)))), rows), alone)
    assert np.abs(A @ alone[..., None] - rows[..., None]).max() < 1e-13


def _formula(x: np.ndarray, count: int) -> np.ndarray:
    squares = x[..., :1] * x[..., :1]
    for m in range(1, count):
        squares = squares + x[..., m : m + 1] * x[..., m : m + 1]
    return np.concatenate([x[..., :count] / np.sqrt(squares), x[..., count:]], axis=-1)


@pytest.mark.parametrize(("shape", "count"), [((4,), 4), ((500, 4), 4), ((3, 7, 4), 2), ((0, 4), 2), ((60, 9), 4)])
def test_rows_have_the_bits_of_the_formula(shape: tuple[int, ...], count: int) -> None:
    """In any shape and order in memory, for one row and for many, with zeros of both signs and uneven sizes."""
    rng = np.random.default_rng(7)
    x = rng.normal(size=shape) * 10.0 ** rng.integers(-120, 120, shape)
    x[..., 1:2] *= -0.0
    wide = np.repeat(x, 2, axis=-1)[..., ::2]
    before = x.copy()
    for one in (x, wide, np.asfortranarray(x)):
        result = of_length_one(one, count)
        assert np.array_equal(result.view(np.int64), _formula(x, count).view(np.int64))
    assert np.array_equal(x, before)
    assert not np.shares_memory(of_length_one(x, count), x)


def test_other_numbers_go_by_the_formula() -> None:
    """Single precision stays what it is; what has no length is NaN, and infinite numbers give none."""
    assert of_length_one(np.array([3.0, 4.0], dtype=np.float32), 2).dtype == np.float32
    with np.errstate(invalid="ignore"):  # of plain Python
        bad = of_length_one(np.array([[0.0, 0.0, 1.0], [np.inf, 1.0, 2.0], [np.nan, 1.0, 3.0]]), 2)
    assert np.array_equal(np.isnan(bad), [[True, True, False], [True, False, False], [True, True, False]])


def _drawn(kind: str, rng: np.random.Generator) -> tuple[float, ...]:
    """Draw coefficients of a cubic that is hard in some way."""
    sign, small = rng.choice([-1.0, 1.0]), 10.0 ** rng.uniform(-30, -5)
    s, t = rng.choice(np.arange(-50.0, 50.0), 2, replace=False)
    roots = {
        "double root": (s, s, t),
        "triple root": (s, s, s),
        "nearly double root": (s, s * (1 + 10.0 ** rng.uniform(-12, -4)), t),
        "roots of different size": rng.normal(size=3) * 10.0 ** rng.uniform(-12, 12, 3),
        "simple integers": rng.choice(np.arange(-50.0, 50.0), 3, replace=False),
    }
    if kind in roots:
        x, y, z = roots[kind]
        return 1.0, -(x + y + z), x * y + y * z + z * x, -x * y * z
    return {
        "tiny leading coefficient": (sign * small, *rng.normal(size=3)),
        "coefficients of different size": tuple(rng.normal(size=4) * 10.0 ** rng.uniform(-8, 8, 4)),
        "a root at zero": (*rng.normal(size=3), 0.0),
        "few terms": (rng.uniform(0.1, 5.0), *rng.choice([0.0, 1.0], 3) * rng.uniform(-5.0, 5.0, 3)),
        "sleigh of little push": (small, -s * small, 2.0, -s * small),
    }[kind]


KINDS = ["double root", "triple root", "nearly double root", "roots of different size", "simple integers"]
KINDS += ["tiny leading coefficient", "coefficients of different size", "a root at zero", "sleigh of little push"]
KINDS += ["few terms"]


@pytest.mark.parametrize("kind", KINDS)
def test_hard_cubics(kind: str) -> None:
    """All real roots; each has a backward error of rounding, and a simple one lies as near to a true one as that lets.

    Horner's rule rounds each of the four terms three times at most, and Newton's method ends where that hides the rest.
    """
    rng, eps = np.random.default_rng(1), 2.0**-52
    for _ in range(200):
        coefficients = tuple(map(float, _drawn(kind, rng)))
        count, *result = real_cubic_roots(*coefficients)
        with mpmath.workdps(60):
            a, b, c, d = map(mpmath.mpf, coefficients)
            roots = list(map(mpmath.mpf, result))
            sizes = [mpmath.fsum(map(abs, (a * t**3, b * t**2, c * t, d))) for t in roots]

            def value(t: mpmath.mpf) -> mpmath.mpf:
                return ((a * t + b) * t + c) * t + d  # noqa: B023

            assert all(abs(value(t)) <= 2 * eps * size for t, size in zip(roots, sizes, strict=True)), coefficients
            terms = b**2 * c**2, -4 * a * c**3, -4 * b**3 * d, 18 * a * b * c * d, -27 * a**2 * d**2
            discriminant = mpmath.fsum(terms)
            if abs(discriminant) <= 100 * eps * mpmath.fsum(map(abs, terms)):
                continue  # roots that rounding of the coefficients makes double or complex
            assert count == len(set(result)) == (3 if discriminant > 0 else 1), coefficients
            for t, size in zip(roots, sizes, strict=True):
                bound = 4 * eps * size / abs(3 * a * t**2 + 2 * b * t + c)
                assert mpmath.sign(value(t - bound)) * mpmath.sign(value(t + bound)) <= 0, coefficients


@pytest.mark.parametrize("squared", [0.0, 1e-300, 1e-12, 9.9e-4, 1.01e-3, 1.0, 9.8, np.pi**2])
def test_even_functions_to_rounding(squared: float) -> None:
    """sinc, versine and half cotangent are accurate on both sides of their switch to series."""
    with mpmath.workdps(40):
        half = mpmath.sqrt(mpmath.mpf(squared)) / 2
        cosine = half * mpmath.cot(half) if squared else 1
        exact = mpmath.sinc(2 * half), mpmath.sinc(half) ** 2 / 2, cosine
    functions = numerics.sinc, numerics.versine, numerics.half_cotangent
    for function, value in zip(functions, exact, strict=True):
        assert abs(float(function(np.float64(squared))) - float(value)) < 4e-16
