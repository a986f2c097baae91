"""Make discrete_orbits.json: orbits of tops on SO(3) and of sleighs on SE(2) in 60 digits.

They are cases of the matrix equations that `make_general_orbits` solves; no closed form of a step is used.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from make_general_orbits import DIGITS, Case, make_case, remaining, suslov_rows
from matrix_algebra import write_cases
from mpmath import mp

GENERIC = [[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]
OTHER = [[0.7, -0.15, 0.22], [-0.15, 1.9, 0.41], [0.22, 0.41, 1.2]]
ALIGNED = [[1.1, 0.0, 0.45], [0.0, 0.7, 0.0], [0.45, 0.0, 0.9]]
FLAT = [[1.0, 0.5, 0.25], [0.5, 1.25, -0.375], [0.25, -0.375, 0.3125]]
BALANCED = [[1.3, 0.25, 0.0], [0.25, 0.8, 0.0], [0.0, 0.0, 0.6]]
ROD = [[0.28, 0.125, 0.5], [0.125, 0.0925, 0.25], [0.5, 0.25, 1.03]]
# name, mass tensor or (mass, inertia, a, b), body velocity for time step 1, body velocity for time step 0.1
BODIES: list[tuple[str, Any, list[float], list[float]]] = [
    ("generic-1", GENERIC, [0.35, 0.5, 0.0], [2.1, 2.7, 0.0]),
    ("generic-2", OTHER, [0.8, -0.3, 0.0], [-1.3, -3.2, 0.0]),
    ("balanced", BALANCED, [0.55, -0.7, 0.0], [2.4, 1.9, 0.0]),
    ("aligned", ALIGNED, [0.3, 0.6, 0.0], [-0.9, 3.1, 0.0]),
    ("flat", FLAT, [0.5, 0.4, 0.0], [2.6, -1.2, 0.0]),
    ("rod", ROD, [-0.2, 0.3, 0.0], [1.5, 2.0, 0.0]),
    ("b-zero", (1.2, 0.5, 0.6, 0.0), [0.7, -0.3, 0.0], [3.0, -1.5, 0.0]),
    ("b-nonzero", (0.9, 0.4, 0.7, 0.35), [-0.6, -0.4, 0.0], [2.5, -2.0, 0.0]),
    ("a-negative", (1.5, 0.6, -0.5, 0.2), [0.5, 0.35, 0.0], [-2.2, 2.6, 0.0]),
    ("a-zero", (1.1, 0.8, 0.0, 0.3), [0.75, 0.6, 0.0], [-3.5, 1.4, 0.0]),
    ("balanced", (1.0, 0.7, 0.0, 0.0), [0.8, -0.5, 0.0], [2.8, 1.1, 0.0]),
    ("b-large", (1.3, 0.45, 0.25, 2.5), [0.3, 0.7, 0.0], [1.2, 1.8, 0.0]),
]


def planar(mass: float, inertia: float, a: float, b: float) -> dict[str, Any]:
    """Return the parameters of a sleigh on SE(2) as those of one on SE(n); inertia is about the center of mass."""
    return {"mass": mass, "center_of_mass": [a, b], "mass_tensor": [[inertia / 2, 0.0], [0.0, inertia / 2]]}


def case_of(name: str, body: Any, velocity: list[float], time_step: float = 1.0) -> tuple[Case, dict[str, Any]]:
    """Return the case of a top or a sleigh, and what the file says of it."""
    if isinstance(body, tuple):
        system, group, general, rows = "sleigh", "SE(2)", planar(*body), [[1, 0, 0], [0, 1, 0]]
        parameters = dict(zip(("mass", "inertia", "a", "b"), body, strict=True))
        start, along = [[0.0, -1.0, 0.5], [1.0, 0.0, -0.25], [0.0, 0.0, 1.0]], velocity[:2]
    else:
        system, group, rows = "suslov", "SO(3)", suslov_rows(3)
        general = parameters = {"mass_tensor": body}
        start, along = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [velocity[1], -velocity[0]]
    case = Case(system, name, group, general, rows, remaining(rows), "skew", time_step, along, start)
    return case, {"system": system, "name": name, "parameters": parameters}


def made(name: str, body: Any, time_step: float, velocity: list[float]) -> dict[str, Any]:
    """Return the entry of an orbit."""
    case, report = case_of(name, body, velocity, time_step)
    entry = make_case(case)
    report |= {"time_step": time_step, "body_velocity": velocity, "configuration": case.configuration}
    return report | {key: entry[key] for key in ("displacement", "momentum", "multipliers", "configurations")}


def main() -> None:
    """Write discrete_orbits.json beside this script."""
    mp.dps = DIGITS
    runs = [(name, body, h, v) for name, body, *both in BODIES for h, v in zip((1.0, 0.1), both, strict=True)]
    write_cases(Path(__file__).with_name("discrete_orbits.json"), [made(*run) for run in runs])


if __name__ == "__main__":
    main()
