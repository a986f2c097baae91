"""Formulas of Section 7, the discrete sleigh, as printed and right. A body is (m, J, a, b), a pose (theta, x, y)."""

from collections.abc import Sequence

from nonholo_paper._twin import Matrix, Number, ctx, trace

Body = tuple[Number, Number, Number, Number]
Three = Sequence[Number]


def step_angle(before: Three, after: Three) -> Number:
    """Return the angle of a displacement."""
    return after[0] - before[0]


def printed_step_angle(before: Three, after: Three) -> Number:
    """Return it with a cosine too much."""
    return after[0] - ctx.cos(before[0])


def discrete_velocities(before: Three, after: Three) -> tuple[Number, Number]:
    """Return V_1 and V_2."""
    dx, dy = after[1] - before[1], after[2] - before[2]
    cosine, sine = ctx.cos(before[0]), ctx.sin(before[0])
    return dx * cosine + dy * sine, dy * cosine - dx * sine


def displacement(before: Three, after: Three, angle: Number) -> Matrix:
    """Return the matrix of the helical displacement; `angle` is the step angle."""
    V_1, V_2 = discrete_velocities(before, after)
    cosine, sine = ctx.cos(angle), ctx.sin(angle)
    return ctx.matrix([[cosine, -sine, V_1], [sine, cosine, V_2], [0, 0, 1]])


def mass_tensor(body: Body) -> Matrix:
    """Return the homogeneous mass tensor, with J about the center of mass."""
    m, J, a, b = body
    rows = [[J / 2 + m * a**2, m * a * b, m * a], [m * a * b, J / 2 + m * b**2, m * b], [m * a, m * b, m]]
    return ctx.matrix(rows)


def printed_mass_tensor(body: Body) -> Matrix:
    """Return it with J2, read as 2 J."""
    m, J, a, b = body
    rows = [[J / 2 + m * a**2, m * a * b, m * a], [m * a * b, 2 * J + m * b**2, m * b], [m * a, m * b, m]]
    return ctx.matrix(rows)


def trace_lagrangian(W: Matrix, tensor: Matrix) -> Number:
    """Return the discrete Lagrangian as a trace, up to a constant."""
    return trace(W * tensor * W.T) / 2 - trace(tensor * W.T + W * tensor) / 2


def printed_trace_lagrangian(W: Matrix, tensor: Matrix) -> Number:
    """Return it with another letter in the last product, read as the identity."""
    return trace(W * tensor * W.T) / 2 - trace(tensor * W.T + W) / 2


def scalar_lagrangian(body: Body, before: Three, after: Three) -> Number:
    """Return the discrete Lagrangian in coordinates."""
    m, J, a, b = body
    dx, dy = after[1] - before[1], after[2] - before[2]
    sines, cosines = ctx.sin(after[0]) - ctx.sin(before[0]), ctx.cos(after[0]) - ctx.cos(before[0])
    turning = (J + m * a**2 + m * b**2) * (1 - ctx.cos(after[0] - before[0]))
    mixed = a * m * (sines * dy + cosines * dx) + b * m * (cosines * dy - sines * dx)
    return m / 2 * dy**2 + m / 2 * dx**2 + turning + mixed


def momentum(body: Body, angle: Number, V_1: Number, V_2: Number) -> tuple[Number, Number, Number]:
    """Return the discrete momentum."""
    m, J, a, b = body
    sine, versine = ctx.sin(angle), 1 - ctx.cos(angle)
    p_theta = (J + m * a**2 + m * b**2) * sine + a * m * V_2 - b * m * V_1
    return p_theta, m * V_1 - a * m * versine - b * m * sine, m * V_2 + a * m * sine - b * m * versine


def coadjoint(p: Three, angle: Number, V_1: Number, V_2: Number) -> tuple[Number, Number, Number]:
    """Return the coadjoint action of a displacement on a momentum."""
    cosine, sine = ctx.cos(angle), ctx.sin(angle)
    return p[0] - p[2] * V_1 + p[1] * V_2, cosine * p[1] + sine * p[2], cosine * p[2] - sine * p[1]


def naive_constraint(before: Three, after: Three) -> Number:
    """Return what the naive constraint puts to zero."""
    return (after[2] - before[2]) * ctx.cos(before[0]) - (after[1] - before[1]) * ctx.sin(before[0])


def quotients(W: Matrix) -> tuple[Number, Number]:
    """Return the two quotients of entries that are equal on exp d."""
    return W[1, 2] / W[0, 2], (1 - W[0, 0]) / W[1, 0]


def half_angle_constraint(angle: Number, V_1: Number, V_2: Number) -> Number:
    """Return what defines exp d."""
    return V_2 * ctx.cos(angle / 2) - V_1 * ctx.sin(angle / 2)


def full_angle_constraint(angle: Number, V_1: Number, V_2: Number) -> Number:
    """Return what vanishes on exp d, and also where the angle is zero."""
    return V_1 * (1 - ctx.cos(angle)) - V_2 * ctx.sin(angle)


def constraint_in_space(before: Three, after: Three) -> Number:
    """Return what the constraint puts to zero, in coordinates of space."""
    middle = (after[0] + before[0]) / 2
    return (after[2] - before[2]) * ctx.cos(middle) - (after[1] - before[1]) * ctx.sin(middle)


def exponential(omega: Number, v: Number, time: Number) -> Matrix:
    """Return the exponential of an admissible velocity."""
    angle = omega * time
    cosine, sine = ctx.cos(angle), ctx.sin(angle)
    return ctx.matrix([[cosine, -sine, v / omega * sine], [sine, cosine, v / omega * (1 - cosine)], [0, 0, 1]])


def tangent_velocities(before: Three, after: Three) -> tuple[Number, Number]:
    """Return V_1 and V_2 from the second heading."""
    dx, dy = after[1] - before[1], after[2] - before[2]
    cosine, sine = ctx.cos(after[0]), ctx.sin(after[0])
    return dx * cosine + dy * sine, dx * sine - dy * cosine


def cubic_in_sine(J: Number, p_theta: Number, p_hat: Number, z: Number) -> Number:
    """Return the cubic of the sine of the step angle."""
    return J**2 * z**3 - 2 * J * p_theta * z**2 + (p_hat**2 + 2 * J * p_hat + p_theta**2) * z - 2 * p_theta * p_hat


def cubic(J: Number, p_theta: Number, p_hat: Number) -> list[Number]:
    """Return the coefficients of the cubic of the tangent of half the step angle."""
    return [p_hat, -p_theta, 2 * J + p_hat, -p_theta]


def discriminant_curve(J: Number, p_theta: Number, p_hat: Number) -> Number:
    """Return what vanishes where branches meet: a deltoid."""
    quadratic = p_hat**2 * (12 * J**2 + 2 * p_theta**2)
    return (
        p_hat**4
        + 6 * J * p_hat**3
        + quadratic
        - p_hat * (10 * J * p_theta**2 - 8 * J**3)
        + p_theta**4
        - J**2 * p_theta**2
    )


def ellipse(body: Body, angle: Number) -> tuple[Number, Number]:
    """Return the point (p_theta, p_hat) over which V_1 vanishes."""
    m, J, a, _ = body
    return (J + m * a**2) * ctx.sin(angle), m * a**2 * (1 + ctx.cos(angle))


def quartic(body: Body, p_theta: Number, p_1: Number, angle: Number) -> Number:
    """Return the condition on the step angle, which the angle zero always satisfies."""
    m, J, a, _ = body
    sine = ctx.sin(angle)
    return J * sine**2 - p_theta * sine + (2 * m * a**2 + a * p_1) * (1 - ctx.cos(angle))


def conoid(J: Number, turning: Number, p_hat: Number, across: Number) -> Number:
    """Return the cubic of the momentum locus; `across` is a p_2."""
    return (turning - across) * (p_hat**2 + across**2) - 2 * J * p_hat * across


def next_in_space(body: Body, before: Three, after: Three) -> tuple[Number, Number]:
    """Return the first two momenta after the step in coordinates of space."""
    p_theta, p_1 = _turned(body, before, after)
    m, _, a, _ = body
    return p_theta, p_1 + a * m * (1 - ctx.cos(after[0] - before[0]))


def printed_next_in_space(body: Body, before: Three, after: Three) -> tuple[Number, Number]:
    """Return them with a length instead of an angle."""
    p_theta, p_1 = _turned(body, before, after)
    m, _, a, _ = body
    dx, dy = after[1] - before[1], after[2] - before[2]
    return p_theta, p_1 + a * m * (dx * ctx.cos(after[0]) + dy * ctx.sin(after[0]))


def _turned(body: Body, before: Three, after: Three) -> tuple[Number, Number]:
    m, J, a, b = body
    dx, dy = after[1] - before[1], after[2] - before[2]
    V_1 = discrete_velocities(before, after)[0]
    sine = ctx.sin(after[0] - before[0])
    along = dy * ctx.cos(after[0]) - dx * ctx.sin(after[0])
    return (J + m * a**2 + m * b**2) * sine - b * m * V_1 + a * m * along, m * V_1 - b * m * sine


def next_momenta(body: Body, p_theta: Number, p_1: Number, angle: Number, V_2: Number) -> tuple[Number, Number]:
    """Return the first two momenta after the step."""
    m, _, a, _ = body
    return p_theta - 2 * a * m * V_2, p_1 + 2 * a * m * (1 - ctx.cos(angle))


def printed_third_step(body: Body, angle: Number, V_1: Number) -> tuple[Number, Number]:
    """Return the momenta of an admissible displacement with a quotient that angles 0 and pi do not have."""
    m, J, a, b = body
    sine, versine = ctx.sin(angle), 1 - ctx.cos(angle)
    p_theta = (J + m * a**2 + m * b**2) * sine + (a * m * versine / sine - b * m) * V_1
    return p_theta, m * V_1 - a * m * versine - b * m * sine


def third_step(body: Body, p_1: Number, t: Number) -> tuple[Number, Number, Number]:
    """Return sine of the angle, V_1 and V_2 of the displacement with tangent t of half its angle."""
    m, _, a, b = body
    sine, versine = 2 * t / (1 + t**2), 2 * t**2 / (1 + t**2)
    V_1 = (p_1 + a * m * versine + b * m * sine) / m
    return sine, V_1, t * V_1


def multiplier(body: Body, angle: Number, p_2: Number, next_p_2: Number) -> Number:
    """Return the multiplier of a step."""
    m, _, a, _ = body
    return next_p_2 + p_2 - 2 * a * m * ctx.sin(angle)


def radius(angle: Number, V_1: Number) -> Number:
    """Return the radius of the circle of a displacement."""
    return V_1 / ctx.sin(angle)


def bound_of_the_theorem(body: Body) -> Number:
    """Return the value of the integral below which the map is single-valued by the theorem."""
    m, J, a, _ = body
    return m**2 * a**2 * (J + m * a**2)


def sharp_bound(body: Body) -> Number:
    """Return the least value of the integral on the deltoid."""
    m, J, a, _ = body
    ours = m * a**2
    at_cusp = (J / 4 - 2 * ours) ** 2 + 27 * ours * J**2 / (16 * (J + ours))
    return (J + ours) / a**2 * min(4 * ours**2, at_cusp)


def on_line(q: Matrix, nu: Number) -> Matrix:
    """Return the displacement of a point nu q on the line of a unit vector q."""
    n = q.rows
    W = ctx.eye(n + 1)
    for i in range(n):
        for j in range(n):
            turned = 2 * q[i] * q[j] - (1 if i == j else 0)
            W[i, j] = turned if j == 0 else -turned
        W[i, n] = nu * q[i]
    return W


def deltoid(J: Number, t: Number) -> tuple[Number, Number]:
    """Return the point (p_theta, p_hat) of the discriminant curve with double root t."""
    return 4 * J * t**3 / (1 + t**2) ** 2, -2 * J * (1 - t**2) / (1 + t**2) ** 2


def upper_cusp(J: Number) -> tuple[Number, Number]:
    """Return the constants c_1 and c_2 of the cusps."""
    return 3 * ctx.sqrt(3) / 4 * J, J / 4


def tangency(J: Number, p_theta: Number, p_hat: Number, side: int) -> Number:
    """Return the value of the cubic at the plane z = side, whose double zero is the line of tangency."""
    return side * (J - side * p_theta + p_hat) ** 2


def unit_cubic(J: Number, turning: Number, p_hat: Number, U: Number) -> Number:
    """Return the cubic of U, the exponential of i times the step angle."""
    kappa = (2j * turning - 2 * p_hat - J) / J
    return U**3 - kappa * U**2 + ctx.conj(kappa) * U - 1


def spiral(angle: Number, V_1: Number, count: int) -> Number:
    """Return x + i y after steps with the naive constraint and a = b = 0, from the origin."""
    ratio = ctx.cos(angle) * ctx.expj(angle)
    return V_1 / (1 - ratio) * (1 - ratio**count)


def half_plane(body: Body, p_hat: Number, t: Number) -> tuple[Number, Number]:
    """Return what both have to be positive for p_theta + b p_1 to keep its sign, for p_hat > 0 the second suffices."""
    m, J, a, _ = body
    return 2 * J + p_hat * (1 + t**2), 2 * J + 4 * m * a**2 - p_hat * (1 + t**2)
