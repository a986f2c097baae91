"""A million states with pose, equally spaced in time: the discrete map beside samples of continuous solutions."""

import statistics
from collections.abc import Callable
from typing import Any

import numpy as np
from _command import small

from peers.problems import Problem, State, by_library, error, in_turns, last, median_ratio, reference
from peers.solvers import decoded, missing, rates, start

STATES = small(1_000_000, 200_000)
HEADER = ("method", "ns per state", "times slower", "error at the end")
TOLERANCE = 1e-12
OURS = "nonholo, map of order 2"


def by_heyoka(problem: Problem) -> Callable[[], State]:
    """Return samples of heyoka's Taylor solution."""
    import heyoka

    names = [f"z{i}" for i in range(len(start(problem)))]
    z = heyoka.make_vars(*names)
    equations = list(zip(z, rates(problem, heyoka.cos, heyoka.sin)(z), strict=True))
    integrator = heyoka.taylor_adaptive(equations, start(problem), tol=TOLERANCE)
    grid = np.linspace(0, problem.end, STATES + 1)

    def run() -> State:
        integrator.time = 0.0
        integrator.state[:] = start(problem)
        return decoded(integrator.propagate_grid(grid)[-1][-1])

    return run


def by_scipy(problem: Problem) -> Callable[[], State]:
    """Return samples of scipy's DOP853."""
    from scipy.integrate import solve_ivp

    rate, grid = rates(problem), np.linspace(0, problem.end, STATES + 1)

    def run() -> State:
        result = solve_ivp(
            lambda _t, z: rate(z.tolist()), (0, problem.end), start(problem),
            method="DOP853", t_eval=grid, rtol=TOLERANCE, atol=TOLERANCE,
        )  # fmt: skip
        return decoded(result.y[:, -1])

    return run


PEERS = {"heyoka Taylor, propagate_grid": (by_heyoka, "heyoka"), "scipy DOP853, t_eval": (by_scipy, "scipy")}


def rows(problem: Problem, skip: set[str], rounds: int) -> tuple[list[tuple], list[str]]:
    """Return the rows of the table and lines about what was left out."""
    runs: dict[str, Callable[[], Any]] = {OURS: lambda: by_library(problem, problem.end / STATES, STATES)}
    left_out = []
    for name, (make, module) in PEERS.items():
        reason = "skipped on request" if module in skip else missing(module)
        if reason:
            left_out.append(f"{name}: {reason}.")
        else:
            runs[name] = make(problem)
    wanted = reference(problem, problem.end)
    ends = {name: last(run()) if name == OURS else run() for name, run in runs.items()}
    errors = {name: error(problem, end, wanted) for name, end in ends.items()}
    assert max(errors.values()) < 1e-5, errors
    times = in_turns(runs, rounds)
    return [
        (
            name,
            f"{statistics.median(durations) / STATES * 1e9:.3g}",
            f"{median_ratio(durations, times[OURS]):.3g}",
            f"{errors[name]:.1e}",
        )
        for name, durations in times.items()
    ], left_out
