"""Feedback along an orbit: gains of least cost, exact derivatives, motions led back, errors out of reach."""

import functools
from typing import Any

import numpy as np
import pytest
from refusals import refusals
from scipy.linalg import solve_discrete_are

import nonholo as nh
from nonholo.analysis.steering import Feedback
from nonholo.analysis.steering._feedback import riccati_gains

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


def test_gains_far_from_the_end_are_stationary() -> None:
    """Where nothing depends on the step, the first of many gains is that of the algebraic Riccati equation."""
    rng = np.random.default_rng(1)
    A, B, Q, R = rng.normal(size=(3, 3)), rng.normal(size=(3, 2)), np.diag([1.0, 2.0, 0.5]), np.diag([0.7, 1.1])
    P = solve_discrete_are(A, B, Q, R)
    expected = np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A)
    gains = riccati_gains(np.tile(A, (300, 1, 1)), np.tile(B, (300, 1, 1)), (Q, R, np.eye(3)))
    np.testing.assert_allclose(gains[0], expected, rtol=0, atol=1e-11 * np.abs(expected).max())


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
