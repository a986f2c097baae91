"""Sections 2 and 3: equations of motion, energies, momenta on any matrix group. Vectors and covectors are columns."""

from collections.abc import Sequence

from nonholo.groups import AbstractMatrixGroup
from nonholo_paper import _twin as twin
from nonholo_paper._twin import Matrix, Number, ctx


def energy(p: Matrix, velocity: Matrix, lagrangian: Number) -> Number:
    """Return <p, v> - L."""
    return twin.dot(p, velocity) - lagrangian


def euler_lagrange(rate: Matrix, slope: Matrix) -> Matrix:
    """Return the left-hand side of the equations with multipliers, d/dt dL/dv - dL/dq."""
    return rate - slope


def reaction(multipliers: Sequence[Number], forms: Sequence[Matrix]) -> Matrix:
    """Return the sum of multipliers times forms."""
    total = 0 * forms[0]
    for multiplier, form in zip(multipliers, forms, strict=True):
        total = total + multiplier * form
    return total


def body_velocity(g: Matrix, rate: Matrix) -> Matrix:
    """Return g^-1 g'."""
    return g**-1 * rate


def reconstructed_rate(g: Matrix, velocity: Matrix) -> Matrix:
    """Return g' = g omega."""
    return g * velocity


def momentum_rate(torque: Matrix, multipliers: Sequence[Number], forms: Sequence[Matrix]) -> Matrix:
    """Return p' of the Euler-Poincare-Suslov equations; the torque is ad*_omega p."""
    return torque + reaction(multipliers, forms)


def half_form(matrix: Matrix, vector: Matrix, count: int) -> Number:
    """Return half the quadratic form of the first `count` coordinates."""
    return ctx.fsum(matrix[i, j] * vector[i] * vector[j] for i in range(count) for j in range(count)) / 2


def spatial_momentum(group: AbstractMatrixGroup, g: Matrix, p: Matrix) -> Matrix:
    """Return Ad*_{g^-1} p."""
    return twin.column(twin.coadjoint(group, g**-1, p))


def printed_spatial_momentum(group: AbstractMatrixGroup, g: Matrix, p: Matrix) -> Matrix:
    """Return Ad*_g p."""
    return twin.column(twin.coadjoint(group, g, p))


def difference(g: Matrix, g_next: Matrix, time_step: Number) -> Matrix:
    """Return g^-1 (g' - g) / h, which stands for the body velocity."""
    return g**-1 * (g_next - g) / time_step


def right_pullback(slope: Matrix, W: Matrix, x: Matrix) -> Number:
    """Return the value on x of R*_W of a covector at W, given as a matrix of partial derivatives."""
    return twin.inner(slope, x * W)


def left_pullback(slope: Matrix, W: Matrix, x: Matrix) -> Number:
    """Return the value on x of L*_W of a covector at W."""
    return twin.inner(slope, W * x)


def printed_transport(slope: Matrix, W: Matrix, x: Matrix) -> Number:
    """Return <l', TL_W Ad_W x>, as printed before (disc.momentum.eqn)."""
    return left_pullback(slope, W, W * x * W**-1)


def transport(slope: Matrix, W: Matrix, x: Matrix) -> Number:
    """Return <l', TL_W Ad_{W^-1} x>."""
    return left_pullback(slope, W, W**-1 * x * W)


def displacement_variation(W: Matrix, start: Matrix, end: Matrix) -> Matrix:
    """Return (var_W), the variation of W when its ends vary by g_k start and g_{k+1} end."""
    return W * (end - W**-1 * start * W)


def balance(slopes: Sequence[Matrix], displacements: Sequence[Matrix], x: Matrix) -> Number:
    """Return the left-hand side of (discEP.eqn) on x, for two displacements in a row."""
    before, after = displacements
    return left_pullback(slopes[0], before, x) - transport(slopes[1], after, x)


def momentum_jump(P_next: Matrix, arriving: Matrix) -> Matrix:
    """Return P_{k+1} - Ad*_{W_k} P_k, the left-hand side of (disc.momentum.eqn)."""
    return P_next - arriving


def coordinate_balance(slope_at_start: Matrix, slope_at_end: Matrix) -> Matrix:
    """Return D1 L_d(q_k, q_{k+1}) + D2 L_d(q_{k-1}, q_k)."""
    return slope_at_start + slope_at_end


def printed_continuation(X: Matrix, J: Matrix) -> Number:
    """Return -tr(J X^2)/2, which agrees with the kinetic energy on skew matrices alone."""
    return -twin.trace(J * X * X) / 2


def continuation(X: Matrix, J: Matrix) -> Number:
    """Return tr(X J X^T)/2."""
    return twin.trace(X * J * X.T) / 2


def matrix_momentum(W: Matrix, J: Matrix) -> Matrix:
    """Return equation (*) of Section 6, W J - J W^T."""
    return W * J - J * W.T


def bordered(mixed: Matrix, forms: Sequence[Matrix], slopes: Sequence[Matrix]) -> Matrix:
    """Return the regularity matrix: D1 D2 L_d beside the forms at q_k, above the rows D2 F_j."""
    rows = [[*mixed[i, :], *(form[i] for form in forms)] for i in range(mixed.rows)]
    return ctx.matrix(rows + [[*slope, *(0 for _ in forms)] for slope in slopes])


def momentum_by_pose(slope: Number) -> Number:
    """Return the first form of (disc.mom.dfn), of the derivative of L_d(g_k e^{e x}, g_{k+1})."""
    return -slope


def momentum_by_displacement(slope: Number) -> Number:
    """Return the second form, of the derivative of l_d(e^{e x} W_k)."""
    return +slope


def printed_momentum_by_displacement(slope: Number) -> Number:
    """Return the second form as printed."""
    return -slope
