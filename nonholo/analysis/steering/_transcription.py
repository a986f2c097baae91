"""The search of a motion by direct transcription: guesses, what IPOPT makes of them, and what the orbit says of it.

A sparse program by IPOPT, from the wheel of casadi, which calls back for values and derivatives.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import casadi
import numpy as np

from nonholo.analysis.steering._arguments import Limits
from nonholo.analysis.steering._program import Program
from nonholo.analysis.steering._shooting import TOLERANCE
from nonholo.base.progress import go_on, is_over
from nonholo.base.types import Float

_SPREADS = (0.03, 0.3, 1.0, 2.0)  # of random bends of the first guess, in turn
_ITERATIONS = 500  # of IPOPT

_OPTIONS = {
    "ipopt.tol": 1e-9,
    "ipopt.constr_viol_tol": 1e-11,
    "ipopt.bound_relax_factor": 0.0,
    "ipopt.mu_strategy": "adaptive",
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "print_time": False,
    "error_on_fail": False,
    "show_eval_warnings": False,
    "no_nlp_grad": True,  # this and the following no one asks for
    "calc_f": False,
    "calc_g": False,
    "calc_lam_p": False,
}


class Problem(NamedTuple):
    """A program and what it belongs to.

    Attributes:
        program: Equations of all steps, and the cost.
        bounds: The least and the largest value of each unknown.
        guess: From random numbers and a spread to unknowns.
        gap_of: By what the orbit under forces, (steps, k), misses goal, obstacles and places.
    """

    program: Program
    bounds: tuple[np.ndarray, np.ndarray]
    guess: Callable[[np.random.Generator, float], np.ndarray]
    gap_of: Callable[[np.ndarray], float]


def transcribe(problem: Problem) -> tuple[Float[np.ndarray, "steps k"], float, str]:
    """Return forces, what their orbit misses, and in a word what became of the search: see `Steering.outcome`."""
    rng, searches = np.random.default_rng(0), []
    for spread in _SPREADS:
        solution = minimize(problem.program, problem.guess(rng, spread), problem.bounds, _ITERATIONS)
        forces = problem.program.split(solution.unknowns)[1]
        gap = problem.gap_of(forces)
        searches.append((gap, forces, outcome_of(solution.status, gap)))
        if searches[-1][2] == "converged":
            break
    gap, forces, outcome = min(searches, key=lambda each: (each[2] != "converged", each[0]))
    agree = all(each[2] == outcome for each in searches)
    return forces, gap, "not found" if outcome == "infeasible" and not agree else outcome


def outcome_of(status: str, gap: float) -> str:
    """Return the word for what an orbit misses and why IPOPT stopped."""
    if gap < TOLERANCE:
        return "converged" if status == "Solve_Succeeded" else "not least"
    return "infeasible" if status == "Infeasible_Problem_Detected" else "not found"


def bounds_of(program: Program, limits: tuple[np.ndarray, np.ndarray], pins: dict[int, dict[int, Any]]) -> Any:
    """Return bounds of all unknowns: those of forces, and of numbers of states that are fixed after a step."""
    inner, forces, states = (program.steps.nodes.sizes[i] for i in (1, 2, 0))
    both = []
    for limit, free in zip(limits, (-np.inf, np.inf), strict=True):
        each = np.full((len(program.rows), inner + forces + states), free)
        each[:, inner : inner + forces] = limit.reshape(-1, forces)
        for step, numbers in pins.items():
            each[step - 1, [inner + forces + at for at in numbers]] = list(numbers.values())
        both.append(each.ravel())
    return tuple(both)


class Solution(NamedTuple):
    """Where IPOPT stopped: unknowns, its word for why, and the number of iterations."""

    unknowns: Float[np.ndarray, "n"]
    status: str
    iterations: int


def minimize(program: Program, guess: Float[np.ndarray, "n"], bounds: Limits, iterations: int) -> Solution:
    """Return unknowns between bounds that meet the conditions of a program with least effort, from a guess."""
    numbers, one, nothing = (casadi.Sparsity.dense(size) for size in (program.unknowns, 1, 0))
    conditions = casadi.Sparsity.dense(len(program.limits[0]))
    slopes, curvatures = map(_sparsity, (program.slope_places, program.curvature_places))

    def slope_values(u: np.ndarray, _: Any) -> tuple[Any, ...]:
        return program.conditions(u), program.slopes(u).data

    def curvature_values(u: np.ndarray, _: Any, weight: np.ndarray, weights: np.ndarray) -> tuple[Any, ...]:
        return (program.curvatures(u, weights, weight[0]).data,)

    f = _Call("f", (numbers,), (one,), lambda u: program.cost(u)[:1])
    g = _Call("g", (numbers,), (conditions,), lambda u: (program.conditions(u),))
    calls = {
        "grad_f": _Call("grad_f", (numbers, nothing), (one, numbers), lambda u, _: program.cost(u)),
        "jac_g": _Call("jac_g", (numbers, nothing), (conditions, slopes), slope_values),
        "hess_lag": _Call("hess_lag", (numbers, nothing, one, conditions), (curvatures,), curvature_values),
    }
    state = numbers, one, conditions, numbers, conditions, nothing
    calls["iteration_callback"] = _Call("stop", state, (one,), lambda *_: (float(is_over()),))
    u = casadi.MX.sym("u", program.unknowns)
    options = {**_OPTIONS, **calls, "ipopt.max_iter": iterations}
    solver = casadi.nlpsol("steer", "ipopt", {"x": u, "f": f(u), "g": g(u)}, options)
    result = solver(x0=guess, lbx=bounds[0], ubx=bounds[1], lbg=program.limits[0], ubg=program.limits[1])
    stats = solver.stats()
    go_on()
    if stats["return_status"] == "NonIpopt_Exception_Thrown":  # by a call back, or by the keyboard
        raise next((call.failure for call in (f, g, *calls.values()) if call.failure), KeyboardInterrupt())
    return Solution(np.array(result["x"]).ravel(), stats["return_status"], stats["iter_count"])


def _sparsity(places: Any) -> Any:
    rows, columns = places.shape
    return casadi.Sparsity(rows, columns, places.columns.tolist(), places.rows.tolist())


class _Call(casadi.Callback):
    """A function of NumPy arrays, the nonzeros of its arguments, as one of casadi."""

    def __init__(self, name: str, into: tuple[Any, ...], out: tuple[Any, ...], function: Callable[..., Any]) -> None:
        casadi.Callback.__init__(self)
        self.into, self.out, self.function = into, out, function
        self.failure: BaseException | None = None
        self.construct(name, {})

    def get_n_in(self) -> int:
        """Return the number of arguments."""
        return len(self.into)

    def get_n_out(self) -> int:
        """Return the number of values."""
        return len(self.out)

    def get_sparsity_in(self, k: int) -> Any:
        """Return the shape of an argument."""
        return self.into[k]

    def get_sparsity_out(self, k: int) -> Any:
        """Return the shape of a value."""
        return self.out[k]

    def eval(self, arguments: Any) -> list[Any]:
        """Return the values."""
        try:
            values = self.function(*(np.array(each.nonzeros()) for each in arguments))
        except BaseException as failure:
            self.failure = failure
            raise
        return [casadi.DM(shape, value) for shape, value in zip(self.out, values, strict=True)]
