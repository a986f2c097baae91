"""Section 8, the conclusions: what is kept, whether the maps are solvable, several dimensions."""

import itertools
from collections.abc import Callable

import numpy as np

import nonholo as nh
from nonholo.discrete import BranchGrowth
from nonholo.groups import SE, SO, AbstractMatrixGroup
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import ANY_4, BALANCED_SLEIGH, BALANCED_TOP, SLEIGH, TOP, Body, displacements, velocities
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, ctx
from nonholo_paper.formulas import correspondences, energy_theorem, general, suslov_continuous


@statement
def conservation() -> Measured:
    """Compare the restricted momenta and their energies before and after a step, and follow orbits of the library."""
    defects = []
    for body in (TOP, SLEIGH, BALANCED_TOP, BALANCED_SLEIGH):
        balanced = body in (BALANCED_TOP, BALANCED_SLEIGH)
        for W in displacements(body):
            r, after = body.restrict(body.momentum(W)), body.restrict(body.arriving(W))
            defects.append(twin.worst([_energy_change(body, W)]))
            defects += [twin.worst(after - r)] if balanced else []
        orbit = nh.simulate(nh.discretize(body.system, 1.0), restricted_velocity=(0.5, -0.25), steps=10)
        constant = [orbit.energy, *orbit.momentum.T] if balanced else [orbit.energy]
        defects += [twin.both(0.0, np.ptp(values)) for values in constant]
    return Measured(max(defects), note="tops and sleighs, balanced or not; 4 orbits of 10 steps")


def _energy_change(body: Body, W: Matrix) -> Number:
    """Return what a step with this displacement adds to the reduced constrained energy."""
    inverse = body.restricted_inertia() ** -1
    before, after = (body.restrict(p) for p in (body.momentum(W), body.arriving(W)))
    return general.half_form(inverse, after, after.rows) - general.half_form(inverse, before, before.rows)


State = tuple[Number, Number]
Images = Callable[[State], list[tuple[Matrix, State]]]

_MOMENTS, _COUPLING = (ctx.mpf("2.75"), ctx.mpf("2.25")), (ctx.mpf("0.5"), ctx.mpf("-0.25"))
_SOLVED_TOP = Body(
    SO(3), ((1.5, 0.0, 0.5), (0.0, 1.0, -0.25), (0.5, -0.25, 1.25)), ((0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)), ()
)
_SIZES = ctx.mpf(2), ctx.mpf("1.25"), ctx.mpf("0.5")
_SOLVED_SLEIGH = Body(SE(2), ((1.125, 0.0, 1.0), (0.0, 0.625, 0.0), (1.0, 0.0, 2.0)), SLEIGH.subspace, ())
_START = ctx.mpf("0.3"), ctx.mpf("0.2")


def _top_images(r: State) -> list[tuple[Matrix, State]]:
    """Return every displacement with given halved momenta of the top, and the momenta after it."""
    images = []
    for s in correspondences.top_roots(r, _MOMENTS, _COUPLING):
        y, after = correspondences.top_image(s, r, _MOMENTS, _COUPLING)
        Y = suslov_continuous.admissible(list(y))
        images.append(((ctx.eye(3) - Y) ** -1 * (ctx.eye(3) + Y), after))
    return images


def _sleigh_images(p: State) -> list[tuple[Matrix, State]]:
    return [correspondences.sleigh_image(t, p, _SIZES) for t in correspondences.sleigh_roots(p, _SIZES)]


def _wrong_momenta(body: Body, images: Images, unit: int) -> float:
    """Return the distance of momenta by definition, before and after displacements of a start, from those solved."""
    defects = []
    for W, after in images(_START):
        result = (body.restrict(body.momentum(W)), body.restrict(body.arriving(W)))
        defects += [p - unit * twin.column(state) for p, state in zip(result, (_START, after), strict=True)]
    return twin.worst(*defects)


def _count(images: Images, generations: int) -> int:
    """Count the momenta after some steps that are further apart than 1e-12."""
    states = [_START]
    for _ in range(generations):
        states = [after for state in states for _, after in images(state)]
    values = np.array([[complex(x) for x in state] for state in states])
    near = np.abs(values[:, None] - values[None]).max(axis=2) < 1e-12
    return len(values) - int(np.triu(near, 1).any(axis=0).sum())


@statement
def sleigh_solvability() -> Measured:
    """Count images after 1 to 4 steps, check the first by the definition; follow the words of the theorem."""
    counts = [(n, _count(_sleigh_images, n)) for n in (1, 2, 3, 4)]
    right = [abs(result - 3**n) for n, result in counts]
    wrong = [abs(result - correspondences.printed_image_count(3, n)) for n, result in counts]
    solved, growth = _wrong_momenta(_SOLVED_SLEIGH, _sleigh_images, 1), nh.branch_growth(_GROWING)
    words = f"words of {', '.join(str(len(word)) for word in growth.words)} steps, L = {growth.rate:.4f}"
    note = f"{counts[-1][1]} images after 4 steps; {words}"
    return Measured(max(solved, _outside(growth), *right), float(max(wrong)), note)


_GROWING = nh.discretize(nh.ChaplyginSleigh(2.0, 1.25, 0.5), 1.0)


def _outside(growth: BranchGrowth) -> float:
    """Count ends of the interval that a word takes out of its disc, by the cubic; they hold the interval's parts."""
    m, J, a = _SIZES
    turning, sliding = ctx.sqrt(2 * (J + m * a**2) * growth.energy), ctx.sqrt(2 * m * growth.energy)
    outside, (middle, half) = 0, growth.discs[0]
    for word, (center, radius) in zip(growth.words, growth.discs[1:], strict=True):
        for x in (middle - half, middle + half):
            state = ctx.mpc(0, turning * ctx.sinh(x)), sliding * ctx.cosh(x)
            for letter in word:
                roots = sorted(correspondences.sleigh_roots(state, _SIZES), key=lambda t: t.imag)
                state = correspondences.sleigh_image(roots[1 + letter], state, _SIZES)[1]
            outside += abs(ctx.asinh(state[0].imag / turning) - center) > radius
    return float(outside)


@statement
def top_solvability() -> Measured:
    """Count the images after 1 and 2 steps, n = 3; compare energies and Lyapunov functions, n = 3, 4, 5."""
    counts = [(n, _count(_top_images, n)) for n in (1, 2)]
    right = [_wrong_momenta(_SOLVED_TOP, _top_images, 2), *(abs(result - 4**n) for n, result in counts)]
    wrong = [abs(result - correspondences.printed_image_count(4, n)) for n, result in counts]
    for n in (3, 4, 5):
        body = _random_top(n)
        c = twin.column([body.tensor[i, n - 1] for i in range(n - 1)])
        for w in velocities(body)[::2]:
            W = body.displacement(w)
            r, after = body.restrict(body.momentum(W)), body.restrict(body.arriving(W))
            drop = twin.dot(c, after - r) - energy_theorem.lyapunov_step(c, _half_angle_vector(body, w))
            right.append(twin.worst([_energy_change(body, W), drop]))
    return Measured(max(right), float(max(wrong)), f"{counts[-1][1]} images after 2 steps; tops n = 3, 4, 5")


def _random_top(n: int) -> Body:
    group = SO(n)
    places = [[round(8 * float(x)) / 8 for x in twin.numbers(10 * n + i, n, -2, 2)] for i in range(n + 1)]
    tensor = np.array(places).T @ np.array(places)
    planes = tuple(tuple(row) for row in nh.SuslovTop(tensor).constraint_subspace.tolist())
    return Body(group, tuple(map(tuple, tensor.tolist())), planes, ())


def _half_angle_vector(body: Body, w: Matrix) -> Matrix:
    """Return z = sin(t/2) u of the rotation by t in the plane of u and e_n."""
    X = twin.hat(body.group, list(w))
    x = X[: X.rows - 1, X.rows - 1]
    angle = ctx.sqrt(twin.dot(x, x))
    return x / 2 if angle == 0 else ctx.sin(angle / 2) / angle * x


def _random_body(group: AbstractMatrixGroup, k: int) -> Body:
    """Return a body with k random directions, all numbers short binary fractions."""
    homogeneous = not np.any(group.basis[:, -1])
    places = [[round(8 * float(x)) / 8 for x in twin.numbers(20 * k + i, group.size, -2, 2)] for i in range(6)]
    points = np.array([[*place[:-1], 1.0] if homogeneous else place for place in places])
    rows = [tuple(round(8 * float(x)) / 8 for x in twin.numbers(90 + k + i, group.dim)) for i in range(k)]
    return Body(group, tuple(map(tuple, (points.T @ points).tolist())), tuple(rows), ())


@statement
def several_dimensions() -> Measured:
    """Compare energies before and after a step for random subspaces of so(n) and se(n), with both varieties."""
    right, wrong = [], []
    for group, k in ((SO(3), 2), (SO(4), 2), (SO(4), 3), (SE(2), 2), (SE(3), 2), (SE(3), 4)):
        body = _random_body(group, k)
        velocity = body.velocity([x / 4 for x in twin.numbers(k, k)])
        X = twin.hat(group, list(velocity))
        W = energy_theorem.with_skew_part(X)
        right += [twin.worst(energy_theorem.skew_part(W) - X), abs(_energy_change(body, W))]
        if group.dim == 6:
            wrong.append(float(abs(_energy_change(body, body.displacement(velocity)))))
    orbit = nh.simulate(nh.discretize(ANY_4.system, 1.0), restricted_velocity=(0.5, -0.25), steps=10)
    return Measured(twin.both(max(right), np.ptp(orbit.energy)), min(wrong), "6 random subspaces; one orbit on SO(4)")


@statement
def right_invariant() -> Measured:
    """Follow a top whose constraint is fixed in space: momenta by definition, displacements as seen from space."""
    tensor = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
    orbit = nh.simulate(nh.discretize(nh.VeselovaTop(tensor), 1.0), restricted_velocity=(0.5, -0.25), steps=10)
    poses, momenta, spins = [ctx.matrix(g.tolist()) for g in orbit.configuration], [], []
    for g, after in itertools.pairwise(poses):
        W, U = g**-1 * after, after * g**-1
        P = twin.column(twin.vee(SO(3), W * ctx.matrix(tensor.tolist()) - ctx.matrix(tensor.tolist()) * W.T))
        momenta.append(g * P)
        spins.append(U[1, 0] - U[0, 1])
    changes = [p[:2, 0] - momenta[0][:2, 0] for p in momenta]
    moves = twin.worst(*(p[2] - momenta[0][2] for p in momenta)) > 0.01
    return Measured(max(twin.both(0, twin.worst(*changes, spins)), float(not moves)), note="a top, 10 steps")
