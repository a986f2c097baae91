"""Linear systems of momenta and velocities: as accurate as their bodies are uneven, alone as among others."""

from typing import Any, cast

import mpmath
import numpy as np

from nonholo.base.numerics import factors_of, solve_by_factors


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
