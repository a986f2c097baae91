"""Left- and right-invariant systems answer the same questions, by one formula each, with or without a pose."""

import numpy as np
import pytest
from bodies import GENERAL

from nonholo.systems import AbstractSystem

_SYSTEMS = {name: system for name, (system, _) in GENERAL.items()}


@pytest.fixture(params=list(_SYSTEMS))
def system(request: pytest.FixtureRequest) -> AbstractSystem:
    """Return a system of either kind."""
    return _SYSTEMS[request.param]


@pytest.fixture
def g(system: AbstractSystem) -> np.ndarray:
    """Return a pose."""
    return system.group.random(np.random.default_rng(3))


def test_momenta_of_velocities(system: AbstractSystem, g: np.ndarray) -> None:
    """Momenta along the constraint are those of which the velocities are known, one by one or stacked."""
    r = np.random.default_rng(1).normal(size=(3, system.rank))
    w = system.restricted_velocity(r, g)
    assert np.allclose(system.restricted_momentum(w, g), r, rtol=1e-12, atol=1e-12 * np.abs(r).max())
    assert np.allclose(system.restricted_momentum(w[1], g), r[1], rtol=1e-12, atol=1e-12 * np.abs(r).max())
    poses = np.stack([g, g, g])
    assert np.allclose(system.restricted_momentum(w, poses), r, rtol=1e-12, atol=1e-12 * np.abs(r).max())


def test_a_move_is_seen_by_the_constraint(system: AbstractSystem, g: np.ndarray) -> None:
    """A displacement along the constraint moves the pose by an admissible velocity, to second order."""
    group, size = system.group, 1e-5
    x = np.random.default_rng(2).normal(size=system.rank) @ system.constraint_subspace
    moved = system.moved(g, group.exp(size * x))
    body = group.log(group.inverse(g) @ moved) / size
    assert np.abs(system.annihilator @ system.carried(g) @ body).max(initial=0.0) < 1e-8


def test_poses_are_needed_in_space_alone(system: AbstractSystem) -> None:
    """Without a pose a constraint in space is refused, with the remedy; one in the body does not need it."""
    r, p = np.ones(system.rank), np.ones(system.group.dim)
    for question, value in ((system.restricted_velocity, r), (system.constrained_energy, r), (system.restrict_at, p)):
        if system.is_spatial:
            with pytest.raises(ValueError, match="be given where the constraint is fixed in space"):
                question(value)
        else:
            assert np.all(np.isfinite(question(value)))
