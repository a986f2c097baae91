"""Section 6: discrete Lagrangian, momentum and displacements of the top, as printed and corrected.

Matrices are those of mpmath, indices start at 0; a displacement of the top of three dimensions is a unit vector
(q0, q1, q2).
"""

from collections.abc import Sequence

from nonholo_paper._twin import Matrix, Number, Vector, ctx, trace


def small_step(velocity: Matrix, epsilon: Number) -> Matrix:
    """Return the displacement (limits) of a short step."""
    return ctx.eye(velocity.rows) + epsilon * velocity


def printed_small_step(velocity: Matrix) -> Matrix:
    """Return the displacement (limits) without its factor."""
    return ctx.eye(velocity.rows) + velocity


def lagrangian(W: Matrix, J: Matrix) -> Number:
    """Return the discrete Lagrangian."""
    return trace(J) - trace(W * J)


def printed_lagrangian(W: Matrix, J: Matrix) -> Number:
    """Return the discrete Lagrangian as printed."""
    return trace(W * J) / 2


def small_momentum(velocity: Matrix, J: Matrix) -> Matrix:
    """Return the momentum of the continuous top."""
    return J * velocity + velocity * J


def asymmetries(W: Matrix) -> Vector:
    """Return the differences of the two sides of (sp)."""
    last = W.rows - 1
    block = [W[i, j] - W[j, i] for i in range(last) for j in range(i)]
    return block + [W[i, last] + W[last, i] for i in range(last)]


def reflected_trace(W: Matrix) -> Number:
    """Return the trace of diag(1, ..., 1, -1) W without its value on the variety."""
    last = W.rows - 1
    return trace(W) - 2 * W[last, last] - (last - 1)


def displacement(z0: Number, z: Sequence[Number]) -> Matrix:
    """Return the displacement (sp1)."""
    last = len(z)
    W = ctx.eye(last + 1)
    for i, zi in enumerate(z):
        for j, zj in enumerate(z):
            W[i, j] = W[i, j] - 2 * zi * zj
        W[i, last] = 2 * z0 * zi
        W[last, i] = -2 * z0 * zi
    W[last, last] = 2 * z0 * z0 - 1
    return W


def half_angles(theta: Number, u: Sequence[Number]) -> tuple[Number, Vector]:
    """Return the point (t->q) of the sphere: z0 and z."""
    return ctx.cos(theta / 2), [ctx.sin(theta / 2) * ui for ui in u]


def other_half_angle(theta: Number) -> Vector:
    """Return sine and cosine of half the angle from those of half of the angle that is left to a full turn."""
    rest = (2 * ctx.pi - theta) / 2
    return [ctx.sin(rest), -ctx.cos(rest)]


def printed_other_sine(theta: Number) -> Number:
    """Return the sine with the sign as printed; that of the cosine is right."""
    return -ctx.sin((2 * ctx.pi - theta) / 2)


def image_along(theta: Number, u: Matrix, last: Matrix) -> Matrix:
    """Return the image of u."""
    return ctx.cos(theta) * u - ctx.sin(theta) * last


def image_across(theta: Number, u: Matrix, last: Matrix, j: int) -> Matrix:
    """Return the image of the basis vector j, which is not the last one."""
    basis = ctx.zeros(u.rows, 1)
    basis[j] = 1
    return basis - u[j] * u + u[j] * (ctx.cos(theta) * u - ctx.sin(theta) * last)


def image_of_last(theta: Number, u: Matrix, last: Matrix) -> Matrix:
    """Return the image of the last basis vector."""
    return ctx.cos(theta) * last + ctx.sin(theta) * u


def trace_constraint(R: Matrix, after: Matrix, i: int, j: int) -> Number:
    """Return the constraint that forbids the plane of i and j, both below n."""
    product = R.T * after
    return product[j, i] - product[i, j]


def printed_trace_constraint(R: Matrix, after: Matrix, j: int) -> Number:
    """Return the constraint as printed, for j below n."""
    plane = ctx.zeros(R.rows)
    plane[j, R.rows - 1] = 1
    plane[R.rows - 1, j] = -1
    return trace(R.T * plane * after - after.T * plane * R)


def printed_constraint_count(n: int) -> int:
    """Return how many constraints are printed."""
    return n - 1


def rotation_axis(z: Sequence[Number]) -> Vector:
    """Return the axis about which the displacement turns to the left."""
    return [-z[1], z[0], 0]


def printed_rotation_axis(z: Sequence[Number]) -> Vector:
    """Return the axis as printed."""
    return [z[1], -z[0], 0]


def rodrigues(q0: Number, q1: Number, q2: Number, q3: Number) -> Matrix:
    """Return the matrix (Rod)."""
    return ctx.matrix(
        [
            [q0**2 + q1**2 - q2**2 - q3**2, 2 * (q1 * q2 + q3 * q0), -2 * (q1 * q3 - q2 * q0)],
            [2 * (q1 * q2 - q3 * q0), q0**2 + q2**2 - q1**2 - q3**2, -2 * (q2 * q3 + q0 * q1)],
            [-2 * (q1 * q3 + q2 * q0), -2 * (q2 * q3 - q0 * q1), q0**2 + q3**2 - q1**2 - q2**2],
        ]
    )


def rodrigues_vector(q1: Number, q2: Number, q3: Number) -> Vector:
    """Return the vector about which (Rod) turns."""
    return [q1, q2, -q3]


def printed_rodrigues_vector(q1: Number, q2: Number, q3: Number) -> Vector:
    """Return the vector as printed."""
    return [q1, q2, q3]


def asymmetry_of_rodrigues(q0: Number, q3: Number) -> Number:
    """Return what the entries 12 and 21 of (Rod) differ by."""
    return 4 * q0 * q3


def admissible(q0: Number, q1: Number, q2: Number) -> Matrix:
    """Return the displacement (PE)."""
    return ctx.matrix(
        [
            [2 * (q0**2 + q1**2) - 1, 2 * q1 * q2, 2 * q0 * q2],
            [2 * q1 * q2, 2 * (q0**2 + q2**2) - 1, -2 * q0 * q1],
            [-2 * q0 * q2, 2 * q0 * q1, 2 * q0**2 - 1],
        ]
    )


def quaternion(z: Sequence[Number]) -> Vector:
    """Return q1 and q2 of the coordinates z1 and z2."""
    return [-z[1], z[0]]


def position(start: Matrix, steps: Sequence[Matrix]) -> Matrix:
    """Return the position after some displacements."""
    R = start
    for W in steps:
        R = R * W
    return R


def printed_position(steps: Sequence[Matrix]) -> Matrix:
    """Return the position as printed."""
    R = ctx.eye(steps[0].rows)
    for W in steps:
        R = W * R
    return R
