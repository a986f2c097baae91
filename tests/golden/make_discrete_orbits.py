"""Make discrete_orbits.json: orbits of the discrete Euler-Poincare-Suslov map in 60 digits.

Solves the matrix equations on exp d by Newton's method; no closed form of a step is used.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from matrix_algebra import (
    ANNIHILATOR,
    IDENTITY,
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
    exponential,
    group_residual,
    inertia_operator,
    largest,
    multiply,
    require,
    solve2,
    subtract,
    suslov_top,
    trace_product,
    transpose,
    write_cases,
)
from mpmath import mp, mpf

STEPS = 20
DIGITS = 60
PARTS = 40

# name, mass tensor, body velocity for time step 1, body velocity for time step 0.1
TOPS = [
    (
        "generic-1",
        [[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]],
        [0.35, 0.5, 0.0],
        [2.1, 2.7, 0.0],
    ),
    (
        "generic-2",
        [[0.7, -0.15, 0.22], [-0.15, 1.9, 0.41], [0.22, 0.41, 1.2]],
        [0.8, -0.3, 0.0],
        [-1.3, -3.2, 0.0],
    ),
    (
        "balanced",
        [[1.3, 0.25, 0.0], [0.25, 0.8, 0.0], [0.0, 0.0, 0.6]],
        [0.55, -0.7, 0.0],
        [2.4, 1.9, 0.0],
    ),
    (
        "aligned",
        [[1.1, 0.0, 0.45], [0.0, 0.7, 0.0], [0.45, 0.0, 0.9]],
        [0.3, 0.6, 0.0],
        [-0.9, 3.1, 0.0],
    ),
    (
        "flat",
        [[1.0, 0.5, 0.25], [0.5, 1.25, -0.375], [0.25, -0.375, 0.3125]],
        [0.5, 0.4, 0.0],
        [2.6, -1.2, 0.0],
    ),
    (
        "rod",
        [[0.28, 0.125, 0.5], [0.125, 0.0925, 0.25], [0.5, 0.25, 1.03]],
        [-0.2, 0.3, 0.0],
        [1.5, 2.0, 0.0],
    ),
]
# name, (mass, inertia, a, b), body velocity for time step 1, body velocity for time step 0.1
SLEIGHS = [
    ("b-zero", (1.2, 0.5, 0.6, 0.0), [0.7, -0.3, 0.0], [3.0, -1.5, 0.0]),
    ("b-nonzero", (0.9, 0.4, 0.7, 0.35), [-0.6, -0.4, 0.0], [2.5, -2.0, 0.0]),
    ("a-negative", (1.5, 0.6, -0.5, 0.2), [0.5, 0.35, 0.0], [-2.2, 2.6, 0.0]),
    ("a-zero", (1.1, 0.8, 0.0, 0.3), [0.75, 0.6, 0.0], [-3.5, 1.4, 0.0]),
    ("balanced", (1.0, 0.7, 0.0, 0.0), [0.8, -0.5, 0.0], [2.8, 1.1, 0.0]),
    ("b-large", (1.3, 0.45, 0.25, 2.5), [0.3, 0.7, 0.0], [1.2, 1.8, 0.0]),
]
START = {
    "suslov": [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    "sleigh": [[0.0, -1.0, 0.5], [1.0, 0.0, -0.25], [0.0, 0.0, 1.0]],
}


def displacement(body: Body, y: Vector) -> Matrix:
    """Return expm(y_1 e_1 + y_2 e_2), e_i the rows of the constraint subspace."""
    return exponential(combine(apply(transpose([list(r) for r in body.subspace]), y), body.basis))


def momentum(body: Body, h: Number, w: Matrix) -> Vector:
    """Return P_i = tr(E_i W JJ (W - I)^T) / h."""
    n = multiply(multiply(w, body.mass_tensor), transpose(subtract(w, IDENTITY)))
    return [trace_product(element, n) / h for element in body.basis]


def restrict(body: Body, p: Vector) -> Vector:
    """Return the components of a momentum along the constraint subspace."""
    return apply([list(row) for row in body.subspace], p)


def coadjoint(body: Body, y: Vector, p: Vector) -> Vector:
    """Return Ad*_W p, the transpose of the matrix of Ad_W applied to p."""
    w, inverse = displacement(body, y), displacement(body, [-entry for entry in y])
    return [mp.fdot(p, coordinates(body.basis, multiply(multiply(w, element), inverse))) for element in body.basis]


def newton(body: Body, h: Number, target: Vector, y: Vector, tolerance: Number) -> Vector:
    """Solve P(W(y))|_d = target from y; the Jacobian determinant must stay positive."""
    increment = mpf(10) ** (-mp.dps // 2)

    def residual(point: Vector) -> Vector:
        p = restrict(body, momentum(body, h, displacement(body, point)))
        return [q - r for q, r in zip(p, target, strict=True)]

    for _ in range(30):
        value = residual(y)
        columns = []
        for j in range(2):
            moved = residual([entry + (i == j) * increment for i, entry in enumerate(y)])
            columns.append([(q - r) / increment for q, r in zip(moved, value, strict=True)])
        change, determinant = solve2(transpose(columns), value)
        if determinant <= 0:
            raise ArithmeticError(f"{body.name}: fold crossed")
        y = [entry - delta for entry, delta in zip(y, change, strict=True)]
        if max(abs(delta) for delta in change) < tolerance:
            return y
    raise ArithmeticError(f"{body.name}: Newton's method did not converge")


def principal(body: Body, h: Number, target: Vector) -> Vector:
    """Continue the root from momentum zero along s target, 0 <= s <= 1, in 20 digits."""
    with mp.workdps(20):
        y: Vector = [mpf(0), mpf(0)]
        for part in range(1, PARTS + 1):
            scaled = [mpf(part) / PARTS * entry for entry in target]
            y = newton(body, h, scaled, y, mpf(10) ** -9)
    return y


def orbit(body: Body, h: Number, velocity: Vector, verify: bool) -> dict[str, list[Any]]:
    """Return chart points, displacements, momenta, multipliers and configurations."""
    tolerance = mpf(10) ** (5 - mp.dps)
    start = apply(inertia_operator(body.basis, body.mass_tensor), velocity)
    target = restrict(body, start)
    y = newton(body, h, target, principal(body, h, target), tolerance)
    g = [[mpf(entry) for entry in row] for row in START[body.system]]
    found: dict[str, list[Any]] = {
        "chart": [y],
        "displacement": [displacement(body, y)],
        "momentum": [momentum(body, h, displacement(body, y))],
        "multipliers": [],
        "configurations": [g],
    }
    for _ in range(STEPS):
        carried = coadjoint(body, y, found["momentum"][-1])
        target = restrict(body, carried)
        found["configurations"].append(multiply(found["configurations"][-1], found["displacement"][-1]))
        y = newton(body, h, target, y, tolerance)
        if verify:
            w = displacement(body, principal(body, h, target))
            require(largest(subtract(w, displacement(body, y))), "principal root", mpf(10) ** -15)
        p = momentum(body, h, displacement(body, y))
        difference = [q - r for q, r in zip(p, carried, strict=True)]
        require(max(map(abs, restrict(body, difference))), "step equation", 100 * tolerance)
        found["chart"].append(y)
        found["displacement"].append(displacement(body, y))
        found["momentum"].append(p)
        found["multipliers"].append([mp.fdot(ANNIHILATOR, difference)])
    return found


def check(body: Body, h: Number, velocity: Vector, found: dict[str, list[Any]]) -> list[Any]:
    """Return defects of energy, constraint, group, and against 15 more digits; raise if large."""
    energies = [constrained_energy(body, p) for p in found["momentum"]]
    energy = max(abs(e / energies[0] - 1) for e in energies)
    constraint = mpf(0)
    for y, w in zip(found["chart"], found["displacement"], strict=True):
        back = displacement(body, [-entry for entry in y])
        inclination = mp.fdot(ANNIHILATOR, coordinates(body.basis, subtract(w, back)))
        constraint = max(constraint, abs(inclination))
    group = max(group_residual(body, g) for g in found["configurations"])
    with mp.workdps(DIGITS + 15):
        again = orbit(body, h, velocity, verify=False)
        precision = max(largest(subtract(found[key], again[key])) for key in ("momentum", "multipliers"))
        for g, finer in zip(found["configurations"], again["configurations"], strict=True):
            precision = max(precision, largest(subtract(g, finer)))
    defects = [energy, constraint, group, precision]
    for defect, what in zip(defects, ("energy", "constraint", "group", "precision"), strict=True):
        require(defect, f"{body.name} {what}", mpf(10) ** -48)
    return defects


def make_case(body: Body, time_step: float, velocity: list[float]) -> dict[str, Any]:
    """Compute and check one orbit, print angle and defects; return its entry for the file."""
    began = time.perf_counter()
    h = mpf(time_step)
    found = orbit(body, h, [mpf(entry) for entry in velocity], verify=True)
    defects = check(body, h, [mpf(entry) for entry in velocity], found)
    rotations = [y if body.system == "suslov" else y[:1] for y in found.pop("chart")]
    angle = max(mp.degrees(mp.norm(rotation)) for rotation in rotations)
    seconds = time.perf_counter() - began
    figures = " ".join(str(mp.nstr(defect, 2)) for defect in [angle, *defects])
    print(f"{body.system} {body.name} h={time_step}: {figures}, {seconds:.1f} s", flush=True)
    return {
        "system": body.system,
        "name": body.name,
        "parameters": body.parameters,
        "time_step": time_step,
        "body_velocity": velocity,
        "configuration": START[body.system],
    } | {key: decimals(value) for key, value in found.items()}


def main() -> None:
    """Write discrete_orbits.json beside this script."""
    mp.dps = DIGITS
    bodies = [(suslov_top(name, tensor), one, tenth) for name, tensor, one, tenth in TOPS]
    bodies += [(chaplygin_sleigh(name, *p), one, tenth) for name, p, one, tenth in SLEIGHS]
    cases = []
    for body, one, tenth in bodies:
        cases.append(make_case(body, 1.0, one))
        cases.append(make_case(body, 0.1, tenth))
    write_cases(Path(__file__).with_name("discrete_orbits.json"), cases)


if __name__ == "__main__":
    main()
