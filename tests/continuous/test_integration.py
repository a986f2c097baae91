"""The flow against diffrax; the compiled Runge-Kutta method, for constraints in space, against scipy's; overflow."""

import numpy as np
import pytest
from bodies import GENERAL, mass_tensor
from problems import PROBLEMS
from scipy.integrate import DOP853, solve_ivp

import nonholo as nh
from nonholo.continuous._integration import space_flow
from nonholo.kernels import solve
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


@pytest.mark.parametrize("name", [name for name, system in SYSTEMS.items() if system.is_spatial])
def test_a_step_is_that_of_scipy(name: str) -> None:
    """One step of the equations as the vector field states them, by scipy's class, agrees to 500 roundings."""
    system, span = SYSTEMS[name], 0.3
    r = RNG.normal(size=len(system.constraint_subspace))
    field, start = nh.vector_field(system), np.concatenate([r, system.group.identity.ravel()])
    steps = DOP853(field, 0.0, start, span, first_step=span, rtol=1e6, atol=1e6)
    steps.step()
    assert steps.status == "finished"
    (_, end) = solve(space_flow(system, r, False), start[len(r) :], np.array([0.0, span]), (1e6, 1e6))
    large = np.abs(field(0.0, start)).max() * span + np.abs(steps.y).max()
    assert np.abs(end - steps.y[len(r) :]).max() <= 1e-13 * large


@pytest.mark.parametrize("rtol", [1e-4, 1e-7, 1e-10])
def test_the_error_is_that_which_scipy_makes(rtol: float) -> None:
    """Over many steps the error is that of scipy's steps under the same tolerances, within a factor 10."""
    system, r, ends = SYSTEMS["right-invariant on SE(2)"], np.array([0.9, -0.4]), np.array([0.0, 30.0])
    start = np.concatenate([r, np.eye(3).ravel()])
    exact, scipys = (
        solve_ivp(nh.vector_field(system), ends, start, "DOP853", rtol=tolerance, atol=tolerance / 100).y[2:, -1]
        for tolerance in (1e-13, rtol)
    )
    found = solve(space_flow(system, r, False), start[2:], ends, (rtol, rtol / 100))[-1]
    assert np.abs(found - exact).max() <= 10 * np.abs(scipys - exact).max()


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
