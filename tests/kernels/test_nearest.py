"""The kernel that follows one value of the map: its equations, its paths and what it leaves to the definition."""

import numpy as np
import pytest

import nonholo as nh
from nonholo import kernels
from nonholo.discrete.branching._equations import Equations, frame_of, nearest_body
from nonholo.discrete.branching._rules import branch_rule, displacement_at, first_place, next_place

BODIES = {
    "four values": (nh.SuslovTop([[1.25, 0.0, -0.5], [0.0, 1.0, -0.75], [-0.5, -0.75, 1.25]]), 1.0),
    "balanced": (nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1),
    "sleigh": (nh.ChaplyginSleigh(1.0, 1.0, 0.5), 1.0),
    "motion": (nh.MultidimensionalSleigh(1.3, [0.3, 0.2, -0.1], np.diag([0.5, 0.7, 0.4]) + 0.1), 0.3),
    "rod": (nh.SuslovTop(np.outer([1.0, 0.5, 0.4], [1.0, 0.5, 0.4]) + np.diag([0.01, 0.02, 0.0])), 1.0),
}


def _goal(equations: Equations) -> np.ndarray:
    return equations.target if equations.lever is None else np.append(equations.target, equations.push)


@pytest.mark.parametrize("name", BODIES)
def test_runs_have_the_values_of_the_definition(name: str) -> None:
    """From every real value over three momenta: the states of steps by the rule itself, and the same outcome."""
    system, step = BODIES[name]
    discrete, rng, rule = nh.discretize(system, step), np.random.default_rng(5), branch_rule("test", "nearest")
    frame = frame_of("test", discrete)
    for size in (0.3, 1.0, 3.0):
        found = nh.displacements_over(discrete, size * rng.normal(size=len(system.constraint_subspace)))
        for W in found.displacement[found.is_real].real:
            orbit = nh.simulate(discrete, displacement=W, steps=30, branch="nearest", throw=False)
            code, place = first_place("test", discrete, frame, rule, np.empty(0), W)
            for present in orbit.displacement:
                assert place is not None
                assert np.abs(displacement_at(discrete, frame, place.point) - present).max() < 1e-12 * np.abs(W).max()
                code, place = next_place(discrete, frame, rule, place)
            assert code == orbit.outcome or len(orbit) == 31


def test_an_unclear_step_is_left_to_the_definition() -> None:
    """A sleigh that meets a fold on its way: the kernel stops before it, the definition says why the run ends."""
    discrete, outcomes = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 1.0), set()
    for r in 3 * np.random.default_rng(5).normal(size=(8, 2)):
        found = nh.displacements_over(discrete, r)
        for W in found.displacement[found.is_real].real:
            outcomes.add(nh.simulate(discrete, displacement=W, steps=40, branch="nearest", throw=False).outcome)
    assert outcomes == {nh.Outcome.successful, nh.Outcome.no_real_branch}


def test_a_singular_point_is_not_followed() -> None:
    """Where the derivative has no inverse the kernel takes no step."""
    equations = frame_of("test", nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 1.0)).equations(np.ones(2))
    goals, points = np.empty((1, 2)), np.empty((1, 3))
    assert kernels.advance_to_nearest(nearest_body(equations), _goal(equations), np.zeros(3), goals, points) == 0
