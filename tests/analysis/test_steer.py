"""Controls to goals: poses and velocities met, least effort by hand, bounds, what cannot be reached."""

import numpy as np
import pytest

import nonholo as nh

SLEIGH = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.2), 0.1)
ASIDE = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]])
REST = {"restricted_velocity": (0.0, 0.0)}


@pytest.mark.profile("routes", instead="test_bounds_hold")
def test_sleigh_is_parked_beside_itself_and_elsewhere() -> None:
    """From rest to rest at 20 poses, one of them sideways, each met to 1e-8 by the rollout of the controls."""
    rng = np.random.default_rng(1)
    for pose in (ASIDE, *(nh.SE(2).random(rng) for _ in range(19))):
        found = nh.steer(SLEIGH, {}, {"configuration": pose, **REST}, steps=40)
        assert found.converged
        end = nh.rollout(SLEIGH, restricted_velocity=(0.0, 0.0), controls=found.controls, steps=40)
        np.testing.assert_allclose(end.configuration[-1], pose, rtol=0, atol=1e-8)
        np.testing.assert_allclose(end.restricted_momentum[-1], 0.0, rtol=0, atol=1e-8)


def test_least_effort_to_a_speed_is_a_constant_thrust() -> None:
    """A sleigh that is to slide at speed 1 after 4 units of time is pushed with 1/4 all the time, at cost 1/8."""
    found = nh.steer(SLEIGH, {}, {"restricted_velocity": (0.0, 1.0)}, steps=40)
    np.testing.assert_allclose(found.controls, np.tile([0.0, 0.25, 0.0], (40, 1)), rtol=0, atol=1e-6)
    np.testing.assert_allclose(found.cost, 0.125, rtol=1e-9)
    assert found.converged


def test_bounds_hold() -> None:
    """Forces stay within their bounds, and cost more than without them."""
    goal = {"configuration": ASIDE, **REST}
    bounded, free = (nh.steer(SLEIGH, {}, goal, steps=40, bounds=bounds) for bounds in ((-1.5, 1.5), None))
    assert bounded.converged
    assert np.abs(bounded.controls).max() <= 1.5 + 1e-12 < np.abs(free.controls).max()
    assert bounded.cost > free.cost


@pytest.mark.profile("routes", instead="test_bounds_hold")
def test_torque_alone_does_not_stop_a_sleigh() -> None:
    """With its mass ahead, v' = a omega^2: no torque brings it to rest, and the result says so."""
    start = {"restricted_velocity": (0.0, 0.3)}
    found = nh.steer(SLEIGH, start, REST, steps=6, bounds=((-5.0, 0.0), (5.0, 0.0)))
    assert not found.converged
    assert found.missed > 0.2


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"goal": {}}, "name a pose or a velocity"),
        ({"goal": {"pose": ASIDE}}, "name only"),
        ({"goal": {"configuration": 2 * ASIDE}}, "lie in SE"),
        ({"start": 5}, "name only"),
        ({"bounds": (1.0, -1.0)}, "leave room"),
        ({"bounds": 3.0}, "be a pair"),
        ({"cost": "time"}, "be one of"),
        ({"steps": 0}, "positive integer"),
        ({"discrete": SLEIGH.system}, "discretized system"),
        ({"discrete": nh.discretize(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), 0.1)}, "left-invariant"),
        ({"discrete": nh.discretize(SLEIGH.system, 0.1, order=4)}, "order 2"),
    ],
)
def test_bad_arguments_are_refused(change: dict, words: str) -> None:
    """What cannot be steered is named before any work."""
    with pytest.raises(ValueError, match=words):
        nh.steer(**{"discrete": SLEIGH, "start": {}, "goal": {"configuration": ASIDE}, "steps": 4} | change)
