"""The flow against diffrax, and where it overflows."""

import numpy as np
import pytest
from bodies import GENERAL, mass_tensor
from problems import PROBLEMS

import nonholo as nh
from nonholo.systems import AbstractSystem

RNG = np.random.default_rng(11)
HYPERBOLIC = nh.MatrixGroup([[[0.0, 1.0], [1.0, 0.0]]], form=[[1.0, 0.0], [0.0, -1.0]])
SYSTEMS: dict[str, AbstractSystem] = {
    **{problem.name: problem.system for problem in PROBLEMS},
    **{name: system for name, (system, _) in GENERAL.items()},
    "top on SO(5)": nh.SuslovTop(mass_tensor(nh.SO(5), RNG)),
    "free body on SE(3)": nh.RigidBody(mass_tensor(nh.SE(3), RNG), nh.SE(3)),
    "right-invariant on SE(2)": nh.LRSystem(nh.SE(2), mass_tensor(nh.SE(2), RNG), [[1.0, 0.2, 0.0], [0.0, 1.0, 0.3]]),
    "any inertia on a product": nh.LLSystem(
        nh.ProductGroup(nh.SE(2), nh.SO(3), nh.Translations(2)),
        constraint_subspace=RNG.normal(size=(4, 8)),
        inertia_operator=np.diag(np.arange(1.0, 9.0)),
    ),
}


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
