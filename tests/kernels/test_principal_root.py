"""The principal root of the closed forms against fine continuation from momentum zero, and its singular cases."""

import math

import numpy as np
import pytest

import nonholo as nh
from nonholo import kernels
from nonholo.discrete.branching._equations import Equations, frame_of, nearest_body
from nonholo.discrete.branching._rules import branch_rule, displacement_at, first_place, next_place
from nonholo.kernels import _sleigh, _suslov


def _random_top(rng: np.random.Generator, rod: bool) -> kernels.SuslovBody:
    points = rng.normal(size=(3, 3)) * rng.uniform(0.1, 2, size=(1, 3))
    J = points @ points.T
    if rod:
        direction = rng.normal(size=3)
        J = np.outer(direction, direction) + 1e-2 * J
    return kernels.suslov_body(J[:2, :2] + (J[2, 2] + 0.02) * np.eye(2), J[:2, 2])


def test_top_certificate_is_sound() -> None:
    """Every root in the certified disc is the principal one: 2000 points just inside its edge."""
    rng = np.random.default_rng(8)
    for trial in range(2000):
        p = _random_top(rng, trial % 2 == 0)
        y = rng.normal(size=2)
        y *= math.sqrt(p.certain) * rng.uniform(0.8, 1) / np.linalg.norm(y)
        zero = kernels.residual(p, 0.0, 0.0, *y)
        m = np.array(zero) / (1 + y @ y)
        code, *root = _suslov.principal(p, *m)
        assert code == 0
        assert np.abs(np.array(root) - y).max() < 1e-9


def test_sleigh_at_angle_pi() -> None:
    """Where p_hat = 0 the principal root turns by pi exactly: V = (0, pi/(a m)) and the momentum pi changes sign."""
    p = kernels.SleighBody(1.0, 1.0, 2.0)
    m1, m2 = 9.0, -2 * p.mass * p.a
    code, t, y2 = _sleigh.principal(p, m1, m2)
    assert code == 0
    cos, sin, x, y = kernels.move(p, t, y2, 1.0, 0.0, 0.0, 0.0)
    assert (cos, sin) == pytest.approx((-1.0, 0.0), abs=1e-15)
    assert (x, y) == pytest.approx((0.0, m1 / (p.a * p.mass)), abs=1e-14)
    assert kernels.increment(p, m1, m2, t, y2) == pytest.approx((-2 * m1, 4 * p.a * p.mass))


@pytest.mark.parametrize("hat", [1e-3, 1e-6, -1e-6, -1e-3, -0.1])
def test_sleigh_near_angle_pi_keeps_its_energy(hat: float) -> None:
    """Close to angle pi the root and its slide stay accurate: one step conserves m pi^2 + I p_1^2 to rounding."""
    p = kernels.SleighBody(1.0, 1.0, 2.0)
    m1, m2 = 9.0, hat / p.a - 2 * p.mass * p.a
    code, t, y2 = _sleigh.principal(p, m1, m2)
    assert code == 0
    d1, d2 = kernels.increment(p, m1, m2, t, y2)
    inertia = p.inertia + p.mass * p.a**2
    before, after = (p.mass * u**2 + inertia * v**2 for u, v in ((m1, m2), (m1 + d1, m2 + d2)))
    assert after == pytest.approx(before, rel=1e-13)


def test_balanced_sleigh_ends_at_a_quarter_turn() -> None:
    """With a = 0 the step angle is arcsin(pi/J): up to |pi| = J it is real, beyond the branch has ended."""
    p = kernels.SleighBody(1.0, 2.0, 0.0)
    for m1 in (0.0, 0.5, -1.9, 2.0):
        code, t, _ = _sleigh.principal(p, m1, 0.3)
        assert code == 0
        assert 2 * math.atan(t) == pytest.approx(math.asin(m1 / 2.0), abs=1e-15)
    assert _sleigh.principal(p, 2.0001, 0.3)[0] == 1


def test_straight_motion_through_the_lower_cusp_is_not_certified() -> None:
    """On pi = 0 beyond the lower cusp the path from zero is singular: unverified, not a missing branch."""
    p = kernels.SleighBody(1.0, 1.0, 0.5)
    assert _sleigh.principal(p, 0.0, -3.0)[0] == 0
    assert _sleigh.principal(p, 0.0, -6.0)[0] == 2


def test_overflow_is_its_own_outcome() -> None:
    """Momenta that are not finite are reported as such, never as a missing branch."""
    assert _sleigh.principal(kernels.SleighBody(1.0, 1.0, 0.5), math.inf, 0.0)[0] == 5
    assert _suslov.principal(_random_top(np.random.default_rng(0), False), math.nan, 0.0)[0] == 5


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
        result = nh.displacements_over(discrete, size * rng.normal(size=len(system.constraint_subspace)))
        for W in result.displacement[result.is_real].real:
            orbit = nh.simulate(discrete, displacement=W, steps=30, branch="nearest", throw=False)
            code, place = first_place("test", frame, rule, np.empty(0), W)
            for present in orbit.displacement:
                assert place is not None
                assert np.abs(displacement_at(frame, place.point) - present).max() < 1e-12 * np.abs(W).max()
                code, place = next_place(frame, rule, place)
            assert code == orbit.outcome or len(orbit) == 31


def test_an_unclear_step_is_left_to_the_definition() -> None:
    """A sleigh that meets a fold on its way: the kernel stops before it, the definition says why the run ends."""
    discrete, outcomes = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 1.0), set()
    for r in 3 * np.random.default_rng(5).normal(size=(8, 2)):
        result = nh.displacements_over(discrete, r)
        for W in result.displacement[result.is_real].real:
            outcomes.add(nh.simulate(discrete, displacement=W, steps=40, branch="nearest", throw=False).outcome)
    assert outcomes == {nh.Outcome.successful, nh.Outcome.no_real_branch}


def test_a_singular_point_is_not_followed() -> None:
    """Where the derivative has no inverse the kernel takes no step."""
    equations = frame_of("test", nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 1.0)).equations(np.ones(2))
    goals, points = np.empty((1, 2)), np.empty((1, 3))
    assert kernels.advance_to_nearest(nearest_body(equations), _goal(equations), np.zeros(3), goals, points) == 0
