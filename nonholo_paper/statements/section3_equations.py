"""Section 3, the discrete Euler-Poincare-Suslov equations: signs, the three steps of the map."""

import itertools

import numpy as np

import nonholo as nh
from nonholo_paper import _sequences as sequences
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import ANY_4, SLEIGH, SMALL, TOP, TOP_4, Body
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import ctx
from nonholo_paper.formulas import general


@statement
def transported_slope() -> Measured:
    """Compare both middle terms with the last one and with the momentum by its definition."""
    right, wrong = [], []
    for body in SMALL:
        for W in sequences.displacements(body):
            slope, E = sequences.slope(body, W), twin.basis(body.group)
            pulled = [general.left_pullback(slope, W, e) for e in E]
            last = twin.column(twin.coadjoint(body.group, W**-1, pulled))
            middle = twin.column([general.transport(slope, W, e) for e in E])
            right += [middle - last, last - body.momentum(W)]
            wrong.append(twin.worst(twin.column([general.printed_transport(slope, W, e) for e in E]) - last))
    return Measured(twin.worst(*right), min(wrong), "2 tops and a sleigh, 4 displacements each")


@statement
def momentum_equation() -> Measured:
    """Compare both left-hand sides for any two displacements, and the library with the jump of momentum."""
    right, wrong = [], []
    for body in (TOP, SLEIGH, TOP_4):
        for before, after in itertools.pairwise(sequences.displacements(body)):
            carried = twin.column(twin.coadjoint(body.group, before, list(body.momentum(before))))
            jump = general.momentum_jump(body.momentum(after), carried)
            slopes = [sequences.slope(body, before), sequences.slope(body, after)]
            left = twin.column([general.balance(slopes, [before, after], E) for E in twin.basis(body.group)])
            right.append(twin.worst(jump + left))
            wrong.append(twin.worst(jump - left))
    library = [_multiplier_defect(body) for body in (TOP, SLEIGH, TOP_4, ANY_4)]
    return Measured(twin.both(max(right), max(library)), min(wrong), "tops n = 3, 4 and a sleigh; 4 orbits")


def _multiplier_defect(body: Body) -> float:
    orbit, worst = sequences.orbit(body), 0.0
    for k in range(sequences.STEPS):
        before, after = (sequences.exactly(orbit.displacement[i]) for i in (k, k + 1))
        jump = general.momentum_jump(body.momentum(after), body.arriving(before))
        worst = max(worst, twin.worst(jump - general.reaction(orbit.multipliers[k].tolist(), body.forms)))
    return worst


@statement
def discrete_analog() -> Measured:
    """Compare jumps of momentum over a step of size 1e-60 with the free part of the continuous equations."""
    defects = []
    for body in (*SMALL, TOP_4):
        with ctx.workdps(200):
            h, k = ctx.mpf(10) ** -60, len(body.subspace)
            omega, rate = (body.velocity(twin.numbers(seed, k, -2, 2)) for seed in (5, 6))
            before, after = body.displacement(h * omega), body.displacement(h * omega + h**2 * rate)
            jump = general.momentum_jump(body.momentum(after), body.arriving(before))
            torque = twin.coad(body.group, omega, body.inertia * omega)
            free = general.momentum_rate(torque, [0] * len(body.forms), body.forms)
            defects.append(jump / h**2 - (body.inertia * rate - free))
    return Measured(twin.worst(*defects), note="3 bodies and a top n = 4, h = 1e-60")


@statement
def three_steps() -> Measured:
    """Take the three steps with the library, and compare the smallest momentum with its own next state."""
    defects = []
    tops = [nh.SuslovTop(body.mass_tensor) for body in (TOP, TOP_4)]
    for system in (*tops, nh.ChaplyginSleigh(2.0, 1.25, 0.5, -0.25)):
        discrete, k = nh.discretize(system, 0.25), len(system.constraint_subspace)
        orbit = nh.simulate(discrete, restricted_velocity=[0.5, -0.25, 0.125][:k], steps=2)
        W = nh.inverse_discrete_legendre(discrete, orbit.momentum[0])
        arriving = system.group.coadjoint(W, orbit.momentum[0])
        result = nh.displacements_over(discrete, system.restrict(arriving))
        points = result.momentum[result.is_real].real
        chosen = points[np.linalg.norm(points, axis=1).argmin()]
        defects += [abs(chosen - orbit.momentum[1]).max(), abs(system.restrict(chosen - arriving)).max()]
    return Measured(twin.both(0.0, max(defects)), note="tops n = 3, 4 and a sleigh")
