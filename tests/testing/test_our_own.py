"""Every kind of group, system and discretization of the library passes the checks that users run on their own."""

import numpy as np
import pytest
from bodies import GENERAL
from groups.examples import GROUPS, HEISENBERG, RIGID, SL2, SL3, WHEELED
from problems import PROBLEMS

import nonholo as nh
from nonholo.groups import AbstractMatrixGroup
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
OTHERS = {
    "Heisenberg": nh.LLSystem(HEISENBERG, inertia_operator=INERTIA, annihilator=[[0, 0, 1]]),
    "SL(2)": ON_SL2,
    "robot": ROBOT,
}


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
    assert report["energy"].status == (
        "not checked" if name == "all forbidden" else "ok" if discrete.conserves_energy else "reported"
    )


def test_a_compiled_step_against_the_definition() -> None:
    """With `definition` the report also compares with the steps of JAX."""
    report = check_discretization(nh.discretize(COMPILED["offset sleigh"], 0.2))
    assert report["definition"].status == "ok"


@pytest.mark.profile("routes", keep=["robot"])
@pytest.mark.parametrize(
    ("system", "least", "most"), [(ON_SL2, 1e-3, 1e-1), (ROBOT, 1e-7, 1e-1)], ids=["SL(2)", "robot"]
)
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


@pytest.mark.parametrize(
    ("check", "thing"),
    [(check_group, np.eye(3)), (check_system, nh.SE(2)), (check_discretization, ON_SL2)],
)
def test_other_things_are_refused(check: object, thing: object) -> None:
    """Each check says what it takes."""
    with pytest.raises(ValueError, match=rf"`{check.__name__}\(.*must be .*Got .*Pass "):
        check(thing)


SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)
START = (1.0, 0.5, 0.0)


@pytest.mark.profile("routes", cases=["4"])
@pytest.mark.parametrize("order", [2, 4])
def test_the_order_is_found(order: int) -> None:
    """Slopes of momenta and poses are those of the composition, and the errors are drawn."""
    found = check_order(nh.discretize(SLEIGH, 0.2, order=order), START)
    assert np.allclose([found.order.momentum, found.order.pose], order, atol=0.1)
    assert found.plot().axes


def test_another_order_is_refused() -> None:
    """Slopes that are farther off than allowed are an error, which names them; without `throw` they are returned."""
    discrete = nh.discretize(SLEIGH, 0.2)
    with pytest.raises(AssertionError, match=r"must find order 2 \+- 1e-06. Got <Convergence"):
        check_order(discrete, START, tolerance=1e-6)
    assert abs(check_order(discrete, START, tolerance=1e-6, throw=False).order.momentum - 2) > 1e-6


def test_a_system_is_no_discretization() -> None:
    """What is refused is named with the remedy."""
    with pytest.raises(ValueError, match=r"check_order\(discrete=...\).*Pass `discretize"):
        check_order(SLEIGH, START)
