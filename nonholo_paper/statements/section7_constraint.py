"""Section 7: the constraint on displacements of the sleigh, what defines it and what it means in the plane."""

from collections.abc import Callable

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._sleigh_twin import TURNS, admissible, pose, poses
from nonholo_paper._twin import Matrix, Number, ctx, worst
from nonholo_paper.formulas import sleigh_continuous as continuous
from nonholo_paper.formulas import sleigh_discrete as formulas

PAIRS = poses(731, 4)
ALL_TURNS = [*TURNS, (ctx.pi, ctx.mpf("0.9")), (-ctx.pi, ctx.mpf(2)), (2 * ctx.pi, ctx.mpf(1))]
PROPER = [turn for turn in TURNS if abs(turn[0]) > 0.1]


def _entries(turn: tuple) -> tuple[Number, Number, Number]:
    """Return the angle and the translation of an admissible displacement."""
    W = admissible(turn)
    return turn[0], W[0, 2], W[1, 2]


def _stepped(turn: tuple, start: list) -> tuple[list, list]:
    """Return a pose and the pose after an admissible displacement."""
    moved = pose(*start) * admissible(turn)
    return start, [start[0] + turn[0], moved[0, 2], moved[1, 2]]


STEPS = [_stepped(turn, start) for turn in TURNS for start in (PAIRS[0][0], PAIRS[1][0])]


@statement
def naive_choice() -> Measured:
    """Compare the two sides, and count exponentials with a turn and a shift that satisfy it."""
    gaps = [formulas.naive_constraint(*pair) - (pose(*pair[0]) ** -1 * pose(*pair[1]))[1, 2] for pair in PAIRS]
    satisfied = sum(abs(admissible(turn)[1, 2]) < 1e-30 for turn in PROPER if turn[1] != 0)
    return Measured(max(worst(gaps), satisfied), note="6 pairs of poses; 5 exponentials, none naive")


@statement
def left_invariance() -> Measured:
    """Move both poses by a rigid motion."""
    right, wrong = [], []
    mover = pose(*PAIRS[0][0])
    for before, after in PAIRS:
        X, Y = pose(*before), pose(*after)
        right += [*((mover * X) ** -1 * (mover * Y) - X**-1 * Y)]
        wrong.append(worst(mover * Y * (mover * X).T - Y * X.T))
    return Measured(worst(right), min(wrong), "6 pairs of poses")


def _two_cosets(n: int, seed: int) -> tuple[Matrix, list[Matrix]]:
    """Return exp of an admissible velocity and two elements g with W = g s(g)^-1, s the involution that reverses d."""
    row = twin.numbers(seed, n, -1, 1)
    X = continuous.admissible_velocity(row[:-1], row[-1])
    half, turned = twin.exp(X / 2), ctx.eye(n + 1)
    turned[0, 0] = turned[1, 1] = -1
    return twin.exp(X), [half, half * turned]


@statement
def coverings() -> Measured:
    """Map two cosets to one exponential, and one coset to itself; printed is the distance between the two cosets."""
    right, wrong = [], []
    for n in (2, 3, 4):
        W, elements = _two_cosets(n, 740 + n)
        mirror = ctx.diag([-1, *[1] * n])
        for g in elements:
            q, x = g[:n, 0], g[:n, n]
            right += [*(g * mirror * g**-1 * mirror - W), *(formulas.on_line(q, 2 * ctx.fdot(q, x)) - W)]
        wrong.append(ctx.norm(elements[0][:n, 0] - elements[1][:n, 0]))
    return Measured(worst(right), worst(wrong), "n = 2, 3, 4")


@statement
def circ_motion() -> Measured:
    """Write exponentials as points of lines; printed is the distance of a shift sideways from all such points."""
    gaps = []
    for angle, v1 in ALL_TURNS:
        half = angle / 2
        nu, q = v1 * ctx.sinc(half), ctx.matrix([ctx.cos(half), ctx.sin(half)])
        gaps += [
            *(formulas.on_line(q, nu) - admissible((angle, v1))),
            *(formulas.on_line(-q, -nu) - admissible((angle, v1))),
        ]
        once = ctx.matrix([ctx.cos(half + ctx.pi), ctx.sin(half + ctx.pi)])
        gaps += [*(once + q)]
    sideways = (ctx.zero, ctx.mpf("0.3"), ctx.mpf("0.7"))
    gaps.append(formulas.full_angle_constraint(*sideways))
    return Measured(worst(gaps), worst([formulas.half_angle_constraint(*sideways)]), "12 exponentials")


@statement
def constr_omegas() -> Measured:
    """Evaluate both quotients on exponentials where they have a value."""
    pairs = [formulas.quotients(admissible(turn)) for turn in PROPER if turn[1] != 0]
    return Measured(
        worst([x - y for x, y in pairs]), note="5 exponentials, angles to 5.1; not defined at 0 and half a turn"
    )


@statement
def se2_const() -> Measured:
    """Evaluate it on exponentials, and on the displacements that the library gives for a sleigh."""
    gaps = [formulas.half_angle_constraint(*_entries(turn)) for turn in ALL_TURNS]
    result = nh.displacements_over(nh.discretize(nh.ChaplyginSleigh(1.0, 1.5, 0.3, 0.2), 1.0), [0.1, -0.7])
    library = []
    for W in result.displacement[result.is_real].real:
        library.append(formulas.half_angle_constraint(ctx.atan2(W[1, 0], W[0, 0]), W[0, 2], W[1, 2]))
    return Measured(twin.both(worst(gaps), worst(library)), note="12 exponentials; library: 3 displacements")


@statement
def se_const() -> Measured:
    """Compare both at random displacements; printed is (se2.const) at a displacement that satisfies the other."""
    gaps = []
    for before, after in PAIRS:
        entries = formulas.step_angle(before, after), *formulas.discrete_velocities(before, after)
        factor = -2 * ctx.sin(entries[0] / 2)
        gaps.append(formulas.full_angle_constraint(*entries) - factor * formulas.half_angle_constraint(*entries))
    sideways = (ctx.zero, ctx.mpf("0.3"), ctx.mpf("0.7"))
    gaps.append(formulas.full_angle_constraint(*sideways))
    return Measured(worst(gaps), worst([formulas.half_angle_constraint(*sideways)]), "6 displacements")


@statement
def constraint_in_space() -> Measured:
    """Evaluate it on admissible steps, compare with (se2.const) on all, and differentiate in the limit."""
    gaps = [formulas.constraint_in_space(*step) for step in STEPS]
    for before, after in PAIRS:
        entries = formulas.step_angle(before, after), *formulas.discrete_velocities(before, after)
        gaps.append(formulas.constraint_in_space(before, after) - formulas.half_angle_constraint(*entries))
        limit = ctx.diff(_toward(before, after), 0)
        gaps.append(limit - continuous.reconstruction(before[0], after[1], after[2])[1])
    return Measured(worst(gaps), note="18 admissible steps, 6 others")


def _toward(start: list, velocity: list) -> Callable[[Number], Number]:
    """Return the constraint of the step from a pose along a velocity, as a function of the time step."""
    return lambda e: formulas.constraint_in_space(start, [x + e * v for x, v in zip(start, velocity, strict=True)])


@statement
def exponential() -> Measured:
    """Compare with the series of the exponential."""
    gaps = []
    for omega, v in PROPER:
        time = ctx.mpf("0.7")
        gaps += [*(formulas.exponential(omega, v, time) - admissible((omega * time, v * time)))]
    return Measured(worst(gaps), note="6 velocities")


@statement
def quotient() -> Measured:
    """Compare the quotients of the entries of exponentials with the tangent of half the angle."""
    gaps = []
    for angle, v1 in PROPER:
        tangent = ctx.tan(angle / 2)
        for turn in (angle, angle + 2 * ctx.pi):
            entries = formulas.quotients(admissible((turn, v1))) if v1 != 0 else []
            gaps += [(x - tangent) / (1 + tangent**2) for x in entries]
    return Measured(worst(gaps), note="10 exponentials; for the tangent t relative to 1 + t^2")


@statement
def discr_vel1() -> Measured:
    """Evaluate both on admissible steps."""
    gaps = []
    for step in STEPS:
        pairs = zip(formulas.discrete_velocities(*step), formulas.tangent_velocities(*step), strict=True)
        gaps += [x - y for x, y in pairs]
    return Measured(worst(gaps), note="18 admissible steps")


@statement
def circle_of_a_step() -> Measured:
    """Put a circle of this radius to the first blade, and test the second point and the second blade."""
    gaps = []
    for before, after in STEPS:
        angle = formulas.step_angle(before, after)
        if abs(angle) < 0.1:
            continue
        radius = formulas.radius(angle, formulas.discrete_velocities(before, after)[0])
        middle = [before[1] - radius * ctx.sin(before[0]), before[2] + radius * ctx.cos(before[0])]
        dx, dy = after[1] - middle[0], after[2] - middle[1]
        gaps += [dx**2 + dy**2 - radius**2, dx * ctx.cos(after[0]) + dy * ctx.sin(after[0])]
    return Measured(worst(gaps), note="12 admissible steps, angles to 5.1")


@statement
def rotate_slide_rotate() -> Measured:
    """Multiply the three; the slide is the component of the translation along the blade turned halfway."""
    gaps = []
    for turn in ALL_TURNS:
        angle, V_1, V_2 = _entries(turn)
        slide = V_1 * ctx.cos(angle / 2) + V_2 * ctx.sin(angle / 2)
        product = pose(angle / 2, 0, 0) * pose(0, slide, 0) * pose(angle / 2, 0, 0)
        gaps += [*(product - admissible(turn))]
    return Measured(worst(gaps), note="12 exponentials, half turns and full turns among them")
