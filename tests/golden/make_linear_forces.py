"""Make linear_forces.json: bodies under weights and friction by Taylor series in whole multiples of 2^-220.

Solves r' = S (ad*_omega p - dU - C omega), g' = g omega for the entries of g, with <-dU, x> = F . (g x point) from the
definition. Nothing of the library is imported here.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np
from matrix_algebra import algebra, coordinates, decimals, exact, inertia_operator, inverse_of, require, write_cases
from mpmath import mp, mpf

BITS, ORDER, STEPS = 220, 72, (8, 16)  # digits, terms, and steps a unit of time
TIMES = [0, 1, 5, 10, 20]

# name, group, homogeneous mass tensor, admissible body velocities, first velocity along them, F, point, friction
TOP = [[1.5, 0.25, 0.5], [0.25, 1.0, -0.375], [0.5, -0.375, 1.0]]
SLEIGH = [[0.75, 0.15625, 0.625], [0.15625, 0.578125, 0.3125], [0.625, 0.3125, 1.25]]
SPACE = [[1.25, 0.125, 0.0, 0.5], [0.125, 1.0, 0.0, 0.25], [0.0, 0.0, 0.75, -0.25], [0.5, 0.25, -0.25, 2.0]]
FOUR = [[1.0, 0.0, 0.0, 0.25], [0.0, 1.25, 0.0, -0.125], [0.0, 0.0, 0.75, 0.375], [0.25, -0.125, 0.375, 1.5]]
UPRIGHT, ALL = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], np.eye(3).tolist()
LAST, MIDDLE = np.eye(6)[[2, 4, 5]].tolist(), np.eye(6)[[1, 2, 3]].tolist()
RUBBED = [0.25, 0.5, 0.0]
MIXED = (np.eye(6) / 4 + np.eye(6, k=2) / 8 - np.eye(6, k=-2) / 8).tolist()
TILTED, DOWN, ASIDE = [0.25, -0.5, -2.0], [0.0, 0.0, -2.0], [0.25, 0.125, 0.5]
CASES: list[tuple[str, str, Any, Any, list[float], list[float], list[float], Any]] = [
    ("heavy top", "SO(3)", TOP, UPRIGHT, [0.5, -0.375], TILTED, ASIDE, []),
    ("heavy top at rest", "SO(3)", TOP, UPRIGHT, [0.0, 0.0], TILTED, ASIDE, []),
    ("heavy top with friction", "SO(3)", TOP, UPRIGHT, [0.5, -0.375], DOWN, [0.0, 0.0, 0.5], RUBBED),
    ("sleigh on a slope with friction", "SE(2)", SLEIGH, UPRIGHT, [0.75, -0.5], [1.0, -0.5], [0.5, 0.25], RUBBED),
    ("heavy free body", "SO(3)", TOP, ALL, [0.5, -0.375, 0.75], DOWN, ASIDE, []),
    ("heavy top on SO(4)", "SO(4)", FOUR, LAST, [0.5, -0.375, 0.25], [0.5, 0, -1, 0.25], [0.25, 0.125, 0.5, -0.25], []),
    ("heavy body on SE(3)", "SE(3)", SPACE, MIDDLE, [0.5, -0.375, 0.5], [0.5, 0, -1], [0.25, 0.125, -0.125], MIXED),
]


def whole(x: Any) -> Any:
    """Return an array of numbers in units of 2^-BITS."""
    scaled = np.vectorize(lambda one: int(cast(Any, mp.nint(mp.ldexp(mpf(one), BITS)))), otypes=[object])
    return scaled(np.array(x, dtype=object)) if np.size(x) else np.zeros(np.shape(x), dtype=object)


class Motion:
    """The numbers of a case: of w' = sum T_ab w_a w_b - D w + L s, s = g^T F, and g' = g sum w_a X_a."""

    def __init__(self, case: tuple[Any, ...]) -> None:
        """Prepare them in 80 digits."""
        _, group, tensor, rows, _, F, point, C = case
        affine, basis, S = group[1] == "E", exact(algebra(group)), exact(rows)
        force, place = [*F, *[0] * affine], exact([*point, *[1] * affine])
        momenta = inertia_operator(basis, exact(tensor)) @ S.T
        back, hats = inverse_of(S @ momenta), np.tensordot(S, basis, 1)
        brackets = coordinates(basis, hats[:, None] @ hats - hats @ hats[:, None])
        self.torques = whole(np.swapaxes(brackets @ momenta, 1, 2) @ back)
        friction = exact(C if np.ndim(C) == 2 else np.diag(C or np.zeros(len(basis))))
        self.friction = whole(back @ S @ friction @ S.T)
        self.levers, self.force, self.hats = whole(back @ (hats @ place)), whole(force), whole(hats)
        self.size = len(place)

    def expanded(self, w: Any, g: Any, shift: int) -> tuple[list[Any], list[Any]]:
        """Return the terms of a step of 2^-shift."""
        ws, gs = [w], [g]
        for j in range(ORDER):
            pairs = sum(np.multiply.outer(ws[i], ws[j - i]) for i in range(j + 1)) >> BITS
            force = (self.force @ gs[j]) >> BITS
            rate = np.tensordot(pairs, self.torques, 2) + self.levers @ force - self.friction @ ws[j]
            moves = [np.tensordot(x, self.hats, 1) >> BITS for x in ws]
            turned = sum(gs[i] @ moves[j - i] for i in range(j + 1)) >> BITS
            ws.append(((rate >> BITS) >> shift) // (j + 1))
            gs.append((turned >> shift) // (j + 1))
        return ws, gs

    def solved(self, velocity: list[float], a_unit: int, times: Sequence[float] = TIMES) -> list[tuple[Any, Any]]:
        """Return velocities and poses at the times."""
        w, g, result = whole(velocity), whole(np.eye(self.size)), []
        for step in range(int(times[-1] * a_unit) + 1):
            if step / a_unit in times:
                result.append((w, g))
            ws, gs = self.expanded(w, g, a_unit.bit_length() - 1)
            w, g = sum(ws[1:], ws[0]), sum(gs[1:], gs[0])
        return result


def main() -> None:
    """Solve every case with two lengths of steps, and write it."""
    mp.dps, written = 90, []
    for case in CASES:
        name, group, tensor, rows, velocity, F, point, C = case
        motion = Motion(case)
        result, other = (motion.solved(velocity, unit) for unit in STEPS)
        for one, two in zip(result, other, strict=True):
            gap = max(np.abs(a - b).max() for a, b in zip(one, two, strict=True))
            require(mp.ldexp(mpf(gap), -BITS), f"{name}: two lengths of steps", mpf(10) ** -45)
        states = [[decimals(number * mp.ldexp(1, -BITS)) for number in state] for state in result]
        written.append(
            {"name": name, "group": group, "mass_tensor": tensor, "constraint_subspace": rows, "friction": C}
            | {"force": F, "point": point, "restricted_velocity": velocity, "times": TIMES}
            | {"restricted_velocities": [w for w, _ in states], "configurations": [g for _, g in states]}
        )
        print(name)
    write_cases(Path(__file__).with_name("linear_forces.json"), written)


if __name__ == "__main__":
    main()
