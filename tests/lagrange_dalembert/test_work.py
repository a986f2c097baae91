"""Work on systems in coordinates: forces, driven joints, moving constraints; the balance closes at order two."""

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest

import nonholo as nh
from nonholo.lagrange_dalembert import LagrangeDAlembert

SPAN = 1.6


def _blade(q: Any) -> Any:
    return jnp.array([[-jnp.sin(q[2]), jnp.cos(q[2]), 0.0]])


def _push(time: Any, q: Any, v: Any) -> Any:
    return jnp.stack([jnp.cos(time), 0.4 * q[0], 0.3]) - 0.2 * v * jnp.abs(v)


def _kinetic(_q: Any, v: Any) -> Any:
    return (v[0] ** 2 + v[1] ** 2 + 0.3 * v[2] ** 2) / 2


def _skate(lagrangian: Callable[..., Any] = _kinetic, **more: Any) -> LagrangeDAlembert:
    return LagrangeDAlembert(lagrangian, _blade, dimension=3, **more)


def _table(h: float) -> np.ndarray:
    t = (np.arange(round(SPAN / h)) + 0.5) * h
    return np.stack([np.cos(t), np.sin(3 * t), 0.3 + 0 * t], axis=1)


CASES: dict[str, Callable[[float], LagrangeDAlembert]] = {
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
    found = nh.invariants(orbits[1])
    assert found.work == orbits[1].work[-1]
    assert found.energy_drift == left[1] / np.abs(orbits[1].energy).max()
    if name not in ("table", "all three"):
        exact = nh.flow(CASES[name](0.02), **_start(name), times=(0.0, SPAN), rtol=1e-13, atol=1e-14)
        errors = [np.abs(orbit.configuration[-1] - exact.configuration[-1]).max() for orbit in orbits]
        assert abs(np.log2(errors[0] / errors[1]) - 2.0) <= 0.2
        assert orbits[1].constraint_residual.max() <= 1e-13


@pytest.mark.profile("routes", instead="test_a_spring_passes")
def test_work_of_friction_is_known() -> None:
    """A particle that friction stops: v = e^(-ct); and the flow of a table is refused."""
    body = nh.Forced(LagrangeDAlembert(lambda _, v: v @ v / 2, None, dimension=1), force=nh.Friction([0.7]))
    times = np.linspace(0.0, 2.0, 4001)
    orbit = nh.flow(body, configuration=[0.0], body_velocity=[1.0], times=times)
    assert np.abs(orbit.work - (np.exp(-1.4 * times) - 1) / 2).max() < 1e-7  # trapezoidal: 1.4^2 h^2 / 12
    np.testing.assert_allclose(orbit.dissipation, -orbit.work, rtol=1e-15)


@pytest.mark.parametrize("table", [None, np.full((9, 1), 0.4)], ids=["function", "table"])
def test_dissipation_less_work_is_that_of_motors(table: Any) -> None:
    """A constant force of 0.4 beside friction does the work 0.4 q, known by the trapezoidal rule up to order 2."""
    motor = (lambda _time, _q, v: 0.4 + 0 * v) if table is None else table
    body = nh.Forced(LagrangeDAlembert(lambda _, v: v @ v / 2, None, dimension=1), force=(nh.Friction([0.7]), motor))
    orbit = nh.simulate(nh.discretize(body, 0.1), configuration=[0.0], body_velocity=[1.0], steps=9)
    assert np.diff(orbit.dissipation).min() > 0
    np.testing.assert_allclose(orbit.work + orbit.dissipation, 0.4 * orbit.configuration[:, 0], rtol=1e-2)


def test_a_table_belongs_to_steps() -> None:
    """It has no flow; its work needs every step."""
    body = nh.Forced(LagrangeDAlembert(lambda _, v: v @ v / 2, None, dimension=1), force=np.ones((9, 1)))
    with pytest.raises(ValueError, match=r"flow\(system=...\)` must have forces at times. Got one force for each step"):
        nh.flow(body, configuration=[0.0], body_velocity=[1.0], times=(0.0, 1.0))
    empty = np.zeros((3, 1))
    numbers = (empty, None, empty, empty, empty[:, :0], np.zeros(3), np.zeros(3))
    thinned = nh.lagrange_dalembert.CoordinateOrbit(np.array([0.0, 0.2, 0.4]), *numbers, system=body, time_step=0.1)
    with pytest.raises(ValueError, match=r"Orbit.work` must contain every step. Got steps .* Run with"):
        _ = thinned.work
