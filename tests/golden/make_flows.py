"""Make flows.json: continuous Suslov tops and Chaplygin sleighs by Taylor series in 60 digits.

Integrates p' = ad*_omega p + lambda a, g' = g omega as matrix equations; no closed form is used.
"""

from __future__ import annotations

import time
from itertools import pairwise
from pathlib import Path
from typing import Any

from matrix_algebra import (
    ANNIHILATOR,
    Body,
    Matrix,
    Number,
    Vector,
    apply,
    chaplygin_sleigh,
    combine,
    constrained_energy,
    coordinates,
    decimals,
    group_residual,
    inertia_operator,
    largest,
    multiply,
    require,
    subtract,
    suslov_top,
    write_cases,
)
from mpmath import mp, mpf

DIGITS = 60
ORDER = 64
TIMES = [0.0, 0.5, 1.0, 2.0, 5.0, 10.0]

# name, mass tensor, body velocity
TOPS = [
    ("generic-1", [[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]], [0.7, 0.9, 0.0]),
    ("generic-2", [[0.7, -0.15, 0.22], [-0.15, 1.9, 0.41], [0.22, 0.41, 1.2]], [-1.3, 0.8, 0.0]),
    ("aligned", [[1.1, 0.0, 0.45], [0.0, 0.7, 0.0], [0.45, 0.0, 0.9]], [0.4, 0.95, 0.0]),
    ("flat", [[1.0, 0.5, 0.25], [0.5, 1.25, -0.375], [0.25, -0.375, 0.3125]], [0.6, -1.1, 0.0]),
]
# name, (mass, inertia, a, b), body velocity
SLEIGHS = [
    ("b-zero", (1.2, 0.5, 0.6, 0.0), [1.1, -0.4, 0.0]),
    ("b-nonzero", (0.9, 0.4, 0.7, 0.35), [-0.9, -0.5, 0.0]),
    ("a-negative", (1.5, 0.6, -0.5, 0.2), [0.8, 0.7, 0.0]),
    ("lambda-two", (1.0, 0.75, 0.5, 0.1), [-0.75, -0.3, 0.0]),
    ("equilibrium", (1.2, 0.5, 0.6, 0.25), [0.0, 0.8, 0.0]),
    ("far-start", (1.1, 0.45, 0.5, -0.2), [0.001, -0.9, 0.0]),
]
START = {
    "suslov": [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    "sleigh": [[0.0, -1.0, 0.5], [1.0, 0.0, -0.25], [0.0, 0.0, 1.0]],
}


class Flow:
    """Taylor coefficients of the motion of one body."""

    def __init__(self, body: Body) -> None:
        """Prepare inertia operator, its inverse and structure constants from the matrices."""
        self.body = body
        self.inertia = inertia_operator(body.basis, body.mass_tensor)
        self.inverse: Matrix = (mp.matrix(self.inertia) ** -1).tolist()
        self.brackets = [
            [coordinates(body.basis, subtract(multiply(x, y), multiply(y, x))) for y in body.basis] for x in body.basis
        ]
        self.reaction = apply(self.inverse, ANNIHILATOR)

    def multiplier(self, q: Vector) -> Number:
        """Return lambda with <a, I^-1 (q + lambda a)> = 0."""
        return -mp.fdot(self.reaction, q) / mp.fdot(self.reaction, ANNIHILATOR)

    def torque(self, velocities: list[Vector], momenta: list[Vector]) -> Vector:
        """Return the last Taylor coefficient of ad*_omega p, <ad*_omega p, x> = <p, [omega, x]>."""
        total = [mpf(0)] * 3
        for j in range(3):
            for i in range(3):
                weights = self.brackets[j][i]
                if not any(weights):
                    continue
                dual = [mp.fdot(weights, p) for p in reversed(momenta)]
                total[i] += mp.fdot([v[j] for v in velocities], dual)
        return total

    def coefficients(self, momentum: Vector, g: Matrix) -> tuple[list[Vector], list[Matrix]]:
        """Return Taylor coefficients of momentum and configuration up to ORDER."""
        momenta, configurations = [momentum], [g]
        velocities = [apply(self.inverse, momentum)]
        hats = [combine(velocities[0], self.body.basis)]
        for k in range(ORDER):
            q = self.torque(velocities, momenta)
            force = self.multiplier(q)
            configurations.append(self.product(configurations, hats, k + 1))
            total = zip(q, ANNIHILATOR, strict=True)
            momenta.append([(entry + force * a) / (k + 1) for entry, a in total])
            velocities.append(apply(self.inverse, momenta[-1]))
            hats.append(combine(velocities[-1], self.body.basis))
        return momenta, configurations

    @staticmethod
    def product(left: list[Matrix], right: list[Matrix], divisor: int) -> Matrix:
        """Return the last coefficient of the product of two matrix series, over divisor."""
        size = range(3)
        rows = [[entry for x in left for entry in x[i]] for i in size]
        columns = [[row[j] for x in reversed(right) for row in x] for j in size]
        return [[mp.fdot(row, column) / divisor for column in columns] for row in rows]


def evaluate(coefficients: list[Any], t: Number) -> Number | list[Any]:
    """Evaluate a power series of numbers, vectors or matrices."""
    if isinstance(coefficients[0], list):
        return [evaluate(list(entry), t) for entry in zip(*coefficients, strict=True)]
    return mp.polyval(coefficients[::-1], t)


def integrate(flow: Flow, velocity: Vector, step: Number) -> list[tuple[Vector, Matrix, Number]]:
    """Return momentum, configuration and turn (the integral of omega_1) at the times wanted."""
    p = apply(flow.inertia, velocity)
    g = [[mpf(entry) for entry in row] for row in START[flow.body.system]]
    turn = mpf(0)
    found = [(p, g, turn)]
    for begin, end in pairwise(TIMES):
        for _ in range(round((end - begin) / step)):
            momenta, configurations = flow.coefficients(p, g)
            rates = [apply(flow.inverse, q)[0] for q in momenta]
            turn += evaluate([mpf(0)] + [rate / (k + 1) for k, rate in enumerate(rates)], step)
            p, g = evaluate(momenta, step), evaluate(configurations, step)
        found.append((p, g, turn))
    return found


def tabulate(flow: Flow, found: list[tuple[Vector, Matrix, Number]]) -> dict[str, list[Any]]:
    """Return the columns of the file."""
    momenta = [p for p, _, _ in found]
    configurations = [g for _, g, _ in found]
    velocities = [apply(flow.inverse, p) for p in momenta]
    torques = [flow.torque([v], [p]) for v, p in zip(velocities, momenta, strict=True)]
    table: dict[str, list[Any]] = {
        "body_velocities": velocities,
        "momentum": momenta,
        "multipliers": [[flow.multiplier(q)] for q in torques],
        "configurations": configurations,
    }
    if flow.body.system == "sleigh":
        first = configurations[0]
        start = mp.atan2(first[1][0], first[0][0])
        table["heading"] = [start + turn for _, _, turn in found]
        table["position"] = [[g[0][2], g[1][2]] for g in configurations]
    return table


def check(flow: Flow, table: dict[str, list[Any]], finer: dict[str, list[Any]]) -> list[Any]:
    """Return defects of energy, constraint, group, heading and step halving; raise if large."""
    energies = [constrained_energy(flow.body, p) for p in table["momentum"]]
    energy = max(abs(e / energies[0] - 1) for e in energies)
    constraint = max(abs(mp.fdot(ANNIHILATOR, v)) for v in table["body_velocities"])
    group = max(group_residual(flow.body, g) for g in table["configurations"])
    heading = mpf(0)
    for theta, g in zip(table.get("heading", []), table["configurations"], strict=False):
        heading = max(heading, abs(mp.cos(theta) - g[0][0]), abs(mp.sin(theta) - g[1][0]))
    halving = mpf(0)
    for key, column in table.items():
        for old, new in zip(column, finer[key], strict=True):
            rows = [x if isinstance(x, list) else [x] for x in (old, new)]
            pair = [x if isinstance(x[0], list) else [x] for x in rows]
            halving = max(halving, largest(subtract(pair[0], pair[1])))
    defects = [energy, constraint, group, heading, halving]
    names = ("energy", "constraint", "group", "heading", "step halving")
    for defect, what in zip(defects, names, strict=True):
        require(defect, f"{flow.body.name} {what}", mpf(10) ** -45)
    return defects


def make_case(body: Body, velocity: list[float]) -> dict[str, Any]:
    """Integrate with two steps, check and report; return the entry for the file."""
    began = time.perf_counter()
    flow = Flow(body)
    start = [mpf(entry) for entry in velocity]
    table = tabulate(flow, integrate(flow, start, mpf(1) / 8))
    defects = check(flow, table, tabulate(flow, integrate(flow, start, mpf(1) / 4)))
    figures = " ".join(str(mp.nstr(defect, 2)) for defect in defects)
    seconds = time.perf_counter() - began
    print(f"{body.system} {body.name}: {figures}, {seconds:.1f} s", flush=True)
    return {
        "system": body.system,
        "name": body.name,
        "parameters": body.parameters,
        "body_velocity": velocity,
        "configuration": START[body.system],
        "times": TIMES,
    } | {key: decimals(value) for key, value in table.items()}


def main() -> None:
    """Write flows.json beside this script."""
    mp.dps = DIGITS
    bodies = [(suslov_top(name, tensor), velocity) for name, tensor, velocity in TOPS]
    bodies += [(chaplygin_sleigh(name, *p), velocity) for name, p, velocity in SLEIGHS]
    cases = [make_case(body, velocity) for body, velocity in bodies]
    write_cases(Path(__file__).with_name("flows.json"), cases)


if __name__ == "__main__":
    main()
