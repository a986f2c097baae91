"""Speed, error and energy error of schemes that take the same number of equal steps as the library's map."""

import statistics
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from _command import small

from peers.compiled import compiled_midpoint
from peers.exudyn_sleigh import ExudynSleigh
from peers.problems import (
    Problem,
    State,
    by_library,
    energy_error,
    error,
    in_turns,
    last,
    median_ratio,
    quaternion_matrix,
    reference,
)
from peers.schemes import SCHEMES
from peers.solvers import missing

END, STEPS, LONG = 20.0, 400, small(1_000_000, 2_000)
HEADER = ("scheme", "us/step", "steps/s", "times slower", "times slower, 400 steps", "error", "energy error", "order")
SAME_MAP = 1e-9  # largest difference of two routes to the same map

Result = tuple[State, np.ndarray]  # the end, and body velocities at all steps


class Scheme(NamedTuple):
    """What is compared: how it is checked, and what is timed."""

    name: str
    states: Callable[[float, int], Result]
    timed: Callable[[], object]
    steps: int = STEPS


def end_of(velocities: np.ndarray, poses: np.ndarray) -> Result:
    """Return the result of a scheme with matrices or quaternions as poses."""
    pose = poses[-1] if poses.ndim == 3 else quaternion_matrix(poses[-1])
    return State(velocities[-1], pose), velocities


def library(problem: Problem, steps: int) -> Scheme:
    """Return the library, everything stored, as a scheme."""

    def states(h: float, n: int) -> Result:
        orbit = by_library(problem, h, n)
        return last(orbit), orbit.body_velocity

    return Scheme(f"nonholo, {steps} steps in one call", states, lambda: by_library(problem, END / STEPS, steps), steps)


def from_function(problem: Problem, name: str, run: Callable, steps: int = STEPS) -> Scheme:
    """Return a scheme that is one function of problem, step and number of steps."""
    return Scheme(
        name, lambda h, n: end_of(*run(problem, h, n)), lambda: run(problem, END / STEPS, steps), steps
    )  # fmt: skip


def exudyn(problem: Problem) -> Scheme:
    """Return Exudyn: checked with all steps stored, timed without."""
    bare = ExudynSleigh(problem, END / STEPS, STEPS, stored=False)

    def states(h: float, n: int) -> Result:
        model = ExudynSleigh(problem, h, n, stored=True)
        model.run()
        return end_of(*model.states())

    return Scheme("Exudyn, rolling-disc joint, generalized alpha, nothing stored", states, bare.run)


def schemes(problem: Problem, skip: set[str]) -> tuple[list[Scheme], list[str]]:
    """Return all schemes for a body, the library first, and lines about those left out."""
    result, left_out = [library(problem, LONG), library(problem, STEPS)], []
    result += [from_function(problem, name, run) for name, run in SCHEMES[problem.name].items()]
    if problem.name == "Suslov top":
        name = "midpoint retraction, written for one body and compiled by numba"
        result.append(from_function(problem, name, compiled_midpoint, LONG))
        return result, left_out
    reason = "skipped on request" if "exudyn" in skip else missing("exudyn")
    if reason:
        left_out.append(f"Exudyn: {reason}.")
    else:
        result.append(exudyn(problem))
    return result, left_out


def check_same_map(problem: Problem) -> None:
    """Refuse to continue unless the map solved step by step agrees with the library at every step."""
    orbit = by_library(problem, END / STEPS, STEPS)
    run = next(iter(SCHEMES[problem.name].values()))
    velocities, poses = run(problem, END / STEPS, STEPS)
    for ours, theirs in ((orbit.body_velocity, velocities), (orbit.configuration, poses)):
        assert np.allclose(ours, theirs, rtol=0, atol=SAME_MAP)


def rows(problem: Problem, skip: set[str], rounds: int) -> tuple[list[tuple], list[str]]:
    """Return the rows of the table and lines about what was left out."""
    check_same_map(problem)
    compared, left_out = schemes(problem, skip)
    wanted, h = reference(problem, END), END / STEPS
    measured = []
    for scheme in compared:
        coarse = error(problem, scheme.states(h, STEPS)[0], wanted)
        fine = error(problem, scheme.states(h / 2, 2 * STEPS)[0], wanted)
        order = np.log2(coarse / fine)
        assert 1.8 < order < 2.2, f"{scheme.name} does not converge to the same motion: {coarse}, {fine}"
        measured.append((coarse, energy_error(problem, scheme.states(h, STEPS)[1]), order))
    for scheme in compared:
        scheme.timed()
    times = in_turns({scheme.name: scheme.timed for scheme in compared}, rounds)
    per_step = {scheme.name: [t / scheme.steps for t in times[scheme.name]] for scheme in compared}
    table = []
    for scheme, (missed, energy, order) in zip(compared, measured, strict=True):
        each = per_step[scheme.name]
        durations = statistics.median(each)
        ratios = [f"{median_ratio(each, per_step[ours.name]):.3g}" for ours in compared[:2]]
        row = (scheme.name, f"{1e6 * durations:.3g}", f"{1 / durations:.2g}", *ratios, f"{missed:.2g}", f"{energy:.0e}")
        table.append((*row, f"{order:.2f}"))
    return table, left_out
