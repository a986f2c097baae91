"""Closed forms and numerical flow against Taylor series of the matrix equations in 60 digits (tests/golden)."""

import numpy as np
import pytest
from references import golden, golden_system, numbers

import nonholo as nh

CASES = golden("flows.json")
SLEIGHS = [case for case in CASES if case["system"] == "sleigh"]
TOPS = [case for case in CASES if case["system"] == "suslov"]
SHARP = {"rtol": 1e-13, "atol": 1e-15}


def _name(case: dict) -> str:
    return f"{case['system']} {case['name']}"


def _flow(case: dict, **options: object) -> nh.Orbit:
    start = {"body_velocity": case["body_velocity"], "configuration": case["configuration"], "times": case["times"]}
    return nh.flow(golden_system(case), **start, **options)


def _miss(found: np.ndarray, reference: list) -> float:
    return float(np.abs(found - numbers(reference)).max())


@pytest.mark.parametrize("case", CASES, ids=_name)
def test_closed_form_of_velocity_momentum_and_force(case: dict) -> None:
    """Velocities, momenta and multipliers of the closed form are right to 1e-13.

    The worst case starts near a repelling axis, where rounding the momentum is felt 20 times; the others reach 1e-15.
    """
    orbit = _flow(case, method="closed_form")
    assert _miss(orbit.body_velocity, case["body_velocities"]) <= 1e-13
    assert _miss(orbit.momentum, case["momentum"]) <= 1e-13
    assert _miss(orbit.multipliers, case["multipliers"]) <= 1e-13


@pytest.mark.parametrize("case", SLEIGHS, ids=_name)
def test_closed_form_of_sleigh_pose(case: dict) -> None:
    """Poses and headings of the closed form are right to 5e-14, with paths up to 10 long."""
    orbit = _flow(case, method="closed_form")
    assert _miss(orbit.configuration, case["configurations"]) <= 5e-14
    assert _miss(orbit.position, case["position"]) <= 5e-14
    assert _miss(orbit.heading, case["heading"]) <= 5e-14


@pytest.mark.parametrize("case", TOPS, ids=_name)
def test_pose_of_top_by_quadrature(case: dict) -> None:
    """Poses of tops integrated from the closed velocity are right to 1e-11, 100 times the error allowed per step."""
    assert _miss(_flow(case, method="closed_form", **SHARP).configuration, case["configurations"]) <= 1e-11


@pytest.mark.parametrize("case", CASES, ids=_name)
def test_numerical_flow(case: dict) -> None:
    """With 1e-13 per step the numerical flow is right to 1e-11 after some 100 steps, in every quantity."""
    orbit = _flow(case, **SHARP)
    assert _miss(orbit.configuration, case["configurations"]) <= 1e-11
    assert _miss(orbit.body_velocity, case["body_velocities"]) <= 1e-11
    assert _miss(orbit.multipliers, case["multipliers"]) <= 1e-11


@pytest.mark.parametrize("case", CASES, ids=_name)
def test_numerical_flow_at_default_tolerances(case: dict) -> None:
    """With the default 1e-10 per step the error at time 10 is below 1e-8."""
    assert _miss(_flow(case).configuration, case["configurations"]) <= 1e-8


@pytest.mark.parametrize("case", SLEIGHS, ids=_name)
def test_numerical_heading_is_unwrapped(case: dict) -> None:
    """The numerical heading counts full turns and is, to rounding, the angle of the configuration."""
    orbit = _flow(case, **SHARP)
    assert _miss(orbit.heading, case["heading"]) <= 1e-11
    assert np.abs(np.cos(orbit.heading) - orbit.configuration[:, 0, 0]).max() <= 1e-14
