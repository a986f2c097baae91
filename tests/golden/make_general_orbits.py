"""Make general_orbits.json: discrete maps of constrained and free bodies on SO(n) and SE(n) in 60 digits.

Solves the matrix equations in exponential coordinates by Newton's method with derivatives from float64; no closed form
of a step is used. Nothing of the library is imported here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import matrix_algebra
import numpy as np
from matrix_algebra import Array, Number, algebra, coordinates, decimals, exact, inertia_operator, inverse_of, require
from mpmath import mp, mpf
from scipy.linalg import expm

STEPS = 20
DIGITS = 60
PARTS = 40
TOLERANCE = "1e-48"

# Three directions of se(3) that mix rotations and translations, and three covectors that vanish on them, exactly.
MIXED_SUBSPACE = [[1.0, 0.0, 1.0, 0.75, -0.5, 0.75], [0.0, 1.0, 0.0, 0.5, 0.25, -1.0], [1.0, 1.0, 0.0, 1.0, 0.5, -0.75]]
MIXED_ANNIHILATOR = [
    [-0.5, -0.5, -0.25, 1.0, 0.0, 0.0],
    [-0.25, -0.25, 0.75, 0.0, 1.0, 0.0],
    [-0.25, 1.0, -0.5, 0.0, 0.0, 1.0],
]


@dataclass(frozen=True)
class Equations:
    """What determines a displacement, all in mpmath numbers or all in float64."""

    basis: Array
    mass_tensor: Array
    time_step: Array
    rows: Array
    annihilator: Array
    skew: Array

    def rounded(self) -> Equations:
        """Return the same equations in float64."""
        return Equations(**{field.name: getattr(self, field.name).astype(float) for field in fields(self)})


@dataclass(frozen=True)
class Case:
    """One orbit to compute: float inputs, taken as exact."""

    system: str
    name: str
    group: str
    parameters: dict[str, Any]
    constraint_subspace: list[list[Number]]
    annihilator: list[list[Number]]
    constraint: str
    time_step: float
    restricted_velocity: list[float]
    configuration: list[list[float]]

    @property
    def n(self) -> int:
        """The dimension of the space that the body turns in."""
        return len(self.configuration) - (self.group[1] == "E")

    def equations(self) -> Equations:
        """Return the equations in mpmath numbers; the constraint rows are those at the identity."""
        basis = exact(algebra(self.group))
        rows = exact(self.constraint_subspace).reshape(-1, len(basis))
        annihilator = exact(self.annihilator).reshape(-1, len(basis))
        # Suslov tops, sleighs and Veselova tops are symmetric pairs: what is in exp d is skew too
        skew = exact(int(self.system == "left_invariant" and self.constraint == "skew"))
        return Equations(basis, homogeneous(self.parameters), exact(self.time_step), rows, annihilator, skew)


def homogeneous(parameters: dict[str, Any]) -> Array:
    """Return the mass tensor; of a sleigh, [[Jc + m a a^T, m a], [m a^T, m]]."""
    tensor = exact(parameters["mass_tensor"])
    if "mass" not in parameters:
        return tensor
    a = np.append(exact(parameters["center_of_mass"]), mpf(1))
    moved = parameters["mass"] * np.outer(a, a)
    moved[:-1, :-1] += tensor
    return moved


def displacement(basis: Array, x: Array) -> Array:
    """Return expm of the algebra element with coordinates x."""
    element = np.tensordot(x, basis, axes=1)
    return matrix_algebra.exponential(element) if element.dtype == object else expm(element)


def momentum(equations: Equations, w: Array) -> Array:
    """Return P_i = tr(E_i W JJ (W - I)^T) / h."""
    n = w @ equations.mass_tensor @ (w - np.eye(len(w), dtype=int)).T
    return equations.basis.reshape(len(equations.basis), -1) @ n.T.reshape(-1) / equations.time_step


def adjoint(basis: Array, w: Array, inverse: Array) -> Array:
    """Return the matrix of Ad_W; its transpose is that of Ad*_W."""
    return coordinates(basis, w @ basis @ inverse).T


def inclination(equations: Equations, x: Array) -> Array:
    """Return x for the constraint W in exp d, the coordinates of (W - W^-1)/2 for the skew constraint."""
    if not equations.skew:
        return x
    basis = equations.basis
    return coordinates(basis, displacement(basis, x) - displacement(basis, -x)) / 2


def residual(equations: Equations, x: Array, target: Array) -> Array:
    """Return the defects of P(W)|_d = target and of the constraint, W = expm(x)."""
    along = equations.rows @ momentum(equations, displacement(equations.basis, x)) - target
    return np.concatenate([along, equations.annihilator @ inclination(equations, x)])


def derivative(equations: Equations, x: Array) -> Array:
    """Return the Jacobian matrix of the residual in float64, by complex increments."""
    increment = 1e-30
    moved = [residual(equations, x + 1j * increment * unit, np.float64(0)) for unit in np.eye(len(x))]
    return np.array(moved).imag.T / increment


def newton(equations: Equations, target: Array, x: Array) -> Array:
    """Solve in float64 from x; the Jacobian determinant must keep the sign that it has at zero."""
    orientation = np.linalg.slogdet(derivative(equations, np.zeros_like(x)))[0]
    for _ in range(30):
        jacobian = derivative(equations, x)
        if np.linalg.slogdet(jacobian)[0] != orientation:
            raise ArithmeticError("fold crossed")
        change = np.linalg.solve(jacobian, residual(equations, x, target))
        x = x - change
        if np.abs(change).max() < 1e-10:
            return x
    raise ArithmeticError("Newton's method did not converge")


def principal(equations: Equations, target: Array) -> Array:
    """Continue the root from momentum zero along s target, 0 <= s <= 1, in float64."""
    rounded = equations.rounded()
    x = np.zeros(len(equations.basis))
    for part in range(1, PARTS + 1):
        x = newton(rounded, part / PARTS * target.astype(float), x)
    return x


def solve(equations: Equations, target: Array, x: Array) -> Array:
    """Solve from x, in float64 and then in mpmath numbers with the inverse Jacobian of float64."""
    rounded = equations.rounded()
    x = newton(rounded, target.astype(float), x.astype(float))
    return refined(equations, target, (exact(x), np.linalg.inv(derivative(rounded, x))))


def refined(equations: Equations, target: Array, root: tuple[Array, Array]) -> Array:
    """Return the root that is that close to a known one, with the inverse Jacobian matrix there in float64."""
    x, inverse = root
    for _ in range(30):
        change = inverse @ residual(equations, x, target)
        x = x - change
        if np.abs(change).max() < mpf(10) ** (5 - mp.dps):
            return x
    raise ArithmeticError("Newton's method did not converge")


def start(case: Case) -> Array:
    """Return g_0: the float64 entries with their rotation block projected on SO(n)."""
    g = exact(case.configuration)
    block = g[: case.n, : case.n]
    for _ in range(8):  # to the orthogonal factor of the polar decomposition
        block[:] = (block + inverse_of(block).T) / 2
    return g


def at(case: Case, equations: Equations, g: Array) -> Equations:
    """Return the equations at g: a constraint fixed in space is carried to the body frame."""
    if case.system != "veselova":
        return equations
    back = inverse_of(g)
    rows = equations.rows @ adjoint(equations.basis, back, g).T
    return replace(equations, rows=rows, annihilator=equations.annihilator @ adjoint(equations.basis, g, back))


def multipliers(annihilator: Array, difference: Array) -> Array:
    """Return the coefficients of a covector in rows of the annihilator; raise if it is not spanned by them."""
    result = np.zeros(0, dtype=object)
    if len(annihilator):
        gram = mp.matrix((annihilator @ annihilator.T).tolist())
        result = exact(list(mp.lu_solve(gram, mp.matrix((annihilator @ difference).tolist()))))
    require(np.abs(difference - annihilator.T @ result).max(), "step equation", mpf(10) ** (8 - mp.dps))
    return result


def energy(inertia: Array, rows: Array, p: Array) -> Number:
    """Return 1/2 r . (I|_d)^-1 r, r = P|_d."""
    r = rows @ p
    inner = mp.matrix((rows @ inertia @ rows.T).tolist())
    return mp.fdot(r, mp.lu_solve(inner, mp.matrix(r.tolist()))) / 2


def orbit(case: Case, verify: bool) -> dict[str, list[Any]]:
    """Return logarithms, displacements, momenta, multipliers, configurations and energies."""
    equations = case.equations()
    basis = equations.basis
    inertia = inertia_operator(basis, equations.mass_tensor)
    g = start(case)
    here = at(case, equations, g)
    target = here.rows @ inertia @ here.rows.T @ exact(case.restricted_velocity)
    x = principal(here, target)
    names = ("logarithm", "displacement", "momentum", "configurations", "energy", "multipliers")
    result: dict[str, list[Any]] = {name: [] for name in names}
    carried: list[Array] = []
    for step in range(STEPS + 1):
        x = solve(here, target, x)
        w = displacement(basis, x)
        if verify:
            same = displacement(basis.astype(float), principal(here, target))
            require(np.abs(same - w).max(), "principal root", mpf(10) ** -10)
        p = momentum(equations, w)
        values = (x, w, p, g, energy(inertia, here.rows, p))
        for name, value in zip(names, values, strict=False):
            result[name].append(value)
        if step:
            result["multipliers"].append(multipliers(here.annihilator, p - carried[-1]))
        carried.append(adjoint(basis, w, displacement(basis, -x)).T @ p)
        g = g @ w
        here = at(case, equations, g)
        target = here.rows @ carried[-1]
    return result


def precision(case: Case, result: dict[str, list[Any]]) -> Number:
    """Return the largest difference from the same orbit in 15 more digits."""
    with mp.workdps(DIGITS + 15):
        again = orbit(case, verify=False)
        names = ("momentum", "multipliers", "displacement", "configurations")
        return max(np.abs(np.array(result[name]) - np.array(again[name])).max(initial=mpf(0)) for name in names)


def make_case(case: Case) -> dict[str, Any]:
    """Compute one orbit and compare it with that in more digits; return its entry for the file."""
    result = orbit(case, verify=True)
    difference = precision(case, result)
    require(difference, f"{case.system} {case.name}", mpf(TOLERANCE))
    print(case.system, case.name, case.time_step, mp.nstr(difference, 2), flush=True)
    if case.system == "veselova":
        pairs = zip(result["configurations"], result["displacement"], strict=True)
        result["spatial_displacement"] = [g @ w @ inverse_of(g) for g, w in pairs]
    del result["logarithm"]
    return vars(case) | {key: decimals(value) for key, value in result.items()}


def remaining(rows: list[list[int]]) -> list[list[int]]:
    """Return the coordinate covectors that vanish on rows made of plus or minus unit vectors."""
    return np.eye(len(rows[0]), dtype=int)[~np.any(rows, axis=0)].tolist()


def suslov_rows(n: int) -> list[list[int]]:
    """Return e_i ^ e_n, i = 1..n-1."""
    turns = np.array([matrix_algebra.wedge(i, n - 1, n) for i in range(n - 1)])
    return coordinates(algebra(f"SO({n})"), turns).astype(int).tolist()


def sleigh_rows(n: int) -> list[list[int]]:
    """Return e_1 ^ e_j, j = 2..n, then v1."""
    basis = algebra(f"SE({n})")
    motions = np.array([*(matrix_algebra.wedge(0, j, n + 1) for j in range(1, n)), basis[-n]])
    return coordinates(basis, motions).astype(int).tolist()


def draw_tensor(draw: np.random.RandomState, size: int) -> list[list[float]]:
    """Draw a full positive definite matrix of short decimals."""
    factor = draw.uniform(-1, 1, (size, size))
    return np.round(factor @ factor.T / 2 + 0.15 * np.eye(size), 2).tolist()


def draw_velocity(draw: np.random.RandomState, basis: Array, rows: Array, turn: float) -> list[float]:
    """Draw a velocity whose rotation angle in unit time is about turn degrees."""
    direction = draw.uniform(0.3, 1, len(rows)) * draw.choice([-1, 1], len(rows))
    rate = np.abs(np.linalg.eigvals(np.tensordot(direction @ rows, basis, axes=1)).imag).max()
    return np.round(np.radians(turn) / rate * direction, 3).tolist()


def draw_configuration(draw: np.random.RandomState, n: int, size: int) -> list[list[float]]:
    """Draw a pose; its rotation block is orthogonal to float64 rounding, the same on every machine."""
    drawn = draw.uniform(-0.7, 0.7, (n, n))
    skew, unit = exact(drawn - drawn.T), np.eye(n, dtype=int)
    g = np.eye(size)
    g[:n, :n] = inverse_of(unit - skew) @ (unit + skew)
    g[:n, n:] = np.round(draw.uniform(-1, 1, (n, size - n)), 2)
    return g.tolist()


def symmetric(system: str, group: str, rows: list[list[int]], *runs: tuple[float, float]) -> tuple[Any, ...]:
    """Return a problem whose subspace is spanned by elements of the basis."""
    return system, group, "skew", rows, remaining(rows), [*runs]


# system, group, constraint, rows, annihilator, (time step, degrees a step of the drawn velocity) ...
PROBLEMS: list[tuple[Any, ...]] = [
    *(symmetric("suslov", f"SO({n})", suslov_rows(n), (0.1, 38.0), (0.5, 33.0)) for n in (4, 6, 10)),
    *(symmetric("sleigh", f"SE({n})", sleigh_rows(n), (0.1, 28.0), (0.5, 32.0)) for n in (3, 5)),
    ("left_invariant", "SE(3)", "skew", MIXED_SUBSPACE, MIXED_ANNIHILATOR, [(0.1, 30.0), (0.5, 28.0)]),
    ("left_invariant", "SE(3)", "exponential", MIXED_SUBSPACE, MIXED_ANNIHILATOR, [(0.5, 25.0)]),
    *(symmetric("veselova", f"SO({n})", suslov_rows(n), (0.1, 30.0), (0.5, 25.0)) for n in (3, 4)),
    symmetric("rigid_body", "SO(3)", np.eye(3, dtype=int).tolist(), (0.1, 40.0), (0.5, 35.0)),
    symmetric("rigid_body", "SO(4)", np.eye(6, dtype=int).tolist(), (0.1, 38.0), (0.5, 33.0)),
    symmetric("rigid_body", "SE(2)", np.eye(3, dtype=int).tolist(), (0.5, 30.0)),
    symmetric("rigid_body", "SE(3)", np.eye(6, dtype=int).tolist(), (0.1, 30.0)),
]


def draw_parameters(draw: np.random.RandomState, system: str, n: int, size: int) -> dict[str, Any]:
    """Draw mass, center of mass and mass tensor about it for a sleigh, else the mass tensor."""
    if system != "sleigh":
        return {"mass_tensor": draw_tensor(draw, size)}
    center = np.round(draw.uniform(0.15, 0.4, n) * draw.choice([-1, 1], n), 2).tolist()
    return {"mass": 1.3, "center_of_mass": center, "mass_tensor": draw_tensor(draw, n)}


def cases() -> list[Case]:
    """Draw the inputs; the stream of RandomState is the same in every version of NumPy."""
    result = []
    for seed, (system, group, constraint, rows, annihilator, runs) in enumerate(PROBLEMS):
        draw = np.random.RandomState(seed)
        n, basis = int(group[3:-1]), algebra(group)
        size = len(basis[0])
        parameters = draw_parameters(draw, system, n, size)
        for h, turn in runs:
            velocity = draw_velocity(draw, basis, np.array(rows), turn / h)
            if system == "sleigh":  # backwards, away from the unstable straight motion: the turning first grows
                velocity[-1] = -math.copysign(velocity[-1], parameters["center_of_mass"][0])
            pose = draw_configuration(draw, n, size)
            name = f"{group[:2]}{n}-{constraint}" if system == "left_invariant" else f"{group[:2]}{n}"
            result.append(Case(system, name, group, parameters, rows, annihilator, constraint, h, velocity, pose))
    return result


def main() -> None:
    """Write general_orbits.json beside this script."""
    mp.dps = DIGITS
    matrix_algebra.write_cases(Path(__file__).with_name("general_orbits.json"), [make_case(case) for case in cases()])


if __name__ == "__main__":
    main()
