"""Linear systems of momenta and velocities: as accurate as their bodies are uneven, alone as among others."""

from typing import Any, cast

import mpmath
import numpy as np
import pytest

from nonholo.base.numerics import factors_of, of_length_one, solve_by_factors


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
        found = of_length_one(one, count)
        assert np.array_equal(found.view(np.int64), _formula(x, count).view(np.int64))
    assert np.array_equal(x, before)
    assert not np.shares_memory(of_length_one(x, count), x)


def test_other_numbers_go_by_the_formula() -> None:
    """Single precision stays what it is; what has no length is NaN, and infinite numbers give none."""
    assert of_length_one(np.array([3.0, 4.0], dtype=np.float32), 2).dtype == np.float32
    with np.errstate(invalid="ignore"):  # of plain Python
        bad = of_length_one(np.array([[0.0, 0.0, 1.0], [np.inf, 1.0, 2.0], [np.nan, 1.0, 3.0]]), 2)
    assert np.array_equal(np.isnan(bad), [[True, True, False], [True, False, False], [True, True, False]])
