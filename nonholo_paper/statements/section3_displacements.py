"""Section 3, displacements that satisfy the constraint, and the momenta that they have."""

import numpy as np

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import BODIES, SLEIGH, TOP, TOP_4, Body, apart, displacements, in_double, velocities
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, ctx
from nonholo_paper.formulas import general, symmetric_pairs

_PAIRS = (TOP, TOP_4, SLEIGH)


def _mirror(body: Body) -> Matrix:
    """Return the matrix whose conjugation is the involution: -1 on d, +1 on h."""
    return ctx.diag([-1, 1, 1]) if body is SLEIGH else ctx.diag([1] * (body.group.size - 1) + [-1])


@statement
def tangent_space() -> Measured:
    """Differentiate the exponential at zero along each direction of d."""
    slopes = []
    for body in BODIES:
        slopes.append(body.displacement(0 * body.directions[0]) - ctx.eye(body.group.size))
        for e in body.directions:
            slopes.append(twin.rate(lambda t, b=body, e=e: b.displacement(t * e)) - twin.hat(body.group, e))
    return Measured(twin.worst(*slopes), note="7 bodies")


@statement
def generic_exponential() -> Measured:
    """Let a line of so(4) turn two planes at rates 1 and the root of 2: it comes back to the identity without end."""
    with ctx.workdps(150):
        turns, denominator = 1, 1  # the fractions turns/denominator tend to the root of 2, from Pell's equation
        while denominator < 10**50:
            turns, denominator = turns + 2 * denominator, turns + denominator
        angle = 2 * ctx.pi * denominator
        second = angle * ctx.sqrt(2)
        near = [ctx.cos(angle) - 1, ctx.sin(angle), ctx.cos(second) - 1, ctx.sin(second)]
        left = ctx.sin(second) == 0
    return Measured(twin.worst(near, [int(left)]), note="one of infinitely many sheets: length of the velocity 1e51")


@statement
def symmetric_pair() -> Measured:
    """Multiply out all brackets, and ask the library, also for two subspaces that belong to none."""
    defects = []
    for body in _PAIRS:
        d, h = ([twin.hat(body.group, e) for e in rows] for rows in (body.directions, body.forms))
        mirror = _mirror(body)
        for left, right, sign in ((h, h, 1), (d, d, 1), (h, d, -1)):
            pairs = [symmetric_pairs.bracket(x, y) for x in left for y in right]
            defects += [mirror * z * mirror - sign * z for z in pairs]
            defects += [twin.hat(body.group, twin.vee(body.group, z)) - z for z in pairs]
        defects += [mirror * x * mirror - x for x in h] + [mirror * x * mirror + x for x in d]
    wrong = [body for body in BODIES if nh.is_symmetric_pair(body.group, body.subspace) != (body is not BODIES[-1])]
    return Measured(twin.worst(*defects, [len(wrong)]), note="tops n = 3, 4, sleigh; library: 7 bodies")


@statement
def cartan_model() -> Measured:
    """Test the map on random elements and on two cosets with one image; measure traces in SL(2, R)."""
    defects = []
    for body in _PAIRS:
        mirror = _mirror(body)
        g = twin.exp(twin.hat(body.group, twin.numbers(3, body.group.dim, -2, 2)))
        h = twin.exp(sum((c * twin.hat(body.group, a) for c, a in zip((2, -1, 3), body.forms, strict=False)), 0 * g))
        W = symmetric_pairs.cartan(g, mirror)
        defects += [symmetric_pairs.cartan(g * h, mirror) - W, mirror * W * mirror - W**-1]
        defects.append([0 if body is SLEIGH or nh.in_exp_d(in_double(W)) else 1])
        for w in velocities(body)[2:]:
            half = body.displacement(w / 2)
            defects.append(symmetric_pairs.cartan(half, mirror) - body.displacement(w))
        defects.append(_second_coset(body, mirror))
    return Measured(twin.worst(*defects), _trace_gap(), "tops n = 3, 4, sleigh; SL(2, R) for the printed statement")


def _second_coset(body: Body, mirror: Matrix) -> Matrix:
    """Return the difference of the images of two cosets: those of a direction and of half a turn less."""
    w = body.velocity([ctx.mpf("0.75")] + [0] * (len(body.subspace) - 1))
    one, other = (body.displacement(part) for part in (w, w - ctx.pi * w / ctx.mpf("0.75")))
    turned = 0 if body is SLEIGH else body.group.size - 1
    between = (other**-1 * one)[turned, turned]  # 1 for elements of H
    return symmetric_pairs.cartan(one, mirror) - symmetric_pairs.cartan(other, mirror) + (between + 1)


def _trace_gap() -> float:
    """Return the distance of traces near -I, with bc > 0, from traces of exponentials, at least -2."""
    traces = []
    for b, c in ((1, 2), (1, -2), (-3, 1), (0, 1), (4, 4)):
        X = ctx.matrix([[0, b], [c, 0]])
        traces += [twin.trace(twin.exp(t * X)) for t in (ctx.mpf("0.5"), 1, 2, 5)]
    least = min(traces)
    t = ctx.mpf("0.125")
    model = ctx.matrix([[-ctx.cosh(t), ctx.sinh(t)], [ctx.sinh(t), -ctx.cosh(t)]])
    return float(max(least, -2) - twin.trace(model))


@statement
def tangent_bundle() -> Measured:
    """Compare the forbidden part of the velocity of a curve on exp d with its closed form, for a top."""
    defects = []
    for w in velocities(TOP)[1:]:
        eta = TOP.velocity(twin.numbers(2, 2))
        moved = twin.exp_derivative(twin.hat(TOP.group, w), twin.hat(TOP.group, eta))
        velocity = twin.vee(TOP.group, TOP.displacement(-w) * moved)
        part = symmetric_pairs.twisted(w, eta)
        defects += [velocity[2] - part, int(part == 0)]
    return Measured(twin.worst(defects), note="4 points of exp d, n = 3")


def _printed_locus(body: Body, W: Matrix) -> Matrix:
    """Return L*_W of the differential of l_d, whose matrix of partial derivatives is (W - I) J."""
    slope = (W - ctx.eye(W.rows)) * body.tensor
    return twin.column([general.left_pullback(slope, W, e) for e in twin.basis(body.group)])


@statement
def locus() -> Measured:
    """Compare with the momenta by definition, and printed points with all momenta of the same part along d."""
    right, wrong = [], []
    for body in (TOP, SLEIGH):
        for W in displacements(body)[2:]:
            slope = (W - ctx.eye(W.rows)) * body.tensor
            pulled = twin.column([general.right_pullback(slope, W, e) for e in twin.basis(body.group)])
            printed = _printed_locus(body, W)
            right += [pulled - body.momentum(W), printed + body.momentum(W**-1)]
        wrong.append(_distance_from_locus(body, printed))
    return Measured(twin.worst(*right), min(wrong), "top and sleigh; distance from the locus with the library")


def _sleigh() -> nh.ChaplyginSleigh:
    """Return SLEIGH, whose inertia about its center of mass is 5/4."""
    return nh.ChaplyginSleigh(2.0, 1.25, 0.5, -0.25)


def _distance_from_locus(body: Body, p: Matrix) -> float:
    top = nh.SuslovTop(TOP.mass_tensor) if body is TOP else _sleigh()
    result = nh.displacements_over(nh.discretize(top, 1.0), in_double(body.restrict(p)))
    return float(np.abs(result.momentum - in_double(p)).max(axis=1).min())


@statement
def inverse_legendre() -> Measured:
    """Take momenta at 50 digits back to their displacements with the library."""
    defects = []
    systems = [(TOP, nh.SuslovTop(TOP.mass_tensor)), (TOP_4, nh.SuslovTop(TOP_4.mass_tensor)), (SLEIGH, _sleigh())]
    for body, system in systems:
        discrete = nh.discretize(system, 1.0)
        for W in displacements(body)[2:]:
            result = nh.inverse_discrete_legendre(discrete, in_double(body.momentum(W)))
            defects.append(twin.both(0.0, apart(result, W)))
    return Measured(max(defects), note="tops n = 3, 4 and a sleigh, steps of up to more than half a turn")
