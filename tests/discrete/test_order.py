"""The discrete map against the continuous motion it discretizes: second order in momenta and pose."""

import numpy as np
import pytest
from bodies import GENERAL
from problems import PROBLEMS

import nonholo as nh

STEPS = (50, 100, 200, 400)
QUANTITIES = ("restricted_momentum", "configuration")
BODIES = {problem.name: (problem.system, problem.restricted_velocity) for problem in PROBLEMS} | GENERAL
CASES = [*((name, "matrix") for name in BODIES), *((problem.name, "logarithmic") for problem in PROBLEMS)]
ELSEWHERE = ["*-logarithmic", *(f"{name}-matrix" for name in GENERAL if name != "suslov 4")]


@pytest.mark.profile("routes", cases=ELSEWHERE)
@pytest.mark.parametrize(("name", "difference"), CASES)
def test_slope_two(name: str, difference: str) -> None:
    """Halving the step divides the errors at a fixed time by four: slope 2.0 +- 0.1 on a log-log line."""
    (system, velocity), errors = BODIES[name], []
    start = {"restricted_velocity": velocity, "configuration": system.group.random(np.random.default_rng(6))}
    exact = nh.flow(system, times=[0.0, 1.0], rtol=1e-13, atol=1e-15, **start)
    for n in STEPS:
        end = nh.simulate(nh.discretize(system, 1 / n, difference), steps=n, save_every=n, **start)
        errors.append([np.abs(getattr(end, each)[-1] - getattr(exact, each)[-1]).max() for each in QUANTITIES])
    for column in np.transpose(errors):
        if column.max() < 1e-12:  # steady motions without a force, and momenta that are conserved, are exact
            assert "balanced" in name or "normal" in name or "flat" in name or name in GENERAL
        else:
            assert abs(-np.polyfit(np.log(STEPS), np.log(column), 1)[0] - 2.0) <= 0.1
