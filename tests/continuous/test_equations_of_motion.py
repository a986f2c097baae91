"""Flow, forces and vector field against the equations in the frame of the user, and those of SymPy by Kane."""

from collections.abc import Callable
from typing import Any

import jax
import numpy as np
import pytest
from problems import PROBLEMS, Problem
from references import golden
from scipy.integrate import solve_ivp

import nonholo as nh
from nonholo.systems import AbstractLLSystem, AbstractSystem

TIMES = np.linspace(0.0, 3.0, 7)
EACH = pytest.mark.parametrize("problem", PROBLEMS, ids=lambda p: p.name)


def _definition(system: AbstractLLSystem) -> Callable[[float, np.ndarray], np.ndarray]:
    """Return p' = ad*_omega p + lambda a, g' = g omega, from matrix commutators and the inverse inertia operator."""
    basis, a = system.group.basis, system.annihilator
    inverse = np.linalg.inv(system.inertia_operator)
    coordinates = np.linalg.pinv(basis.reshape(len(basis), -1).T)

    def rate(_: float, state: np.ndarray) -> np.ndarray:
        p, g = state[:3], state[3:].reshape(3, 3)
        X = np.tensordot(inverse @ p, basis, axes=1)
        torque = np.array([p @ coordinates @ (X @ E - E @ X).ravel() for E in basis])
        force = -np.linalg.solve(a @ inverse @ a.T, a @ inverse @ torque)
        return np.concatenate([torque + a.T @ force, (g @ X).ravel()])

    return rate


def _start(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    velocity = np.array(problem.restricted_velocity) @ problem.system.constraint_subspace
    return velocity, problem.system.group.random(np.random.default_rng(7))


@EACH
@pytest.mark.parametrize("method", [None, "closed_form"])
def test_flow_obeys_the_definition(problem: Problem, method: str | None) -> None:
    """In the user's frame (tilted axes, offset sleighs) both methods follow scipy's solution to the latter's errors."""
    system = problem.system
    velocity, g = _start(problem)
    state = np.concatenate([system.inertia_operator @ velocity, g.ravel()])
    reference = solve_ivp(_definition(system), (0, 3), state, "DOP853", TIMES, rtol=1e-12, atol=1e-13).y.T
    orbit = nh.flow(system, body_velocity=velocity, configuration=g, times=TIMES, method=method)
    scale = np.abs(reference).max()
    assert np.abs(orbit.momentum - reference[:, :3]).max() <= 1e-9 * scale
    assert np.abs(orbit.configuration.reshape(-1, 9) - reference[:, 3:]).max() <= 1e-9 * scale


@EACH
def test_forces_are_rates_of_momentum(problem: Problem) -> None:
    """Multipliers are the coefficients of p' - ad*_omega p, by differences of order 6 of a closed-form orbit."""
    system, step = problem.system, 0.01
    velocity, _ = _start(problem)
    orbit = nh.flow(system, body_velocity=velocity, times=step * np.arange(7), method="closed_form")
    weights = np.array([-1, 9, -45, 0, 45, -9, 1]) / (60 * step)
    p, omega = orbit.momentum, orbit.body_velocity
    residual = weights @ p - system.group.coad(omega[3], p[3])
    expected = orbit.multipliers[3] @ system.annihilator
    assert np.abs(residual - expected).max() <= 1e-9 * max(1.0, np.abs(p).max())


@EACH
@pytest.mark.parametrize("method", [None, "closed_form"])
def test_conserved_and_constrained(problem: Problem, method: str | None) -> None:
    """Constraint and group hold to rounding, energy to the error of the steps (closed form: to rounding)."""
    velocity, g = _start(problem)
    times = np.linspace(0.0, 20.0, 41)
    result = nh.invariants(nh.flow(problem.system, body_velocity=velocity, configuration=g, times=times, method=method))
    assert result.energy_drift <= (1e-8 if method is None else 1e-14)
    assert result.constraint_residual <= 1e-13
    assert result.group_residual <= 1e-14


@EACH
def test_vector_field_under_jax(problem: Problem) -> None:
    """Traced and compiled, the vector field is the NumPy one to rounding; leading axes broadcast."""
    field = nh.vector_field(problem.system)
    states = np.random.default_rng(3).normal(size=(4, 11))
    expected = np.stack([field(0.0, state) for state in states])
    with jax.enable_x64(True):
        result = np.asarray(jax.jit(field)(0.0, states))
    assert np.abs(result - expected).max() <= 1e-13 * np.abs(expected).max()
    assert np.abs(field(0.0, states) - expected).max() <= 1e-14 * np.abs(expected).max()


def test_vector_field_differentiates_with_respect_to_the_body() -> None:
    """The derivative of omega' = -(m a/I) u omega by a is (m u omega/I)(2 m a^2/I - 1)."""

    def rate(a: jax.Array) -> jax.Array:
        sleigh = nh.ChaplyginSleigh(mass=1.2, inertia=0.5, a=a)
        inertia = 0.5 + 1.2 * a * a
        state = jax.numpy.concatenate([jax.numpy.stack([inertia * 0.7, 1.2 * 0.3 + 0 * a]), jax.numpy.eye(3).ravel()])
        return nh.vector_field(sleigh)(0.0, state)[0] / inertia

    with jax.enable_x64(True):
        slope = float(jax.jit(jax.grad(rate))(0.6))
    inertia = 0.5 + 1.2 * 0.36
    assert abs(slope - 1.2 * 0.3 * 0.7 / inertia * (2 * 1.2 * 0.36 / inertia - 1)) <= 1e-14


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
    potential, force = (next((things[k] for k in things if k in acting), None) for things in (potentials, forces))
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
