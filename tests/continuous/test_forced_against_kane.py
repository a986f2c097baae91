"""Flows under forces against equations that SymPy derives with Kane's method (tests/golden/make_forced_flows.py)."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from references import golden

import nonholo as nh
from nonholo.systems import AbstractSystem

WRITTEN: Any = golden("forced_flows.json")
FORCES = WRITTEN["forces"]
PARTS = {nh.SO(3): [0, 1, 2], nh.SE(2): [2, 3, 4], nh.SE(3): [0, 1, 2, 3, 4, 5]}
"""Which coordinates of se(3) a group has."""


def _system(body: dict[str, Any]) -> AbstractSystem:
    mass, inertia = body["mass"], np.array(body["inertia"])
    if body["fixed"]:
        return nh.SuslovTop.from_inertia(inertia, body["held"][0][:3])
    if not inertia[0, 0]:
        return nh.ChaplyginSleigh(mass, inertia[2, 2], *body["center"][:2])
    return nh.MultidimensionalSleigh(mass, body["center"], np.trace(inertia) / 2 * np.eye(3) - inertia)


def _forced(case: dict[str, Any]) -> nh.Forced:
    """Return the system of a case, its forces as data or functions."""
    system, acting = _system(case["body"]), case["acting"]
    parts, n = PARTS[system.group], 2 if system.group == nh.SE(2) else 3
    point, anchor, C = (np.array(FORCES[name]) for name in ("point", "anchor", "friction"))
    C = C[np.ix_(parts, parts)]

    def spring(g: np.ndarray) -> float:
        place = g[:n, :n] @ point[:n] + (g[:n, n] if len(g) > n else 0.0)
        return float(FORCES["stiffness"] * np.sum((place - anchor[:n]) ** 2) / 2)

    def drive(time: float, g: np.ndarray, w: np.ndarray) -> np.ndarray:
        del g
        full = np.zeros(6)
        full[parts] = w
        force = np.cos(3 * time + np.arange(6)) - 0.2 * full * np.roll(full, -1)
        return force[parts] - ("friction" in acting) * C @ w

    heavy = nh.Gravity(FORCES["weight"][:n], point[:n])
    potentials: dict[str, Any] = {"weight": heavy, "spring": spring}
    forces: dict[str, Callable[..., Any] | nh.Friction] = {"drive": drive, "friction": nh.Friction(C)}
    potential, force = (next((made[k] for k in made if k in acting), None) for made in (potentials, forces))
    return nh.Forced(system, potential, force)


@pytest.mark.parametrize("case", WRITTEN["cases"], ids=lambda case: case["name"])
def test_velocities_poses_and_reactions(case: dict[str, Any]) -> None:
    """Body velocities, poses and the covectors of the constraint force agree to 1e-10."""
    forced = _forced(case)
    velocities, reactions = (np.array(case[key])[:, PARTS[forced.group]] for key in ("body_velocities", "reactions"))
    flow = nh.flow(forced, body_velocity=velocities[0], times=WRITTEN["times"])
    n = 2 if forced.group == nh.SE(2) else 3
    assert np.abs(flow.body_velocity - velocities).max() < 1e-10
    assert np.abs(flow.multipliers @ forced.annihilator - reactions).max() < 1e-10
    assert np.abs(flow.configuration[:, :n, :n] - np.array(case["rotations"])[:, :n, :n]).max() < 1e-10
    if forced.group.size > n:
        assert np.abs(flow.configuration[:, :n, n] - np.array(case["places"])[:, :n]).max() < 1e-10


@pytest.mark.parametrize("case", WRITTEN["cases"], ids=lambda case: case["name"])
def test_maps_approach_them_by_order_two(case: dict[str, Any]) -> None:
    """Velocities and poses of the discrete map come near them by order 2, and so do its impulses over the time step."""
    forced, missed = _forced(case), []
    velocities, reactions = (np.array(case[key])[:, PARTS[forced.group]] for key in ("body_velocities", "reactions"))
    n = 2 if forced.group == nh.SE(2) else 3
    for h in (0.04, 0.02):
        orbit = nh.simulate(nh.discretize(forced, h), body_velocity=velocities[0], steps=round(0.8 / h) + 1)
        impulse = orbit.multipliers[-2] @ forced.annihilator
        pose = orbit.configuration[-2][:n, :n] - np.array(case["rotations"])[2][:n, :n]
        missed.append(
            [np.abs(x).max() for x in (orbit.body_velocity[-2] - velocities[2], pose, impulse / h - reactions[2])]
        )
    assert np.log2(missed[0]) - np.log2(missed[1]) == pytest.approx(2.0, abs=0.1)
