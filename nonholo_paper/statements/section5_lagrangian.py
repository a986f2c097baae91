"""Section 5: position, kinetic energy, Lagrangian and momenta of the sleigh."""

import numpy as np

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._finding import Measured, finding
from nonholo_paper._sleigh_twin import BODIES, PLANE, Body, kinetic, momenta, points, pose, poses
from nonholo_paper._twin import ctx, worst
from nonholo_paper._verdict import Verdict
from nonholo_paper.formulas import sleigh_continuous as formulas

VELOCITIES = [twin.numbers(511 + k, 3, -2, 2) for k in range(3)] + [
    [ctx.mpf(v) for v in e] for e in ((0, 1, 0), (9, -7, 5))
]
POSES = poses(521, 3)


def _center(body: Body) -> list:
    """Return the whole mass at the center of mass."""
    return [(body.m, ctx.matrix([body.a, body.b, 1]))]


def _library(body: Body) -> nh.ChaplyginSleigh:
    return nh.ChaplyginSleigh(*map(float, body))


@finding(
    "center-of-mass",
    "equation",
    "Section 5, the position of the center of mass",
    r"The center of mass, at body point $(a, b)$, is at $(x + a\cos\theta - b\sin\theta,\ y + a\sin\theta + "
    r"b\cos\theta)$.",
    tolerance=1e-45,
)
def center_of_mass() -> Measured:
    """Move the body point by the matrix of the pose."""
    gaps = []
    for body in BODIES:
        for _, at in POSES:
            moved = pose(*at) * ctx.matrix([body.a, body.b, 1])
            x, y = formulas.center_of_mass(body.a, body.b, at)
            gaps += [moved[0] - x, moved[1] - y]
    return Measured(worst(gaps), note="8 bodies, 5 poses")


@finding(
    "C2",
    "equation",
    "Section 5, the words on J before equation (Caplag)",
    "“Let $m$ and $J$ denote the mass and moment of inertia of the sleigh relative to the contact point.”",
    verdict=Verdict.MISPRINT,
    corrected="The formulas add $m(a^2 + b^2)$, so $J$ is the moment of inertia about the center of mass.",
    errata=("C2",),
    tolerance=1e-45,
)
def meaning_of_inertia() -> Measured:
    """Put both readings of J into the Lagrangian, against the kinetic energy of mass points."""
    right, wrong = [], []
    for body in BODIES:
        about_contact = body._replace(J=body.J + body.m * (body.a**2 + body.b**2))
        for v in VELOCITIES:
            energy = kinetic(points(body))(twin.hat(PLANE, v))
            right.append(formulas.lagrangian(body, v) - energy)
            wrong.append(formulas.lagrangian(about_contact, v) - energy)
    return Measured(worst(right), worst(wrong), "8 bodies, 5 velocities")


@finding(
    "C3",
    "equation",
    "Section 5, the two displays of the kinetic energy of the center of mass",
    r"“$m[\dot x^2 + \dot y^2 + (a^2 + b^2)\dot\theta^2 + 2\dot\theta(a(-\dot x\sin\theta + \dot y\cos\theta) - "
    r"b(\dot x\cos\theta + \dot y\sin\theta))]$” and “$m[(a^2 + b^2)\omega^2 + v_1^2 + v_2^2 - 2b\,\omega v_1^2 + "
    r"2a\,\omega v_2]$”",
    verdict=Verdict.MISPRINT,
    corrected="Both have the factor $m/2$. (The power of $v_1$ is the slip of (Caplag).)",
    errata=(
        "C3",
        "C4",
    ),
    tolerance=1e-45,
)
def energy_of_center() -> Measured:
    """Compare both displays with half the mass times the square of the velocity of the center."""
    right, wrong, wrong_in_space = [], [], []
    for body in BODIES:
        for v, (_, at) in zip(VELOCITIES, POSES, strict=True):
            energy = kinetic(_center(body))(twin.hat(PLANE, v))
            speed = pose(at[0], 0, 0) * ctx.matrix([v[1], v[2], 1])
            in_space = v[0], speed[0], speed[1]
            right.append(formulas.energy_of_center(body, v) - energy)
            right.append(formulas.energy_of_center_in_space(body, at, in_space) - energy)
            wrong.append(formulas.printed_energy_of_center(body, v) - energy)
            wrong_in_space.append(formulas.printed_energy_of_center_in_space(body, at, in_space) - energy)
    return Measured(worst(right), worst(wrong) + worst(wrong_in_space), "8 bodies, 5 velocities; both displays")


@finding(
    "Caplag",
    "equation",
    "Section 5, equation (Caplag)",
    r"“$l = \frac12[(J + m(a^2 + b^2))\omega^2 + m(v_1^2 + v_2^2) - 2mb\,\omega v_1^2 + 2ma\,\omega v_2]$”",
    verdict=Verdict.MISPRINT,
    corrected=r"The mixed term is $-2mb\,\omega v_1$, and $-2b\,\omega v_1$ in the display before: the kinetic "
    r"energy is quadratic.",
    errata=("C4",),
    tolerance=1e-45,
)
def caplag() -> Measured:
    """Compare with the kinetic energy of mass points, and with the inertia operator of the library."""
    right, wrong, library = [], [], []
    for body in BODIES:
        operator = _library(body).inertia_operator
        for v in VELOCITIES:
            energy = kinetic(points(body))(twin.hat(PLANE, v))
            right.append(formulas.lagrangian(body, v) - energy)
            wrong.append(formulas.printed_lagrangian(body, v) - energy)
            double = np.array(v, dtype=float)
            library.append((double @ operator @ double / 2 - float(energy)) / (1 + float(energy)))
    return Measured(twin.both(worst(right), worst(library)), worst(wrong), "8 bodies, 5 velocities")


@finding(
    "C5",
    "equation",
    "Section 5, the components of the body momentum",
    r"“$p_\theta \equiv \frac{\partial l}{\partial\omega} = (J + m(a^2 + b^2))\omega + 2m(av_2 - bv_1)$”",
    verdict=Verdict.MISPRINT,
    corrected=r"$p_\theta = (J + m(a^2 + b^2))\omega + m(av_2 - bv_1)$.",
    errata=("C5",),
    tolerance=1e-45,
)
def body_momentum() -> Measured:
    """Compare with the derivatives of the kinetic energy of mass points."""
    right, wrong = [], []
    for body in BODIES:
        for v in VELOCITIES:
            p = momenta(PLANE, points(body), twin.hat(PLANE, v))
            right += [x - y for x, y in zip(formulas.momentum(body, v), p, strict=True)]
            wrong.append(formulas.printed_momentum_theta(body, v) - p[0])
    return Measured(worst(right), worst(wrong), "8 bodies, 5 velocities")


@finding(
    "se2_reconstruction.eqn",
    "equation",
    "Section 5, equation (se2_reconstruction.eqn)",
    r"Lagrangian and constraint depend on $(g, \dot g)$ through $\Omega = g^{-1}\dot g$ only: they are left-invariant.",
    tolerance=1e-45,
)
def se2_reconstruction() -> Measured:
    """Compute energy and velocity across the blade in space, at a pose and at that pose moved by a rigid motion."""
    gaps = []
    for body in BODIES:
        for v, (mover, at) in zip(VELOCITIES, POSES, strict=True):
            for g in (pose(*at), pose(*mover) * pose(*at)):
                speed = g * twin.hat(PLANE, v)
                across = speed[1, 2] * g[0, 0] - speed[0, 2] * g[1, 0]
                body_velocity = twin.vee(PLANE, g**-1 * speed)
                gaps += [kinetic(points(body))(speed) - formulas.lagrangian(body, body_velocity), across - v[2]]
    return Measured(worst(gaps), note="8 bodies, 5 poses")
