"""Section 6: stationary solutions of the discrete top, and the theorem about where the others come from and go to."""

import numpy as np

import nonholo as nh
from nonholo_paper import _suslov_twin as data
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._twin import Matrix, Number, Vector, ctx
from nonholo_paper.formulas import suslov_integrals as formulas
from nonholo_paper.formulas import suslov_momenta


def _equilibria() -> list[tuple[Matrix, Vector, Matrix]]:
    """Return points of the line of equilibria of bodies with c not zero, a half-turn among them."""
    bodies = [data.body(name) for name in (*data.REGULAR, "aligned", "tilted rod")]
    cases = []
    for J in bodies:
        for q0, sign in ((0.9, 1), (0.6, -1), (0, 1)):
            length = ctx.sqrt((1 - ctx.mpf(q0) ** 2) / (J[0, 2] ** 2 + J[1, 2] ** 2))
            q = [ctx.mpf(q0), -sign * length * J[1, 2], sign * length * J[0, 2]]
            cases.append((J, q, data.rotation(q)))
    return cases


@statement
def mirror() -> Measured:
    """Compare the turned momentum with the reflected one."""
    right = []
    for J, q, W in _equilibria():
        M = data.momentum(J, W)
        right += [suslov_momenta.slope(J, q), *twin.differences(data.turned(J, W), [M[0], M[1], -M[2]])]
    return Measured(twin.worst(right), note="four bodies, three points of the line each")


@statement
def stationary() -> Measured:
    """Choose the multiplier and look for the change; with another one, which the printed equation allows, too."""
    right, wrong = [], []
    for J, q, W in _equilibria():
        chosen = (data.momentum(J, W)[2] - data.turned(J, W)[2]) / 4
        right += suslov_momenta.change(J, q, chosen)
        wrong += suslov_momenta.change(J, q, chosen + 1)
    return Measured(twin.worst(right), twin.worst(wrong), "four bodies, three points each")


@statement
def no_other_equilibria() -> Measured:
    r"""Compare the change along the constraint with $4|J_{13}q_1 + J_{23}q_2|\,|(q_1, q_2)|$, and the library too."""
    exact, library = [], []
    for J, q, W in data.samples():
        moved = twin.differences(data.turned(J, W), data.momentum(J, W))
        exact.append(ctx.hypot(*moved[:2]) - 4 * abs(suslov_momenta.slope(J, q)) * ctx.hypot(q[1], q[2]))
    for name in (*data.REGULAR, "tilted rod"):
        J = data.body(name)
        line = nh.equilibria(data.discrete(J), energy=0.01).subspace[0]
        library.append(float(J[0, 2]) * line[0] + float(J[1, 2]) * line[1])
    return Measured(twin.both(twin.worst(exact), twin.worst(library)), note="8 bodies, 12 displacements")


@statement
def balanced() -> Measured:
    """Compare turned momenta with the momentum, those of both branches too; printed: the change of the third."""
    right, library, jumps = [], [], []
    for name in ("balanced", "J1 = J2"):
        J = data.body(name)
        for q, W in data.turns():
            right += twin.differences(data.turned(J, W)[:2], data.momentum(J, W)[:2])
            right += twin.differences(suslov_momenta.arriving(J, q)[:2], suslov_momenta.momentum(J, q)[:2])
            sine = ctx.hypot(q[1], q[2])
            if sine > 0.01 and q[0] > 0.01:
                other = data.rotation([sine, q[1] * q[0] / sine, q[2] * q[0] / sine])
                changes = twin.differences(data.momentum(J, other), data.turned(J, W))
                right += changes[:2]
                jumps.append(data.momentum(J, other)[2] - data.momentum(J, W)[2])
        orbit = nh.simulate(data.discrete(J), displacement=data.array(data.rotation(data.points()[0])), steps=20)
        library += list((orbit.momentum - orbit.momentum[0]).ravel())
    note = "two bodies, 12 displacements; 20 steps"
    return Measured(twin.both(twin.worst(right), twin.worst(library)), twin.worst(jumps), note)


@statement
def theorem() -> Measured:
    """Compare multipliers at equilibria with derivatives of momenta; follow six orbits of the library to their ends."""
    missed = []
    for name in (*data.REGULAR, "aligned"):
        J = data.body(name)
        across = [J[0, 2], J[1, 2]]
        for zeta in (0.1, 0.4, -0.3):
            z0, q = _equilibrium(J, ctx.mpf(zeta))
            leaving, arriving = _slope_along(J, q, False), _slope_along(J, q, True)
            inertia = (twin.trace(J) * ctx.eye(3) - J)[:2, :2] ** -1
            weights = inertia * ctx.matrix(across)
            before, after = (weights[0] * m[0] + weights[1] * m[1] for m in (leaving, arriving))
            missed.append(after - formulas.multiplier(J, z0, ctx.mpf(zeta)) * before)
    ends, facts = [], []
    for name in data.REGULAR:
        for start in ((0.2, 0.1), (0.1, -0.3), (-0.2, 0.3)):
            end, is_sound = _orbit(name, start)
            ends.append(end)
            facts.append(is_sound)
    wrong = [max(end, 0) for end in ends]
    return Measured(max(twin.worst(missed), data.lacking(*facts, *(end > 0 for end in ends))), max(wrong), "6 orbits")


def _equilibrium(J: Matrix, zeta: Number) -> tuple[Number, Vector]:
    """Return the displacement with z = -zeta c."""
    z = [-zeta * J[0, 2], -zeta * J[1, 2]]
    z0 = ctx.sqrt(1 - z[0] ** 2 - z[1] ** 2)
    return z0, [z0, -z[1], z[0]]


def _slope_along(J: Matrix, q: Vector, turned: bool) -> Vector:
    """Return the derivative of both momenta along the constraint, across the line of equilibria."""
    momenta = data.turned if turned else data.momentum
    tangent = data.unit([0, -q[2], q[1]])

    def curve(e: Number) -> Matrix:
        return ctx.matrix(
            momenta(J, data.rotation([ctx.cos(e) * a + ctx.sin(e) * b for a, b in zip(q, tangent, strict=True)]))
        )

    return list(data.slope(curve)[:2])


def _orbit(name: str, start: tuple[float, float]) -> tuple[float, bool]:
    """Return Q at the end of an orbit, and whether it kept its energy and side and came to the line."""
    J = data.body(name)
    orbit = nh.simulate(data.discrete(J), displacement=data.array(data.cayley(start)), steps=400)
    W = orbit.displacement
    q0 = np.sqrt((1 + W[:, 2, 2]) / 2)
    q = [q0, -W[:, 1, 2] / (2 * q0), W[:, 0, 2] / (2 * q0)]
    side = np.array(J[0, 2] * q[1] + J[1, 2] * q[2], dtype=np.float64)
    moved = side[np.abs(side) > 1e-9]
    level = np.abs(orbit.energy / orbit.energy[0] - 1).max() < 1e-12
    is_sound = bool(np.all(moved * moved[0] > 0)) and abs(side[-1]) < 1e-9 and bool(level)
    return float(formulas.stability_form(J, [ctx.mpf(x[-1]) for x in q])), is_sound


@statement
def limit_rotations() -> Measured:
    """Follow orbits to both ends: the map is inverted by inverting the displacement."""
    library, exact = [], []
    for name in data.REGULAR:
        start = data.cayley((0.2, 0.1) if name == "generic" else (0.1, -0.3))
        J, top = data.body(name), data.discrete(data.body(name))
        after, before = (nh.simulate(top, displacement=data.array(W), steps=400) for W in (start, start.T))
        library += list((after.displacement[-1] - before.displacement[-1]).ravel())
        exact += [a + b for a, b in zip(data.momentum(J, start.T), data.turned(J, start), strict=True)]
    return Measured(twin.both(twin.worst(exact), twin.worst(library)), note="two orbits, 400 steps each way")
