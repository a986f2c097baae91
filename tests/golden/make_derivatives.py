"""Make derivatives.json: how the end of an orbit depends on the numbers of its body, its start and its controls.

Central differences, in 60 digits, of orbits that the matrix equations determine (`make_general_orbits`): 40 digits are
right. Nothing of the library is imported here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import make_general_orbits as orbits
import numpy as np
from make_discrete_orbits import planar
from make_general_orbits import adjoint, displacement, homogeneous, momentum, remaining, suslov_rows
from matrix_algebra import Array, algebra, decimals, exact, inertia_operator, inverse_of, write_cases
from mpmath import mp, mpf

STEPS = 4
OFFSET = "1e-20"
Roots = list[tuple[Array, Array]]  # charts of the steps, with the inverse Jacobian matrices there in float64


@dataclass(frozen=True)
class Case:
    """An orbit as a function of numbers: those of the body, time step, velocity and controls, in this order."""

    name: str
    basis: Any
    rows: Any
    annihilator: Any
    body: list[float]
    velocity: list[float]
    controls: list[list[float]]
    skew: bool
    time_step: float = 0.3
    friction: tuple[float, ...] = ()  # coefficients
    weight: tuple[float, ...] = ()  # the force, and the body point where it acts
    gains: tuple[float, ...] = ()  # of a policy that steers a sleigh along the axis of x

    def numbers(self) -> list[Any]:
        """Return all numbers, exactly."""
        flat = [*(x for row in self.controls for x in row), *self.friction, *self.weight, *self.gains]
        return [mpf(x) for x in (*self.body, self.time_step, *self.velocity, *flat)]

    def tensor(self, body: list[Any]) -> Array:
        """Return the mass tensor: of a sleigh from four numbers, else from an upper triangle row by row."""
        if "sleigh" in self.name:
            return homogeneous(planar(*body))
        size = len(self.basis[0])
        tensor = np.zeros((size, size), dtype=object)
        tensor[np.triu_indices(size)] = body
        return tensor + np.triu(tensor, 1).T


def end(case: Case, numbers: list[Any], roots: Roots) -> Array:
    """Return momenta along the constraint and the entries of the pose after the last step.

    Roots that are not known yet are found by continuation, and added.
    """
    count, k = len(case.body), len(case.rows)
    tensor, h = case.tensor(numbers[:count]), numbers[count]
    velocity = np.array(numbers[count + 1 : count + 1 + k])
    rest = numbers[count + 1 + k :]
    size = len(case.basis)
    controls = np.array(rest[: size * len(case.controls)], dtype=object).reshape(-1, size)
    others = np.array(rest[size * len(case.controls) :], dtype=object)
    others, gains = np.split(others, [len(case.friction) + len(case.weight)])
    basis, rows = exact(case.basis), exact(case.rows)
    skew = exact(int(case.skew))
    equations = orbits.Equations(basis, tensor, exact(h), rows, exact(case.annihilator).reshape(-1, len(basis)), skew)
    inertia = inertia_operator(basis, tensor)
    r, g = rows @ inertia @ rows.T @ velocity, exact(np.eye(len(tensor)))
    to_velocity = inverse_of(rows @ inertia @ rows.T)
    for step in range(STEPS):
        control = controls[step] if len(controls) else exact([0] * size)
        if case.gains:
            control = steering(gains, (g, to_velocity @ r), h * step)
        pushed = kicked(case, (rows, basis, to_velocity), (r, g), (control, others), h / 2)
        if step == len(roots):
            x = orbits.solve(equations, pushed, orbits.principal(equations, pushed))
            roots.append((x, np.linalg.inv(orbits.derivative(equations.rounded(), x.astype(float)))))
        x = orbits.refined(equations, pushed, roots[step])
        w = displacement(basis, x)
        g = g @ w
        arriving = rows @ adjoint(basis, w, displacement(basis, -x)).T @ momentum(equations, w)
        r = kicked(case, (rows, basis, to_velocity), (arriving, g), (control, others), h / 2)
    return np.concatenate([r, g.ravel()])


def steering(gains: Array, state: tuple[Array, Array], time: Any) -> Array:
    """Return the control of the policy."""
    (turning, damping, driving), (g, (omega, speed)) = gains, state
    torque = -turning * mp.cos(time) * (g[1, 2] + g[1, 0]) - damping * omega
    return np.array([torque, driving * (1 - speed), mpf(0)], dtype=object)


def kicked(case: Case, body: Any, state: Any, forces: Any, tau: Any) -> Array:
    """Return the momenta after half an impulse: the solution of r' = a - D r by a matrix exponential."""
    (rows, basis, to_velocity), (r, g), (control, others), k = body, state, forces, len(case.rows)
    friction, weight = others[: len(case.friction)], others[len(case.friction) :]
    covector = control
    if len(weight):
        force, point = (np.append(part, mpf(last)) for part, last in zip(np.split(weight, 2), (0, 1), strict=True))
        covector = control + np.array([force @ g @ np.array(b, dtype=object) @ point for b in basis])
    a = rows @ covector
    if not len(friction):
        return r + tau * a
    block = np.full((k + 1, k + 1), mpf(0), dtype=object)
    block[:k, :k], block[:k, k] = -tau * rows @ np.diag(friction) @ rows.T @ to_velocity, tau * a
    whole = np.array(mp.expm(mp.matrix(block.tolist()), method="taylor").tolist(), dtype=object).reshape(k + 1, k + 1)
    return whole[:k, :k] @ r + whole[:k, k]


def make_case(case: Case) -> dict[str, Any]:
    """Return the entry of a case: its numbers and the derivative of the end by each of them, a row for each."""
    numbers, offset, rows = case.numbers(), mpf(OFFSET), []
    roots: Roots = []
    here = end(case, numbers, roots)
    for i in range(len(numbers)):
        there, back = list(numbers), list(numbers)
        there[i], back[i] = numbers[i] + offset, numbers[i] - offset
        rows.append((end(case, there, roots) - end(case, back, roots)) / (2 * offset))
    print(case.name, len(rows), flush=True)
    arguments = {"body": case.body, "time_step": case.time_step, "velocity": case.velocity, "controls": case.controls}
    arguments |= {"friction": case.friction, "weight": case.weight} if case.friction else {}
    arguments |= {"gains": case.gains} if case.gains else {}
    result = {"end": decimals(here), "derivative": decimals(rows)}
    return {"name": case.name, "steps": STEPS, **arguments, **result}


TOP = [1.4, 0.2, 0.5, 1.0, -0.3, 0.9]
TILTED = [1.3, 0.1, -0.2, 0.9, 0.3, 1.1]
FOUR = [1.2, 0.1, -0.2, 0.3, 0.9, 0.2, -0.1, 1.1, 0.4, 1.3]
MIXED = [1.1, 0.2, -0.1, 0.3, 0.8, 0.1, -0.2, 0.9, 0.4, 1.5]
SLEIGH = [1.5, 0.7, 0.4, 0.2]
TILTED_ROWS, TILTED_AXIS = [[0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]], [[0.6, 0.0, 0.8]]


def cases() -> list[Case]:
    """Return seven bodies, each in motion and at rest, where the displacement is the identity, and a closed loop."""
    so3, so4, se3, se2 = map(algebra, ("SO(3)", "SO(4)", "SE(3)", "SE(2)"))
    pushes = [[0.3, -0.5, 0.2], [-0.4, 0.6, 0.1], [0.2, 0.3, -0.3], [0.5, -0.1, 0.4]]
    plane = se2, [[1, 0, 0], [0, 1, 0]], [[0, 0, 1]], SLEIGH
    moving = [
        Case("top", so3, suslov_rows(3), remaining(suslov_rows(3)), TOP, [0.9, -0.4], [], False),
        Case("tilted top", so3, TILTED_ROWS, TILTED_AXIS, TILTED, [0.5, 0.6], [], False),
        Case("sleigh", *plane, [0.8, -0.5], [], False),
        Case("four", so4, suslov_rows(4), remaining(suslov_rows(4)), FOUR, [0.5, -0.4, 0.3], [], False),
        Case("mixed", se3, orbits.MIXED_SUBSPACE, orbits.MIXED_ANNIHILATOR, MIXED, [0.3, -0.2, 0.25], [], True),
        Case("driven sleigh", *plane, [0.8, -0.5], pushes, False),
        Case("heavy sleigh", *plane, [0.8, -0.5], pushes, False, 0.3, (0.3, 0.2, 0.1), (0.4, -1.0, 0.5, 0.3)),
    ]
    return [
        *moving,
        Case("steered sleigh", *plane, [0.8, -0.5], [], False, gains=(0.7, 0.2, 0.5)),
        *(replace(case, name=f"{case.name} at rest", velocity=[0.0] * len(case.velocity)) for case in moving),
    ]


def main() -> None:
    """Write derivatives.json beside this script."""
    mp.dps = orbits.DIGITS
    write_cases(Path(__file__).with_name("derivatives.json"), [make_case(case) for case in cases()])


if __name__ == "__main__":
    main()
