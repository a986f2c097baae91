"""Section 2, left-invariant systems: constraints, momenta, Euler-Poincare-Suslov equations, reconstruction."""

import numpy as np

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import BODIES, SLEIGH, TOP, TOP_4, Body, admissible, any_velocity, apart, in_double, pose
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, ctx
from nonholo_paper.formulas import general


def _as_column(body: Body, X: Matrix) -> Matrix:
    return twin.column(twin.vee(body.group, X))


@statement
def linv_const() -> Measured:
    """Test that the velocity lies in the algebra and does not change when the motion is moved by a group element."""
    right, wrong = [], []
    for body in BODIES:
        g, moved, velocity = pose(body), pose(body, 8), twin.hat(body.group, admissible(body))
        rate = g * velocity
        omega = general.body_velocity(g, rate)
        right += [omega - velocity, general.body_velocity(moved * g, moved * rate) - omega]
        right += [[twin.dot(a, _as_column(body, omega))] for a in body.forms]
        q = general.body_velocity(moved, rate)
        wrong.append(q - twin.hat(body.group, twin.vee(body.group, q)))
    return Measured(twin.worst(*right), twin.worst(*wrong), "7 bodies")


@statement
def body_momentum() -> Measured:
    """Count the derivatives of the kinetic energy, and compare them with the inertia operator of the library."""
    right, wrong = [], []
    for body in BODIES:
        omega = any_velocity(body)
        slopes = _slopes(body, omega)
        exact = twin.worst(slopes - body.inertia * omega)
        right.append(twin.both(exact, apart(body.system.inertia_operator, body.inertia)))
        wrong.append(len(slopes) - 1)
    return Measured(max(right), min(wrong), "7 bodies; the printed defect is a count of components")


def _slopes(body: Body, omega: Matrix) -> Matrix:
    """Return the derivatives of the kinetic energy tr(X J X^T)/2."""

    def kinetic(x: Matrix) -> Number:
        X = twin.hat(body.group, x)
        return twin.trace(X * body.tensor * X.T) / 2

    return twin.column([twin.rate(lambda s, e=e: kinetic(omega + s * e)) for e in _units(body)])


def _units(body: Body) -> list[Matrix]:
    return [ctx.eye(body.group.dim)[:, i] for i in range(body.group.dim)]


def _in_chart(body: Body, g_velocity: tuple[Matrix, Matrix]) -> Matrix:
    """Return exp(-x) d/dt exp(x), the body velocity in coordinates x with rate v."""
    X, V = (twin.hat(body.group, list(part)) for part in g_velocity)
    return _as_column(body, twin.exp(-X) * twin.exp_derivative(X, V))


def _lagrange_in_chart(body: Body, omega: Matrix, acceleration: Matrix) -> Matrix:
    """Return d/dt dL/dv - dL/dx at x = 0 in the coordinates g = g_0 exp(x), from the definition of l."""

    def slope(t: Number, e: Matrix) -> Number:
        x, v = t * omega + t * t / 2 * acceleration, omega + t * acceleration
        return twin.dot(body.inertia * _in_chart(body, (x, v)), _in_chart(body, (x, e)))

    def lagrangian(x: Matrix) -> Number:
        w = _in_chart(body, (x, omega))
        return twin.dot(body.inertia * w, w) / 2

    pairs = [(twin.rate(lambda t, e=e: slope(t, e)), twin.rate(lambda t, e=e: lagrangian(t * e))) for e in _units(body)]
    return twin.column([general.euler_lagrange(momentum, force) for momentum, force in pairs])


@statement
def eps() -> Measured:
    """Compare with the Lagrange equations with multipliers in coordinates, and with the vector field of the library."""
    defects = []
    for body in (TOP, SLEIGH):
        omega, multipliers = admissible(body), twin.numbers(9, len(body.forms), -2, 2)
        rate = general.momentum_rate(twin.coad(body.group, omega, body.inertia * omega), multipliers, body.forms)
        left = _lagrange_in_chart(body, omega, ctx.lu_solve(body.inertia, rate))
        defects.append(twin.worst(left - general.reaction(multipliers, body.forms)))
    for body in BODIES:
        omega = admissible(body)
        p = body.inertia * omega
        rate = general.momentum_rate(twin.coad(body.group, omega, p), [0] * len(body.forms), body.forms)
        state = np.concatenate([in_double(body.restrict(p)).ravel(), body.group.identity.ravel()])
        library = nh.vector_field(body.system)(0.0, state)[: len(body.subspace)]
        defects.append(twin.both(0.0, apart(library, body.restrict(rate))))
    return Measured(max(defects), note="top and sleigh in coordinates; 7 bodies in the library")


@statement
def reconstruction() -> Measured:
    """Differentiate the curve of constant velocity, and compare with the vector field of the library."""
    defects = []
    for body in (TOP, SLEIGH, TOP_4):
        g, omega = pose(body), admissible(body)
        X = twin.hat(body.group, omega)
        rate = general.reconstructed_rate(g, X)
        state = np.concatenate([in_double(body.restrict(body.inertia * omega)), in_double(g).ravel()])
        moved = nh.vector_field(body.system)(0.0, state)[len(body.subspace) :].reshape(body.group.identity.shape)
        derivative = twin.rate(lambda t, g=g, X=X: g * twin.exp(t * X))
        defects.append(twin.both(twin.worst(derivative - rate), apart(moved, rate)))
    return Measured(max(defects), note="SO(3), SE(2), SO(4)")
