"""Flow, forces and vector field against the Euler-Poincare-Suslov equations, written out in the user's frame."""

from collections.abc import Callable

import jax
import numpy as np
import pytest
from problems import PROBLEMS, Problem
from scipy.integrate import solve_ivp

import nonholo as nh
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import AbstractLLSystem

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
    found = nh.invariants(nh.flow(problem.system, body_velocity=velocity, configuration=g, times=times, method=method))
    assert found.energy_drift <= (1e-8 if method is None else 1e-14)
    assert found.constraint_residual <= 1e-13
    assert found.group_residual <= 1e-14


@EACH
def test_vector_field_under_jax(problem: Problem) -> None:
    """Traced and compiled, the vector field is the NumPy one to rounding; leading axes broadcast."""
    field = nh.vector_field(problem.system)
    states = np.random.default_rng(3).normal(size=(4, 11))
    expected = np.stack([field(0.0, state) for state in states])
    with jax.enable_x64(True):
        found = np.asarray(jax.jit(field)(0.0, states))
    assert np.abs(found - expected).max() <= 1e-13 * np.abs(expected).max()
    assert np.abs(field(0.0, states) - expected).max() <= 1e-14 * np.abs(expected).max()


@pytest.mark.parametrize("group", [nh.SO(3), nh.SE(2)], ids=str)
def test_pose_rate(group: AbstractMatrixGroup) -> None:
    """The rate of a compact pose is its central difference along g exp(t x), to the error of order t^2."""
    rng, step = np.random.default_rng(5), 1e-5
    for _ in range(5):
        g, x = group.random(rng), rng.normal(size=3)
        before, pose, after = (group.pose_from_matrix(g @ group.exp(t * x)) for t in (-step, 0.0, step))
        assert np.abs((after - before) / (2 * step) - group.pose_rate(pose, x)).max() <= 1e-9


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
