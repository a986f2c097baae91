"""Real roots of polynomials with rational coefficients, counted exactly."""

from itertools import pairwise

import numpy as np
from flint import fmpq_poly, fmpz_poly

import nonholo as nh
from nonholo.discrete.certificate._certificate import locate
from nonholo.discrete.certificate._roots import problem_of


def real_roots(polynomial: fmpz_poly) -> int:
    """Count distinct real roots by Sturm's theorem: the changes of sign that the chain of remainders loses."""
    chain = [fmpq_poly(polynomial), fmpq_poly(polynomial.derivative())]
    while chain[-1] != 0:
        chain.append(-(chain[-2] % chain[-1]))

    def changes(side: int) -> int:
        signs = [p[p.degree()] * side ** p.degree() > 0 for p in chain[:-1]]
        return sum(x != y for x, y in pairwise(signs))

    return changes(-1) - changes(1)


def assert_counted(discrete: nh.Discretization, r: list[float] | np.ndarray) -> None:
    """Compare the real values over a momentum, in each factor of their polynomial, with the exact count."""
    canonical = discrete.system.to_canonical(np.array(r, dtype=float))
    result = locate(problem_of(discrete.system.canonical.normal_form, float(discrete.time_step), canonical))
    assert [sum(mu.imag == 0 for mu in x.balls) for x in result] == [real_roots(x.factor) for x in result]
