"""Equations by SymPy's Kane method, with the parameters of `foreign.py`: accelerations as functions of (q, v)."""

import functools
from collections.abc import Callable
from typing import Any

import numpy as np


@functools.cache
def disk() -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Return accelerations of a disk that rolls and tilts: contact x, y, heading, lean to the right, rolling angle."""
    from sympy import cos, sin
    from sympy.physics.mechanics import Point, ReferenceFrame, RigidBody, dynamicsymbols, inertia

    m, R, axle, J, g = 1.2, 0.7, 0.3, 0.11, 9.8
    q, u = dynamicsymbols("x y heading lean roll"), dynamicsymbols("turning leaning rolling")
    space, level, leaning, body = (ReferenceFrame(name) for name in "NALB")
    level.orient_axis(space, space.z, q[2])
    leaning.orient_axis(level, level.x, q[3])
    body.orient_axis(leaning, leaning.y, q[4])
    body.set_ang_vel(space, u[0] * level.z + u[1] * level.x + u[2] * leaning.y)
    contact = Point("C")
    contact.set_vel(space, 0)
    middle = contact.locatenew("M", R * leaning.z)
    middle.set_vel(space, body.ang_vel_in(space).cross(R * leaning.z))
    disk = RigidBody("D", middle, body, m, (inertia(body, J, axle, J), middle))
    rates = [R * cos(q[2]) * u[2], R * sin(q[2]) * u[2], *u]
    return _accelerations(space, q, u, rates, [disk], [(middle, -m * g * space.z)], (2, 3, 4))


@functools.cache
def tractor() -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Return accelerations of a tractor and a trailer: axle x, y, both headings."""
    from sympy import cos, sin
    from sympy.physics.mechanics import Point, ReferenceFrame, RigidBody, dynamicsymbols, inertia

    d, q, (along, turning) = 0.8, dynamicsymbols("x y front rear"), dynamicsymbols("along turning")
    space, bend, bodies = ReferenceFrame("N"), q[2] - q[3], []
    rates = [along * cos(q[2]), along * sin(q[2]), turning, along * sin(bend) / d]
    for angle, rate, speed, mass, moment in (
        (q[2], turning, along, 1.0, 0.2),
        (q[3], rates[3], along * cos(bend), 0.5, 0.1),
    ):
        frame, axle = ReferenceFrame(f"F{len(bodies)}"), Point(f"P{len(bodies)}")
        frame.orient_axis(space, space.z, angle)
        frame.set_ang_vel(space, rate * space.z)
        axle.set_vel(space, speed * frame.x)
        bodies.append(RigidBody(f"B{len(bodies)}", axle, frame, mass, (inertia(frame, 0, 0, moment), axle)))
    # the speed along is x' cos + y' sin
    result = _accelerations(space, q, [along, turning], rates, bodies, [], (0, 2))
    return lambda q, v: result(q, np.array([v[0] * np.cos(q[2]) + v[1] * np.sin(q[2]), 0.0, v[2], 0.0]))


def _accelerations(
    space: Any,
    q: list[Any],
    u: list[Any],
    rates: list[Any],
    bodies: list[Any],
    loads: list[Any],
    places: tuple[int, ...],
) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Return the accelerations of coordinates from those of speeds, which stand at places of the velocity."""
    from sympy import Matrix, lambdify
    from sympy.physics.mechanics import KanesMethod, dynamicsymbols

    dots = [x.diff(dynamicsymbols._t) for x in q]
    kane = KanesMethod(space, q_ind=q, u_ind=u, kd_eqs=[dot - rate for dot, rate in zip(dots, rates, strict=True)])
    kane.kanes_equations(bodies, loads)
    matrix = Matrix(rates)
    pieces = lambdify(
        [q, u],
        [kane.mass_matrix, kane.forcing.subs(kane.kindiffdict()), matrix, matrix.jacobian(q), matrix.jacobian(u)],
    )

    def values(at: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        M, F, first, by_place, by_speed = (np.array(x, float) for x in pieces(at, velocity[list(places)]))
        return (by_place @ first + by_speed @ np.linalg.solve(M, F)).ravel()

    return values
