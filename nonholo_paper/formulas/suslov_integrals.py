"""Section 6: integrals of the discrete top, their critical values, and the combinations of the last proof.

q is (q0, q1, q2); B and c are blocks of J: the inertia along the constraint, and what couples it to the forbidden axis.
"""

from collections.abc import Sequence

from nonholo_paper._twin import Matrix, Number, Vector


def quadratic(J: Matrix, M: Sequence[Number]) -> Number:
    """Return the integral (sus_int)."""
    return (J[0, 0] + J[2, 2]) * M[0] ** 2 + 2 * J[0, 1] * M[0] * M[1] + (J[1, 1] + J[2, 2]) * M[1] ** 2


def quartic(J: Matrix, q: Sequence[Number]) -> Number:
    """Return the integral (quatern_int)."""
    q0, q1, q2 = q
    form = (J[1, 1] + J[2, 2]) * q1**2 - 2 * J[0, 1] * q1 * q2 + (J[0, 0] + J[2, 2]) * q2**2
    return form * ((J[0, 2] * q1 + J[1, 2] * q2) ** 2 + determinant(J) * q0**2)


def quadratic_of_quartic(H: Number) -> Number:
    """Return the value of (sus_int) from that of (quatern_int)."""
    return 4 * H


def printed_quadratic_of_quartic(H: Number) -> Number:
    """Return the value of (sus_int) as printed: the same."""
    return H


def determinant(J: Matrix) -> Number:
    """Return D, the determinant of B."""
    return (J[0, 0] + J[2, 2]) * (J[1, 1] + J[2, 2]) - J[0, 1] ** 2


def coupling_square(J: Matrix) -> Number:
    """Return the square of the length of c."""
    return J[0, 2] ** 2 + J[1, 2] ** 2


def coupling_form(J: Matrix) -> Number:
    """Return the quadratic form of B at c."""
    first = (J[0, 0] + J[2, 2]) * J[0, 2] + J[0, 1] * J[1, 2]
    return J[0, 2] * first + J[1, 2] * ((J[1, 1] + J[2, 2]) * J[1, 2] + J[0, 1] * J[0, 2])


def critical_equation(J: Matrix) -> Vector:
    """Return the coefficients, highest first, of the quadratic equation of four times the two critical values."""
    D = determinant(J)
    middle = J[0, 0] + J[1, 1] + 2 * J[2, 2] - coupling_form(J) / D
    return [1 - coupling_square(J) / D, -middle, D]


def critical_direction(J: Matrix, mu: Number) -> Vector:
    """Return the direction (z1, z2) of the critical points with four times the critical value mu, of any length."""
    D = determinant(J)
    first = J[0, 0] + J[2, 2] - mu * (1 - J[1, 2] ** 2 / D)
    return [J[0, 1] - mu * J[0, 2] * J[1, 2] / D, -first]


def ridge(J: Matrix, u: Sequence[Number]) -> Number:
    """Return the squared sine of the half-angle at which the energy is largest along a unit vector u = (z1, z2)."""
    return 1 / (2 - 2 * (J[1, 2] * u[0] - J[0, 2] * u[1]) ** 2 / determinant(J))


def equatorial_cubic(J: Matrix, u: Sequence[Number]) -> Number:
    """Return the cubic form of u = (z1, z2) that vanishes at the critical half-turns."""
    b11, b12, b22 = J[0, 0] + J[2, 2], J[0, 1], J[1, 1] + J[2, 2]
    Bu = [b11 * u[0] + b12 * u[1], b12 * u[0] + b22 * u[1]]
    across = J[1, 2] * u[0] - J[0, 2] * u[1]
    along = J[0, 2] * u[0] + J[1, 2] * u[1]
    return (Bu[1] * u[0] - Bu[0] * u[1]) * across - (Bu[0] * u[0] + Bu[1] * u[1]) * along


def equatorial_value(J: Matrix, u: Sequence[Number]) -> Number:
    """Return the reduced energy of the half-turn with unit vector u = (z1, z2)."""
    form = (J[0, 0] + J[2, 2]) * u[0] ** 2 + 2 * J[0, 1] * u[0] * u[1] + (J[1, 1] + J[2, 2]) * u[1] ** 2
    return form * (J[1, 2] * u[0] - J[0, 2] * u[1]) ** 2 / determinant(J)


def stability_form(J: Matrix, q: Sequence[Number]) -> Number:
    """Return Q, whose sign tells stable from unstable equilibria."""
    first = J[0, 1] * J[0, 2] + J[1, 1] * J[1, 2] + J[1, 2] * J[2, 2]
    return first * q[1] - (J[0, 0] * J[0, 2] + J[0, 1] * J[1, 2] + J[0, 2] * J[2, 2]) * q[2]


def combinations(J: Matrix, M: Sequence[Number]) -> Vector:
    """Return the two combinations of momenta of the proof."""
    first = (J[0, 2] * (J[0, 0] + J[2, 2]) + J[0, 1] * J[1, 2]) * M[0]
    first += (J[1, 2] * (J[1, 1] + J[2, 2]) + J[0, 1] * J[0, 2]) * M[1]
    return [first, J[1, 2] * M[0] - J[0, 2] * M[1]]


def bracket(J: Matrix, q: Sequence[Number]) -> Number:
    """Return the square bracket of (M_1)."""
    return stability_form(J, q) + determinant(J) * q[0]


def first_of_point(J: Matrix, q: Sequence[Number]) -> Number:
    """Return the right side of (M_1)."""
    return (J[0, 2] * q[1] + J[1, 2] * q[2]) * bracket(J, q)


def second_of_point(J: Matrix, q: Sequence[Number]) -> Number:
    """Return the right side of (M_2)."""
    return stability_form(J, q) * q[0] - (J[0, 2] * q[1] + J[1, 2] * q[2]) ** 2


def scaled(M: Sequence[Number]) -> Vector:
    """Return the momenta of which (M_1) and (M_2) are true."""
    return [value / 2 for value in M]


def growth_of_second(s: Number) -> Number:
    """Return what a step adds to the second combination."""
    return 2 * s**2


def printed_growth_of_second(s: Number) -> Number:
    """Return the same as printed."""
    return s**2


def growth_of_first(s: Number, Q: Number) -> Number:
    """Return what a step adds to the first combination."""
    return -2 * s * Q


def printed_growth_of_first(s: Number, Q: Number) -> Number:
    """Return the same as printed."""
    return -s * Q


def next_first(J: Matrix, q: Sequence[Number]) -> Number:
    """Return the first combination after the step."""
    s = J[0, 2] * q[1] + J[1, 2] * q[2]
    return s * (determinant(J) * q[0] - stability_form(J, q))


def printed_next_first(J: Matrix, q: Sequence[Number]) -> Number:
    """Return the same as printed."""
    return (J[0, 2] * q[1] + J[1, 2] * q[2]) * determinant(J) * q[0]


def multiplier(J: Matrix, z0: Number, zeta: Number) -> Number:
    """Return by what a step multiplies small distances from the equilibrium with z = -zeta c."""
    D, q = determinant(J), coupling_form(J)
    return (D * z0 - zeta * q) / (D * z0 + zeta * q)
