"""Section 6: the equations of a step of the top of three dimensions."""

import nonholo as nh
from nonholo.groups import SO
from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, ctx
from nonholo_paper.formulas import suslov_momenta as formulas

NOTE = "all four values after three displacements, two bodies"


def _steps() -> list[tuple[Matrix, Matrix, Matrix]]:
    """Return bodies with displacements and next displacements, real and complex."""
    return [
        (data.body(name), data.cayley(y), data.cayley(after))
        for name, y in data.STEPS
        for after in data.successors(name, y)
    ]


def _multiplier(J: Matrix, W: Matrix, after: Matrix) -> Number:
    """Return the multiplier of the matrix equation."""
    return (after * J - J * after.T - W.T * (W * J - J * W.T) * W)[0, 1]


@statement
def equations() -> Measured:
    """Compare with momenta that are derivatives, with matrix products, and a step of the library with both."""
    exact, library = [], []
    for J, W, after in _steps():
        difference = after * J - J * after.T - W.T * (W * J - J * W.T) * W
        exact += list(difference - ctx.matrix(formulas.multiplier_matrix(difference[0, 1])))
    group, lagrangian = SO(3), twin.trace_lagrangian(data.body("generic"))
    J, W, after = _steps()[0]
    carried = twin.coadjoint(group, W, twin.momentum(group, lagrangian, W))
    moved = twin.hat(group, twin.differences(twin.momentum(group, lagrangian, after), carried))
    exact += list(moved - ctx.matrix(formulas.multiplier_matrix(_multiplier(J, W, after))))
    orbit = nh.simulate(data.discrete(J), displacement=data.array(W), steps=1)
    library += list((orbit.displacement[1] - data.array(after)).ravel())
    library.append(orbit.multipliers[0, 0] + _multiplier(J, W, after))
    return Measured(twin.both(twin.worst(exact), twin.worst(library)), note=NOTE)


@statement
def arriving() -> Measured:
    """Compare with the product of matrices, with the turned vector and with the library."""
    exact, library = [], []
    for J, q, W in data.samples():
        turned, vector = data.turned(J, W), W.T * ctx.matrix(data.momentum(J, W))
        exact += twin.differences(turned, formulas.arriving(J, q)) + twin.differences(turned, list(vector))
        exact += twin.differences(turned, twin.vee(SO(3), formulas.turned_difference(W, J)))
        P = nh.discrete_legendre(data.discrete(J), data.array(W), side="right")
        library += list(P - [float(x) for x in turned])
    return Measured(twin.both(twin.worst(exact), twin.worst(library)), note="8 bodies, 12 displacements")


@statement
def vector_form() -> Measured:
    """Take the multiplier of the matrix equation at all values of the map."""
    right, wrong = [], []
    for name, y in data.STEPS:
        J, W, q = data.body(name), data.cayley(y), data.point_of([ctx.mpf(v) for v in y])
        for tangents in data.successors(name, y):
            after = data.cayley(tangents)
            moved, mu = twin.differences(data.momentum(J, after), data.momentum(J, W)), _multiplier(J, W, after)
            right += twin.differences(moved, formulas.change(J, q, formulas.multiplier_of_vector(mu)))
            wrong += twin.differences(moved, formulas.change(J, q, formulas.printed_multiplier_of_vector(mu)))
    return Measured(twin.worst(right), twin.worst(wrong), NOTE)


@statement
def orthogonal_change() -> Measured:
    """Multiply the change, of matrices and of the formula, with the axis."""
    right = []
    for J, q, W in data.samples():
        moved = twin.differences(data.turned(J, W), data.momentum(J, W))
        right += [moved[0] * q[1] + moved[1] * q[2]]
        change = formulas.change(J, q, 1)
        right += [change[0] * q[1] + change[1] * q[2]]
    return Measured(twin.worst(right), note="8 bodies, 12 displacements")


@statement
def discrete_analog() -> Measured:
    """Put half of a small velocity for q: the change along the constraint is the square of its size times the force."""
    missed, epsilon = [], ctx.mpf("1e-4")
    for J in data.bodies():
        velocity = twin.numbers(7, 2, -2, 2)
        momentum = (twin.trace(J) * ctx.eye(3) - J) * ctx.matrix([*velocity, 0])
        force = [-momentum[2] * velocity[1], momentum[2] * velocity[0]]
        change = formulas.change(J, [ctx.mpf(1), epsilon * velocity[0] / 2, epsilon * velocity[1] / 2], 0)
        missed += [a / epsilon**2 - b for a, b in zip(change, force, strict=False)]
    return Measured(twin.worst(missed), note="8 bodies, one velocity")
