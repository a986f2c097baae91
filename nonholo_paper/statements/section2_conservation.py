"""Section 2, left-invariant systems: what is conserved, reduced constrained energy and momenta."""

import numpy as np

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import (
    BALANCED_TOP,
    BODIES,
    SLEIGH,
    TOP,
    TOP_4,
    Body,
    admissible,
    any_velocity,
    in_double,
    pose,
)
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, ctx
from nonholo_paper.formulas import general


def _curved_momentum(body: Body, omega: Matrix) -> Matrix:
    return body.inertia * omega + omega * twin.dot(omega, omega) / 2


def _curved_energy(body: Body, omega: Matrix) -> Number:
    """The energy of l = <I w, w>/2 + |w|^4/8, which is not quadratic."""
    square = twin.dot(omega, omega)
    return general.energy(
        _curved_momentum(body, omega), omega, twin.dot(body.inertia * omega, omega) / 2 + square**2 / 8
    )


def _curved_acceleration(body: Body, omega: Matrix) -> Matrix:
    """Solve the equations for that l: their part along the subspace holds no multipliers."""
    torque = general.momentum_rate(
        twin.coad(body.group, omega, _curved_momentum(body, omega)), [0] * len(body.forms), body.forms
    )
    n = body.group.dim
    hessian = body.inertia + ctx.eye(n) * twin.dot(omega, omega) / 2 + omega * omega.T
    along = ctx.matrix([[twin.dot(e, hessian * f) for f in body.directions] for e in body.directions])
    return body.velocity(list(ctx.lu_solve(along, body.restrict(torque))))


@statement
def reduced_energy() -> Measured:
    """Differentiate it along the equations, for a quartic Lagrangian and for the kinetic energies of the library."""
    defects = []
    for body in BODIES:
        omega = admissible(body)
        a = _curved_acceleration(body, omega)
        rate = twin.rate(lambda t, body=body, omega=omega, a=a: _curved_energy(body, omega + t * a))
        r = in_double(body.restrict(body.inertia * omega))
        state = np.concatenate([r, body.group.identity.ravel()])
        moved = nh.vector_field(body.system)(0.0, state)[: len(r)]
        defects.append(twin.both(twin.worst([rate]), abs(body.system.restricted_velocity(r) @ moved)))
    return Measured(max(defects), note="7 bodies, quartic and quadratic Lagrangians")


@statement
def momentum_subspace() -> Measured:
    """Test the printed condition and the annihilation of d on momenta of random admissible velocities."""
    right, wrong = [], []
    for body in BODIES:
        omega = admissible(body)
        p = body.inertia * omega
        right += [twin.dot(a, ctx.lu_solve(body.inertia, p)) for a in body.forms]
        wrong.append(twin.worst(body.restrict(p)))
    return Measured(twin.worst(right), min(wrong), "7 bodies")


@statement
def adapted_energy() -> Measured:
    """Compare both sums with the definition and with the library, in bases adapted to each constraint."""
    right, wrong = [], []
    for body in BODIES:
        k, s, w = len(body.directions), len(body.forms), twin.column(twin.numbers(4, len(body.directions), -2, 2))
        omega = body.velocity(list(w))
        p = body.inertia * omega
        definition = general.energy(p, omega, twin.dot(p, omega) / 2)
        basis = [*body.directions, *body.forms]
        inertia = ctx.matrix([[twin.dot(e, body.inertia * f) for f in basis] for e in basis])
        w_all, r = twin.column([*w, *[0] * s]), body.restrict(p)
        inverse = body.restricted_inertia() ** -1
        exact = [general.half_form(inertia, w_all, k) - definition, general.half_form(inverse, r, k) - definition]
        library = abs(body.system.constrained_energy(in_double(r)) - float(definition))
        right.append(twin.both(twin.worst(exact), library))
        if s < k:
            wrong.append(twin.worst([general.half_form(inertia, w_all, s) - definition]))
    return Measured(max(right), min(wrong), "7 bodies; the printed sum is too short for 5 of them")


@statement
def spatial_momentum() -> Measured:
    """Differentiate both along a free motion, and follow a free body of the library."""
    right, wrong = [], []
    for body in (TOP, SLEIGH, TOP_4):
        for formula, defects in ((general.spatial_momentum, right), (general.printed_spatial_momentum, wrong)):
            defects.append(twin.worst(twin.rate(lambda t, b=body, f=formula: f(b.group, *_free_motion(b, t)))))
    free = nh.discretize(nh.RigidBody(TOP.mass_tensor), 0.25)
    momenta = nh.simulate(free, body_velocity=(0.5, -1.0, 0.75), steps=20).spatial_momentum
    return Measured(twin.both(max(right), np.ptp(momenta, axis=0).max()), min(wrong), "SO(3), SE(2), SO(4)")


def _free_motion(body: Body, t: Number) -> tuple[Matrix, Matrix]:
    """Return configuration and momentum of a free motion, to first order in t."""
    omega = any_velocity(body)
    p = body.inertia * omega
    rate = general.momentum_rate(twin.coad(body.group, omega, p), [0], [0 * p])
    return pose(body) * twin.exp(t * twin.hat(body.group, omega)), p + t * rate


@statement
def conserved_body_momentum() -> Measured:
    """Count the conserved components: all for a balanced top, none for an unbalanced one."""
    counts = []
    for body, expected in ((BALANCED_TOP, 2), (TOP, 0)):
        omega = admissible(body)
        p = body.inertia * omega
        rate = body.restrict(general.momentum_rate(twin.coad(body.group, omega, p), [0], [0 * p]))
        counts.append(sum(abs(value) < ctx.mpf(10) ** -40 for value in rate) - expected)
    balanced = nh.conserved_momenta(nh.SuslovTop(np.diag([1.0, 1.0, 0.5])))
    unbalanced = nh.conserved_momenta(nh.SuslovTop(TOP.mass_tensor))
    counts += [len(unbalanced.body), len(unbalanced.spatial), len(balanced.body) - 2, len(balanced.spatial) - 3]
    return Measured(float(max(abs(count) for count in counts)), note="numbers of conserved components")
