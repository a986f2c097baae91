"""The discrete map against the continuous motion it discretizes: second order in momenta and pose."""

import numpy as np
import pytest
from problems import PROBLEMS, Problem

import nonholo as nh

TIME = 3.0
STEPS = (150, 300, 600, 1200)
QUANTITIES = ("restricted_momentum", "configuration")


@pytest.mark.profile("routes", cases=["*logarithmic"])
@pytest.mark.parametrize("difference", ["matrix", "logarithmic"])
@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda p: p.name)
def test_slope_two(problem: Problem, difference: str) -> None:
    """Halving the step divides the errors at a fixed time by four: slope 2.0 +- 0.1 on a log-log line."""
    start, errors = {"restricted_velocity": problem.restricted_velocity}, []
    exact = nh.flow(problem.system, times=[0.0, TIME], rtol=1e-13, atol=1e-15, **start)
    for n in STEPS:
        end = nh.simulate(nh.discretize(problem.system, TIME / n, difference), steps=n, save_every=n, **start)
        errors.append([np.abs(getattr(end, name)[-1] - getattr(exact, name)[-1]).max() for name in QUANTITIES])
    for column in np.transpose(errors):
        if column.max() < 1e-12:  # steady motions without a force are exact
            assert "balanced" in problem.tags
        else:
            assert abs(-np.polyfit(np.log(STEPS), np.log(column), 1)[0] - 2.0) <= 0.1
