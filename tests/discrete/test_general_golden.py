"""Orbits of the general step against 50-digit solutions of the matrix equations (tests/golden)."""

import numpy as np
import pytest
from references import golden, golden_system, numbers

import nonholo as nh
from nonholo.systems import AbstractSystem

GENERAL = golden("general_orbits.json")
CASES = [*GENERAL, *golden("discrete_orbits.json")]


def _name(case: dict) -> str:
    return f"{case['system']}-{case['name']}-{case['time_step']}"


def _group(name: str) -> object:
    family, n = name.rstrip(")").split("(")
    return {"SO": nh.SO, "SE": nh.SE}[family](int(n))


def _system(case: dict) -> AbstractSystem:
    data = case["parameters"]
    if case["system"] == "sleigh" and "center_of_mass" in data:
        return nh.MultidimensionalSleigh(data["mass"], data["center_of_mass"], data["mass_tensor"])
    if case["system"] in ("suslov", "sleigh"):
        return golden_system(case)
    if case["system"] == "veselova":
        return nh.VeselovaTop(data["mass_tensor"])
    if case["system"] == "rigid_body":
        return nh.RigidBody(data["mass_tensor"], _group(case["group"]))
    rows = {"constraint_subspace": case["constraint_subspace"], "annihilator": case["annihilator"]}
    return nh.LLSystem(_group(case["group"]), data["mass_tensor"], **rows)


def _check(case: dict, quantity: str, result: np.ndarray) -> None:
    """Compare with the reference, relative to the largest entry of a quantity over the orbit."""
    expected = numbers(case[quantity]).reshape(result.shape)
    missed = np.abs(result - expected).max(initial=0.0) / (np.abs(expected).max(initial=0.0) or 1.0)
    assert missed <= (1e-11 if case in GENERAL else 1e-12), quantity


def _orbit(case: dict, **options: object) -> nh.Orbit:
    discrete = nh.discretize(_system(case), case["time_step"], constraint=case.get("constraint", "skew"))
    names = ("restricted_velocity", "body_velocity", "configuration")
    start = {name: case[name] for name in names if name in case}
    return nh.simulate(discrete, **start, steps=len(case["momentum"]) - 1, **options)


@pytest.mark.profile("routes", keep=["[!l]*", "left_invariant-SE3-skew-*"])
@pytest.mark.parametrize("case", CASES, ids=_name)
def test_orbit_agrees_with_matrix_equations(case: dict) -> None:
    """Displacement, momentum, pose, multipliers and energy of 20 steps agree with the 50-digit reference."""
    orbit = _orbit(case)
    for quantity in ("displacement", "momentum", "configurations", "multipliers", "energy", "spatial_displacement"):
        if quantity in case:
            _check(case, quantity, getattr(orbit, quantity.removesuffix("s") if quantity[0] == "c" else quantity))


@pytest.mark.profile("routes", keep=["left_invariant-SE3-skew-*"])
@pytest.mark.parametrize("case", [case for case in GENERAL if case["group"] != "SO(10)"], ids=_name)
def test_definition_route_agrees(case: dict) -> None:
    """The same orbits by the definition, in JAX."""
    orbit = _orbit(case, backend="jax")
    _check(case, "displacement", orbit.displacement)
    _check(case, "configurations", orbit.configuration)
