"""Formulas of Section 5, the sleigh and its flow, as printed and right. A body is (m, J, a, b)."""

from collections.abc import Sequence

from nonholo_paper._twin import Matrix, Number, ctx, trace

Body = tuple[Number, Number, Number, Number]
Three = Sequence[Number]


def center_of_mass(a: Number, b: Number, pose: Three) -> tuple[Number, Number]:
    """Return the position of the center of mass."""
    theta, x, y = pose
    cosine, sine = ctx.cos(theta), ctx.sin(theta)
    return x + a * cosine - b * sine, y + a * sine + b * cosine


def energy_of_center_in_space(body: Body, pose: Three, speed: Three) -> Number:
    """Return the kinetic energy of the center of mass."""
    m, _, a, b = body
    cosine, sine = ctx.cos(pose[0]), ctx.sin(pose[0])
    omega, dx, dy = speed
    mixed = a * (dy * cosine - dx * sine) - b * (dx * cosine + dy * sine)
    return m / 2 * (dx**2 + dy**2 + (a**2 + b**2) * omega**2 + 2 * omega * mixed)


def printed_energy_of_center_in_space(body: Body, pose: Three, speed: Three) -> Number:
    """Return it with the factor m."""
    m, _, a, b = body
    cosine, sine = ctx.cos(pose[0]), ctx.sin(pose[0])
    omega, dx, dy = speed
    mixed = a * (dy * cosine - dx * sine) - b * (dx * cosine + dy * sine)
    return m * (dx**2 + dy**2 + (a**2 + b**2) * omega**2 + 2 * omega * mixed)


def energy_of_center(body: Body, velocity: Three) -> Number:
    """Return the kinetic energy of the center of mass in body components."""
    m, _, a, b = body
    omega, v1, v2 = velocity
    return m / 2 * ((a**2 + b**2) * omega**2 + v1**2 + v2**2 - 2 * b * omega * v1 + 2 * a * omega * v2)


def printed_energy_of_center(body: Body, velocity: Three) -> Number:
    """Return it with the factor m and with v1 squared."""
    m, _, a, b = body
    omega, v1, v2 = velocity
    return m * ((a**2 + b**2) * omega**2 + v1**2 + v2**2 - 2 * b * omega * v1**2 + 2 * a * omega * v2)


def lagrangian(body: Body, velocity: Three) -> Number:
    """Return the reduced Lagrangian."""
    m, J, a, b = body
    omega, v1, v2 = velocity
    mixed = 2 * m * a * omega * v2 - 2 * m * b * omega * v1
    return ((J + m * (a**2 + b**2)) * omega**2 + m * (v1**2 + v2**2) + mixed) / 2


def printed_lagrangian(body: Body, velocity: Three) -> Number:
    """Return it with v1 squared in the mixed term."""
    m, J, a, b = body
    omega, v1, v2 = velocity
    mixed = 2 * m * a * omega * v2 - 2 * m * b * omega * v1**2
    return ((J + m * (a**2 + b**2)) * omega**2 + m * (v1**2 + v2**2) + mixed) / 2


def momentum(body: Body, velocity: Three) -> tuple[Number, Number, Number]:
    """Return the body momentum."""
    m, J, a, b = body
    omega, v1, v2 = velocity
    return (J + m * (a**2 + b**2)) * omega + m * (a * v2 - b * v1), m * (v1 - b * omega), m * (v2 + a * omega)


def printed_momentum_theta(body: Body, velocity: Three) -> Number:
    """Return the angular momentum with a factor 2."""
    m, J, a, b = body
    omega, v1, v2 = velocity
    return (J + m * (a**2 + b**2)) * omega + 2 * m * (a * v2 - b * v1)


def momentum_rates(p: Three, velocity: Three) -> tuple[Number, Number, Number]:
    """Return the derivative of the body momentum without the multiplier."""
    omega, v1, v2 = velocity
    return p[1] * v2 - p[2] * v1, p[2] * omega, -p[1] * omega


def momentum_equation(body: Body, p_theta: Number, p_1: Number) -> tuple[Number, Number]:
    """Return the derivatives of p_theta and p_1."""
    m, J, a, b = body
    inertia, turning = J + m * a**2, p_theta + b * p_1
    across = m * b * p_theta + (J + m * (a**2 + b**2)) * p_1
    return -a / inertia**2 * turning * across, m * a / inertia**2 * turning**2


def energy_integral(body: Body, p_theta: Number, p_1: Number) -> Number:
    """Return the quadratic integral, 2 m (J + m a^2) times the constrained energy."""
    m, J, a, b = body
    return m * p_theta**2 + 2 * b * m * p_theta * p_1 + (J + m * (a**2 + b**2)) * p_1**2


def momentum_equation_centered(body: Body, p_theta: Number, p_1: Number) -> tuple[Number, Number]:
    """Return the derivatives of p_theta and p_1 for b = 0."""
    m, J, a, _ = body
    return -a * p_theta * p_1 / (J + m * a**2), m * a * p_theta**2 / (J + m * a**2) ** 2


def reconstruction(theta: Number, dx: Number, dy: Number) -> tuple[Number, Number]:
    """Return the velocities of the contact point along and across the blade."""
    cosine, sine = ctx.cos(theta), ctx.sin(theta)
    return dx * cosine + dy * sine, dy * cosine - dx * sine


def circle(start: Three, omega: Number, v1: Number, time: Number) -> tuple[Number, Number, Number]:
    """Return the pose on a circle; `start` has its heading at time 0 and its center."""
    theta, x, y = start
    heading = theta + omega * time
    return heading, x + v1 / omega * ctx.sin(heading), y - v1 / omega * ctx.cos(heading)


def straight(start: Three, v1: Number, time: Number) -> tuple[Number, Number, Number]:
    """Return the pose on a straight line."""
    theta, x, y = start
    return theta, x + v1 * ctx.cos(theta) * time, y + v1 * ctx.sin(theta) * time


def printed_straight(start: Three, v1: Number, time: Number) -> tuple[Number, Number, Number]:
    """Return it without the time in y."""
    theta, x, y = start
    return theta, x + v1 * ctx.cos(theta) * time, y + v1 * ctx.sin(theta)


def cusp_line(body: Body, p: Three) -> Number:
    """Return what vanishes where the contact point rests."""
    m, J, a, b = body
    return m * b * p[0] + (J + m * (a**2 + b**2)) * p[1]


def printed_cusp_line(body: Body, p: Three) -> Number:
    """Return it with p_1 and p_2 in the places of p_theta and p_1."""
    m, J, a, b = body
    return m * b * p[1] + (J + m * (a**2 + b**2)) * p[2]


def rate(body: Body, peak: Number) -> Number:
    """Return the rate of approach to the straight motion; `peak` is the largest angular velocity."""
    m, J, a, _ = body
    inertia = J + m * a**2
    return m * abs(a) * abs(peak) * ctx.sqrt(inertia / m) / inertia


def arch(body: Body, peak: Number, time: Number) -> tuple[Number, Number]:
    """Return omega and v1 along a motion that turns fastest at time 0."""
    m, J, a, b = body
    phase = rate(body, peak) * time
    omega = peak * ctx.sech(phase)
    return omega, ctx.sign(a) * abs(peak) * ctx.sqrt((J + m * a**2) / m) * ctx.tanh(phase) + b * omega


def heading(body: Body, peak: Number, time: Number) -> Number:
    """Return the heading along this motion, zero at time 0."""
    kappa = rate(body, peak)
    return peak / kappa * 2 * ctx.atan(ctx.tanh(kappa * time / 2))


def path(body: Body, peak: Number, time: Number) -> Number:
    """Return x + i y along this motion with peak > 0, up to a shift."""
    m, J, a, b = body
    kappa = rate(body, peak)
    ratio, phi = peak / kappa, 2 * ctx.atan(ctx.tanh(kappa * time / 2))
    turned = ctx.expj(ratio * phi)
    series = ctx.hyp2f1(1, ratio / 2, 1 + ratio / 2, -ctx.expj(2 * phi))
    return (J + m * a**2) / (m * a) * turned / ratio * (2 * series - 1) - 1j * b * turned


def heading_turn(body: Body) -> Number:
    """Return by how much the heading turns in all time."""
    m, J, a, _ = body
    return ctx.pi * ctx.sqrt(1 + J / (m * a**2))


def bracket(xi1: Matrix, v1: Matrix, xi2: Matrix, v2: Matrix) -> tuple[Matrix, Matrix]:
    """Return the Lie bracket of se(n) in pairs."""
    return xi1 * xi2 - xi2 * xi1, xi1 * v2 - xi2 * v1


def homogeneous_mass_tensor(mass: Number, center: Matrix, moments: list) -> Matrix:
    """Return S diag(J_1, .., J_n, m) S^T."""
    n = len(moments)
    S = ctx.eye(n + 1)
    for i in range(n):
        S[i, n] = center[i]
    return S * ctx.diag([*moments, mass]) * S.T


def trace_energy(xi: Matrix, mass_tensor: Matrix) -> Number:
    """Return the Lagrangian on SE(n) as a trace."""
    return trace(xi * mass_tensor * xi.T) / 2


def printed_trace_energy(xi: Matrix, mass_tensor: Matrix) -> Number:
    """Return it with the factor -1/4."""
    return -trace(xi * mass_tensor * xi.T) / 4


def block_energy(mass: Number, a: Matrix, J: Matrix, omega: Matrix, v: Matrix) -> Number:
    """Return the Lagrangian on SE(n) in the pair (omega, v)."""
    lever = omega * a
    return mass * trace(v.T * lever) + mass / 2 * trace(v.T * v) - trace(omega * (J + mass * a * a.T) * omega) / 2


def printed_block_energy(mass: Number, a: Matrix, J: Matrix, omega: Matrix, v: Matrix) -> Number:
    """Return it with the factor -1/4."""
    lever = omega * a
    return mass * trace(v.T * lever) + mass / 2 * trace(v.T * v) - trace(omega * (J + mass * a * a.T) * omega) / 4


def angular_momentum(mass: Number, a: Matrix, J: Matrix, omega: Matrix, v: Matrix) -> Matrix:
    """Return M of the pair (M, p)."""
    about = J + mass * a * a.T
    return about * omega + omega * about + mass * (v * a.T - a * v.T)


def linear_momentum(mass: Number, a: Matrix, omega: Matrix, v: Matrix) -> Matrix:
    """Return p of the pair (M, p)."""
    return mass * (v + omega * a)


def admissible_velocity(turning: list, v1: Number) -> Matrix:
    """Return the matrix of the constraint subspace with first row (0, omega_12, .., omega_1n, v_1)."""
    n = len(turning) + 1
    X = ctx.zeros(n + 1)
    for j, value in enumerate(turning, start=1):
        X[0, j], X[j, 0] = value, -value
    X[0, n] = v1
    return X


def admissible_velocity_in_plane(omega: Number, v1: Number) -> Matrix:
    """Return the matrix of the constraint subspace for n = 2."""
    return ctx.matrix([[0, -omega, v1], [omega, 0, 0], [0, 0, 0]])


def rates_in_space(mass: Number, a1: Number, row: list, w: list, u: Number) -> list:
    """Return the derivatives of the momenta about the foot of the center, with row = (J_12, .., J_1n), and of p_1."""
    square, mixed = ctx.fdot(w, w), ctx.fdot(row, w)
    return [square * c - mixed * wj - mass * a1 * u * wj for c, wj in zip(row, w, strict=True)] + [mass * a1 * square]
