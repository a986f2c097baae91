"""The checks of systems in coordinates: ready ones pass, errors in the equations are named."""

from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest

import nonholo as nh
from nonholo.lagrange_dalembert import _equations, _flow, _places
from nonholo.testing import check_discretization, check_system

READY = ["particle", "two_wheeled_robot", "roller_racer", "driven_sleigh", "rolling_disk", "knife_edge_on_incline"]
HERE = pytest.mark.profile("routes", instead="test_a_spring_passes")
STRAIGHT = np.zeros(5)  # a snakeboard whose wheels are not turned


def _ball(q: Any, v: Any) -> Any:
    return v @ v / 2 - q[0] ** 2 / 2


def _late(time: Any, _q: Any, v: Any) -> Any:
    return jnp.cos(time) - 0.2 * v


def _pushed(time: Any, q: Any, v: Any) -> Any:
    return jnp.stack([jnp.sin(time) - 0.1 * v[0], 0.3 * q[0]])


@HERE
@pytest.mark.parametrize("name", [*READY, "snakeboard"])
def test_ready_systems_pass(name: str) -> None:
    """From a random place, or one that is given; what is driven closes its balance."""
    system, place = getattr(nh.examples, name)().system, STRAIGHT if name == "snakeboard" else None
    assert check_system(system, configuration=place).passed
    report = check_discretization(nh.discretize(system, 0.05), configuration=place)
    assert report.passed
    assert report["order of the balance"].status == "ok"
    assert (report["reversal"].status == "ok") == (not system.is_driven)
    assert (report["prescribed"].status == "ok") == bool(system.prescribed)


@HERE
def test_torques_friction_and_tables_pass() -> None:
    """A differential drive with motors; with one force for each step the flow is not compared."""
    robot = nh.examples.two_wheeled_robot(torques=lambda t: (jnp.sin(t), 0.3), friction=0.1).system
    assert check_system(robot).passed
    assert check_discretization(nh.discretize(robot, 0.05)).passed
    table = nh.Forced(nh.examples.two_wheeled_robot().system, force=np.ones((40, 5)))
    report = check_discretization(nh.discretize(table, 0.05))
    assert report["order of the balance"].status == "ok"
    assert report["order of momenta"].status == "not checked"
    assert {result.status for result in check_system(table).results} == {"not checked"}


def test_a_spring_passes() -> None:
    """Momentum, energy and equations of motion are those of the Lagrangian and the force, whose work balances."""
    spring = nh.LagrangeDAlembert(lambda q, v: (v @ v - q @ q) / 2, None, dimension=1, force=_late)
    report = check_system(spring)
    assert {result.status for result in report.results} == {"ok"}


@HERE
def test_a_body_that_is_pushed_passes() -> None:
    """The map of a spring with a force of time, place and velocity."""
    body = nh.Forced(nh.LagrangeDAlembert(_ball, None, dimension=2), force=_pushed)
    report = check_discretization(nh.discretize(body, 0.05), steps=4)
    assert report["discrete principle"].status == report["order of the balance"].status == "ok"


def _turning(g: Any) -> Any:
    return jnp.array([[0.0, -jnp.sin(g[0, 2]), jnp.cos(g[0, 2])]])


def _hill(g: Any) -> Any:
    return jnp.cos(g[0, 2]) + g[1, 2] ** 2


def _crooked(g: Any, W: Any, h: Any) -> Any:
    return _turning(g) @ jnp.array([W[1, 0], W[0, 2], W[1, 2]]) / h


@HERE
@pytest.mark.parametrize("potential", [None, _hill])
def test_systems_on_groups_by_functions_pass(potential: Any) -> None:
    """A blade that turns in the body with the place: the equations and the principle in the body, with a potential."""
    action = nh.mass_tensor_lagrangian(nh.SE(2), nh.ChaplyginSleigh(1.3, 0.5, a=0.3).homogeneous_mass_tensor)
    sleigh = nh.Forced(nh.GroupLagrangeDAlembert(nh.SE(2), action, _turning), potential)
    assert check_system(sleigh, rng=2).passed
    report = check_discretization(nh.discretize(sleigh, 0.05))
    assert report.passed
    names = ("discrete principle", "reversal", "order of momenta", "order of configurations")
    assert {report[name].status for name in names} == {"ok"}


@HERE
def test_errors_on_groups(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the term ad* the equations fail; a crooked rule for the constraint is of order one."""
    action = nh.mass_tensor_lagrangian(nh.SE(2), nh.ChaplyginSleigh(1.3, 0.5, a=0.3).homogeneous_mass_tensor)
    crooked = nh.GroupLagrangeDAlembert(nh.SE(2), action, _turning, _crooked)
    report = check_discretization(nh.discretize(crooked, 0.05), throw=False)
    assert {"order of momenta", "order of configurations"} <= {result.name for result in report.failed}
    monkeypatch.setattr(_places.Poses, "force", lambda *given: 0.0 * given[1])
    body = nh.GroupLagrangeDAlembert(nh.SO(3), nh.mass_tensor_lagrangian(nh.SO(3), np.diag([3.0, 1.0, 2.0])), None)
    assert "equations of motion" in {result.name for result in check_system(body, throw=False).failed}


@HERE
@pytest.mark.parametrize(
    ("home", "name", "expected"),
    [
        (_equations, "force", {"equations of motion", "balance"}),
        (_equations, "energy", {"energy", "balance"}),
        (_flow, "_power", {"balance"}),
    ],
)
def test_errors_in_equations(monkeypatch: pytest.MonkeyPatch, home: Any, name: str, expected: set[str]) -> None:
    """Forces, an energy and a power that are a tenth too large fail the checks of their own."""
    original = getattr(home, name)
    monkeypatch.setattr(home, name, lambda *given: 1.1 * original(*given))
    body = nh.Forced(nh.LagrangeDAlembert(lambda q, v: _ball(q, v), None, dimension=2), force=_pushed)
    report = check_system(body, throw=False)
    assert {result.name for result in report.failed} == expected


def test_a_place_is_for_coordinates() -> None:
    """Bodies on a group begin anywhere, and say so."""
    sleigh = nh.ChaplyginSleigh(1.0, 1.0, 0.5)
    with pytest.raises(ValueError, match=r"check_system\(configuration=...\)` must be left out on a group"):
        check_system(sleigh, configuration=np.eye(3))
    with pytest.raises(ValueError, match=r"check_discretization\(configuration=...\)` must be left out"):
        check_discretization(nh.discretize(sleigh, 0.1), configuration=np.eye(3))
