"""The Chaplygin sleigh in (theta, x, y), with the discrete Lagrangian of the group route: the same motion."""

import functools

import jax.numpy as jnp
import numpy as np
import pytest

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit, LagrangeDAlembert

pytestmark = pytest.mark.profile("routes", instead="test_the_equations_hold_with_their_sign")

SLEIGH = nh.ChaplyginSleigh(mass=1.3, inertia=0.7, a=0.5, b=0.2)
STEP = 0.15
STEPS = 200


def pose(q):  # noqa: ANN001, ANN201
    """Return the matrix of a configuration (theta, x, y)."""
    c, s = jnp.cos(q[0]), jnp.sin(q[0])
    return jnp.array([[c, -s, q[1]], [s, c, q[2]], [0.0, 0.0, 1.0]])


def lagrangian(q, v):  # noqa: ANN001, ANN201
    """Return the left-invariant kinetic energy."""
    c, s = jnp.cos(q[0]), jnp.sin(q[0])
    w = jnp.array([v[0], c * v[1] + s * v[2], -s * v[1] + c * v[2]])
    return w @ np.asarray(SLEIGH.inertia_operator) @ w / 2


def discrete_lagrangian(q, q_next, h):  # noqa: ANN001, ANN201
    """Return tr (W - I) J (W - I)^T / (2 h), W = X^-1 X', which is left-invariant."""
    W = jnp.linalg.inv(pose(q)) @ pose(q_next)
    X = W - jnp.eye(3)
    return jnp.trace(X @ np.asarray(SLEIGH.homogeneous_mass_tensor) @ X.T) / (2 * h)


@functools.cache
def sleigh(bend: float) -> LagrangeDAlembert:
    """Return the sleigh whose blade points along theta + bend x: for bend = 0 the constraint is left-invariant too."""

    def forms(q):  # noqa: ANN001, ANN202
        angle = q[0] + bend * q[1]
        return jnp.array([[0.0, -jnp.sin(angle), jnp.cos(angle)]])

    def constraint(q, q_next, h):  # noqa: ANN001, ANN202, ARG001
        middle = (q + q_next) / 2
        angle = middle[0] + bend * middle[1]
        return jnp.array([-jnp.sin(angle) * (q_next[1] - q[1]) + jnp.cos(angle) * (q_next[2] - q[2])])

    return LagrangeDAlembert(
        lagrangian, forms, dimension=3, discrete_lagrangian=discrete_lagrangian, discrete_constraints=constraint
    )


def in_space(body_velocity: tuple[float, float, float], heading: float) -> np.ndarray:
    """Return (theta', x', y') of a body velocity."""
    c, s = np.cos(heading), np.sin(heading)
    omega, v1, v2 = body_velocity
    return np.array([omega, c * v1 - s * v2, s * v1 + c * v2])


@functools.cache
def both() -> tuple[CoordinateOrbit, nh.Orbit]:
    """Return the orbits of both routes from the same start."""
    start, velocity = np.array([0.4, 1.0, -2.0]), (1.0, -1.0, 0.0)
    discrete = nh.discretize(sleigh(0.0), STEP)
    ours = nh.simulate(discrete, configuration=start, body_velocity=in_space(velocity, 0.4), steps=STEPS)
    g = np.asarray([[np.cos(0.4), -np.sin(0.4), 1.0], [np.sin(0.4), np.cos(0.4), -2.0], [0.0, 0.0, 1.0]])
    return ours, nh.simulate(nh.discretize(SLEIGH, STEP), body_velocity=velocity, configuration=g, steps=STEPS)


def test_the_motion_is_that_of_the_group_route() -> None:
    """Poses of size 40 after 200 steps, impulses in size and sign, and <P_k, v> agree to rounding, below 1e-11."""
    ours, group = both()
    turned, p = ours.configuration[:, 0] - group.heading, ours.momentum
    assert np.abs(turned - turned[0]).max() <= 1e-11
    assert np.abs(ours.configuration[:, 1:] - group.position).max() <= 1e-11
    assert np.abs(group.multipliers).max() > 0.1
    assert np.abs(ours.multipliers - group.multipliers).max() <= 1e-11
    c, s = np.cos(ours.configuration[:, 0]), np.sin(ours.configuration[:, 0])
    body = np.stack([p[:, 0], c * p[:, 1] + s * p[:, 2], -s * p[:, 1] + c * p[:, 2]], axis=1)
    assert np.abs(body - group.momentum).max() <= 1e-11


def test_the_energy_theorem_shows_in_coordinates() -> None:
    """The reduced constrained energy of the coordinate orbit is constant, though -dL_d/dh is not."""
    ours, group = both()
    angle = ours.configuration[:, 0]
    restricted = np.stack(
        [ours.momentum[:, 0], np.cos(angle) * ours.momentum[:, 1] + np.sin(angle) * ours.momentum[:, 2]], axis=1
    )
    energy = [group.system.constrained_energy(r) for r in restricted]
    assert np.ptp(energy) <= 1e-12
    assert np.ptp(ours.energy) > 1e-3


def test_a_blade_that_depends_on_position_has_slope_two() -> None:
    """L_d is left-invariant, the constraint is not: this route still converges to the flow with order 2 +- 0.1."""
    bend = 0.3
    q, v = np.array([0.4, 1.0, -2.0]), in_space((0.7, 1.0, 0.0), 0.4 + bend)
    v[0], time, counts = 0.7, 2.0, (50, 100, 200, 400)
    exact = nh.flow(sleigh(bend), configuration=q, body_velocity=v, times=[0.0, time], rtol=1e-13, atol=1e-14)
    errors = []
    for n in counts:
        orbit = nh.simulate(
            nh.discretize(sleigh(bend), time / n), configuration=q, body_velocity=v, steps=n, save_every=n
        )
        errors.append(np.abs(orbit.configuration[-1] - exact.configuration[-1]).max())
    slope = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert abs(slope - 2.0) <= 0.1
