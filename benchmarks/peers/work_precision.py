"""Time against error at the end of a run: general solvers, `nh.flow`, and the discrete map of all orders."""

import statistics
from collections.abc import Callable
from typing import NamedTuple

from _command import small

import nonholo as nh
from peers.problems import Problem, State, by_library, error, last, reference, seconds
from peers.solvers import SOLVERS, missing

TARGETS = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
TOLERANCES = [10.0**-k for k in range(3, 15)]
LARGEST = 1 << small(21, 18)  # steps of the discrete map
HEADER = ("method", *(f"{target:.0e}" for target in TARGETS), "first call")


class Method(NamedTuple):
    """A way to the state at the end, and its settings from coarse to fine."""

    name: str
    solve: Callable[[float], State]
    settings: list[float]
    preparation: float = 0.0


def library_methods(problem: Problem) -> tuple[list[Method], list[str]]:
    """Return the orders of the map that this version has, and the flow."""
    result, left_out = [], []
    for order in (2, 4, 6, 8):
        try:
            nh.discretize(problem.system, 0.1, order=order)
        except ValueError:
            left_out.append(f"nonholo, order {order}: not in this version.")
            continue
        steps = [float(64 << k) for k in range(30) if 64 << k <= LARGEST // (order // 2) ** 2]

        def solve(n: float, order: int = order) -> State:
            return last(by_library(problem, problem.end / n, round(n), save_every=round(n), order=order))

        result.append(Method(f"nonholo, map of order {order}", solve, steps))
    times = (0.0, problem.end)

    arguments, reached = {"body_velocity": problem.velocity, "times": times}, [t for t in TOLERANCES if t >= 1e-14]
    for name, method in (("nonholo flow", None), ("nonholo flow, diffrax", "diffrax")):

        def flow(tolerance: float, method: str | None = method) -> State:
            return last(nh.flow(problem.system, **arguments, rtol=tolerance, atol=tolerance, method=method))

        result.append(Method(name, flow, reached))
    return result, left_out


def solver_methods(problem: Problem, skip: set[str]) -> tuple[list[Method], list[str]]:
    """Return the solvers that are installed and asked for."""
    result, left_out = [], []
    for name, (make, modules) in SOLVERS.items():
        if "PyDy" in name and problem.name == "Suslov top":
            continue
        reason = "skipped on request" if modules[0] in skip else missing(*modules)
        if reason:
            left_out.append(f"{name}: {reason}.")
            continue
        solvers: list[Callable[[float], State]] = []
        preparation = seconds(lambda make=make, solvers=solvers: solvers.append(make(problem)))
        usable = [t for t in TOLERANCES if t >= 1e-13 or "PyDy" not in name]  # odeint refuses less
        result.append(Method(name, solvers[0], usable, preparation))
    return result, left_out


def measure(problem: Problem, method: Method, wanted: State, rounds: int) -> tuple[list[tuple[float, float]], float]:
    """Return errors and median times of all settings, and the time of the first call with all that precedes it."""
    first = method.preparation + seconds(lambda: method.solve(method.settings[-1]))
    measured = []
    for setting in method.settings:
        try:
            missed = error(problem, method.solve(setting), wanted)
        except nh.OutcomeError:  # the map folds at steps this long, and says so
            continue
        measured.append((missed, statistics.median(seconds(lambda s=setting: method.solve(s)) for _ in range(rounds))))
        if missed <= TARGETS[-1]:
            break
    return measured, first


def rows(problem: Problem, skip: set[str], rounds: int) -> tuple[list[tuple], list[str]]:
    """Return, for each method and target, the least time in milliseconds with which the target was met."""
    wanted = reference(problem, problem.end)
    ours, ours_out = library_methods(problem)
    theirs, theirs_out = solver_methods(problem, skip)
    table = []
    for method in ours + theirs:
        measured, first = measure(problem, method, wanted, rounds)
        assert min(missed for missed, _ in measured) < 1e-5, f"{method.name} computes another motion"
        best = [min((time for missed, time in measured if missed <= target), default=None) for target in TARGETS]
        table.append((method.name, *("-" if x is None else f"{1e3 * x:.3g}" for x in best), f"{first:.2g} s"))
    return table, ours_out + theirs_out
