"""Make flows.json: continuous Suslov tops and Chaplygin sleighs by the Taylor series of `make_linear_forces`.

Nothing acts on them: p' = ad*_omega p + lambda a, g' = g omega. No closed form is used.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from make_discrete_orbits import ALIGNED, FLAT, GENERIC, OTHER, case_of
from make_general_orbits import DIGITS, homogeneous
from make_linear_forces import BITS, STEPS, Motion
from matrix_algebra import algebra, coordinates, decimals, exact, inertia_operator, inverse_of, require, write_cases
from mpmath import mp, mpf

TIMES = [0.0, 0.5, 1.0, 2.0, 5.0, 10.0]
BODIES: list[tuple[str, Any, list[float]]] = [  # name, mass tensor or (mass, inertia, a, b), body velocity
    ("generic-1", GENERIC, [0.7, 0.9, 0.0]),
    ("generic-2", OTHER, [-1.3, 0.8, 0.0]),
    ("aligned", ALIGNED, [0.4, 0.95, 0.0]),
    ("flat", FLAT, [0.6, -1.1, 0.0]),
    ("b-zero", (1.2, 0.5, 0.6, 0.0), [1.1, -0.4, 0.0]),
    ("b-nonzero", (0.9, 0.4, 0.7, 0.35), [-0.9, -0.5, 0.0]),
    ("a-negative", (1.5, 0.6, -0.5, 0.2), [0.8, 0.7, 0.0]),
    ("lambda-two", (1.0, 0.75, 0.5, 0.1), [-0.75, -0.3, 0.0]),
    ("equilibrium", (1.2, 0.5, 0.6, 0.25), [0.0, 0.8, 0.0]),
    ("far-start", (1.1, 0.45, 0.5, -0.2), [0.001, -0.9, 0.0]),
]


def table(case: Any, unit: int) -> dict[str, Any]:
    """Return the columns of the file, by steps, this many a unit of time."""
    basis, tensor, nothing = exact(algebra(case.group)), homogeneous(case.parameters), [0.0] * case.n
    motion = Motion(("", case.group, tensor, case.constraint_subspace, [], nothing, nothing, []))
    every = [k / unit for k in range(int(TIMES[-1] * unit) + 1)]
    result = motion.solved(case.restricted_velocity, unit, every)
    states = [[exact(number.tolist()) * mp.ldexp(1, -BITS) for number in state] for state in result]
    inertia = inertia_operator(basis, tensor)
    turns = [mpf(0)]
    for (_, before), (_, after) in pairwise(states):
        moved = before.T[:2, :2] @ after[:2, :2]
        turns.append(turns[-1] + mp.atan2(moved[1, 0], moved[0, 0]))
    chosen = [every.index(t) for t in TIMES]
    velocities = np.array([states[k][0] for k in chosen]) @ exact(case.constraint_subspace)
    poses, momenta = exact(case.configuration) @ np.array([states[k][1] for k in chosen]), velocities @ inertia
    reaction = inverse_of(inertia) @ exact(case.annihilator[0])
    hats = np.tensordot(velocities, basis, axes=1)[:, None]
    torques = np.einsum("tik,tk->ti", coordinates(basis, hats @ basis - basis @ hats), momenta)
    columns = {"body_velocities": velocities, "momentum": momenta}
    columns |= {"multipliers": -(torques @ reaction)[:, None] / reaction[-1], "configurations": poses}
    if case.system == "sleigh":
        columns["heading"] = mp.atan2(poses[0, 1, 0], poses[0, 0, 0]) + np.array([turns[k] for k in chosen])
        columns["position"] = poses[:, :2, 2]
    return columns


def made(name: str, body: Any, velocity: list[float]) -> dict[str, Any]:
    """Return the entry of a motion; raise if one by steps half as long differs."""
    case, report = case_of(name, body, velocity)
    result, finer = (table(case, unit) for unit in STEPS)
    difference = max(np.abs(result[key] - finer[key]).max() for key in result)
    require(difference, name, mpf(10) ** -45)
    print(name, mp.nstr(difference, 2), flush=True)
    report |= {"body_velocity": velocity, "configuration": case.configuration, "times": TIMES}
    return report | {key: decimals(result[key]) for key in result}


def main() -> None:
    """Write flows.json beside this script."""
    mp.dps = DIGITS
    write_cases(Path(__file__).with_name("flows.json"), [made(*body) for body in BODIES])


if __name__ == "__main__":
    main()
