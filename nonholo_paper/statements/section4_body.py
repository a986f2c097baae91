"""Section 4, the Suslov problem in space: constraint, equations of motion, multiplier."""

import numpy as np

import nonholo as nh
from nonholo_paper import _tops as tops
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import in_double
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix
from nonholo_paper.formulas import suslov_continuous as suslov


@statement
def constraint() -> Measured:
    """Compare with the projection of the spatial angular velocity in several poses, and the library's annihilator."""
    group, defects = nh.SO(3), []
    for seed, (top, w) in enumerate(tops.states()):
        R = twin.exp(twin.hat(group, twin.numbers(seed, 3, -3, 3)))
        u = w + seed * top.axis
        spatial = twin.column(twin.vee(group, R * twin.hat(group, u) * R.T))
        exact = [twin.dot(spatial, R * top.axis) - twin.dot(u, top.axis), *(spatial - R * u), twin.dot(w, top.axis)]
        defects.append(twin.both(twin.worst(exact), abs(top.system.annihilator[0] - in_double(top.axis)).max()))
    return Measured(max(defects), note="5 tops, 4 velocities each")


@statement
def equations() -> Measured:
    """Compare with the Euler-Poincare-Suslov equations on so(3), and with the vector field of the library."""
    defects = []
    for top, w in tops.states():
        rate, multiplier = top.accelerated(w)
        exact = top.inertia * rate - suslov.momentum_rate(top.inertia, w, top.axis, multiplier)
        defects.append(twin.both(twin.worst(exact), _library_defect(top, w, top.inertia * rate)))
    return Measured(max(defects), note="5 tops, 4 velocities each")


def _library_defect(top: tops.Top, w: Matrix, rate: Matrix) -> float:
    """Return the distance of the library's rate of the restricted momenta from one at 50 digits, relative to w^2."""
    rows = top.system.constraint_subspace
    state = np.concatenate([rows @ in_double(top.inertia * w), np.eye(3).ravel()])
    result = nh.vector_field(top.system)(0.0, state)[:2]
    return float(abs(result - rows @ in_double(rate)).max() / (1 + twin.dot(w, w)))


@statement
def eliminated_multiplier() -> Measured:
    """Compare with the solution of the equations together with the derivative of the constraint."""
    defects = [suslov.multiplier(top.inertia, w, top.axis) - top.accelerated(w)[1] for top, w in tops.states()]
    return Measured(twin.worst(defects), note="5 tops, 4 velocities each")


@statement
def eliminated_equation() -> Measured:
    """Compare with the rate by definition."""
    pairs = [(suslov.eliminated(t.inertia, w, t.axis), t.inertia * t.accelerated(w)[0]) for t, w in tops.states()]
    return Measured(twin.worst(*(result - rate for result, rate in pairs)), note="5 tops, 4 velocities each")


@statement
def reduced_equation() -> Measured:
    """Compare both with the rate by definition, and the library with the corrected one."""
    right, wrong = [], []
    for top, w in tops.states():
        rate, result = top.inertia * top.accelerated(w)[0], suslov.ep3_26(top.inertia, w, top.axis)
        right.append(twin.both(twin.worst(result - rate), _library_defect(top, w, result)))
        wrong.append(twin.worst(suslov.printed_ep3_26(top.inertia, w, top.axis) - rate))
    return Measured(max(right), max(wrong), "5 tops, 4 velocities each")
