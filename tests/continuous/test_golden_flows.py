"""Closed forms and numerical flow against Taylor series of the matrix equations in 60 digits (tests/golden)."""

import numpy as np
import pytest
from references import golden, golden_system, numbers

import nonholo as nh

CASES = golden("flows.json")
SLEIGHS = [case for case in CASES if case["system"] == "sleigh"]
SHARP = {"rtol": 1e-13, "atol": 1e-15}


def _name(case: dict) -> str:
    return f"{case['system']} {case['name']}"


def _flow(case: dict, **options: object) -> nh.Orbit:
    start = {"body_velocity": case["body_velocity"], "configuration": case["configuration"], "times": case["times"]}
    return nh.flow(golden_system(case), **start, **options)


def _miss(found: np.ndarray, reference: list) -> float:
    return float(np.abs(found - numbers(reference)).max())


@pytest.mark.parametrize("case", CASES, ids=_name)
def test_closed_form(case: dict) -> None:
    """Velocities, momenta and multipliers are right to 1e-13, poses and headings of sleighs to 5e-14.

    The worst case starts near a repelling axis, where rounding the momentum is felt 20 times; the others reach 1e-15.
    Poses of tops are integrated, to 100 times the error allowed per step.
    """
    orbit = _flow(case, method="closed_form", **SHARP)
    assert _miss(orbit.body_velocity, case["body_velocities"]) <= 1e-13
    assert _miss(orbit.momentum, case["momentum"]) <= 1e-13
    assert _miss(orbit.multipliers, case["multipliers"]) <= 1e-13
    assert _miss(orbit.configuration, case["configurations"]) <= (5e-14 if case in SLEIGHS else 1e-11)
    if case in SLEIGHS:
        assert _miss(orbit.position, case["position"]) <= 5e-14
        assert _miss(orbit.heading, case["heading"]) <= 5e-14


@pytest.mark.parametrize("case", CASES, ids=_name)
def test_numerical_flow(case: dict) -> None:
    """Right to 1e-11 after some 100 steps of 1e-13 each, full turns counted; with the default 1e-10 to 1e-8."""
    orbit = _flow(case, **SHARP)
    assert _miss(orbit.configuration, case["configurations"]) <= 1e-11
    assert _miss(orbit.body_velocity, case["body_velocities"]) <= 1e-11
    assert _miss(orbit.multipliers, case["multipliers"]) <= 1e-11
    assert _miss(_flow(case).configuration, case["configurations"]) <= 1e-8
    if case in SLEIGHS:
        assert _miss(orbit.heading, case["heading"]) <= 1e-11
        assert np.abs(np.cos(orbit.heading) - orbit.configuration[:, 0, 0]).max() <= 1e-14
