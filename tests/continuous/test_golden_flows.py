"""Flows against Taylor series in 60 digits (tests/golden) and diffrax; times, directions, starts, refusals."""

from typing import Any

import jax
import numpy as np
import pytest
from comparisons import assert_same
from problems import EVERY as SYSTEMS
from references import golden, golden_system, numbers
from refusals import refusals

import nonholo as nh
from nonholo.systems import AbstractLLSystem, AbstractSystem

CASES = golden("flows.json")
SLEIGHS = [case for case in CASES if case["system"] == "sleigh"]
SHARP = {"rtol": 1e-13, "atol": 1e-15}


def _name(case: dict) -> str:
    return f"{case['system']} {case['name']}"


def _flow(case: dict, **options: object) -> nh.Orbit:
    start = {"body_velocity": case["body_velocity"], "configuration": case["configuration"], "times": case["times"]}
    return nh.flow(golden_system(case), **start, **options)


def _miss(result: np.ndarray, reference: list) -> float:
    return float(np.abs(result - numbers(reference)).max())


@pytest.mark.parametrize("case", CASES, ids=_name)
def test_closed_form(case: dict) -> None:
    """Velocities, momenta and multipliers are right to 1e-13, poses and headings of sleighs to 5e-14.

    The worst case starts near a repelling axis, where rounding the momentum is felt 20 times; the others reach 1e-15.
    Poses of tops are integrated, to 100 times the error allowed per step.
    """
    orbit = _flow(case, method="closed_form", **SHARP)
    assert _miss(orbit.body_velocity, case["body_velocities"]) <= 1e-13
    assert _miss(orbit.momentum, case["momentum"]) <= 1e-13
    assert _miss(orbit.multipliers, case["multipliers"]) <= 1e-13
    assert _miss(orbit.configuration, case["configurations"]) <= (5e-14 if case in SLEIGHS else 1e-11)
    if case in SLEIGHS:
        assert _miss(orbit.position, case["position"]) <= 5e-14
        assert _miss(orbit.heading, case["heading"]) <= 5e-14


@pytest.mark.parametrize("case", CASES, ids=_name)
def test_numerical_flow(case: dict) -> None:
    """Right to 1e-11 after some 100 steps of 1e-13 each, full turns counted; by default to 1e-14 early on."""
    orbit = _flow(case, **SHARP)
    assert _miss(orbit.configuration, case["configurations"]) <= 1e-11
    assert _miss(orbit.body_velocity, case["body_velocities"]) <= 1e-11
    assert _miss(orbit.multipliers, case["multipliers"]) <= 1e-11
    usual = _flow(case)
    assert _miss(usual.configuration, case["configurations"]) <= 1e-8
    assert _miss(usual.configuration[:3], case["configurations"][:3]) <= 1e-14
    assert _miss(usual.body_velocity[:3], case["body_velocities"][:3]) <= 1e-14
    if case in SLEIGHS:
        assert _miss(orbit.heading, case["heading"]) <= 1e-11
        assert np.abs(np.cos(orbit.heading) - orbit.configuration[:, 0, 0]).max() <= 1e-14


HYPERBOLIC = nh.MatrixGroup([[[0.0, 1.0], [1.0, 0.0]]], form=[[1.0, 0.0], [0.0, -1.0]])


def _start(system: AbstractSystem) -> dict:
    rng = np.random.default_rng(3)
    return {"restricted_velocity": rng.normal(size=system.rank), "configuration": system.group.random(rng)}


@pytest.mark.profile("routes", keep=["rod"])
@pytest.mark.parametrize("name", SYSTEMS)
def test_diffrax_arrives_at_the_same_states(name: str) -> None:
    """Both integrators follow the same motion to 1e-8, a hundred of the errors of their steps, there and back."""
    system, start = SYSTEMS[name], _start(SYSTEMS[name])
    for times in (np.linspace(0.0, 6.0, 8), np.linspace(1.0, -2.0, 4)):
        compiled, other = (nh.flow(system, **start, times=times, method=method) for method in (None, "diffrax"))
        for value in ("momentum", "configuration", "body_velocity", "multipliers"):
            result, expected = getattr(compiled, value), getattr(other, value)
            assert np.abs(result - expected).max(initial=0.0) <= 1e-8 * max(1.0, np.abs(expected).max(initial=0.0))
        if system.group == nh.SE(2):
            assert np.abs(compiled.heading - other.heading).max() <= 1e-8 * max(1.0, np.abs(other.heading).max())


@pytest.mark.profile("routes", keep=["None"])
@pytest.mark.parametrize("method", [None, "diffrax"])
def test_a_motion_that_overflows_keeps_its_good_states(method: str | None) -> None:
    """A pose on SO(1, 1) grows like e^t: beyond the largest number the solve ends, and earlier states are good."""
    boost = nh.LLSystem(HYPERBOLIC, constraint_subspace=[[1.0]], inertia_operator=[[1.0]])
    with pytest.raises(nh.OutcomeError, match="from time 700 to 800") as caught:
        nh.flow(boost, body_velocity=[1.0], times=(0.0, 300.0, 700.0, 800.0, 900.0), method=method)
    orbit = caught.value.orbit
    assert orbit.outcome == nh.Outcome.not_converged
    assert orbit.time.tolist() == [0.0, 300.0, 700.0]
    assert np.abs(np.log(2 * orbit.configuration[1:, 0, 0]) - orbit.time[1:]).max() <= 1e-6


SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3)
TOP = nh.SuslovTop.from_inertia([[3.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 2.5]], (2 / 3, -1 / 3, 2 / 3))
BOTH = pytest.mark.parametrize("system", [SLEIGH, TOP], ids=["sleigh", "top"])
METHODS = pytest.mark.parametrize("method", [None, "closed_form"])
START = {"restricted_velocity": (0.8, -0.5)}


@BOTH
@METHODS
def test_only_elapsed_time_matters(system: AbstractLLSystem, method: str | None) -> None:
    """The start is at the first time, also at one alone: a shift of all times, by a power of two, changes no bit."""
    first, second = (nh.flow(system, **START, times=t + np.array([0.0, 1.0, 2.5]), method=method) for t in (0.0, 64.0))
    assert_same(first, second, "configuration", "momentum")
    assert_same(
        nh.flow(system, **START, times=[2.0], method=method), first[:1], "configuration", "momentum", "multipliers"
    )


@BOTH
def test_equal_starts_are_equal(system: AbstractLLSystem) -> None:
    """A velocity, its restriction, its momentum and the restricted momentum start the same motion."""
    orbit = nh.flow(system, **START, times=(0.0, 2.0))
    for name in ("body_velocity", "momentum", "restricted_momentum"):
        same = nh.flow(system, **{name.replace("restricted_", ""): getattr(orbit, name)[0]}, times=(0.0, 2.0))
        assert np.abs(same.configuration[-1] - orbit.configuration[-1]).max() <= 1e-10


def test_precision_is_local() -> None:
    """The flow works in 64 bits and leaves JAX's global precision alone."""
    before = jax.config.read("jax_enable_x64")
    assert nh.flow(SLEIGH, **START, times=(0.0, 1.0)).configuration.dtype == np.float64
    assert jax.config.read("jax_enable_x64") == before
    assert jax.numpy.zeros(1).dtype == (np.float64 if before else np.float32)


# A bad argument is refused by name, with the requirement and what was got.
test_refusals = refusals(
    ({"times": []}, r"`flow\(times=...\)` must hold at least one time"),
    ({"times": 1.0}, r"`flow\(times=...\)` must have shape \(any,\)"),
    ({"times": (0.0, 1.0, 1.0)}, r"strictly increasing or strictly decreasing. Got 1.0 after 1.0"),
    ({"times": (0.0, 2.0, 1.0)}, r"Got 1.0 after 2.0. Sort the times"),
    ({"restricted_velocity": None, "momentum": (1, 0, 9.0)}, r"`flow\(momentum=...\)` must belong to an admissible"),
    ({"times": (0.0, np.inf)}, r"`flow\(times=...\)` must be finite"),
    ({"rtol": 1e-15}, r"`flow\(rtol=...\)` must be at least 1e-14. Got 1e-15"),
    ({"atol": 0.0}, r"`flow\(atol=...\)` must be positive"),
    ({"method": "euler"}, r"`flow\(method=...\)` must be one of None, 'closed_form', 'diffrax'. Got 'euler'"),
    ({"momentum": (1.0, 0.0)}, r"`flow\(...\)` must be given exactly one of .* Got restricted_velocity and momentum"),
    ({"restricted_velocity": None}, r"must be given exactly one of .* Got none"),
    ({"restricted_velocity": (1.0,)}, r"`flow\(restricted_velocity=...\)` must have shape \(2,\)"),
    ({"restricted_velocity": None, "body_velocity": (1, 0, 1)}, r"`flow\(body_velocity=...\)` must satisfy"),
    ({"configuration": 2 * np.eye(3)}, r"`flow\(configuration=...\)` must lie in SE\(2\)"),
    ask=lambda options: nh.flow(SLEIGH, **({"times": (0.0, 1.0)} | START | options)),
)


_NO_CLOSED_FORM = {"restricted_velocity": np.ones(3), "times": (0.0, 1.0), "method": "closed_form"}
_TIMES: dict[str, Any] = {"times": (0.0, 1.0), **START}
# What is not a system is refused by both entry points; a system without a closed form with the advice to integrate.
test_what_has_no_such_flow_is_refused = refusals(
    (lambda: nh.flow(SLEIGH.group, **_TIMES), r"`flow\(system=...\)` must be a system"),
    (lambda: nh.vector_field("sleigh"), r"`vector_field\(system=...\)` must be a system"),
    (lambda: nh.discretize(nh.examples.sleigh_in_a_well(), 0.1), "of a ready example its `.system`"),  # type: ignore[arg-type]
    (lambda: nh.flow(nh.examples.sleigh_in_a_well(), **_TIMES), "of a ready example its `.system`"),  # type: ignore[arg-type]
    (
        lambda: nh.flow(nh.SuslovTop(np.diag([1.0, 2.0, 3.0, 4.0])), **_NO_CLOSED_FORM),
        "must have a closed-form solution. Got SuslovTop. Leave method out",
    ),
    (lambda: nh.flow(SLEIGH, **_TIMES).displacement, "continuous flow"),
    (lambda: jax.jit(nh.vector_field(nh.examples.sleigh_in_a_well().system))(0.0, np.ones(11)), "be a NumPy array"),
)
