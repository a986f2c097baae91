"""Work on systems in coordinates: forces, driven joints, moving constraints; the balance closes at order two."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from refusals import refusals
from scipy.integrate import solve_ivp

import nonholo as nh

SPAN = 1.6


def _blade(q: Any) -> Any:
    return jnp.array([[-jnp.sin(q[2]), jnp.cos(q[2]), 0.0]])


def _push(time: Any, q: Any, v: Any) -> Any:
    return jnp.stack([jnp.cos(time), 0.4 * q[0], 0.3]) - 0.2 * v * jnp.abs(v)


def _kinetic(_q: Any, v: Any) -> Any:
    return (v[0] ** 2 + v[1] ** 2 + 0.3 * v[2] ** 2) / 2


def _skate(lagrangian: Callable[..., Any] = _kinetic, **more: Any) -> nh.LagrangeDAlembert:
    return nh.LagrangeDAlembert(lagrangian, _blade, dimension=3, **more)


def _table(h: float) -> np.ndarray:
    t = (np.arange(round(SPAN / h)) + 0.5) * h
    return np.stack([np.cos(t), np.sin(3 * t), 0.3 + 0 * t], axis=1)


CASES: dict[str, Callable[[float], nh.LagrangeDAlembert]] = {
    "force": lambda _: _skate(force=_push),
    "friction": lambda _: nh.Forced(_skate(), lambda q: q[0] ** 2, nh.Friction([0.1, 0.2, 0.3])),
    "table": lambda h: nh.Forced(_skate(), force=_table(h)),
    "all three": lambda h: nh.Forced(_skate(), force=(nh.Friction([0.1, 0.2, 0.3]), _push, _table(h))),
    "driven heading": lambda _: _skate(prescribed={2: lambda time: jnp.sin(2 * time)}, force=_push),
    "moving belt": lambda _: _skate(constraint_velocities=lambda q, time: jnp.stack([0.3 * jnp.cos(time) + q[0]])),
    "growing mass": lambda _: _skate(lambda q, v, time: (1 + time**2 / 2) * _kinetic(q, v) - q[1]),
    "all that changes": lambda _: _skate(
        lambda q, v, t: (1 + 0.5 * jnp.sin(t)) * (v @ v) / 2 - q[0] ** 2 / 2 + 0.2 * v[0] * v[2],
        prescribed={2: lambda time: 0.5 * jnp.sin(2 * time)}, rule="trapezoidal",
    ),
}  # fmt: skip
HEADING = {"driven heading": 2.0, "all that changes": 1.0}  # its rate at the start


def _start(name: str) -> dict[str, Any]:
    return {"configuration": np.zeros(3), "body_velocity": [0.7, 0.3 * (name == "moving belt"), HEADING.get(name, 0.5)]}


def _run(name: str, h: float) -> Any:
    return nh.simulate(nh.discretize(CASES[name](h), h), **_start(name), steps=round(SPAN / h))


@pytest.mark.profile("routes", instead="test_a_spring_passes")
@pytest.mark.parametrize("name", CASES)
def test_the_balance_closes_at_order_two(name: str) -> None:
    """Energy less work, and errors against the flow, fall by four with half the step; work changes the energy."""
    orbits = [_run(name, h) for h in (0.04, 0.02)]
    left = [np.abs(orbit.energy - orbit.energy[0] - orbit.work).max() for orbit in orbits]
    assert abs(np.log2(left[0] / left[1]) - 2.0) <= 0.1
    assert left[1] < 0.02 * np.ptp(orbits[1].energy)
    result = nh.invariants(orbits[1])
    assert result.work == orbits[1].work[-1]
    assert result.energy_drift == left[1] / np.abs(orbits[1].energy).max()
    if name not in ("table", "all three"):
        exact = nh.flow(CASES[name](0.02), **_start(name), times=(0.0, SPAN), rtol=1e-13, atol=1e-14)
        errors = [np.abs(orbit.configuration[-1] - exact.configuration[-1]).max() for orbit in orbits]
        assert abs(np.log2(errors[0] / errors[1]) - 2.0) <= 0.2
        assert orbits[1].constraint_residual.max() <= 1e-13


@pytest.mark.profile("routes", instead="test_a_spring_passes")
def test_work_of_friction_is_known() -> None:
    """A particle that friction stops: v = e^(-ct)."""
    body = nh.Forced(nh.LagrangeDAlembert(lambda _, v: v @ v / 2, None, dimension=1), force=nh.Friction([0.7]))
    times = np.linspace(0.0, 2.0, 4001)
    orbit = nh.flow(body, configuration=[0.0], body_velocity=[1.0], times=times)
    assert np.abs(orbit.work - (np.exp(-1.4 * times) - 1) / 2).max() < 1e-7  # trapezoidal: 1.4^2 h^2 / 12
    np.testing.assert_allclose(orbit.dissipation, -orbit.work, rtol=1e-15)


@pytest.mark.parametrize("table", [None, np.full((9, 1), 0.4)], ids=["function", "table"])
def test_dissipation_less_work_is_that_of_motors(table: Any) -> None:
    """A constant force of 0.4 beside friction does the work 0.4 q, known by the trapezoidal rule up to order 2."""
    motor = (lambda _time, _q, v: 0.4 + 0 * v) if table is None else table
    body = nh.Forced(nh.LagrangeDAlembert(lambda _, v: v @ v / 2, None, dimension=1), force=(nh.Friction([0.7]), motor))
    orbit = nh.simulate(nh.discretize(body, 0.1), configuration=[0.0], body_velocity=[1.0], steps=9)
    assert np.diff(orbit.dissipation).min() > 0
    np.testing.assert_allclose(orbit.work + orbit.dissipation, 0.4 * orbit.configuration[:, 0], rtol=1e-2)


def test_a_solver_reaches_the_end_of_the_flow() -> None:
    """SciPy, given the vector field, ends where `flow` ends."""
    ready = nh.examples.snakeboard()
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
    result = nh.vector_field(system)(time, np.concatenate([q, v]))
    # x'' = -(1 + t) x, and the derivative of x y' - y x' = (x^2 + y^2) / 2 is x y'' = x x'
    np.testing.assert_allclose(result, [0.7, 1.0, -(1 + time) * q[0], 0.7], rtol=0, atol=1e-14)


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


FREE, AT = nh.LagrangeDAlembert(lambda _, v: v @ v / 2, None, dimension=2), np.zeros(2)
TABLE, START = FREE.forced(None, np.ones((9, 2))), {"configuration": AT, "body_velocity": AT}
THINNED = START | {"steps": 8, "save_every": 2}
# A table belongs to steps: it has no vector field and no flow, and its work needs all; nor has a state of another size.
test_what_has_no_vector_field_is_refused = refusals(
    (lambda: nh.vector_field(TABLE), r"`vector_field\(system=\.\.\.\)` must have forces"),
    (lambda: nh.flow(TABLE, **START, times=(0, 1)), r"flow\(system=...\)` must have forces at times. Got one force"),
    (lambda: nh.simulate(nh.discretize(TABLE, 0.1), **THINNED).work, "work` must contain every step. Got .* Run with"),
    (lambda: nh.vector_field(FREE)(0.0, np.zeros(3)), r"must end in shape \(4"),
)
