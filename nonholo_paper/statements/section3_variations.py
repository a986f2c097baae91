"""Section 3, the variational principle on a group: variations, four equivalent forms of the equations."""

import itertools
from collections.abc import Callable

from nonholo_paper import _sequences as sequences
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import ANY_4, SLEIGH, SMALL, TOP, TOP_4, Body, slopes
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, ctx
from nonholo_paper.formulas import general


def _variations(body: Body, seed: int) -> list[Matrix]:
    """Return variations g_k^-1 delta g_k of all poses, zero at both ends, not restricted by the constraint."""
    inner = [twin.hat(body.group, twin.numbers(seed + k, body.group.dim)) for k in range(sequences.STEPS - 1)]
    nothing = ctx.zeros(body.group.size)
    return [nothing, *inner, nothing]


def _action_rate(body: Body, variations: list[Matrix]) -> Number:
    """Return the derivative of the action sum along variations of the poses, by its definition."""
    poses = sequences.poses(body)

    def action(t: Number) -> Number:
        moved = [g * twin.exp(t * eta) for g, eta in zip(poses, variations, strict=True)]
        return ctx.fsum(body.lagrangian(g**-1 * g_next) for g, g_next in itertools.pairwise(moved))

    return twin.rate(action)


@statement
def admissible_variations() -> Measured:
    """Differentiate curves g exp(t eta), eta in d, and move them by a group element."""
    defects = []
    for body in (*SMALL, TOP_4, ANY_4):
        for g in sequences.poses(body):
            eta = twin.hat(body.group, body.velocity(twin.numbers(4, len(body.subspace))))
            variation = twin.rate(lambda t, g=g, eta=eta: g * twin.exp(t * eta))
            x = twin.column(twin.vee(body.group, general.body_velocity(g, variation)))
            defects += [*(twin.dot(a, x) for a in body.forms), *(general.body_velocity(g, variation) - eta)]
    return Measured(twin.worst(defects), note="5 bodies, 5 poses each")


@statement
def action_sums() -> Measured:
    """Count the displacements of N + 1 poses, and compare both sums."""
    right, wrong = [], []
    for body in SMALL:
        poses = sequences.poses(body)
        result = [g**-1 * g_next for g, g_next in itertools.pairwise(poses)]
        pairs = zip(result, sequences.displacements(body), strict=True)
        right += [body.lagrangian(W) - body.lagrangian(V) for W, V in pairs]
        right.append(len(result) - (len(poses) - 1))
        wrong.append(len(result) - (len(poses) - 2))
    return Measured(twin.worst(right), float(min(wrong)), "a count: N + 1 poses have N displacements")


@statement
def equivalence() -> Measured:
    """Compare first variations in the forms (i), (iii), (iv) for arbitrary sequences and variations."""
    defects = []
    for body in (*SMALL, TOP_4):
        result = sequences.displacements(body)
        gradients = [sequences.slope(body, W) for W in result]
        for seed in (40, 50):
            eta = _variations(body, seed)
            by_definition = _action_rate(body, eta)
            reduced = ctx.fsum(
                twin.inner(slope, general.displacement_variation(W, *ends))
                for slope, W, ends in zip(gradients, result, itertools.pairwise(eta), strict=True)
            )
            balances = ctx.fsum(
                general.balance(gradients[k - 1 : k + 1], result[k - 1 : k + 1], eta[k])
                for k in range(1, sequences.STEPS)
            )
            defects += [by_definition - reduced, by_definition - balances]
    orbits = [_stationarity(body) for body in (TOP, SLEIGH, TOP_4, ANY_4)]
    return Measured(
        twin.both(twin.worst(defects), max(orbits)), note="4 bodies, any sequences; 4 orbits of the library"
    )


def _stationarity(body: Body) -> float:
    """Return the largest value on d of the equations (iv) along an orbit of the library."""
    result = [sequences.exactly(W) for W in sequences.orbit(body).displacement]
    balances = []
    for pair in itertools.pairwise(result):
        gradients = [sequences.slope(body, W) for W in pair]
        balances += [general.balance(gradients, pair, twin.hat(body.group, e)) for e in body.directions]
    return twin.worst(balances)


@statement
def first_displacement() -> Measured:
    """Solve (iv) for a first displacement off the variety; printed: how asymmetric it is where it must not be."""
    right, wrong = [], []
    for seed in (1, 2, 3):
        W = TOP.displacement(TOP.velocity(twin.numbers(seed, 2)))
        carried, aside = TOP.restrict(TOP.arriving(W)), ctx.mpf("0.125")

        def turned(x: Number, y: Number, aside: Number = aside) -> Matrix:
            return twin.exp(twin.hat(TOP.group, [x, y, aside]))

        def missed(x: Number, y: Number, carried: Matrix = carried) -> list[Number]:
            return list(TOP.restrict(TOP.arriving(turned(x, y))) - carried)

        start = twin.vee(TOP.group, (W - W.T) / 2)[:2]
        off = turned(*ctx.findroot(missed, start, tol=1e-90, verify=False))
        right += [*(TOP.restrict(TOP.arriving(off)) - carried), W[1, 0] - W[0, 1]]
        wrong.append(abs(off[1, 0] - off[0, 1]))
    return Measured(twin.worst(right), float(min(wrong)), "a top, three displacements")


@statement
def equations_on_group() -> Measured:
    """Differentiate by the common pose: the slopes sum to minus the jump of momentum, for orbits a force."""
    defects, orbits = [], []
    for body in (TOP, SLEIGH, TOP_4):
        poses = sequences.poses(body)
        for before, g, after in zip(poses, poses[1:], poses[2:], strict=False):
            balance = general.coordinate_balance(*_slopes_at(body, before, g, after))
            jump = general.momentum_jump(body.momentum(g**-1 * after), body.arriving(before**-1 * g))
            defects.append(balance + jump)
        orbit = sequences.orbit(body)
        for k in range(sequences.STEPS):
            W, W_next = (sequences.exactly(orbit.displacement[i]) for i in (k, k + 1))
            balance = general.coordinate_balance(*_slopes_at(body, W**-1, ctx.eye(W.rows), W_next))
            orbits.append(twin.worst(balance - general.reaction((-orbit.multipliers[k]).tolist(), body.forms)))
    return Measured(twin.both(twin.worst(*defects), max(orbits)), note="tops n = 3, 4 and a sleigh, and their orbits")


def _slopes_at(body: Body, before: Matrix, g: Matrix, after: Matrix) -> tuple[Matrix, Matrix]:
    """Return D1 L_d(g, after) and D2 L_d(before, g), both pulled back by the pose g."""
    first = slopes(lambda nudge: body.lagrangian((g * nudge) ** -1 * after), body.group)
    return first, slopes(lambda nudge: body.lagrangian(before**-1 * (g * nudge)), body.group)


@statement
def induced_variation() -> Measured:
    """Differentiate the displacement between two moving poses."""
    defects = []
    for body in (*SMALL, TOP_4):
        start, end = (twin.hat(body.group, twin.numbers(seed, body.group.dim, -2, 2)) for seed in (60, 61))
        for g, g_next in itertools.pairwise(sequences.poses(body)):
            moving = _moving(g, g_next, start, end)
            defects.append(twin.rate(moving) - general.displacement_variation(g**-1 * g_next, start, end))
    return Measured(twin.worst(*defects), note="4 bodies, 4 displacements each")


def _moving(g: Matrix, g_next: Matrix, start: Matrix, end: Matrix) -> Callable[[Number], Matrix]:
    """Return the displacement between two poses that move in their own directions."""
    return lambda t: (g * twin.exp(t * start)) ** -1 * (g_next * twin.exp(t * end))


@statement
def reduced_equations() -> Measured:
    """Compare the left-hand side with momenta by definition, and on d with orbits of the library."""
    defects = []
    for body in (TOP, SLEIGH, TOP_4):
        for before, after in itertools.pairwise(sequences.displacements(body)):
            pair = [sequences.slope(body, before), sequences.slope(body, after)]
            left = [general.balance(pair, [before, after], E) for E in twin.basis(body.group)]
            defects.append(twin.column(left) - (body.arriving(before) - body.momentum(after)))
    orbits = [_stationarity(body) for body in (TOP, SLEIGH, TOP_4, ANY_4)]
    return Measured(twin.both(twin.worst(*defects), max(orbits)), note="tops n = 3, 4 and a sleigh; 4 orbits")
