"""Feedback along an orbit, of bodies and in coordinates: gains of least cost, exact derivatives, motions led back."""

import dataclasses
import functools
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.analysis.steering import Feedback
from nonholo.analysis.steering._feedback import riccati_gains
from nonholo.lagrange_dalembert import checked_state

SLEIGH = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.2), 0.1)
STEPS = 60
TURNING = 0.3 * np.sin(0.2 * np.arange(STEPS))[:, None] * [1.0, 0.4, 0.0]
GLIDING: dict[str, Any] = {"restricted_velocity": (0.1, 1.0)}


@functools.cache
def _feedback() -> Feedback:
    return nh.tracking_feedback(SLEIGH, GLIDING, TURNING, final_weight=30.0, bounds=((-0.9, -0.4), (0.9, 0.4)))


def test_gains_are_those_of_the_dense_problem() -> None:
    """Forces by the recursion are those that solve all steps at once, as one least-squares problem."""
    rng = np.random.default_rng(0)
    steps, n, k = 7, 4, 2
    A, B, first = rng.normal(size=(steps, n, n)), rng.normal(size=(steps, n, k)), rng.normal(size=n)
    Q, R, F = (x @ x.T for x in (rng.normal(size=(size, size)) for size in (n, k, n)))
    gains = riccati_gains(A, B, (Q, R, F))
    error, forces, ways = first, [], [(np.eye(n), np.zeros((n, steps * k)))]
    for j in range(steps):
        forces.append(-gains[j] @ error)
        error = A[j] @ error + B[j] @ forces[-1]
        by_first, by_forces = (A[j] @ x for x in ways[-1])
        by_forces[:, k * j : k * j + k] += B[j]
        ways.append((by_first, by_forces))
    roots = [np.linalg.cholesky(Q).T] * steps + [np.linalg.cholesky(F).T]
    rows = [np.kron(np.eye(steps), np.linalg.cholesky(R).T), *(x @ way[1] for x, way in zip(roots, ways, strict=True))]
    goals = [np.zeros(steps * k), *(-x @ way[0] @ first for x, way in zip(roots, ways, strict=True))]
    dense = np.linalg.lstsq(np.concatenate(rows), np.concatenate(goals))[0]
    np.testing.assert_allclose(np.concatenate(forces), dense, rtol=0, atol=1e-10 * np.abs(dense).max())


@pytest.mark.profile("routes", instead="test_gains_are_those_of_the_dense_problem")
def test_linearization_is_that_of_the_compiled_step() -> None:
    """A and B of a step are central differences of single steps of the kernel under a table of forces."""
    feedback, j, offset = _feedback(), 17, 1e-5
    g, r, group = feedback.reference.configuration, feedback.reference.restricted_momentum, SLEIGH.system.group

    def after(error: np.ndarray, force: np.ndarray) -> np.ndarray:
        driven = nh.discretize(nh.Forced(SLEIGH.system, force=(TURNING[j] + np.append(force, 0.0))[None]), 0.1)
        velocity = SLEIGH.system.restricted_velocity(r[j]) + error[3:]
        orbit = nh.simulate(driven, restricted_velocity=velocity, configuration=g[j] @ group.exp(error[:3]), steps=1)
        w = SLEIGH.system.restricted_velocity(orbit.restricted_momentum[1] - r[j + 1])
        return np.concatenate([group.log(group.inverse(g[j + 1]) @ orbit.configuration[1]), w])

    ends = [(after(x[:5], x[5:]), after(-x[:5], -x[5:])) for x in offset * np.eye(7)]
    slopes = np.transpose([(high - low) / (2 * offset) for high, low in ends])
    A, B = feedback.linearization
    np.testing.assert_allclose(np.concatenate([A[j], B[j]], axis=1), slopes, rtol=0, atol=1e-8)


@pytest.mark.profile("routes", instead="test_gains_are_those_of_the_dense_problem")
def test_disturbed_motion_is_led_back() -> None:
    """From beside its track, pushed on the way, a sleigh ends nearer than without; forces keep their bounds."""
    feedback, push = _feedback(), np.zeros((STEPS, 3))
    push[30] = 4.0, 3.0, 0.0
    beside = nh.SE(2).exp([-0.2, 0.1, 0.3])
    motion = feedback.simulate(configuration=beside, disturbance=push)
    alone = nh.rollout(SLEIGH, **GLIDING, configuration=beside, controls=TURNING + push, steps=STEPS)
    goal = feedback.reference.configuration[-1]
    left = SLEIGH.system.group.log(np.linalg.inv(goal) @ alone.configuration[-1])
    assert np.abs(motion.error[-1]).max() < 0.05 * np.abs(left).max()
    np.testing.assert_allclose(np.abs(motion.controls).max(axis=0), [0.9, 0.4, 0.0], rtol=0, atol=1e-15)
    np.testing.assert_allclose(motion.orbit.controls[:-1] - push, motion.controls, rtol=0, atol=1e-12)


@pytest.mark.profile("routes", instead="test_gains_are_those_of_the_dense_problem")
def test_motion_is_that_of_its_controls() -> None:
    """The rollout under the controls that the feedback gave, and the push, is the same motion; the time is its own."""
    push = 0.2 * np.random.default_rng(2).normal(size=(STEPS, 3))
    motion = _feedback().simulate(restricted_velocity=(0.0, 0.8), disturbance=push)
    again = nh.rollout(SLEIGH, restricted_velocity=(0.0, 0.8), controls=motion.controls + push, steps=STEPS)
    for name in again._fields:
        np.testing.assert_allclose(getattr(motion.orbit, name), getattr(again, name), rtol=0, atol=1e-11, err_msg=name)


@pytest.mark.profile("routes", instead="test_gains_are_those_of_the_dense_problem")
def test_small_errors_follow_the_linearized_loop() -> None:
    """An error of 1e-4 goes where products of A - B K take it, up to its square; without one nothing moves."""
    feedback, errors = _feedback(), [1e-4 * np.array([0.5, -1.0, 0.8, 0.3, 0.6])]
    for A, B, gain in zip(*feedback.linearization, feedback.gains, strict=True):
        errors.append((A - B @ gain) @ errors[-1])
    motion = feedback.simulate(
        restricted_velocity=GLIDING["restricted_velocity"] + errors[0][3:], configuration=nh.SE(2).exp(errors[0][:3])
    )
    np.testing.assert_allclose(motion.error, errors, rtol=0, atol=1e-7)
    for start in ({}, {"momentum": _feedback().reference.restricted_momentum[0]}):
        np.testing.assert_allclose(_feedback().simulate(**start).error, 0.0, rtol=0, atol=1e-12)


@pytest.mark.profile("routes", instead="test_gains_are_those_of_the_dense_problem")
def test_misreading_enters_the_force_alone() -> None:
    """The first force of an undisturbed motion answers to what the feedback reads."""
    misreading = np.zeros((STEPS, 5))
    misreading[0] = 0.1, -0.05, 0.2, 0.0, 0.1
    feedback = _feedback()
    forces = feedback.simulate(misreading=misreading).controls[0, :2]
    np.testing.assert_allclose(forces, TURNING[0, :2] - feedback.gains[0] @ misreading[0], rtol=0, atol=1e-12)


@pytest.mark.profile("routes", instead="test_gains_are_those_of_the_dense_problem")
def test_resting_sleigh_is_not_moved_sideways() -> None:
    """At rest one of five errors is out of reach of all forces, and the measure says so; gliding all are in reach."""
    rest = nh.tracking_feedback(SLEIGH, {}, np.zeros((STEPS, 3)))
    assert rest.controllability[-1] < 1e-12 * rest.controllability[0]
    assert rest.controllability[-2] > 0.1
    motion = rest.simulate(configuration=nh.SE(2).exp([0.0, 0.3, 0.2]))
    assert abs(motion.error[-1, 1]) < 0.02
    np.testing.assert_allclose(motion.error[-1, 2], 0.2, rtol=0, atol=1e-9)
    assert _feedback().controllability[-1] > 0.1


# What cannot be held is named before any work.
test_bad_arguments_are_refused = refusals(
    ({"discrete": SLEIGH.system}, "discretized system"),
    ({"discrete": nh.discretize(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), 0.1)}, "left-invariant"),
    ({"discrete": nh.discretize(nh.Forced(SLEIGH.system, force=TURNING), 0.1)}, "Add the table to the controls"),
    ({"start": {"pose": np.eye(3)}}, "name only"),
    ({"controls": np.zeros((4, 2))}, "have shape"),
    ({"state_weight": -1.0}, "not be negative"),
    ({"state_weight": np.ones(3)}, "have shape"),
    ({"control_weight": 0.0}, "positive definite"),
    ({"final_weight": np.triu(np.ones((5, 5)))}, "be symmetric"),
    ({"bounds": (1.0, -1.0)}, "leave room between them"),
    ({"bounds": 3.0}, "be a pair"),
    ask=lambda change: nh.tracking_feedback(**{"discrete": SLEIGH, "start": {}, "controls": np.zeros((4, 3))} | change),
)


_FEW = 12
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
def _along(name: str) -> Feedback:
    """Return a feedback along a motion under forces."""
    ready, n = READY[name], len(READY[name].configuration)
    start = {"configuration": ready.configuration, "body_velocity": ready.body_velocity}
    forces = 0.2 * np.sin(np.arange(_FEW)[:, None] + np.arange(n))
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


@pytest.mark.profile("routes", instead="test_bad_arguments_in_coordinates_are_refused")
@pytest.mark.parametrize("name", READY)
def test_linearization_is_that_of_runs(name: str) -> None:
    """Without gains errors grow as the derivatives of steps say, by those of the start and by pushes."""
    feedback, size = _along(name), 1e-4
    alone = dataclasses.replace(feedback, gains=0 * feedback.gains)
    push = np.random.default_rng(5).normal(size=feedback.controls.shape)
    ends = [alone.simulate(**_beside(name, x), disturbance=x * push).error for x in (size, -size)]
    result = (ends[0] - ends[1]) / (2 * size)
    errors = [result[0]]
    for A, B, force in zip(*feedback.linearization, push, strict=True):
        errors.append(A @ errors[-1] + B @ force)
    np.testing.assert_allclose(result, errors, rtol=0, atol=1e-6 * np.abs(result).max())


@pytest.mark.profile("routes", instead="test_bad_arguments_in_coordinates_are_refused")
@pytest.mark.parametrize("name", READY)
def test_cost_is_the_value_of_the_recursion(name: str) -> None:
    """The cost of errors and forces from two opposite starts is the quadratic form of the first errors, to order 4."""
    feedback, h, size = _along(name), 0.1, 1e-3
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


@pytest.mark.profile("routes", instead="test_bad_arguments_in_coordinates_are_refused")
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
test_bad_arguments_in_coordinates_are_refused = refusals(
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
