"""Weights, friction and the scale of a table among the numbers of a page, as names of its sliders, and back."""

import base64
import hashlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from nonholo.base.checks import number
from nonholo.base.types import Float
from nonholo.systems import AbstractSystem, Forced, Friction, Gravity


def force_numbers(forced: Forced) -> dict[str, float] | None:
    """Return F, the point x, the two coefficients c along the constraint and the scale s of a table.

    None of forces that no page computes.

    A page computes constant weights, and friction whose matrix is diagonal, in the user's own axes.
    """
    inside, friction, n = forced.system, forced.friction, forced.group.size - forced.group.is_affine
    gravity = forced.gravity or Gravity(np.zeros(n), np.zeros(n))
    coefficients = np.zeros(2) if friction is None else friction.coefficients
    turned = not np.array_equal(inside.frame, np.eye(len(inside.frame)))
    if forced.needs_function or coefficients.ndim > 1 or turned:
        return None
    numbered = {"F": gravity.force, "x": gravity.point, "c": coefficients[:2]}
    numbers = {f"{name}{i}": float(x) for name, row in numbered.items() for i, x in enumerate(row, 1)}
    return numbers if forced.table is None else {**numbers, "s": 1.0}


def under_forces(system: AbstractSystem, numbers: Mapping[str, float], rows: Float[np.ndarray, "K dim"]) -> Forced:
    """Return the system under the forces of a page, which acts without those that are zero; rows: its table."""
    F, x, c = ([numbers[f"{name}{i}"] for i in (1, 2, 3) if f"{name}{i}" in numbers] for name in "Fxc")
    weight, scale = Gravity(F, x) if any(F) else None, number("Page.orbit()", numbers.get("s", 0.0))
    forces = [Friction([*c, 0.0])] * any(c) + [scale * rows] * bool(scale)
    return Forced(system, weight, forces[0] if len(forces) == 1 else tuple(forces) or None)


def packed_table(body: str, rows: Float[np.ndarray, "K dim"]) -> dict[str, Any]:
    """Return a table as the data of a page hold it, for a body, with a name by which a state can call it."""
    content = rows.astype("<f8").tobytes()
    name = hashlib.sha256(content).hexdigest()[:12]
    return {"body": body, "name": name, "rows": base64.b64encode(content).decode()}


def table_of(packed: dict[str, Any] | None, least: int) -> Float[np.ndarray, "K dim"]:
    """Return the rows of a page's table, and after the last one as many that are zero as are missing from a number."""
    rows = np.zeros((0, 3)) if packed is None else np.frombuffer(base64.b64decode(packed["rows"]), "<f8").reshape(-1, 3)
    return np.concatenate([rows, np.zeros((max(0, least - len(rows)), 3))])
