"""Weights and friction among the numbers of a page, as names of its sliders, and back."""

from collections.abc import Mapping

import numpy as np

from nonholo.systems import AbstractSystem, Forced, Friction, Gravity


def force_numbers(forced: Forced) -> dict[str, float] | None:
    """Return F, the point x and the two coefficients c along the constraint; None of forces that no page computes.

    A page computes constant weights, and friction whose matrix is diagonal, in the user's own axes.
    """
    inside, friction, n = forced.system, forced.friction, forced.group.size - forced.group.is_affine
    gravity = forced.gravity or Gravity(np.zeros(n), np.zeros(n))
    coefficients = np.zeros(2) if friction is None else friction.coefficients
    turned = not np.array_equal(inside.frame, np.eye(len(inside.frame)))
    if forced.needs_function or forced.table is not None or coefficients.ndim > 1 or turned:
        return None
    numbered = {"F": gravity.force, "x": gravity.point, "c": coefficients[:2]}
    return {f"{name}{i}": float(x) for name, row in numbered.items() for i, x in enumerate(row, 1)}


def under_forces(system: AbstractSystem, numbers: Mapping[str, float]) -> Forced:
    """Return the system under the forces of a page, which acts without those that are zero."""
    F, x, c = ([numbers[f"{name}{i}"] for i in (1, 2, 3) if f"{name}{i}" in numbers] for name in "Fxc")
    weight = Gravity(F, x) if any(F) else None
    return Forced(system, weight, Friction([*c, 0.0]) if any(c) else None)
