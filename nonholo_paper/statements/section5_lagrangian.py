"""Section 5: position, kinetic energy, Lagrangian and momenta of the sleigh."""

import numpy as np

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._sleigh_twin import BODIES, PLANE, Body, kinetic, momenta, points, pose, poses
from nonholo_paper._twin import ctx, worst
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


@statement
def center_of_mass() -> Measured:
    """Move the body point by the matrix of the pose."""
    gaps = []
    for body in BODIES:
        for _, at in POSES:
            moved = pose(*at) * ctx.matrix([body.a, body.b, 1])
            x, y = formulas.center_of_mass(body.a, body.b, at)
            gaps += [moved[0] - x, moved[1] - y]
    return Measured(worst(gaps), note="8 bodies, 5 poses")


@statement
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


@statement
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


@statement
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


@statement
def body_momentum() -> Measured:
    """Compare with the derivatives of the kinetic energy of mass points."""
    right, wrong = [], []
    for body in BODIES:
        for v in VELOCITIES:
            p = momenta(PLANE, points(body), twin.hat(PLANE, v))
            right += [x - y for x, y in zip(formulas.momentum(body, v), p, strict=True)]
            wrong.append(formulas.printed_momentum_theta(body, v) - p[0])
    return Measured(worst(right), worst(wrong), "8 bodies, 5 velocities")


@statement
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
