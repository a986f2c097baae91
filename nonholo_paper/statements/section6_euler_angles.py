"""Section 6: the discrete Lagrangian in Euler angles and its limit."""

import functools
from collections.abc import Callable

import numpy as np

import nonholo as nh
from nonholo.groups import SO
from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, Vector, ctx
from nonholo_paper.formulas import suslov_euler_angles as formulas

NOTE = "random angles up to 4, equal angles, theta = 0, nearly opposite positions"


def _pairs() -> list[tuple[Vector, Vector]]:
    """Return pairs of Euler angles."""
    values = [twin.numbers(seed, 6, -4, 4) for seed in range(5)]
    pairs = [(v[:3], v[3:]) for v in values]
    pairs += [(pairs[0][0], pairs[0][0]), ([ctx.mpf(1), ctx.mpf(0), ctx.mpf(2)], pairs[1][1])]
    return [*pairs, (pairs[2][0], [pairs[2][0][0], pairs[2][0][1] + ctx.pi - ctx.mpf("1e-20"), pairs[2][0][2]])]


def _attitude(angles: Vector) -> Matrix:
    """Return the rotation by three exponentials."""
    phi, theta, psi = angles
    turns = [[0, 0, phi], [theta, 0, 0], [0, 0, psi]]
    first, second, third = (twin.exp(twin.hat(SO(3), turn)) for turn in turns)
    return first * second * third


@functools.cache
def _traces() -> list[tuple[Vector, Vector, Vector]]:
    """Return pairs of angles with what the principal moments multiply in minus the trace of displacement and J."""
    reference = []
    for before, after in _pairs():
        W = _attitude(before).T * _attitude(after)
        factors = [-sum((-W[i, i] if i == which else W[i, i]) for i in range(3)) / 2 for which in range(3)]
        reference.append((before, after, factors))
    return reference


def _missed(formula: Callable[[Vector, Vector], Number], which: int) -> Vector:
    return [abs(formula(before, after) - factors[which]) for before, after, factors in _traces()]


@statement
def matrix() -> Measured:
    """Compare with the product of three exponentials."""
    return Measured(twin.worst(*(formulas.rotation(*a) - _attitude(a) for pair in _pairs() for a in pair)), note=NOTE)


@statement
def first() -> Measured:
    """Compare with the trace at random angles, and the library's Lagrangian too."""
    exact, library = _missed(formulas.factor_1, 0), []
    for moments in ([1.0, 1.2, 1.5], [2.0, 0.75, 1.5]):
        for a, b, factors in _traces():
            value = sum(moments) / 2 + sum(A * factor for A, factor in zip(moments, factors, strict=True))
            before, after = (np.array(angles, dtype=np.float64) for angles in (a, b))
            library.append(nh.euler_angle_discrete_lagrangian(moments, before, after) - value)
    printed = float(sum(_missed(formulas.printed_factor_1, 0)))
    return Measured(twin.both(twin.worst(exact), twin.worst(library)), printed, NOTE)


@statement
def second() -> Measured:
    """Compare with the trace at random angles."""
    printed = float(sum(_missed(formulas.printed_factor_2, 1)))
    return Measured(twin.worst(_missed(formulas.factor_2, 1)), printed, NOTE)


@statement
def third() -> Measured:
    """Compare with the trace at random angles."""
    return Measured(twin.worst(_missed(formulas.factor_3, 2)), note=NOTE)


def _motions() -> list[tuple[Vector, Vector]]:
    return [(twin.numbers(seed, 3, -4, 4), twin.numbers(seed + 40, 3, -2, 2)) for seed in range(4)]


def _lagrangian(moments: Vector, before: Vector, after: Vector) -> Number:
    """Return the corrected discrete Lagrangian."""
    factors = [formulas.factor_1(before, after), formulas.factor_2(before, after), formulas.factor_3(before, after)]
    return sum(A * (ctx.mpf(1) / 2 + f) for A, f in zip(moments, factors, strict=True))


@statement
def limit() -> Measured:
    """Differentiate the Lagrangian twice along straight motions of the angles, and at the identity the momenta."""
    missed = []
    for masses in data.MASSES:
        moments = formulas.moments([ctx.mpf(x) for x in masses])
        inertia = twin.trace(ctx.diag(masses)) * ctx.eye(3) - ctx.diag(masses)
        missed += [A - inertia[i, i] for i, A in enumerate(moments)]
        for angles, rates in _motions():

            def value(t: Number, A: Vector = moments, a: Vector = angles, r: Vector = rates) -> Number:
                return _lagrangian(A, a, formulas.after_time(a, r, t))

            later = formulas.after_time(angles, rates, ctx.mpf(1) / 8)
            missed += [8 * (b - a) - r for a, b, r in zip(angles, later, rates, strict=True)]
            missed += [value(0), ctx.diff(value, 0)]
            missed.append(ctx.diff(value, 0, 2) / 2 - formulas.kinetic_energy(moments, angles, rates))
    return Measured(twin.worst(missed), note="three bodies, four motions: value, first and second derivative")


@statement
def kinetic_energy() -> Measured:
    """Compare with the derivative of the rotation, and with the trace formula of the energy."""
    missed = []
    for angles, rates in _motions():
        R = _attitude(angles)
        X = R.T * data.slope(lambda t, a=angles, r=rates: _attitude(_moved(a, r, t)))
        missed += twin.differences(twin.vee(SO(3), X), formulas.body_velocity(angles, rates))
        for masses in data.MASSES:
            J = ctx.diag(masses)
            A = [J[1, 1] + J[2, 2], J[0, 0] + J[2, 2], J[0, 0] + J[1, 1]]
            missed.append(formulas.kinetic_energy(A, angles, rates) - twin.trace(X * J * X.T) / 2)
    return Measured(twin.worst(missed), note="four motions, three bodies")


def _moved(angles: Vector, rates: Vector, time: Number) -> Vector:
    return [a + r * time for a, r in zip(angles, rates, strict=True)]


@statement
def straightforward() -> Measured:
    """Look for a motion at which the two differ by more than a hundredth of the energy."""
    masses = [ctx.mpf(x) for x in data.MASSES[0]]
    moments = [masses[1] + masses[2], masses[0] + masses[2], masses[0] + masses[1]]
    angles, rates = _motions()[0]
    W = _attitude(angles).T * _attitude(_moved(angles, rates, 1))
    value = twin.trace_lagrangian(ctx.diag(masses))(W)
    energy = formulas.kinetic_energy(moments, angles, rates)
    return Measured(data.lacking(abs(value - energy) > energy / 100), note="one motion, angles changed by up to 2")
