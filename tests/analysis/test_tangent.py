"""The tangent map along orbits against differences of orbits, and Lyapunov exponents where they are known."""

import numpy as np
import pytest

import nonholo as nh
from nonholo.systems import AbstractSystem

MIXED = [[1.0, 0, 1, 0.75, -0.5, 0.75], [0, 1.0, 0, 0.5, 0.25, -1], [1, 1, 0, 1, 0.5, -0.75]]
BODIES = {
    "tilted top": nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 2.5]) + 0.1, (0.6, 0.0, 0.8)),
    "offset sleigh": nh.ChaplyginSleigh(2.0, 1.0, 0.5, 0.3),
    "four": nh.SuslovTop(np.diag([1.0, 2.0, 1.5, 1.0]) + 0.1),
    "mixed": nh.LLSystem(nh.SE(3), np.diag([1.0, 2.0, 1.5, 1.0]) + 0.1, constraint_subspace=MIXED),
    "free": nh.RigidBody(np.diag([1.0, 2.0, 3.0])),
}


@pytest.mark.parametrize("system", BODIES.values(), ids=BODIES)
def test_tangent_map_is_the_difference_of_orbits(system: AbstractSystem) -> None:
    """The product of the steps is what central differences of the last momentum say."""
    discrete, start = nh.discretize(system, 0.1), np.linspace(0.3, 0.5, system.rank)
    steps = nh.simulate(discrete, momentum=start, steps=5).tangent
    product = np.linalg.multi_dot(steps[::-1])

    def last(momentum: np.ndarray) -> np.ndarray:
        return nh.simulate(discrete, momentum=momentum, steps=5).restricted_momentum[-1]

    columns = [
        (8 * (last(start + e) - last(start - e)) - last(start + 2 * e) + last(start - 2 * e)) / 12e-3
        for e in 1e-3 * np.eye(len(start))
    ]
    np.testing.assert_allclose(product, np.transpose(columns), rtol=0, atol=1e-10)


@pytest.mark.parametrize("system", BODIES.values(), ids=BODIES)
@pytest.mark.parametrize("end", [1.5, -1.5])
def test_tangent_map_of_flows(system: AbstractSystem, end: float) -> None:
    """The product of the tangent maps of a flow is what differences of flows say, forwards and backwards."""
    times, start = end * np.array([0.0, 0.2, 0.7, 1.0]), np.linspace(0.3, 0.5, system.rank)
    product = np.linalg.multi_dot(nh.flow(system, momentum=start, times=times).tangent[::-1])

    def last(momentum: np.ndarray) -> np.ndarray:
        return nh.flow(system, momentum=momentum, times=times).restricted_momentum[-1]

    columns = [
        (8 * (last(start + e) - last(start - e)) - last(start + 2 * e) + last(start - 2 * e)) / 12e-3
        for e in 1e-3 * np.eye(len(start))
    ]
    np.testing.assert_allclose(product, np.transpose(columns), rtol=0, atol=1e-10)


def test_tangent_map_of_a_sleigh_in_closed_form() -> None:
    """Straight motion with speed u loses turning at the rate a m u / (J + m a^2); at rest nothing changes."""
    mass, inertia, a, p = 2.0, 1.0, 0.5, 0.8
    flow = nh.flow(nh.ChaplyginSleigh(mass, inertia, a), momentum=(0.0, p), times=np.linspace(0.0, 40.0, 9))
    decay = np.exp(-a * p / (inertia + mass * a * a) * np.diff(flow.time))
    np.testing.assert_allclose(flow.tangent[:, 0, 0], decay, rtol=1e-13)
    np.testing.assert_allclose(flow.tangent[:, 1, 1], 1.0, rtol=1e-13)
    np.testing.assert_allclose(nh.lyapunov_exponents(flow)[1], -a * p / (inertia + mass * a * a), rtol=1e-13)
    rest = nh.flow(nh.ChaplyginSleigh(mass, inertia, a), momentum=(0.0, 0.0), times=(0.0, 3.0))
    np.testing.assert_array_equal(rest.tangent[0], np.eye(2))


def test_exponents_of_a_straight_motion() -> None:
    """A sleigh that slides straight ahead loses turning at a constant factor a step, which the cubic gives."""
    mass, inertia, a, h, p = 1.0, 1.0, 0.5, 0.1, 1.0
    orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(mass, inertia, a), h), momentum=(0.0, p), steps=50)
    shifted = a * (h * p + 2 * mass * a)
    factor = 1 - 2 * a * h * p / (2 * inertia + shifted)
    np.testing.assert_allclose(nh.lyapunov_exponents(orbit), [0.0, np.log(factor) / h], rtol=1e-12, atol=1e-14)


def test_other_orbits_are_refused() -> None:
    """A flow with a constraint in space, a thinned orbit and a composition have no tangent map, and say what has."""
    sleigh = BODIES["offset sleigh"]
    thinned = nh.simulate(nh.discretize(sleigh, 0.1), restricted_velocity=(0.1, 0.2), steps=4, save_every=2)
    composed = nh.simulate(nh.discretize(sleigh, 0.1, order=4), restricted_velocity=(0.1, 0.2), steps=4)
    flow = nh.flow(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), momentum=(0.1, 0.2), times=(0.0, 1.0))
    for orbit, words in ((thinned, "every step"), (composed, "rollout"), (flow, "rollout")):
        with pytest.raises(ValueError, match=words):
            _ = orbit.tangent
    with pytest.raises(ValueError, match="have a step"):
        nh.lyapunov_exponents(nh.simulate(nh.discretize(sleigh, 0.1), momentum=(0.1, 0.2), steps=1)[:1])
