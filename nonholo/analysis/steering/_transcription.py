"""The search of a motion by direct transcription: guesses, what IPOPT makes of them, and what the orbit says of it."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from nonholo.analysis.steering._ipopt import minimized
from nonholo.analysis.steering._program import Program
from nonholo.analysis.steering._shooting import TOLERANCE
from nonholo.base.types import Float

_SPREADS = (0.03, 0.3, 1.0, 2.0)  # of random bends of the first guess, in turn
_ITERATIONS = 500  # of IPOPT


class Problem(NamedTuple):
    """A program and what it belongs to.

    Attributes:
        program: Equations of all steps, and the cost.
        bounds: The least and the largest value of each unknown.
        guess: From random numbers and a spread to unknowns.
        missed: By what the orbit under forces, (steps, k), misses goal, obstacles and places.
    """

    program: Program
    bounds: tuple[np.ndarray, np.ndarray]
    guess: Callable[[np.random.Generator, float], np.ndarray]
    missed: Callable[[np.ndarray], float]


def transcribed(problem: Problem) -> tuple[Float[np.ndarray, "steps k"], float, str]:
    """Return forces, what their orbit misses, and in a word what became of the search: see `Steering.outcome`."""
    rng, found = np.random.default_rng(0), []
    for spread in _SPREADS:
        solution = minimized(problem.program, problem.guess(rng, spread), problem.bounds, _ITERATIONS)
        forces = problem.program.split(solution.unknowns)[1]
        gap = problem.missed(forces)
        found.append((gap, forces, outcome_of(solution.status, gap)))
        if found[-1][2] == "converged":
            break
    gap, forces, outcome = min(found, key=lambda each: (each[2] != "converged", each[0]))
    agree = all(each[2] == outcome for each in found)
    return forces, gap, "not found" if outcome == "infeasible" and not agree else outcome


def outcome_of(status: str, gap: float) -> str:
    """Return the word for what an orbit misses and why IPOPT stopped."""
    if gap < TOLERANCE:
        return "converged" if status == "Solve_Succeeded" else "not least"
    return "infeasible" if status == "Infeasible_Problem_Detected" else "not found"


def bounded(program: Program, limits: tuple[np.ndarray, np.ndarray], fixed: dict[int, dict[int, Any]]) -> Any:
    """Return bounds of all unknowns: those of forces, and of numbers of states that are fixed after a step."""
    inner, forces, states = (program.steps.nodes.sizes[i] for i in (1, 2, 0))
    both = []
    for limit, free in zip(limits, (-np.inf, np.inf), strict=True):
        each = np.full((len(program.rows), inner + forces + states), free)
        each[:, inner : inner + forces] = limit.reshape(-1, forces)
        for step, numbers in fixed.items():
            each[step - 1, [inner + forces + at for at in numbers]] = list(numbers.values())
        both.append(each.ravel())
    return tuple(both)
