"""The search of a motion by direct transcription: guesses, what IPOPT makes of them, and what the orbit says of it.

A sparse program by IPOPT, from the wheel of casadi, which calls back for values and derivatives.
"""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any, NamedTuple, cast

import casadi
import equinox
import jax
import jax.numpy as jnp
import numpy as np
from scipy import sparse

from nonholo.analysis.steering._arguments import Limits, StateBounds
from nonholo.analysis.steering._shooting import TOLERANCE
from nonholo.base.progress import go_on, is_over
from nonholo.base.types import Array, Float
from nonholo.discrete.definition import in_double

_SAMPLES = 3  # random points at which an entry of a derivative vanishes only if it does everywhere


class Steps(NamedTuple):
    """Numbers that all steps share.

    Attributes:
        nodes: Unknowns and equations of a step.
        centers: Of obstacles, (obstacles, n).
        radii: Of obstacles.
        time_step: h, the weight of the cost.
        bounds: Of states after steps, None where they are free.
    """

    nodes: Any
    centers: Float[Array, "obstacles n"]
    radii: Float[Array, "obstacles"]
    time_step: Array
    bounds: StateBounds

    def parts(self, window: Array) -> tuple[Array, ...]:
        """Return state, inner part, forces and the state after them."""
        states, inner, controls = self.nodes.sizes
        return tuple(jnp.split(window, np.cumsum([states, inner, controls])))

    def conditions(self, window: Array, row: Array) -> Array:
        r"""Return equations of a step, clearances $(|x - c|^2 - \rho^2)/2\rho$ after it, and what is bounded."""
        x, z, f, after = self.parts(window)
        states = self.bounds.rows @ self.nodes.numbers(z, after)
        return jnp.concatenate([self.nodes.residual(x, z, f, after, row), self.clearances(after), states])

    def clearances(self, x: Array) -> Array:
        """Return the distance of points from obstacles, exact in the first order where that is little."""
        if not len(self.radii):
            return jnp.zeros(0)
        apart = self.nodes.places(x)[:, None] - self.centers
        return ((jnp.sum(apart**2, axis=-1) - self.radii**2) / (2 * self.radii)).ravel()

    def lagrangian(self, window: Array, row: Array, weights: Array, weight: Array) -> Array:
        """Return the weighted sum of the effort of a step and its conditions."""
        f = self.parts(window)[2]
        return weight * (self.time_step * f @ f / 2) + weights @ self.conditions(window, row)


@equinox.filter_jit
def _values(steps: Steps, windows: Array, rows: Array, last: Array) -> Any:
    return jax.vmap(steps.conditions)(windows, rows), steps.nodes.goal_gap(last)


@equinox.filter_jit
def _slopes(steps: Steps, windows: Array, rows: Array, last: Array) -> Any:
    return jax.vmap(jax.jacfwd(steps.conditions))(windows, rows), jax.jacfwd(steps.nodes.goal_gap)(last)


@equinox.filter_jit
def _curvatures(steps: Steps, windows: Array, rows: Array, last: Array, weights: Any, weight: Array) -> Any:
    hessian = jax.vmap(jax.hessian(steps.lagrangian), in_axes=(0, 0, 0, None))
    return hessian(windows, rows, weights[0], weight), jax.hessian(lambda x: weights[1] @ steps.nodes.goal_gap(x))(last)


@dataclasses.dataclass(frozen=True, eq=False)
class Program:
    """The least effort under the equations of all steps, clearances and a goal.

    Attributes:
        steps: The data that all steps share.
        first: The state at the start.
        rows: Body covectors that act in the steps beside the forces, (steps, size).
    """

    steps: Steps
    first: Float[np.ndarray, "x"]
    rows: Float[np.ndarray, "steps size"]

    @functools.cached_property
    def width(self) -> int:
        """The number of unknowns of a step."""
        return sum(self.steps.nodes.sizes)

    @functools.cached_property
    def shape(self) -> tuple[int, int]:
        """Numbers of conditions of a step and of conditions at the end."""
        values, end = self._call(_values, np.zeros(self.unknowns))
        return values.shape[1], len(end)

    @functools.cached_property
    def limits(self) -> tuple[np.ndarray, ...]:
        """The least and the largest value of each condition: zero of equations, infinity above of clearances."""
        (count, ends), bounds = self.shape, self.steps.bounds
        clear = np.zeros(len(self.steps.radii) * self.steps.nodes.outline.shape[0])
        zeros = np.zeros(count - len(clear) - len(bounds.low))
        steps = np.concatenate([zeros, clear, bounds.low]), np.concatenate([zeros, clear + np.inf, bounds.high])
        return tuple(np.append(np.tile(each, len(self.rows)), np.zeros(ends)) for each in steps)

    @property
    def unknowns(self) -> int:
        """The number of unknowns."""
        return self.width * len(self.rows)

    @functools.cached_property
    def windows(self) -> np.ndarray:
        """Indices of the unknowns of each step, (steps, window); negative ones are of the first state."""
        size = len(self.first)
        return np.arange(len(self.rows))[:, None] * self.width + np.arange(-size, self.width)

    def split(self, u: Float[np.ndarray, "n"]) -> list[np.ndarray]:
        """Return inner parts, forces and states after steps, each (steps, size)."""
        return np.split(u.reshape(len(self.rows), -1), np.cumsum(self.steps.nodes.sizes[1:]), axis=1)

    def conditions(self, u: Float[np.ndarray, "n"]) -> Float[np.ndarray, "c"]:
        """Return equations and clearances, step by step, then what is missed at the end."""
        values, end = self._call(_values, u)
        return np.concatenate([values.ravel(), end])

    def units(self, u: Float[np.ndarray, "n"]) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "c"]]:
        """Return units of unknowns, alike for all steps, and of conditions, as powers of two.

        They are the largest numbers in u; where there are none, those that change conditions by as much as the others.
        """
        J = abs(cast(Any, self.slopes(u)))
        unit = np.tile(np.abs(u.reshape(len(self.rows), -1)).max(axis=0), len(self.rows))
        others = (J / _power((J * unit).max(axis=1).toarray())[:, None]).max(axis=0).toarray()
        unit = _power(np.where(unit > 0, unit, 1 / _power(others)))
        return unit, _power((J * unit).max(axis=1).toarray())

    def cost(self, u: Float[np.ndarray, "n"]) -> tuple[float, Float[np.ndarray, "n"]]:
        """Return the effort and its derivative."""
        forces, slope, h = self.split(u)[1], np.zeros(len(u)), float(self.steps.time_step)
        self.split(slope)[1][:] = h * forces
        return h * float((forces**2).sum()) / 2, slope

    def slopes(self, u: Float[np.ndarray, "n"]) -> sparse.csc_array:
        """Return the derivatives of the conditions."""
        return self.slope_places.matrix(self._call(_slopes, u))

    def curvatures(self, u: Float[np.ndarray, "n"], weights: np.ndarray, weight: float) -> sparse.csc_array:
        """Return the upper triangle of the second derivatives of a weighted sum of cost and conditions."""
        ends = self.shape[1]
        both = weights[: len(weights) - ends].reshape(len(self.rows), -1), weights[len(weights) - ends :]
        return self.curvature_places.matrix(self._call(_curvatures, u, both, np.float64(weight)))

    def _call(self, function: Any, u: np.ndarray, *more: Any) -> Any:
        whole = np.concatenate([self.first, u])
        windows, last = whole[self.windows + len(self.first)], whole[-len(self.first) :]
        return in_double(function, self.steps, windows, self.rows, last, *more)

    @functools.cached_property
    def slope_places(self) -> "_Places":
        """Where the derivatives of the conditions stand."""
        (count, ends), steps, window = self.shape, len(self.rows), self.windows
        row = np.arange(steps * count).reshape(steps, count, 1)
        end = np.arange(steps * count, steps * count + ends)[:, None]
        places = (row, window[:, None]), (end, window[-1, -len(self.first) :])
        return _Places.of(*places, self._pattern(_slopes, ()), (steps * count + ends, self.unknowns))

    @functools.cached_property
    def curvature_places(self) -> "_Places":
        """Where the second derivatives stand."""
        rng, (count, ends) = np.random.default_rng(1), self.shape
        weights = rng.normal(size=(len(self.rows), count)), rng.normal(size=ends)
        pattern, window = self._pattern(_curvatures, (weights, np.float64(1.0))), self.windows
        last = window[-1, -len(self.first) :]
        places = (window[:, :, None], window[:, None]), (last[:, None], last)
        return _Places.of(*places, pattern, (self.unknowns, self.unknowns), upper=True)

    def _pattern(self, function: Any, more: tuple[Any, ...]) -> tuple[np.ndarray, np.ndarray]:
        """Return which entries of the derivatives of a step, and at the end, do not vanish everywhere."""
        rng = np.random.default_rng(0)
        samples = [self._call(function, rng.normal(size=self.unknowns), *more) for _ in range(_SAMPLES)]
        step = np.any([np.any(part != 0, axis=0) for part, _ in samples], axis=0)
        end = np.any([part != 0 for _, part in samples], axis=0)
        return np.broadcast_to(step, samples[0][0].shape), end


def _power(sizes: np.ndarray) -> np.ndarray:
    """Return the nearest powers of two, 1 of nothing."""
    return np.exp2(np.round(np.log2(np.where(sizes > 0, sizes, 1.0))))


class _Places(NamedTuple):
    """Where the entries of the derivatives of steps stand in a sparse matrix.

    Attributes:
        at: Indices of the entries that are laid out.
        places: Their rows and columns.
        shape: Of the matrix.
    """

    at: np.ndarray
    places: tuple[np.ndarray, np.ndarray]
    shape: tuple[int, int]

    @classmethod
    def of(cls, steps: Any, end: Any, pattern: Any, shape: tuple[int, int], upper: bool = False) -> "_Places":
        both = [np.broadcast_arrays(*places, mask) for places, mask in zip((steps, end), pattern, strict=True)]
        row, column, mask = (np.concatenate([part[i].ravel() for part in both]) for i in range(3))
        at = np.flatnonzero(mask & (column >= 0) & (row >= 0) & ((row <= column) | (not upper)))
        return cls(at, (row[at], column[at]), shape)

    def matrix(self, entries: tuple[np.ndarray, np.ndarray]) -> sparse.csc_array:
        """Return the matrix of entries, with those that stand at one place added."""
        return sparse.csc_array((np.concatenate([each.ravel() for each in entries])[self.at], self.places), self.shape)

    @property
    def pattern(self) -> sparse.csc_array:
        """A matrix that has the same places."""
        return sparse.csc_array((np.ones(len(self.at), dtype=bool), self.places), self.shape)


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


def transcribe(
    program: Program, bounds: Limits, guess: Callable[..., np.ndarray], gap_of: Callable[[np.ndarray], float]
) -> tuple[Float[np.ndarray, "steps k"], float, str]:
    """Return forces, what their orbit misses, and in a word what became of the search: see `Steering.outcome`.

    Args:
        program: Equations of all steps, and the cost.
        bounds: The least and the largest value of each unknown.
        guess: From random numbers and a spread to unknowns.
        gap_of: By what the orbit under forces, (steps, k), misses goal, obstacles and places.
    """
    rng, searches = np.random.default_rng(0), []
    units = program.units(guess(np.random.default_rng(0), 1.0))
    for spread in _SPREADS:
        unknowns, status = minimize(program, guess(rng, spread), bounds, units)
        forces = program.split(unknowns)[1]
        gap = gap_of(forces)
        searches.append((gap, forces, outcome_of(status, gap)))
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
    both = np.full((2, len(program.rows), inner + forces + states), [[[-np.inf]], [[np.inf]]])
    both[..., inner : inner + forces] = np.reshape(limits, (2, -1, forces))
    for step, numbers in pins.items():
        both[:, step - 1, [inner + forces + at for at in numbers]] = list(numbers.values())
    return both.reshape(2, -1)


def minimize(
    program: Program, guess: Float[np.ndarray, "n"], bounds: Limits, units: tuple[np.ndarray, np.ndarray]
) -> tuple[np.ndarray, str]:
    """Return unknowns between bounds that meet the conditions of a program with least effort, from a guess.

    IPOPT sees all of them in units.
    """
    (unit, rows), (least, most) = units, program.limits
    numbers, conditions, one, nothing = map(casadi.Sparsity.dense, (program.unknowns, len(rows), 1, 0))
    patterns: Any = program.slope_places.pattern, program.curvature_places.pattern
    slopes, curvatures = (
        casadi.Sparsity(x.shape[0], x.shape[1], x.indptr.tolist(), x.indices.tolist()) for x in patterns
    )
    scales = [(each * unit * by[:, None]).tocsc().data for each, by in zip(patterns, (1 / rows, unit), strict=True)]
    effort = max(program.cost(np.where(bounds[0] < bounds[1], unit, 0.0))[1] * unit) or 1.0

    def cost(x: np.ndarray) -> tuple[Any, ...]:
        value, slope = program.cost(x * unit)
        return value / effort, slope * unit / effort

    def slope_values(x: np.ndarray, _: Any) -> tuple[Any, ...]:
        return program.conditions(x * unit) / rows, program.slopes(x * unit).data * scales[0]

    def curvature_values(x: np.ndarray, _: Any, weight: np.ndarray, weights: np.ndarray) -> tuple[Any, ...]:
        return (program.curvatures(x * unit, weights / rows, weight[0] / effort).data * scales[1],)

    f = _Call("f", (numbers,), (one,), lambda x: cost(x)[:1])
    g = _Call("g", (numbers,), (conditions,), lambda x: (program.conditions(x * unit) / rows,))
    calls = {
        "grad_f": _Call("grad_f", (numbers, nothing), (one, numbers), lambda x, _: cost(x)),
        "jac_g": _Call("jac_g", (numbers, nothing), (conditions, slopes), slope_values),
        "hess_lag": _Call("hess_lag", (numbers, nothing, one, conditions), (curvatures,), curvature_values),
    }
    state = numbers, one, conditions, numbers, conditions, nothing
    calls["iteration_callback"] = _Call("stop", state, (one,), lambda *_: (float(is_over()),))
    u = casadi.MX.sym("u", program.unknowns)
    options = {**_OPTIONS, **calls, "ipopt.max_iter": _ITERATIONS}
    solver = casadi.nlpsol("steer", "ipopt", {"x": u, "f": f(u), "g": g(u)}, options)
    result = solver(x0=guess / unit, lbx=bounds[0] / unit, ubx=bounds[1] / unit, lbg=least / rows, ubg=most / rows)
    stats = solver.stats()
    go_on()
    if stats["return_status"] == "NonIpopt_Exception_Thrown":  # by a call back, or by the keyboard
        raise next((call.failure for call in (f, g, *calls.values()) if call.failure), KeyboardInterrupt())
    return np.array(result["x"]).ravel() * unit, stats["return_status"]


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
