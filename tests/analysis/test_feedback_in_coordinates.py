"""Feedback in coordinates: derivatives of runs, costs of the recursion, motions led back, motors alone."""

import dataclasses
import functools
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.analysis.steering import Feedback
from nonholo.lagrange_dalembert import checked_state

STEPS = 12
PENDULUM = nh.LagrangeDAlembert(
    lambda q, v: v @ v / 2 - q[1], None, holonomic=lambda q: jnp.array([q @ q - 1.0]), dimension=2
)
READY: dict[str, Any] = {
    "disk": nh.examples.rolling_disk(),
    "board": nh.examples.snakeboard(),
    "driven": nh.examples.driven_sleigh(),
    "racer": nh.examples.roller_racer(speed=0.5),
    "pendulum": dataclasses.replace(
        nh.examples.particle(), system=PENDULUM, configuration=np.array([0.6, -0.8]), body_velocity=np.array([0.8, 0.6])
    ),
}


@functools.cache
def _feedback(name: str) -> Feedback:
    """Return a feedback along a motion under forces."""
    ready, n = READY[name], len(READY[name].configuration)
    start = {"configuration": ready.configuration, "body_velocity": ready.body_velocity}
    forces = 0.2 * np.sin(np.arange(STEPS)[:, None] + np.arange(n))
    weights = {"state_weight": np.arange(1.0, 1 + 2 * n), "control_weight": 0.3, "final_weight": 20.0}
    return nh.tracking_feedback(ready.discretize(0.1), start, forces, **weights)


def _beside(name: str, size: float) -> dict[str, Any]:
    """Return an admissible start beside that of the reference."""
    ready, rng = READY[name], np.random.default_rng(4)
    to, w = rng.normal(size=(2, len(ready.configuration)))
    to[[index for index, _ in ready.system.prescribed]] = 0.0
    velocity = {"body_velocity": ready.body_velocity + size * w}
    x, v = checked_state(ready.system, ready.configuration + size * to, velocity, 0.0, project=True)
    return {"configuration": x[: len(v)], "body_velocity": v}


@pytest.mark.profile("routes", instead="test_bad_arguments_are_refused")
@pytest.mark.parametrize("name", READY)
def test_linearization_is_that_of_runs(name: str) -> None:
    """Without gains errors grow as the derivatives of steps say, by those of the start and by pushes."""
    feedback, size = _feedback(name), 1e-4
    alone = dataclasses.replace(feedback, gains=0 * feedback.gains)
    push = np.random.default_rng(5).normal(size=feedback.controls.shape)
    ends = [alone.simulate(**_beside(name, x), disturbance=x * push).error for x in (size, -size)]
    found = (ends[0] - ends[1]) / (2 * size)
    errors = [found[0]]
    for A, B, force in zip(*feedback.linearization, push, strict=True):
        errors.append(A @ errors[-1] + B @ force)
    np.testing.assert_allclose(found, errors, rtol=0, atol=1e-6 * np.abs(found).max())


@pytest.mark.profile("routes", instead="test_bad_arguments_are_refused")
@pytest.mark.parametrize("name", READY)
def test_cost_is_the_value_of_the_recursion(name: str) -> None:
    """The cost of errors and forces from two opposite starts is the quadratic form of the first errors, to order 4."""
    feedback, h, size = _feedback(name), 0.1, 1e-3
    n = feedback.controls.shape[1]
    Q, R, P = h * np.diag(np.arange(1.0, 1 + 2 * n)), h * 0.3 * np.eye(n), 20.0 * np.eye(2 * n)
    for A, B, K in reversed(list(zip(*feedback.linearization, feedback.gains, strict=True))):
        P = Q + K.T @ R @ K + (A - B @ K).T @ P @ (A - B @ K)
    costs, values = [], []
    for sign in (1, -1):
        motion = feedback.simulate(**_beside(name, sign * size))
        errors, last, forces = motion.error[:-1], motion.error[-1], motion.controls - feedback.controls
        costs.append(((errors @ Q) * errors).sum() + ((forces @ R) * forces).sum() + 20.0 * last @ last)
        values.append(motion.error[0] @ P @ motion.error[0])
    np.testing.assert_allclose(np.sum(costs), np.sum(values), rtol=1e-4)
    np.testing.assert_allclose(feedback.simulate().error, 0.0, rtol=0, atol=1e-12)


@pytest.mark.profile("routes", instead="test_bad_arguments_are_refused")
def test_motors_lead_a_board_back_to_a_steered_path() -> None:
    """Rotor and steering alone, within their bounds, lead a board back to the path that it was steered along."""
    ready = READY["board"]
    discrete, motors = ready.discretize(0.1), np.array([0.0, 0.0, 0.0, 3.0, 3.0])
    start = {"configuration": ready.configuration, "body_velocity": ready.body_velocity}
    forces = motors * 0.1 * np.cos(0.3 * np.arange(60))[:, None]
    hold = nh.tracking_feedback(discrete, start, forces, final_weight=100.0, bounds=(-motors, motors))
    beside = ready.configuration + np.array([0.05, -0.05, 0.0, 0.1, 0.0])
    with pytest.raises(ValueError, match=r"`Feedback.simulate\(body_velocity=...\)` must satisfy the constraint"):
        hold.simulate(body_velocity=np.ones(5))
    motion = hold.simulate(configuration=beside)
    alone = nh.rollout(discrete, **{**start, "configuration": beside}, controls=forces, steps=60)
    left = np.abs(alone.configuration[-1] - hold.reference.configuration[-1]).max()
    assert np.abs(motion.error[-1, :3]).max() < 0.3 * left
    assert not motion.controls[:, :3].any()
    again = nh.simulate(
        nh.discretize(ready.system.forced(None, motion.controls), 0.1), **{**start, "configuration": beside}, steps=60
    )
    np.testing.assert_allclose(motion.orbit.configuration, again.configuration, rtol=0, atol=1e-11)


DISK = READY["disk"].discretize(0.1)
_NONE = np.zeros((0, 0))
HOLD = Feedback(DISK, np.zeros((4, 4)), None, np.zeros((4, 4, 8)), (_NONE, _NONE), (_NONE, _NONE))

# What cannot be held is named before any work.
test_bad_arguments_are_refused = refusals(
    (lambda: HOLD.simulate(restricted_velocity=(0.0, 0.0)), "name only configuration and body_velocity or momentum"),
    ({"start": {"restricted_velocity": (0.0, 1.0)}}, "name only configuration and body_velocity"),
    ({"controls": np.zeros((4, 2))}, "have shape"),
    ({"state_weight": np.ones(4)}, "have shape"),
    ({"start": {}}, r"`tracking_feedback\(configuration=...\)` must be given for a system in coordinates"),
    ask=lambda change: (
        change()
        if callable(change)
        else nh.tracking_feedback(**{"discrete": DISK, "start": {}, "controls": np.zeros((4, 4))} | change)
    ),
)
