"""Section 3, discrete Lagrangians on a group and the discrete body momentum."""

import numpy as np

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import BODIES, SLEIGH, SMALL, TOP, TOP_4, Body, apart, displacements, in_double, pose, slopes
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, ctx
from nonholo_paper.formulas import general


def _slope(body: Body, W: Matrix) -> Matrix:
    """Return the partial derivatives of l_d by the entries of W, by their definition."""
    slope = ctx.zeros(W.rows)
    for i in range(W.rows):
        for j in range(W.cols):
            unit = ctx.zeros(W.rows)
            unit[i, j] = 1
            slope[i, j] = twin.rate(lambda t, E=unit: body.lagrangian(W + t * E))
    return slope


@statement
def discrete_lagrangian() -> Measured:
    """Test the invariance, and count: a value is one number, an element of G has dim G of them."""
    right, wrong = [], []
    for body in BODIES:
        group, moved = body.group, pose(body, 2)
        for W in displacements(body):
            g = pose(body, 1)
            values = [body.lagrangian((h * g) ** -1 * (h * g * W)) for h in (moved, ctx.eye(group.size))]
            right += [values[0] - values[1], values[1] - body.lagrangian(W), len(ctx.matrix([values[0]])) - 1]
            wrong.append(group.dim - len(ctx.matrix([values[0]])))
    return Measured(twin.worst(right), float(min(wrong)), "7 bodies; the printed defect is a count of components")


@statement
def approximation() -> Measured:
    """Take a step of size 1e-60: the difference from the velocity is half its square times the step, to first order."""
    defects = []
    for body in BODIES:
        with ctx.workdps(200):
            h, X = ctx.mpf(10) ** -60, twin.hat(body.group, twin.numbers(4, body.group.dim, -2, 2))
            g = pose(body, 1)
            result = general.difference(g, g * twin.exp(h * X), h)
            defects += [result - X, (result - X) / h - X * X / 2]
    return Measured(twin.worst(*defects), note="7 bodies, h = 1e-60")


@statement
def logarithm() -> Measured:
    """Compare the energies before and after a step, for both discrete Lagrangians, also those of the library."""
    right, wrong = [], []
    for body in (TOP, SLEIGH, TOP_4):
        inverse = body.restricted_inertia() ** -1
        matrix, logarithmic = (nh.discretize(body.system, 1.0, difference=name) for name in ("matrix", "logarithmic"))
        for W in displacements(body)[2:]:
            r, r_next = body.restrict(body.momentum(W)), body.restrict(body.arriving(W))
            change = general.half_form(inverse, r_next, r.rows) - general.half_form(inverse, r, r.rows)
            right.append(twin.both(twin.worst([change]), abs(_energy_change(body, matrix, W))))
        W = body.displacement(body.velocity([0.75, -0.5, 0.25][: len(body.subspace)]))
        wrong.append(abs(_energy_change(body, logarithmic, W)))
    return Measured(max(right), min(wrong), "tops n = 3, 4 and a sleigh; logarithm: angles below one")


def _energy_change(body: Body, discrete: nh.Discretization, W: Matrix) -> float:
    before, after = (nh.discrete_legendre(discrete, in_double(W), side=side) for side in ("left", "right"))
    return float(body.system.constrained_energy(after) - body.system.constrained_energy(before))


@statement
def first_momentum() -> Measured:
    """Compare both pullbacks of the matrix of partial derivatives with the definition by the first argument."""
    right, wrong = [], []
    for body in SMALL:
        for W in displacements(body)[2:]:
            slope, E = _slope(body, W), twin.basis(body.group)
            definition = _from_first_argument(body, W)
            pulled = twin.column([general.right_pullback(slope, W, e) for e in E])
            printed = twin.column([general.left_pullback(slope, W, e) for e in E])
            carried = twin.column(twin.coadjoint(body.group, W, list(definition)))
            right += [pulled - definition, printed - carried]
            wrong.append(twin.worst(printed - definition))
    return Measured(twin.worst(*right), min(wrong), "2 tops and a sleigh, 3 displacements each")


def _from_first_argument(body: Body, W: Matrix) -> Matrix:
    """Return -d/de L_d(g e^{e x}, g W), the first form of the definition."""
    g = pose(body, 1)
    result = slopes(lambda nudge: body.lagrangian((g * nudge) ** -1 * (g * W)), body.group)
    return twin.column([general.momentum_by_pose(slope) for slope in result])


@statement
def usual_momentum() -> Measured:
    """Evaluate it at several configurations: it is the momentum carried along the step that ends there."""
    defects = []
    for body in SMALL:
        discrete = nh.discretize(body.system, 1.0)
        for W in displacements(body):
            result = [_usual(body, pose(body, seed), W) for seed in (1, 2)]
            carried = twin.column(twin.coadjoint(body.group, W, list(body.momentum(W))))
            library = nh.discrete_legendre(discrete, in_double(W), side="right")
            exact = twin.worst(result[0] - result[1], result[0] - carried)
            defects.append(twin.both(exact, apart(library, carried)))
    return Measured(max(defects), note="2 tops and a sleigh, 5 displacements each")


def _usual(body: Body, g: Matrix, W: Matrix) -> Matrix:
    return slopes(lambda nudge: body.lagrangian(g**-1 * (g * W * nudge)), body.group)


@statement
def momentum_definition() -> Measured:
    """Compare the two forms, and the library with the first."""
    right, wrong = [], []
    for body in BODIES:
        discrete = nh.discretize(body.system, 1.0)
        for W in displacements(body)[::2]:
            first = _from_first_argument(body, W)
            result = slopes(lambda nudge, b=body, W=W: b.lagrangian(nudge * W), body.group)
            second = twin.column([general.momentum_by_displacement(slope) for slope in result])
            printed = twin.column([general.printed_momentum_by_displacement(slope) for slope in result])
            library = apart(nh.discrete_legendre(discrete, in_double(W)), first)
            right.append(twin.both(twin.worst(first - second), library))
            wrong.append(twin.worst(first - printed))
    return Measured(max(right), max(wrong), "7 bodies, 3 displacements each")


@statement
def legendre() -> Measured:
    """At W = I its derivative is the inertia operator; half-turns about the principal axes also have momentum zero."""
    defects = []
    for body in SMALL:
        for j, e in enumerate(twin.basis(body.group)):
            slope = twin.rate(lambda t, b=body, e=e: b.momentum(twin.exp(t * e)))
            defects.append(twin.worst(slope - body.inertia[:, j]))
    tensor, half_turn = np.diag([1.5, 1.0, 0.5]), np.diag([-1.0, 1.0, -1.0])
    body = Body(nh.SO(3), tuple(map(tuple, tensor)), TOP.subspace, TOP.annihilator)
    exact = twin.worst(body.momentum(ctx.matrix(half_turn.tolist())))
    library = nh.discrete_legendre(nh.discretize(nh.RigidBody(tensor), 1.0), half_turn)
    return Measured(max(*defects, twin.both(exact, abs(library).max())), note="3 bodies; a half-turn with P = 0")
