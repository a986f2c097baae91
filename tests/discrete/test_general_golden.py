"""Orbits of the general step against 50-digit solutions of the matrix equations (tests/golden)."""

import numpy as np
import pytest
from references import golden, numbers

import nonholo as nh
from nonholo.systems import AbstractSystem

CASES = golden("general_orbits.json")
TOLERANCE = 1e-11  # relative to the largest entry of each quantity over the orbit


def _name(case: dict) -> str:
    return f"{case['system']}-{case['name']}-{case['time_step']}"


def _group(name: str) -> object:
    family, n = name.rstrip(")").split("(")
    return {"SO": nh.SO, "SE": nh.SE}[family](int(n))


def _system(case: dict) -> AbstractSystem:
    data = case["parameters"]
    if case["system"] == "suslov":
        return nh.SuslovTop(data["mass_tensor"])
    if case["system"] == "sleigh":
        return nh.MultidimensionalSleigh(data["mass"], data["center_of_mass"], data["mass_tensor"])
    if case["system"] == "veselova":
        return nh.VeselovaTop(data["mass_tensor"])
    if case["system"] == "rigid_body":
        return nh.RigidBody(data["mass_tensor"], _group(case["group"]))
    rows = {"constraint_subspace": case["constraint_subspace"], "annihilator": case["annihilator"]}
    return nh.LLSystem(_group(case["group"]), data["mass_tensor"], **rows)


def _relative(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.abs(found - expected).max(initial=0.0) / (np.abs(expected).max(initial=0.0) or 1.0))


def _orbit(case: dict, **options: object) -> nh.Orbit:
    discrete = nh.discretize(_system(case), case["time_step"], constraint=case["constraint"])
    start = {"restricted_velocity": case["restricted_velocity"], "configuration": case["configuration"]}
    return nh.simulate(discrete, **start, steps=20, **options)


@pytest.mark.profile("routes", keep=["[!l]*", "left_invariant-SE3-skew-*"])
@pytest.mark.parametrize("case", CASES, ids=_name)
def test_orbit_agrees_with_matrix_equations(case: dict) -> None:
    """Displacement, momentum, pose, multipliers and energy of 20 steps agree with the 50-digit reference."""
    orbit = _orbit(case)
    assert _relative(orbit.displacement, numbers(case["displacement"])) <= TOLERANCE
    assert _relative(orbit.momentum, numbers(case["momentum"])) <= TOLERANCE
    assert _relative(orbit.configuration, numbers(case["configurations"])) <= TOLERANCE
    shape = (20, len(orbit.system.annihilator))
    assert _relative(orbit.multipliers, numbers(case["multipliers"]).reshape(shape)) <= TOLERANCE
    assert _relative(orbit.energy, numbers(case["energy"])) <= TOLERANCE


@pytest.mark.parametrize("case", [case for case in CASES if case["system"] == "veselova"], ids=_name)
def test_spatial_displacement(case: dict) -> None:
    """For a right-invariant constraint U_k = g_{k+1} g_k^-1 agrees too."""
    assert _relative(_orbit(case).spatial_displacement, numbers(case["spatial_displacement"])) <= TOLERANCE


@pytest.mark.profile("routes", keep=["left_invariant-SE3-skew-*"])
@pytest.mark.parametrize("case", [case for case in CASES if case["group"] != "SO(10)"], ids=_name)
def test_definition_route_agrees(case: dict) -> None:
    """The same orbits by the definition, in JAX."""
    orbit = _orbit(case, backend="jax")
    assert _relative(orbit.displacement, numbers(case["displacement"])) <= TOLERANCE
    assert _relative(orbit.configuration, numbers(case["configurations"])) <= TOLERANCE
