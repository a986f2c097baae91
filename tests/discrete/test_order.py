"""The discrete map against the continuous motion it discretizes: second order in momenta and pose."""

import numpy as np
import pytest
from problems import PROBLEMS, Problem

import nonholo as nh

TIME = 3.0
STEPS = (150, 300, 600, 1200)
QUANTITIES = {
    "matrix momentum": ("matrix", "restricted_momentum"),
    "matrix pose": ("matrix", "configuration"),
    "logarithmic momentum": ("logarithmic", "restricted_momentum"),
    "logarithmic pose": ("logarithmic", "configuration"),
}


@pytest.mark.profile("routes", keep=["*-matrix *"])
@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda p: p.name)
def test_slope_two(problem: Problem, quantity: str) -> None:
    """Halving the step divides the error at a fixed time by four: slope 2.0 +- 0.1 on a log-log line."""
    difference, name = QUANTITIES[quantity]
    start = {"restricted_velocity": problem.restricted_velocity}
    exact = nh.flow(problem.system, times=[0.0, TIME], rtol=1e-13, atol=1e-15, **start)
    errors = []
    for n in STEPS:
        discrete = nh.discretize(problem.system, TIME / n, difference=difference)
        orbit = nh.simulate(discrete, steps=n, save_every=n, **start)
        errors.append(np.abs(getattr(orbit, name)[-1] - getattr(exact, name)[-1]).max())
    if max(errors) < 1e-12:  # steady motions without a force are exact
        assert "balanced" in problem.tags
        return
    slope = -np.polyfit(np.log(STEPS), np.log(errors), 1)[0]
    assert abs(slope - 2.0) <= 0.1
