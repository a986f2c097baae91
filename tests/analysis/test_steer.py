"""Controls to goals: poses and velocities met, least effort by hand, bounds, what cannot be reached."""

import functools
from typing import Any

import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.analysis.steering import Steering, _arguments, _shooting

SLEIGH = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.2), 0.1)
ASIDE = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]])
REST = {"restricted_velocity": (0.0, 0.0)}


@pytest.mark.profile("long", instead="test_bounds_hold")
def test_thousand_sleighs_are_parked() -> None:
    """From random poses and velocities to rest: at least 999 of 1000 meet pose and velocity to 1e-8, as rollouts do."""
    found = nh.steer(SLEIGH, _starts(1000), {"configuration": np.eye(3), **REST}, steps=40)
    assert found.failures <= 1
    ends = found.orbit
    gap, speed = ends.configuration[:, -1] - np.eye(3), ends.restricted_momentum[:, -1]
    assert ((np.abs(gap).max(axis=(1, 2)) < 1e-8) & (np.abs(speed).max(axis=1) < 1e-8)).sum() >= 999


@pytest.mark.profile("routes", instead="test_bounds_hold")
def test_many_are_parked_at_once() -> None:
    """Each of three members side by side meets its goal, in the compiled run of its controls too."""
    starts, found = _starts(3), _parked(3)
    assert found.failures == 0
    assert found.controls.shape == (3, 40, 3)
    np.testing.assert_allclose(found.orbit.configuration[:, -1], np.broadcast_to(ASIDE, (3, 3, 3)), rtol=0, atol=1e-8)
    np.testing.assert_allclose(found.orbit.restricted_momentum[:, -1], 0.0, rtol=0, atol=1e-8)
    np.testing.assert_allclose(found.cost, 0.05 * (found.controls**2).sum(axis=(1, 2)), rtol=1e-12)
    driven = nh.Forced(SLEIGH.system, force=found.controls[2])
    start = {name: rows[2] for name, rows in starts.items()}
    end = nh.simulate(nh.discretize(driven, 0.1), **start, steps=40).configuration[-1]
    np.testing.assert_allclose(end, ASIDE, rtol=0, atol=1e-8)


@functools.cache
def _parked(count: int = 1) -> Steering:
    return nh.steer(SLEIGH, _starts(count), {"configuration": ASIDE, **REST}, steps=40)


def _starts(count: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(0)
    poses = np.array([nh.SE(2).random(rng) for _ in range(count)])
    return {"configuration": poses, "restricted_velocity": rng.normal(scale=0.5, size=(count, 2))}


def test_a_way_of_least_effort_counts_more_than_a_smaller_miss(monkeypatch: pytest.MonkeyPatch) -> None:
    """A start that comes nearer to the goal, at no minimum of the cost, does not hide a later one at a minimum."""
    ends = iter([([[2.0]], [[1e-12]], [1.0]), ([[1.0]], [[1e-10]], [0.0])])
    monkeypatch.setattr(_shooting, "least_effort", lambda *_: tuple(map(np.array, next(ends))))
    forces, missed, is_least = _shooting.best(lambda f, _: (f + 1, f), np.ones((1, 1)), (-np.ones(1), np.ones(1)))
    assert (forces.item(), missed.item(), is_least.item()) == (1.0, 1e-10, True)


@pytest.mark.parametrize("low", [-1.0, 0.0, 0.5])
def test_a_goal_that_is_met_without_forces_costs_nothing(low: float) -> None:
    """No local minimum with forces is taken for the least, where bounds allow none."""
    gaps = lambda f, _: (f.sum(axis=1, keepdims=True), np.ones((len(f), 1, 2)))  # noqa: E731
    forces, missed, is_least = _shooting.best(gaps, np.ones((1, 2)), (np.full(2, low), np.ones(2)))
    assert is_least.item() == (missed.item() == 0) == (low <= 0)
    assert (forces == 0).all() == (low <= 0)


def test_members_begin_where_they_do_without_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """A member begins each attempt at the same forces whether another one is met at once or never."""

    def begins(other: float) -> list[float]:
        firsts = []

        def attempt(_: Any, f: np.ndarray, __: Any) -> tuple[np.ndarray, ...]:
            firsts.append(f[-1, 0])
            return f, np.array([[other], [1.0]])[-len(f) :], np.zeros(len(f))

        monkeypatch.setattr(_shooting, "least_effort", attempt)
        _shooting.best(lambda f, _: (f + 1, f), np.ones((2, 1)), (-np.ones(1), np.ones(1)))
        return firsts

    assert begins(0.0) == begins(1.0)


@pytest.mark.profile("problems", instead="test_bounds_hold")
@pytest.mark.parametrize("length", [2.0**-10, 2.0**10])
def test_goals_are_met_in_any_unit_of_length(length: float) -> None:
    """Where thrusts cost a million times what torques do, or the inverse, a sleigh still comes to its place at rest."""
    sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, length**2, 0.2 * length), 0.1)
    place = ASIDE * [[1, 1, length], [1, 1, length], [1, 1, 1]]
    found = nh.steer(sleigh, {}, {"configuration": place, **REST}, steps=40)
    assert found.outcome in ("converged", "not least")
    assert found.missed < 1e-8


def test_ends_name_velocities_as_other_runs_do() -> None:
    """Starts by body velocities, of two members, and momenta, and such goals, are those by restricted velocities."""
    system, w = SLEIGH.system, np.array([[0.1, 0.3], [0.0, 0.5]])
    momenta, velocities = w[1] @ system.constrained_inertia, w @ system.constraint_subspace
    for start, wanted in (({"body_velocity": velocities}, w), ({"momentum": momenta}, w[1:])):
        (first, _, _, last), _ = _arguments.checked_ends(system, start, {"body_velocity": velocities[0]}, is_free=False)
        np.testing.assert_allclose(first, wanted, rtol=1e-15, atol=1e-16)
        np.testing.assert_allclose(last, w[: len(wanted)] * 0 + w[0], rtol=1e-15, atol=1e-16)


@pytest.mark.profile("routes", instead="test_bounds_hold")
def test_least_effort_to_a_speed_is_a_constant_thrust() -> None:
    """A sleigh that is to slide at speed 1 after 4 units of time is pushed with 1/4 all the time, at cost 1/8."""
    found = nh.steer(SLEIGH, {}, {"restricted_velocity": (0.0, 1.0)}, steps=40)
    np.testing.assert_allclose(found.controls, np.tile([0.0, 0.25, 0.0], (40, 1)), rtol=0, atol=1e-6)
    np.testing.assert_allclose(found.cost, 0.125, rtol=1e-9)
    assert found.converged


def test_bounds_hold() -> None:
    """Forces stay within their bounds, and cost more than without them."""
    goal, size = {"configuration": ASIDE, **REST}, 0.8 * np.abs(_parked().controls).max()
    bounded = nh.steer(SLEIGH, _starts(1), goal, steps=40, bounds=(-size, size))
    assert bounded.failures == 0
    assert np.abs(bounded.controls).max() <= size + 1e-12
    assert bounded.cost.sum() > _parked().cost.sum() + 1e-6


@pytest.mark.profile("routes", instead="test_bad_arguments_are_refused")
def test_torque_alone_does_not_stop_a_sleigh() -> None:
    """With its mass ahead, v' = a omega^2: no torque brings it to rest, and the result says so."""
    start = {"restricted_velocity": (0.0, 0.3)}
    found = nh.steer(SLEIGH, start, REST, steps=6, bounds=((-5.0, 0.0), (5.0, 0.0)))
    assert not found.converged
    assert found.missed > 0.1  # in units of the body and the 0.6 of the motion


# What cannot be steered is named before any work.
test_bad_arguments_are_refused = refusals(
    ({"goal": {}}, "name a pose or a velocity"),
    ({"goal": {"pose": ASIDE}}, "name only"),
    ({"goal": {"configuration": 2 * ASIDE}}, "lie in SE"),
    ({"start": 5}, "name only"),
    ({"start": {"restricted_velocity": [[1.0, 2.0], [1.0]]}}, "be an array of real numbers"),
    ({"start": {"body_velocity": (0.0, 0.0, 1.0)}}, r"`steer.start\(body_velocity=...\)` must satisfy the constraint"),
    ({"start": {"body_velocity": (0.0, 1.0, 0.0), "momentum": (0.0, 1.0)}}, "exactly one of body_velocity, momentum"),
    ({"goal": {"restricted_velocity": (0.0, 1.0, 0.0)}}, "one number per admissible direction"),
    ({"start": _starts(2), "goal": {"restricted_velocity": np.zeros((3, 2))}}, "as many members each"),
    ({"start": {"configuration": np.zeros((0, 3, 3))}}, "as many members each"),
    ({"bounds": (1.0, -1.0)}, "leave room"),
    ({"bounds": 3.0}, "be a pair"),
    ({"cost": "time"}, "be one of"),
    ({"steps": 0}, "positive integer"),
    ({"discrete": SLEIGH.system}, "discretized system"),
    ({"discrete": nh.discretize(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), 0.1)}, "left-invariant"),
    ({"discrete": nh.discretize(SLEIGH.system, 0.1, order=4)}, "order 2"),
    ask=lambda x: nh.steer(**{"discrete": SLEIGH, "start": {}, "goal": {"configuration": ASIDE}, "steps": 4} | x),
)
