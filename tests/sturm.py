"""Real roots of polynomials with rational coefficients, counted exactly."""

from itertools import pairwise

from flint import fmpq_poly, fmpz_poly


def real_roots(polynomial: fmpz_poly) -> int:
    """Count distinct real roots by Sturm's theorem: the changes of sign that the chain of remainders loses."""
    chain = [fmpq_poly(polynomial), fmpq_poly(polynomial.derivative())]
    while chain[-1] != 0:
        chain.append(-(chain[-2] % chain[-1]))

    def changes(side: int) -> int:
        signs = [p[p.degree()] * side ** p.degree() > 0 for p in chain[:-1]]
        return sum(x != y for x, y in pairwise(signs))

    return changes(-1) - changes(1)
