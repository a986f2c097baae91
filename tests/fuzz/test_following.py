"""The reference of the fuzzer of steps at and beyond half-turns, where other sheets of the variety pass."""

from typing import Any

import numpy as np
import pytest
from fuzz import steps
from fuzz.following import distance, followed

import nonholo as nh

PLANE = nh.ChaplyginSleigh(1.0, 0.3, -0.5)
SPACE = nh.MultidimensionalSleigh(1.0, [0.8, 0.2, -0.1], np.diag([0.2, 0.4, 0.5]))


@pytest.mark.profile("problems", keep=["SE2-3.141592653589793", "SE3-3.1414*", "SE2-3.5"])
@pytest.mark.parametrize("angle", [3.0, np.pi - 1e-4, np.pi, np.pi + 1e-4, 3.5])
@pytest.mark.parametrize(("system", "turn"), [(PLANE, (1.0,)), (SPACE, (0.8, 0.6))], ids=["SE2", "SE3"])
def test_half_turns_are_passed(system: Any, turn: tuple[float, ...], angle: float) -> None:
    """A sleigh turns by nearly, exactly and more than pi where it slides far enough; the library comes there too."""
    W = system.group.exp(np.array([*(angle * np.array(turn)), 4.0]) @ system.constraint_subspace)
    equations, _ = steps.equations_of(system)
    path = followed(equations, equations.momentum(W)[None])
    assert path.whole.all()
    assert distance(path.roots, W[None]) < 1e-7
    discrete = nh.discretize(system, 1.0)
    orbit = nh.simulate(discrete, momentum=system.restrict(nh.discrete_legendre(discrete, W)), steps=1)
    turned = system.group.inverse(orbit.configuration[0]) @ orbit.configuration[1]
    np.testing.assert_allclose(turned, W, rtol=0, atol=1e-8)


@pytest.mark.profile("problems", instead="test_half_turns_are_passed")
def test_a_very_uneven_body_is_followed_through_a_half_turn() -> None:
    """The directions of a body on SE(5) differ by 1e10; its path passes close to a fold, then angle pi."""
    case = steps.draw("sleigh 5", np.random.default_rng([0, 8, 1]))
    path = followed(case.equations, case.first[24:25])
    assert path.whole.all()
    assert distance(path.roots, case.batch.displacement[24:25, 0]) < 1e-9


def test_folds_are_where_squares_of_determinants_vanish() -> None:
    """The momentum of a round body is the sine of the angle: a path to its fold at 1 and beyond."""
    equations, _ = steps.equations_of(nh.SuslovTop(np.eye(3)))
    top = equations.momentum(nh.SO(3).exp(np.array([np.pi / 2, 0.0, 0.0])))
    path = followed(equations, np.array([0.9, 1.1, 4.0])[:, None] * top)
    assert path.folded.tolist() == [False, True, True]
    np.testing.assert_allclose(path.s[1:], [1 / 1.1, 1 / 4.0], rtol=1e-9)
