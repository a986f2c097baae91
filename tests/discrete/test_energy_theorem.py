"""The energy theorem: with the matrix difference and the skew constraint every subspace keeps its energy."""

import numpy as np
import pytest
from bodies import mass_tensor, random_rows

import nonholo as nh

GROUPS = [nh.SO(3), nh.SO(4), nh.SO(5), nh.SE(2), nh.SE(3)]
CASES = [(group, k) for group in GROUPS for k in range(1, group.dim + 1)]


def _orbit(group: object, k: int, constraint: str, steps: int) -> nh.Orbit:
    rng = np.random.default_rng(100 * group.dim + k)
    system = nh.LLSystem(group, mass_tensor(group, rng), random_rows(group, k, rng))
    velocity = rng.normal(size=k)
    velocity *= 1.5 / np.sqrt(2 * system.constrained_energy(system.constrained_inertia @ velocity))
    return nh.simulate(nh.discretize(system, 0.1, constraint=constraint), restricted_velocity=velocity, steps=steps)


@pytest.mark.profile("problems", keep=["S?(2)*", "SO(3)*", "SE(3)-3", "SO(4)-3", "SO(5)-5"])
@pytest.mark.parametrize(("group", "k"), CASES, ids=str)
def test_energy_of_every_dimension(group: object, k: int) -> None:
    """Random d of dimension k, 2000 steps: energy, constraint, group and reversal to rounding."""
    found = nh.invariants(_orbit(group, k, "skew", 2000))
    assert found.energy_drift <= 1e-12
    assert found.constraint_residual <= 1e-12
    assert found.group_residual <= 1e-12
    assert found.reversal_defect <= 1e-12


@pytest.mark.profile("routes", keep=["SO(4)-3"])
@pytest.mark.parametrize(("group", "k"), [(nh.SO(4), 3), (nh.SO(4), 4), (nh.SE(3), 3)], ids=str)
def test_the_exponential_constraint_drifts(group: object, k: int) -> None:
    """With exp d instead, and d no symmetric pair, the energy visibly changes."""
    orbit = _orbit(group, k, "exponential", 40)
    assert not orbit.motion.conserves_energy
    assert nh.invariants(orbit).energy_drift >= 1e-5


@pytest.mark.parametrize("constraint", ["skew", "exponential"])
def test_a_symmetric_pair_of_rank_two(constraint: str) -> None:
    """For so(4) / (so(2) + so(2)), the planes that mix (1, 2) with (3, 4), both constraints are one and conserve."""
    rows = np.eye(6)[[1, 2, 3, 4]]
    assert nh.is_symmetric_pair(nh.SO(4), rows)
    rng = np.random.default_rng(3)
    system = nh.LLSystem(nh.SO(4), mass_tensor(nh.SO(4), rng), rows)
    discrete = nh.discretize(system, 0.2, constraint=constraint)
    assert discrete.conserves_energy
    assert (
        nh.invariants(nh.simulate(discrete, restricted_velocity=rng.normal(size=4), steps=2000)).energy_drift <= 1e-12
    )
