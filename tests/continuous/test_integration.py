"""The flow against diffrax, and where it overflows."""

import numpy as np
import pytest
from problems import EVERY as SYSTEMS

import nonholo as nh
from nonholo.systems import AbstractSystem

HYPERBOLIC = nh.MatrixGroup([[[0.0, 1.0], [1.0, 0.0]]], form=[[1.0, 0.0], [0.0, -1.0]])


def _start(system: AbstractSystem) -> dict:
    rng = np.random.default_rng(3)
    return {
        "restricted_velocity": rng.normal(size=len(system.constraint_subspace)),
        "configuration": system.group.random(rng),
    }


@pytest.mark.profile("routes", keep=["rod"])
@pytest.mark.parametrize("name", SYSTEMS)
def test_diffrax_arrives_at_the_same_states(name: str) -> None:
    """Both integrators follow the same motion to 1e-8, a hundred of the errors of their steps, there and back."""
    system, start = SYSTEMS[name], _start(SYSTEMS[name])
    for times in (np.linspace(0.0, 6.0, 8), np.linspace(1.0, -2.0, 4)):
        compiled, other = (nh.flow(system, **start, times=times, method=method) for method in (None, "diffrax"))
        for value in ("momentum", "configuration", "body_velocity", "multipliers"):
            found, expected = getattr(compiled, value), getattr(other, value)
            assert np.abs(found - expected).max(initial=0.0) <= 1e-8 * max(1.0, np.abs(expected).max(initial=0.0))
        if system.group == nh.SE(2):
            assert np.abs(compiled.heading - other.heading).max() <= 1e-8 * max(1.0, np.abs(other.heading).max())


@pytest.mark.profile("routes", keep=["None"])
@pytest.mark.parametrize("method", [None, "diffrax"])
def test_a_motion_that_overflows_keeps_its_good_states(method: str | None) -> None:
    """A pose on SO(1, 1) grows like e^t: beyond the largest number the solve ends, and earlier states are good."""
    boost = nh.LLSystem(HYPERBOLIC, constraint_subspace=[[1.0]], inertia_operator=[[1.0]])
    with pytest.raises(nh.OutcomeError, match="from time 700 to 800") as caught:
        nh.flow(boost, body_velocity=[1.0], times=(0.0, 300.0, 700.0, 800.0, 900.0), method=method)
    orbit = caught.value.orbit
    assert orbit.outcome == nh.Outcome.not_converged
    assert orbit.time.tolist() == [0.0, 300.0, 700.0]
    assert np.abs(np.log(2 * orbit.configuration[1:, 0, 0]) - orbit.time[1:]).max() <= 1e-6
