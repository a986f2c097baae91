"""Section 4, the Suslov problem in space: integrals, equilibria, limits."""

import numpy as np
from scipy.integrate import solve_ivp

import nonholo as nh
from nonholo_paper import _tops as tops
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import in_double
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, ctx
from nonholo_paper.formulas import suslov_continuous as suslov


@statement
def energy_integral() -> Measured:
    """Differentiate it along the motion, and compare it with the energy of the Lagrangian and of the library."""
    right, wrong = [], []
    for top, w in tops.states():
        rate = top.accelerated(w)[0]
        h = suslov.velocity_integral(top.inertia, w)
        moving = twin.rate(lambda t, top=top, w=w, a=rate: suslov.velocity_integral(top.inertia, w + t * a))
        energy = twin.dot(w, top.inertia * w) - twin.dot(w, top.inertia * w) / 2
        library = top.system.constrained_energy(in_double(top.inertia * w))
        exact = [moving, h - 2 * energy, h - suslov.momentum_integral(top.inertia, top.inertia * w)]
        right.append(twin.both(twin.worst(exact), abs(library - float(h / 2)) / (1 + float(h))))
        wrong.append(float(abs(h - energy)))
    return Measured(max(right), max(wrong), "5 tops, 4 velocities each")


@statement
def equilibria() -> Measured:
    """Test the line, the rest of the plane, and the library's equilibria; a balanced body has a plane of them."""
    defects = []
    for top in tops.TOPS:
        line = suslov.cross(top.axis, top.inertia * top.axis)
        defects += list(suslov.ep3_26(top.inertia, line, top.axis)) + list(top.accelerated(line)[0])
        result = top.system.equilibria().subspace
        library = [abs(result @ in_double(v)).max() for v in (top.axis, top.inertia * top.axis)]
        moved = any(abs(x) > 1e-9 for x in suslov.ep3_26(top.inertia, suslov.cross(top.axis, line), top.axis))
        balanced = top is tops.BALANCED
        count = abs(len(result) - (2 if balanced else 1)) + (moved == balanced)
        defects.append(max(twin.both(0.0, max(library)), float(count)))
    return Measured(twin.worst(defects), note="5 tops, one of them balanced")


@statement
def degenerate_integral() -> Measured:
    """Evaluate both integrals, the derivative along the motion and the kernel, in principal bases."""
    right, wrong = [], []
    for top in (tops.PRINCIPAL, tops.BALANCED, tops.Top(ctx.diag([3.0, 1.0, 2.0]), twin.column([-0.6, 0.8, 0.0]))):
        form = suslov.degenerate_form(top.inertia, top.axis)
        right += list(form * top.axis)
        for w in top.velocities():
            M, rate = top.inertia * w, top.inertia * top.accelerated(w)[0]
            value, h = twin.dot(M, form * M), suslov.velocity_integral(top.inertia, w)
            right += [value - suslov.restriction_factor(top.inertia, top.axis) * h, 2 * twin.dot(M, form * rate)]
            wrong.append(float(abs(value - h)))
    return Measured(twin.worst(right), max(wrong), "3 tops in principal bases")


@statement
def reduced_integral() -> Measured:
    """Compare with (ep3.27) times the determinant of the constrained inertia, and with the energy of the library."""
    defects = []
    for top in (tops.LAST, tops.BALANCED):
        for w in top.velocities():
            M, rate, factor = top.inertia * w, top.inertia * top.accelerated(w)[0], suslov.reduced_factor(top.inertia)
            value = suslov.reduced_integral(top.inertia, M[0], M[1])
            moving = twin.rate(lambda t, A=top.inertia, p=M, f=rate: suslov.reduced_integral(A, *(p + t * f)[:2]))
            energy = top.system.constrained_energy(in_double(M))
            library = abs(2 * float(factor) * energy - float(value)) / (1 + abs(float(value)))
            exact = [value - factor * suslov.velocity_integral(top.inertia, w), moving]
            defects.append(twin.both(twin.worst(exact), library))
    return Measured(max(defects), note="2 tops, 4 velocities each")


@statement
def limits() -> Measured:
    """Test the closed form of the motion in the equations, and its limits; the library says the same of its tops."""
    B, c, defects = ctx.matrix([[2.75, 0.25], [0.25, 2.25]]), twin.column([0.5, -0.25]), []
    end = ctx.sqrt(1 / twin.dot(c, B * c)) * c
    for side, phase in ((1, ctx.mpf("0.3")), (-1, -2), (1, 8)):
        for t in (-3, 0, ctx.mpf("0.7"), 5):
            moving = twin.rate(lambda s, t=t, side=side, phase=phase: _velocity(B, c, phase, side, t + s))
            w = _velocity(B, c, phase, side, t)
            defects.append(moving - tops.LAST.accelerated(w)[0])
        last, first = (suslov.solution(B, c, 1, phase, side, t) for t in (2000, -2000))
        defects += [last + end, first - end]
    result = nh.asymptotics(tops.LAST.system)
    axis = in_double(_lifted(c / ctx.norm(c)))
    library = max(abs(result.axis_before - axis).max(), abs(result.axis_after + axis).max())
    return Measured(twin.both(twin.worst(*defects), library), note="3 motions at 4 times and both ends")


def _lifted(w: Matrix) -> Matrix:
    """Return the angular velocity of the coefficients of e_1 ^ e_3 and e_2 ^ e_3."""
    return twin.column([-w[1], w[0], 0])


def _velocity(B: Matrix, c: Matrix, phase: Number, side: int, t: Number) -> Matrix:
    return _lifted(suslov.solution(B, c, 1, phase, side, t))


_SPECIAL = ((0.75, 0.0, 0.5), (0.0, 0.5, 0.0), (0.5, 0.0, 0.5))
_ALIGNED = (
    _SPECIAL,
    ((0.75, 0.0, 0.375), (0.0, 0.5, 0.0), (0.375, 0.0, 0.5)),
    ((0.5, 0.0, 0.4375), (0.0, 0.75, 0.0), (0.4375, 0.0, 0.5)),
    ((1.5, 0.0, 0.5), (0.0, 0.7, 0.0), (0.5, 0.0, 0.8)),
    ((0.5, 0.0, 0.4375), (0.0, 0.5, 0.0), (0.4375, 0.0, 0.5)),
)


@statement
def axes_in_space() -> Measured:
    """Integrate the vector field of the library to both ends, in double precision; the last body has q = 0."""
    defects, coinciding = [], 0
    for J in _ALIGNED:
        angle = 2 * ctx.asin(suslov.half_angle_sine(J[0][0] + J[2][2], J[1][1] + J[2][2], J[0][2]))
        result = _angle_in_space(nh.SuslovTop(J))
        defects.append(abs(result - float(angle)))
        coinciding += result < 1e-6
    return Measured(max(defects), float(coinciding), "5 bodies; printed: a count of bodies whose axes coincide")


def _angle_in_space(top: nh.SuslovTop) -> float:
    """Return the angle of the spatial angular velocities before and after a motion."""
    rows, field = top.constraint_subspace, nh.vector_field(top)
    start = np.concatenate([top.constrained_inertia @ (0.0, 1.0), np.eye(3).ravel()])
    ends = []
    for span in (90.0, -90.0):
        state = solve_ivp(field, (0.0, span), start, method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
        ends.append(state[2:].reshape(3, 3) @ rows.T @ top.restricted_velocity(state[:2]))
    return float(np.arctan2(np.linalg.norm(np.cross(*ends)), np.dot(*ends)))
