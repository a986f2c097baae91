"""Section 4, the continuous Suslov problem: inertia tensor A, angular velocity w, forbidden axis g."""

from nonholo_paper import _twin as twin
from nonholo_paper._twin import Matrix, Number, ctx


def cross(x: Matrix, y: Matrix) -> Matrix:
    """Return the vector product."""
    return ctx.matrix([x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]])


def momentum_rate(A: Matrix, w: Matrix, g: Matrix, multiplier: Number) -> Matrix:
    """Return the right-hand side of (3.25), A w x w + lambda g."""
    return cross(A * w, w) + multiplier * g


def multiplier(A: Matrix, w: Matrix, g: Matrix) -> Number:
    """Return lambda, from the derivative of the constraint."""
    return -twin.dot(cross(A * w, w), A**-1 * g) / twin.dot(g, A**-1 * g)


def eliminated(A: Matrix, w: Matrix, g: Matrix) -> Matrix:
    """Return the display after the multiplier, a double vector product."""
    return cross(A**-1 * g, cross(cross(A * w, w), g)) / twin.dot(g, A**-1 * g)


def printed_ep3_26(A: Matrix, w: Matrix, g: Matrix) -> Matrix:
    """Return (Iw, g) w x A^-1 g."""
    return twin.dot(A * w, g) * cross(w, A**-1 * g)


def ep3_26(A: Matrix, w: Matrix, g: Matrix) -> Matrix:
    """Return (Iw, g)/(g, A^-1 g) A^-1 g x w."""
    return twin.dot(A * w, g) / twin.dot(g, A**-1 * g) * cross(A**-1 * g, w)


def velocity_integral(A: Matrix, w: Matrix) -> Number:
    """Return (w, Iw), which is twice the energy."""
    return twin.dot(w, A * w)


def momentum_integral(A: Matrix, M: Matrix) -> Number:
    """Return (M, A^-1 M)."""
    return twin.dot(M, A**-1 * M)


def degenerate_form(A: Matrix, g: Matrix) -> Matrix:
    """Return the matrix of (cont_sus_int), for principal moments on the diagonal of A."""
    i1, i2, i3 = (A[j, j] for j in range(3))
    x, y, z = g
    return ctx.matrix(
        [
            [i2 * z**2 + i3 * y**2, -i3 * x * y, -i2 * x * z],
            [-i3 * x * y, i1 * z**2 + i3 * x**2, -i1 * y * z],
            [-i2 * x * z, -i1 * y * z, i1 * y**2 + i2 * x**2],
        ]
    )


def restriction_factor(A: Matrix, g: Matrix) -> Number:
    """Return det A (g, A^-1 g), the ratio of (cont_sus_int) and (ep3.27) on the constraint."""
    return ctx.det(A) * twin.dot(g, A**-1 * g)


def reduced_integral(A: Matrix, M1: Number, M2: Number) -> Number:
    """Return (sus_int_1)."""
    return A[1, 1] * M1**2 - 2 * A[0, 1] * M1 * M2 + A[0, 0] * M2**2


def reduced_factor(A: Matrix) -> Number:
    """Return the ratio of (sus_int_1) and (ep3.27) for g = e3."""
    return A[0, 0] * A[1, 1] - A[0, 1] ** 2


def solution(B: Matrix, c: Matrix, energy: Number, phase: Number, side: int, t: Number) -> Matrix:
    """Return velocities along e_1 ^ e_3, e_2 ^ e_3 of the motion with (w, Bw) = energy, from c at -oo to -c at oo."""
    root = ctx.sqrtm(B)
    across = root**-1 * ctx.matrix([-c[1], c[0]])
    unit = across / ctx.sqrt(twin.dot(across, across))
    along = ctx.matrix([-unit[1], unit[0]])
    s = phase + ctx.sqrt(energy * twin.dot(c, B * c)) / ctx.det(B) * t
    return ctx.sqrt(energy) * (root**-1 * (side * ctx.sech(s) * unit + ctx.tanh(s) * along))


def half_angle_sine(b_along: Number, b_across: Number, coupling: Number) -> Number:
    """Return the sine of half the angle of the limit axes in space, for c an eigenvector of B with b_along."""
    square = b_across * (b_along - b_across) / coupling**2
    return abs(ctx.cos(ctx.pi / 2 * ctx.sqrt(square))) / ctx.cosh(ctx.pi / 2 * b_across / coupling)


def inertia(J: Matrix, w: Matrix) -> Matrix:
    """Return J w + w J for a skew matrix w."""
    return J * w + w * J


def pairing(X: Matrix, Y: Matrix) -> Number:
    """Return -tr(X Y)/2."""
    return -twin.trace(X * Y) / 2


def admissible(coefficients: list) -> Matrix:
    """Return the matrix (matrix_constraint): the last column of a skew matrix."""
    n = len(coefficients) + 1
    w = ctx.zeros(n)
    for i, x in enumerate(coefficients):
        w[i, n - 1], w[n - 1, i] = x, -x
    return w


def plane(n: int, i: int, j: int) -> Matrix:
    """Return e_i ^ e_j."""
    X = ctx.zeros(n)
    X[i, j], X[j, i] = 1, -1
    return X


def torque(M: Matrix, w: Matrix) -> Matrix:
    """Return [M, w], the free part of (Suslov_eq)."""
    return M * w - w * M


def multiplier_count(n: int) -> int:
    """Return the number of planes e_p ^ e_q with 1 <= p < q <= n - 1."""
    return (n - 1) * (n - 2) // 2


def printed_multiplier_count(n: int) -> int:
    """Return the number of planes with 1 < p < q <= n - 1."""
    return (n - 2) * (n - 3) // 2
