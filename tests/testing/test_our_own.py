"""Every kind of group, system and discretization of the library passes the checks that users run on their own."""

from collections.abc import Iterator
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from bodies import GENERAL
from formulas import forget
from groups.examples import GROUPS, HEISENBERG, RIGID, SL2, SL3, WHEELED
from problems import PROBLEMS
from refusals import refusals

import nonholo as nh
from nonholo.groups import AbstractMatrixGroup
from nonholo.lagrange_dalembert import _equations, _flow, _places
from nonholo.lagrange_dalembert.compiled import _machine
from nonholo.systems import AbstractSystem
from nonholo.testing import check_discretization, check_group, check_order, check_system

UNCHECKED = {  # groups in which nothing turns, and one whose Cayley map leaves it
    HEISENBERG: {"log of large turns"},
    nh.Translations(3): {"log of large turns"},
    SL3: {"Cayley", "Cayley stays"},
}
INERTIA = np.array([[2.0, 0.3, 0.5], [0.3, 1.0, 0.2], [0.5, 0.2, 1.5]])
ON_SL2 = nh.LLSystem(SL2, inertia_operator=INERTIA, constraint_subspace=[[1, 0, 0], [0, 1, 1]])
ROBOT = nh.LLSystem(  # two wheels that roll without slipping turn a body in the plane
    WHEELED,
    inertia_operator=np.diag([1.0, 2.0, 2.0, 0.3, 0.3]) + 0.05,
    annihilator=[[0, 0, 1, 0, 0], [0.5, 1, 0, -0.3, 0], [-0.5, 1, 0, 0, -0.3]],
)
COMPILED = {
    **{problem.name: problem.system for problem in PROBLEMS},
    **{name: system for name, (system, _) in GENERAL.items()},
    "free top": nh.RigidBody(np.diag([1.0, 2.0, 3.0])),
    "any d on SO(3)": nh.LLSystem(nh.SO(3), np.diag([1.0, 2.0, 3.0]), [[1.0, 0.5, 0.0], [0.0, 0.4, 1.0]]),
    "all forbidden": nh.LLSystem(nh.SO(3), np.eye(3), []),
    "turned over": nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 2.5]) + 0.1, axis=(0, 0, -1)),
}
ON_HEISENBERG = nh.LLSystem(HEISENBERG, inertia_operator=INERTIA, annihilator=[[0, 0, 1]])
OTHERS = {"Heisenberg": ON_HEISENBERG, "SL(2)": ON_SL2, "robot": ROBOT}


@pytest.mark.parametrize("group", GROUPS, ids=str)
def test_groups(group: AbstractMatrixGroup) -> None:
    """Closed forms, groups from a basis and products pass; what is left out has a reason."""
    report = check_group(group, compiled=group == nh.SE(2))  # JAX takes seconds; tests/groups compares all
    assert report.passed
    unchecked = {result.name: result.note for result in report.results if result.status == "not checked"}
    assert unchecked.keys() == UNCHECKED.get(group, set())
    assert all(unchecked.values())
    tight = check_group(group, compiled=False, tolerance_factor=0.01, throw=False)
    assert {each.name for each in tight.failed} <= {"retract", "log of small motions"}  # a bound, and nine digits
    assert group.is_rigid == (group in RIGID)
    assert group.log(group.exp(np.empty((0, 4, group.dim)))).shape == (0, 4, group.dim)


@pytest.mark.parametrize("seed", [1, np.random.default_rng(2)], ids=["seed", "generator"])
@pytest.mark.parametrize("name", [*COMPILED, *OTHERS])
def test_systems(name: str, seed: object) -> None:
    """Every system passes, from other random states too; ours to a hundredth of what is allowed to others."""
    system = (COMPILED | OTHERS)[name]
    assert check_system(system, rng=seed).passed
    tight = check_system(system, tolerance_factor=0.01, rng=1, throw=False)
    assert {each.name for each in tight.failed} <= {"reconstruction"}


@pytest.mark.profile("routes", keep=["0.1-*"])
@pytest.mark.parametrize("name", COMPILED)
@pytest.mark.parametrize("time_step", [0.1, 1e-3])
def test_compiled_steps(name: str, time_step: float) -> None:
    """Every compiled step passes, and energy is judged wherever the constraint is fixed in the body."""
    discrete = nh.discretize(COMPILED[name], time_step)
    report = check_discretization(discrete, definition=False, tolerance_factor=0.1, throw=False)
    assert {each.name for each in report.failed} <= {"order of the start"}
    assert report["order of the start"].value is None or report["order of the start"].value < 0.3
    judged = "ok" if discrete.conserves_energy else "reported"
    assert report["energy"].status == ("not checked" if name == "all forbidden" else judged)


def test_a_compiled_step_against_the_definition() -> None:
    """With `definition` the report also compares with the steps of JAX."""
    report = check_discretization(nh.discretize(COMPILED["offset sleigh"], 0.2))
    assert report["definition"].status == "ok"


@pytest.mark.profile("routes", keep=["robot"])
@pytest.mark.parametrize(("system", "least", "most"), [(ON_SL2, 1e-3, 0.1), (ROBOT, 1e-7, 0.1)], ids=["SL(2)", "robot"])
def test_steps_on_other_groups(system: AbstractSystem, least: float, most: float) -> None:
    """The defaults on a user's group follow their equations; energy is not exact, and the report says by how much."""
    report = check_discretization(nh.discretize(system, 0.1))
    assert report["compiled reversal"].status == report["definition"].status == "not checked"
    assert report["energy"].status == "reported"
    assert least < report["energy"].value < most


@pytest.mark.profile("routes", instead="test_a_compiled_step_against_the_definition")
def test_callables_in_place_of_names() -> None:
    """The matrix difference and the skew constraint given as functions pass, and keep energy unclaimed."""
    sleigh, h = nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.2
    J = sleigh.homogeneous_mass_tensor

    def lagrangian(W: np.ndarray) -> np.ndarray:
        X = W - np.eye(3)
        return (X @ J @ X.T).trace() / (2 * h)

    def forbidden(W: np.ndarray) -> np.ndarray:
        return (W[1, 2] - sleigh.group.inverse(W)[1, 2]) / 2

    report = check_discretization(nh.discretize(sleigh, h, difference=lagrangian, constraint=forbidden))
    assert report["energy"].status == report["reversal"].status == "reported"
    assert report["energy"].value < 1e-12
    assert report["self-adjoint"].value < 1e-12


SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)
START, HERE = (1.0, 0.5, 0.0), np.eye(3)


@pytest.mark.profile("routes", cases=["4"])
@pytest.mark.parametrize("order", [2, 4])
def test_the_order_is_found(order: int) -> None:
    """Slopes of momenta and poses are those of the composition, and the errors are drawn."""
    result = check_order(nh.discretize(SLEIGH, 0.2, order=order), START)
    assert np.allclose([result.order.momentum, result.order.pose], order, atol=0.1)
    assert result.plot().axes


def test_another_order_is_refused() -> None:
    """Slopes that are farther off than allowed are an error, which names them; without `throw` they are returned."""
    discrete = nh.discretize(SLEIGH, 0.2)
    with pytest.raises(AssertionError, match=r"must find order 2 \+- 1e-06. Got <Convergence"):
        check_order(discrete, START, tolerance=1e-6)
    assert abs(check_order(discrete, START, tolerance=1e-6, throw=False).order.momentum - 2) > 1e-6


# Each check says what it takes; bodies on a group begin anywhere.
test_other_things_are_refused = refusals(
    (lambda: check_group(np.eye(3)), r"check_group\(.*must be .*Got .*Pass "),
    (lambda: check_system(nh.SE(2)), r"check_system\(.*must be .*Got .*Pass "),
    (lambda: check_discretization(ON_SL2), r"check_discretization\(.*must be .*Got .*Pass "),
    (lambda: check_order(SLEIGH, START), r"check_order\(discrete=...\).*Pass `discretize"),
    (
        lambda: check_system(SLEIGH, configuration=HERE),
        r"check_system\(configuration=...\)` must be left out on a group",
    ),
    (
        lambda: check_discretization(nh.discretize(SLEIGH, 0.1), configuration=HERE),
        r"check_discretization\(configuration=...\)` must be left out",
    ),
    begin="`",
)


READY = ["particle", "two_wheeled_robot", "roller_racer", "driven_sleigh", "rolling_disk", "knife_edge_on_incline"]
ROUTES = pytest.mark.profile("routes", instead="test_a_spring_passes")
STRAIGHT = np.zeros(5)  # a snakeboard whose wheels are not turned


def _ball(q: Any, v: Any) -> Any:
    return v @ v / 2 - q[0] ** 2 / 2


def _late(time: Any, _q: Any, v: Any) -> Any:
    return jnp.cos(time) - 0.2 * v


def _pushed(time: Any, q: Any, v: Any) -> Any:
    return jnp.stack([jnp.sin(time) - 0.1 * v[0], 0.3 * q[0]])


@ROUTES
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


@ROUTES
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


ACTION = nh.mass_tensor_lagrangian(nh.SE(2), nh.ChaplyginSleigh(1.3, 0.5, a=0.3).homogeneous_mass_tensor)


def _turning(g: Any) -> Any:
    return jnp.array([[0.0, -jnp.sin(g[0, 2]), jnp.cos(g[0, 2])]])


def _hill(g: Any) -> Any:
    return jnp.cos(g[0, 2]) + g[1, 2] ** 2


def _crooked(g: Any, W: Any, h: Any) -> Any:
    return _turning(g) @ jnp.array([W[1, 0], W[0, 2], W[1, 2]]) / h


@ROUTES
@pytest.mark.parametrize("potential", [None, _hill])
def test_systems_on_groups_by_functions_pass(potential: Any) -> None:
    """A blade that turns in the body with the place: the equations and the principle in the body, with a potential."""
    sleigh = nh.Forced(nh.GroupLagrangeDAlembert(nh.SE(2), ACTION, _turning), potential)
    assert check_system(sleigh, rng=2).passed
    report = check_discretization(nh.discretize(sleigh, 0.05))
    assert report.passed
    names = ("discrete principle", "reversal", "order of momenta", "order of configurations")
    assert {report[name].status for name in names} == {"ok"}


@pytest.fixture(name="changed_equations")
def _changed_equations(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """What is compiled from wrong equations is remembered neither on disk nor in the process."""
    monkeypatch.setattr(_machine, "_file", lambda *_: None)
    forget()
    yield
    forget()


@ROUTES
@pytest.mark.usefixtures("changed_equations")
def test_errors_on_groups(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the term ad* the equations fail; a crooked rule for the constraint is of order one."""
    crooked = nh.GroupLagrangeDAlembert(nh.SE(2), ACTION, _turning, _crooked)
    report = check_discretization(nh.discretize(crooked, 0.05), throw=False)
    assert {"order of momenta", "order of configurations"} <= {result.name for result in report.failed}
    monkeypatch.setattr(_places.Poses, "force", lambda *arguments: 0.0 * arguments[1])
    body = nh.GroupLagrangeDAlembert(nh.SO(3), nh.mass_tensor_lagrangian(nh.SO(3), np.diag([3.0, 1.0, 2.0])), None)
    assert "equations of motion" in {result.name for result in check_system(body, throw=False).failed}


@ROUTES
@pytest.mark.usefixtures("changed_equations")
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
    monkeypatch.setattr(home, name, lambda *arguments: 1.1 * original(*arguments))
    body = nh.Forced(nh.LagrangeDAlembert(_ball, None, dimension=2), force=_pushed)
    report = check_system(body, throw=False)
    assert {result.name for result in report.failed} == expected
