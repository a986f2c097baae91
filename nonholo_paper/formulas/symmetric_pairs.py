"""Section 3, displacements of a symmetric pair: brackets, the involution, the model of Cartan."""

from nonholo_paper._twin import Matrix, Number, ctx


def bracket(X: Matrix, Y: Matrix) -> Matrix:
    """Return [X, Y]."""
    return X * Y - Y * X


def cartan(g: Matrix, mirror: Matrix) -> Matrix:
    """Return g sigma(g)^-1, where sigma is conjugation by a mirror matrix that is its own inverse."""
    return g * (mirror * g * mirror) ** -1


def twisted(omega: Matrix, eta: Matrix) -> Number:
    """Return the e3-part of exp(-omega) times the derivative of exp along eta, for omega, eta in the plane e1, e2."""
    angle = ctx.sqrt(omega[0] ** 2 + omega[1] ** 2)
    return -(omega[0] * eta[1] - omega[1] * eta[0]) * 2 * ctx.sin(angle / 2) ** 2 / angle**2


def quaternion_rotation(q0: Number, q1: Number, q2: Number) -> Matrix:
    """Return the rotation of a quaternion (q0, q1, q2, 0), of any length."""
    size = q0**2 + q1**2 + q2**2
    return (
        ctx.matrix(
            [
                [q0**2 + q1**2 - q2**2, 2 * q1 * q2, 2 * q0 * q2],
                [2 * q1 * q2, q0**2 - q1**2 + q2**2, -2 * q0 * q1],
                [-2 * q0 * q2, 2 * q0 * q1, q0**2 - q1**2 - q2**2],
            ]
        )
        / size
    )


def slide_and_turn(c: Number, s: Number, nu: Number) -> Matrix:
    """Return the displacement of the sleigh with half-angle (c, s) and signed length nu of its slide."""
    return ctx.matrix([[c**2 - s**2, -2 * c * s, nu * c], [2 * c * s, c**2 - s**2, nu * s], [0, 0, 1]])
