"""Section 6: momenta of the top of three dimensions as functions of (q0, q1, q2), as printed and corrected."""

from collections.abc import Sequence

from nonholo_paper._twin import Matrix, Number, Vector


def slope(J: Matrix, q: Sequence[Number]) -> Number:
    """Return the linear form that vanishes on the line of equilibria."""
    return J[0, 2] * q[1] + J[1, 2] * q[2]


def diagonal_momentum(masses: Sequence[Number], q: Sequence[Number]) -> Vector:
    """Return the momentum where J is diagonal."""
    (J1, J2, J3), (q0, q1, q2) = masses, q
    return [2 * (J2 + J3) * q0 * q1, 2 * (J1 + J3) * q0 * q2, 2 * (J1 - J2) * q1 * q2]


def steiner(masses: Sequence[Number], M: Sequence[Number]) -> Number:
    """Return the left side of (Steiner)."""
    (J1, J2, J3), (M1, M2, M3) = masses, M
    A1, A2, difference = J2 + J3, J1 + J3, J1 - J2
    squares = difference / (A1 * A2) * M1**2 * M2**2
    squares += A2 / (A1 * difference) * M1**2 * M3**2 + A1 / (A2 * difference) * M2**2 * M3**2
    return squares - 2 * M1 * M2 * M3


def elliptic_disc(masses: Sequence[Number], M: Sequence[Number]) -> Number:
    """Return the quadratic form that is at most one on the locus where J1 = J2."""
    J1, J2, J3 = masses
    return (M[0] / (J2 + J3)) ** 2 + (M[1] / (J1 + J3)) ** 2


def momentum(J: Matrix, q: Sequence[Number]) -> Vector:
    """Return the momentum (full)."""
    q0, q1, q2 = q
    s = slope(J, q)
    return [
        2 * ((J[1, 1] + J[2, 2]) * q0 * q1 - J[0, 1] * q0 * q2 - s * q2),
        2 * ((J[0, 0] + J[2, 2]) * q0 * q2 - J[0, 1] * q0 * q1 + s * q1),
        2 * ((J[0, 0] - J[1, 1]) * q1 * q2 - J[0, 1] * (q1 * q1 - q2 * q2) - s * q0),
    ]


def arriving(J: Matrix, q: Sequence[Number]) -> Vector:
    """Return the turned momentum (full-1)."""
    q0, q1, q2 = q
    s = slope(J, q)
    return [
        2 * ((J[1, 1] + J[2, 2]) * q0 * q1 - J[0, 1] * q0 * q2 + s * q2),
        2 * ((J[0, 0] + J[2, 2]) * q0 * q2 - J[0, 1] * q0 * q1 - s * q1),
        2 * (-(J[0, 0] - J[1, 1]) * q1 * q2 + J[0, 1] * (q1 * q1 - q2 * q2) - s * q0),
    ]


def turned_difference(W: Matrix, J: Matrix) -> Matrix:
    """Return the turned momentum as a difference of products."""
    return J * W - W.T * J


def multiplier_matrix(multiplier: Number) -> list[list[Number]]:
    """Return the last term of (suslov)."""
    return [[0, multiplier, 0], [-multiplier, 0, 0], [0, 0, 0]]


def change(J: Matrix, q: Sequence[Number], multiplier: Number) -> Vector:
    """Return what (diff_suslov) adds to the momentum, with the multiplier of this equation."""
    _, q1, q2 = q
    s = slope(J, q)
    third = -(J[0, 0] - J[1, 1]) * q1 * q2 + J[0, 1] * (q1**2 - q2**2) + multiplier
    return [4 * s * q2, -4 * s * q1, 4 * third]


def multiplier_of_vector(multiplier: Number) -> Number:
    """Return the multiplier of (diff_suslov) from that of (suslov)."""
    return -multiplier / 4


def printed_multiplier_of_vector(multiplier: Number) -> Number:
    """Return the multiplier of (diff_suslov) as printed: the same."""
    return multiplier


def restricted(J: Matrix, q: Sequence[Number]) -> Vector:
    """Return the right sides of (sys)."""
    return [2 * value for value in printed_restricted(J, q)]


def printed_restricted(J: Matrix, q: Sequence[Number]) -> Vector:
    """Return the right sides of (sys) as printed."""
    q0, q1, q2 = q
    return [
        ((J[1, 1] + J[2, 2]) * q1 - J[0, 1] * q2) * q0 - (J[0, 2] * q1 + J[1, 2] * q2) * q2,
        ((J[0, 0] + J[2, 2]) * q2 - J[0, 1] * q1) * q0 + (J[0, 2] * q1 + J[1, 2] * q2) * q1,
    ]


def last(J: Matrix, q: Sequence[Number]) -> Number:
    """Return the last component of the momentum, step 3."""
    return 2 * printed_last(J, q)


def printed_last(J: Matrix, q: Sequence[Number]) -> Number:
    """Return the last component as printed."""
    q0, q1, q2 = q
    return (J[0, 0] - J[1, 1]) * q1 * q2 - J[0, 1] * (q1**2 - q2**2) - (J[0, 2] * q1 + J[1, 2] * q2) * q0
