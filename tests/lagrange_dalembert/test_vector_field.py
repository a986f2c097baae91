"""The equations of systems in coordinates for your own solver, against their flows."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from refusals import refusals
from scipy.integrate import solve_ivp

import nonholo as nh

READY = ["snakeboard", "knife_edge_on_incline", "driven_sleigh", "non_reversible", "chaplygin_ball"]


@pytest.mark.profile("routes", keep=["snakeboard"])
@pytest.mark.parametrize("name", READY)
def test_a_solver_reaches_the_end_of_the_flow(name: str) -> None:
    """SciPy, given the vector field, ends where `flow` ends: with driven joints and constraints of the pose, too."""
    ready = getattr(nh.examples, name)()
    start = np.concatenate([np.ravel(ready.configuration), ready.body_velocity])
    end = solve_ivp(nh.vector_field(ready.system), (0.0, 2.0), start, rtol=1e-11, atol=1e-12).y[:, -1]
    flow = ready.flow(times=[0.0, 2.0])
    state = np.concatenate([np.ravel(flow.configuration[-1]), flow.body_velocity[-1]])
    np.testing.assert_allclose(end, state, rtol=0, atol=1e-8)


def test_moving_constraints_and_a_lagrangian_of_time() -> None:
    """A bead on a turntable whose spring stiffens: the acceleration is that of a hand calculation."""
    spring: Any = lambda q, v, time: v @ v / 2 - (1 + time) * q @ q / 2  # noqa: E731
    system = nh.LagrangeDAlembert(
        spring,
        lambda q: jnp.array([[-q[1], q[0]]]),
        dimension=2,
        constraint_velocities=lambda q, _: 0.5 * (q @ q)[None],
    )
    time, q, v = 0.3, np.array([2.0, 0.0]), np.array([0.7, 1.0])  # v_y = 0.5 r
    found = nh.vector_field(system)(time, np.concatenate([q, v]))
    # x'' = -(1 + t) x, and the derivative of x y' - y x' = (x^2 + y^2) / 2 is x y'' = x x'
    np.testing.assert_allclose(found, [0.7, 1.0, -(1 + time) * q[0], 0.7], rtol=0, atol=1e-14)


def test_traced_and_stacked_states_are_those_of_numpy() -> None:
    """Inside JAX, and with leading axes, the derivative is the one of a single NumPy state."""
    ready = nh.examples.snakeboard()
    field = nh.vector_field(ready.system)
    states = np.concatenate([ready.configuration, ready.body_velocity]) + 0.01 * np.arange(30).reshape(3, 10)
    single = np.stack([field(0.0, state) for state in states])
    assert isinstance(single, np.ndarray)
    np.testing.assert_allclose(field(0.0, states[None])[0], single, rtol=0, atol=1e-14)
    with jax.enable_x64(True):
        np.testing.assert_allclose(jax.jit(jax.vmap(lambda x: field(0.0, x)))(states), single, rtol=0, atol=1e-14)


def test_parameters_are_those_of_the_system() -> None:
    """Of a system with parameters NumPy and traced states have its numbers, not those it was made with."""
    swing: Any = lambda q, v, p: v @ v / 2 + p["g"] * jnp.cos(q[0])  # noqa: E731
    pendulum = nh.LagrangeDAlembert(swing, None, dimension=1, parameters={"g": 1.0}).with_parameters(g=4.0)
    field, state, wanted = nh.vector_field(pendulum), np.array([0.5, 0.1]), [0.1, -4 * np.sin(0.5)]
    np.testing.assert_allclose(field(0.0, state), wanted, rtol=1e-15)
    with jax.enable_x64(True):
        np.testing.assert_allclose(jax.jit(lambda x: field(0.0, x))(state), wanted, rtol=1e-15)
    np.testing.assert_allclose(nh.linearize(pendulum, configuration=[np.pi]).eigenvalues, [2, -2], rtol=1e-14)


def test_forces_on_groups_are_traced() -> None:
    """The derivative by JAX of the field of a body under weight and friction is that of differences."""
    sleigh = nh.ChaplyginSleigh(2.0, 1.0, 0.5, 0.3)
    field = nh.vector_field(nh.Forced(sleigh, nh.Gravity([0.2, -1.0], [0.5, 0.1]), nh.Friction([0.1, 0.2, 0.0])))
    state = np.concatenate([[0.3, 0.4], nh.SE(2).exp([0.3, 0.1, 0.2]).ravel()])
    with jax.enable_x64(True):
        slope = jax.jacfwd(lambda x: field(0.0, x))(state)
    columns = [(field(0.0, state + e) - field(0.0, state - e)) / 2e-4 for e in 1e-4 * np.eye(len(state))]
    np.testing.assert_allclose(slope, np.transpose(columns), rtol=0, atol=1e-11)


FREE = nh.LagrangeDAlembert(lambda _, v: v @ v / 2, None, dimension=2)
# A force for each step has no vector field; a state of another size is refused.
test_what_has_no_vector_field_is_refused = refusals(
    (lambda: nh.vector_field(FREE.forced(None, np.zeros((3, 2)))), r"`vector_field\(system=\.\.\.\)` must have forces"),
    (lambda: nh.vector_field(FREE)(0.0, np.zeros(3)), r"must end in shape \(4"),
)
