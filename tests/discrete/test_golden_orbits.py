"""Orbits of the closed forms against 50-digit solutions of the matrix equations."""

import numpy as np
import pytest
from references import golden, golden_system, numbers

import nonholo as nh

CASES = golden("discrete_orbits.json")
TOLERANCE = 1e-12  # relative to the largest entry of each quantity over the orbit


def _relative(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.abs(found - expected).max() / (np.abs(expected).max() or 1.0))


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case['system']}-{case['name']}-{case['time_step']}")
def test_orbit_agrees_with_matrix_equations(case: dict) -> None:
    """Displacement, momentum, multiplier and pose of 20 steps agree with the 50-digit reference."""
    discrete = nh.discretize(golden_system(case), case["time_step"])
    orbit = nh.simulate(
        discrete,
        body_velocity=case["body_velocity"],
        configuration=case["configuration"],
        steps=len(case["momentum"]) - 1,
    )
    assert _relative(orbit.displacement, numbers(case["displacement"])) <= TOLERANCE
    assert _relative(orbit.momentum, numbers(case["momentum"])) <= TOLERANCE
    assert _relative(orbit.multipliers, numbers(case["multipliers"])) <= TOLERANCE
    assert _relative(orbit.configuration, numbers(case["configurations"])) <= TOLERANCE
