"""Arguments of any sort are refused by name, by the checks through which all of them come."""

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from fuzz.bad import bad_value

import nonholo as nh

J = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
TOP = nh.discretize(nh.SuslovTop(J), 0.1)
SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5)
MEASURE = nh.invariant_measure(SLEIGH)
BAD: dict[str, tuple[Callable[[Any], Any], str]] = {
    "density": (MEASURE.density, "InvariantMeasure.density(momentum=...)"),
    "jacobian": (nh.invariant_measure(TOP).jacobian, "InvariantMeasure.jacobian(displacement=...)"),
    "half-planes": (lambda x: nh.half_planes(TOP, momentum=x), "half_planes(momentum=...)"),
    "Moser and Veselov": (lambda x: nh.moser_veselov_displacement(x, [0.3, 0.4, 0.2], 0.1), "(mass_tensor=...)"),
    "choice": (nh.Choice, "Choice(values=...)"),
    "grid": (lambda x: nh.Grid({"a": x}), "Grid({'a': ...})"),
    "ensemble": (lambda x: nh.ensemble(TOP, steps=2, restricted_velocity=x), "ensemble(restricted_velocity=...)"),
    "start": (lambda x: nh.simulate(TOP, steps=2, momentum=x), "simulate(momentum=...)"),
    "rollout": (lambda x: nh.rollout(TOP, steps=2, momentum=x), "rollout(momentum=...)"),
    "step": (lambda x: nh.step(TOP, momentum=x), "step(momentum=...)"),
    "chart": (lambda x: TOP.displaced([x, 0.0]), "Discretization.displaced(cayley=...)"),
    "legendre": (lambda x: nh.discrete_legendre(TOP, x), "discrete_legendre(displacement=...)"),
    "subspace": (lambda x: nh.reference_point_subspace(x, np.eye(3)), "reference_point_subspace(n=...)"),
    "depth": (lambda x: nh.branch_tree(TOP, np.eye(3), x), "branch_tree(depth=...)"),
    "rng": (lambda x: nh.Grid({"a": [1.0]}, rng=x), "Grid(rng=...)"),
    "stop": (lambda x: nh.Event(len, stop=x), "Event(stop=...)"),
    "group": (lambda x: nh.LLSystem(x, J, np.eye(3)), "(group=...)"),
}
VALUES = ("unwilling", "ragged", "nested 2000", "module", "timedelta64", "in itself", "dict", "10**5000", "1e160")


@pytest.mark.parametrize("value", VALUES)
@pytest.mark.parametrize("name", BAD)
def test_no_value_passes_a_check_unseen(name: str, value: str) -> None:
    """Whatever NumPy would raise over an argument, or make of it, the error is ours and names the argument."""
    call, owner = BAD[name]
    with pytest.raises(ValueError, match=re.escape(owner)):
        call(bad_value(value, 1.0))


@pytest.mark.parametrize("value", ["density", "half-planes"])
def test_complex_momenta_have_no_side(value: str) -> None:
    """Where only real momenta have a meaning complex ones are refused."""
    with pytest.raises(ValueError, match="be real"):
        BAD[value][0](np.array([0.3 + 0j, 0.4]))


def test_singular_matrices_of_groups_warn() -> None:
    """What has no inverse gives NaN with the warning of NumPy, its neighbors in a stack their numbers."""
    boosts = nh.MatrixGroup(np.array([[[1.0, 0.0], [0.0, -1.0]]]), form=np.array([[0.0, 1.0], [1.0, 0.0]]))
    with pytest.warns(RuntimeWarning, match="invalid value"):
        result = boosts.cayley([[2.0], [0.5]])
    assert np.isnan(result[0]).all()
    np.testing.assert_array_equal(result[1], boosts.cayley([0.5]))


def test_a_huge_element_of_the_algebra_has_an_exponential() -> None:
    """The number of halvings may exceed the exponents of doubles."""
    group = nh.MatrixGroup(nh.SO(3).basis)
    assert np.isfinite(group.exp([1e150, 0.0, 0.0])).all()
    with np.errstate(all="ignore"):
        assert group.exp([1e308, 0.0, 0.0]).shape == (3, 3)


def test_the_free_top_has_no_unit_of_mass() -> None:
    """Of the Riccati equation too only ratios of masses count."""
    P = np.array([0.3, 0.4, 0.2])
    expected = nh.moser_veselov_displacement(J, P, 0.1)
    for mass in (2.0**-490, 2.0**490):
        np.testing.assert_array_equal(nh.moser_veselov_displacement(mass * J, mass * P, 0.1), expected)


def test_what_was_got_stands_on_one_line() -> None:
    """An error about a body with matrices is a line, not the middle of a table."""
    wide = nh.discretize(nh.SuslovTop(np.eye(4)), 0.1)
    with pytest.raises(ValueError, match=r"Got SuslovTop\(n=4, .*\. For others") as failure:
        nh.momentum_locus(wide)
    assert "\n" not in str(failure.value)
