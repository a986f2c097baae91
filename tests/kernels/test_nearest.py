"""The kernel that follows one value of the map: its equations, its paths and what it leaves to the definition."""

import numpy as np
import pytest

import nonholo as nh
from nonholo import kernels
from nonholo.discrete.branching._equations import Equations, follow, frame_of, nearest_body
from nonholo.discrete.branching._rules import branch_rule
from nonholo.discrete.branching._stepper import displacement_at, first_place, next_place
from nonholo.kernels.secular import nearest as _nearest

SHAPES = {"top 3": (2, None), "top 6": (5, None), "sleigh": (1, 0.6), "sleigh 4": (3, 0.4), "no lever": (3, 0.0)}
BODIES = {
    "four values": (nh.SuslovTop([[1.25, 0.0, -0.5], [0.0, 1.0, -0.75], [-0.5, -0.75, 1.25]]), 1.0),
    "balanced": (nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1),
    "sleigh": (nh.ChaplyginSleigh(1.0, 1.0, 0.5), 1.0),
    "motion": (nh.MultidimensionalSleigh(1.3, [0.3, 0.2, -0.1], np.diag([0.5, 0.7, 0.4]) + 0.1), 0.3),
    "rod": (nh.SuslovTop(np.outer([1.0, 0.5, 0.4], [1.0, 0.5, 0.4]) + np.diag([0.01, 0.02, 0.0])), 1.0),
}


def _equations(name: str, rng: np.random.Generator, balanced: bool) -> Equations:
    k, lever = SHAPES[name]
    coupling = 0.0 * rng.normal(size=k) if balanced else 0.3 * rng.normal(size=k)
    push = 0.0 if lever is None else 0.1 * rng.normal()
    return Equations(rng.uniform(0.5, 1, k), coupling, 0.1 * rng.normal(size=k), lever, push)


def _goal(equations: Equations) -> np.ndarray:
    return equations.target if equations.lever is None else np.append(equations.target, equations.push)


@pytest.mark.parametrize("balanced", [False, True], ids=["coupled", "balanced"])
@pytest.mark.parametrize("name", SHAPES)
def test_the_kernel_has_the_equations(name: str, balanced: bool) -> None:
    """Residual, derivative and kick of the kernel are those of `Equations`, to a few ulp, also with c = 0."""
    rng = np.random.default_rng(1)
    equations = _equations(name, rng, balanced)
    body, m = nearest_body(equations), 1 + len(_goal(equations))
    x, out, J, after = rng.normal(size=m), np.empty((m, 1)), np.empty((m, m)), np.empty(m - 1)
    _nearest.residual(body, _goal(equations), x, out)
    _nearest.slope(body, x, J)
    _nearest.kick(body, _goal(equations), x, after)
    np.testing.assert_allclose(out[:, 0], equations.residual(x)[0], rtol=0, atol=1e-14)
    np.testing.assert_allclose(J, equations.slope(x), rtol=0, atol=1e-14)
    target, push = equations.kick(x)
    expected = target if equations.lever is None else np.append(target, push)
    np.testing.assert_allclose(after - _goal(equations), expected, rtol=0, atol=2e-14)


@pytest.mark.parametrize("name", SHAPES)
def test_what_the_kernel_reaches_is_what_the_definition_reaches(name: str) -> None:
    """From roots of random problems to others: the same end, or the kernel declines and leaves the point alone."""
    rng, reached = np.random.default_rng(2), 0
    for _ in range(40):
        start = _equations(name, rng, False)
        x = np.append(1.0, 0.0 * _goal(start))
        rest = Equations(start.stiffness, start.coupling, 0.0 * start.target, start.lever, 0.0 * start.push)
        code, end = follow(rest, start, x)
        y = x.copy()
        if _nearest.follow(nearest_body(start), _goal(rest), _goal(start), y):
            reached += 1
            assert code == 0
            np.testing.assert_allclose(y, end, rtol=1e-9, atol=1e-9)  # Newton's last correction is below 1e-11
        else:
            assert np.array_equal(y, x)
    assert reached > 10


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
