r"""`fit`: the numbers of a body, and how it started, from recorded motion, by least squares with exact derivatives."""

import dataclasses
import functools
import importlib
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from scipy.special import stdtrit

from nonholo.analysis.inverse._likelihood import LOSSES, Problem, Ranges, Search, Shapes, Solution, by_name
from nonholo.analysis.inverse._measurements import WHERE, kinds_of
from nonholo.analysis.inverse._profile import Minimum, Profile, profile_of
from nonholo.base.checks import array, choice, error, function, instance, needs, number, pair, scale, shown
from nonholo.base.results import result
from nonholo.base.types import Array, Float
from nonholo.orbit import Orbit
from nonholo.systems import System

_FLAT = 1e-10  # least singular value of scaled derivatives, relative to the largest
_LEAST_FREE = 0.1  # numbers of a kind that tell its noise


@result
class Fit:
    """A body fitted to recorded motion.

    Attributes:
        parameters: The fitted numbers by name.
        covariance: Of all of them, in the order of the guess, arrays row by row; the starts are marginalized. It is
            somewhat wider than that of known noise, by Kenward and Roger, where noise levels are estimated.
        system: `system_of(parameters)`.
        orbit: The fitted motion, a discrete orbit; of several trials a tuple of them. Time 0 is the first sample's.
        residuals: Measured minus fitted numbers of each trial by kind, as "position", "turn" and "rate", (K, ...); NaN
            where nothing was measured. A turn in space is the vector of the rotation from the fitted pose.
        noise: Standard deviation of the noise of each kind, estimated or given.
        outcome: "converged": the loss is least nearby, and the noise levels have settled. "lost": residuals are many
            times the noise, which is given or that from sample to sample, turns are off by a radian and more, or a
            parameter went to infinity; begin nearer, or look for outliers, wrong units and what the model lacks.
            "not_converged": neither, such as a parameter at the end of its bounds. Only intervals of a fit that has
            converged mean something.
        degrees: Degrees of freedom of each parameter's error, by Satterthwaite; infinite where noise is given.
        samples: Measured numbers less fitted ones.
        minimum: The sum of squares about the fitted point, parameters, then starts, for profiles; None after pickling.
    """

    parameters: dict[str, Any]
    covariance: Float[np.ndarray, "P P"]
    system: System
    orbit: Orbit | tuple[Orbit, ...]
    residuals: tuple[dict[str, np.ndarray], ...] = dataclasses.field(repr=False)
    noise: dict[str, float]
    outcome: str
    degrees: Float[np.ndarray, "P"]
    samples: int
    minimum: Minimum | None = dataclasses.field(repr=False)

    def __getstate__(self) -> dict[str, Any]:
        """Leave out what calls functions of the user's: a fit is sent and kept without it."""
        return {**vars(self), "minimum": None}

    @property
    def intervals(self) -> dict[str, tuple[Any, Any]]:
        """Intervals that hold each parameter with a probability of 95 %, if the noise is normal and the model right.

        They are those of the linearized model, with Student's quantile at the `degrees` of each parameter. `profile`
        has those of the likelihood itself.
        """
        half, ends, at = stdtrit(self.degrees, 0.975) * np.sqrt(self.covariance.diagonal()), {}, 0
        for name, value in self.parameters.items():
            width = half[at : at + np.size(value)].reshape(np.shape(value))
            ends[name], at = (value - width, value + width), at + np.size(value)
        return ends

    def profile(self, name: str, level: float = 0.95) -> Profile:
        r"""Return the likelihood profile of a parameter, and the interval that it gives.

        $$ \tau(\theta) = \pm\sqrt{S(\theta) - S(\hat\theta)},\qquad |\tau| \le t_\nu\bigl(\tfrac{1 + p}2\bigr), $$

        where S is the least sum of squared residuals over all other numbers, in units of the noise levels of the fit,
        or the robust loss in units in which it grows alike, and t the quantile of Student's distribution at the
        `degrees` $\nu$ of the parameter: $\tau^2$ is compared with $F_{1,\nu}$, which chi-squared takes the place of
        where the noise is known. Of a linear model this is the usual interval, exactly; where the model is curved, it
        needs no parabola, and may be lopsided or without bound.

        A profile is followed outwards, each of its points fitted from the one before: what lies beyond another minimum
        on the way may be missed. Sources: [bates-watts-1988], [venzon-moolgavkar-1988].

        Args:
            name: Of a parameter; of an entry of an array, row by row, "c[0]".
            level: p, the probability.

        Returns:
            The profile with its interval and a picture.

        Raises:
            ValueError: No such parameter, a level that is no probability, or a profile that finds a better minimum
                than that of the fit.
        """
        names = _names(tuple((name, np.shape(value)) for name, value in self.parameters.items()))
        choice("Fit.profile(name=...)", name, tuple(names))
        if self.minimum is None:
            raise error("Fit.profile(...)", "be called in the process of the fit", "another process", "Fit again.")
        return profile_of(self.minimum, names.index(name), name, level)

    def plot(self) -> Any:
        """Draw the residuals of every kind against time; return the matplotlib figure."""
        return importlib.import_module("nonholo.plot.motion.fit").fit_residuals(self)


def fit(
    system_of: Callable[[dict[str, Array]], System],
    measurements: Any,
    guess: Mapping[str, Any],
    *,
    time_step: Any = None,
    noise: Any = None,
    bounds: Any = None,
    loss: str = "linear",
) -> Fit:
    r"""Fit the parameters of a body, and the start of each trial, to recorded motion.

    $$ \min \sum_i \sum_k \rho\Bigl(\frac{z_{ik} - \hat z_k(\theta, g_i, w_i)}{\sigma}\Bigr),\qquad
       \sigma_a^2 = \frac{\sum_a r^2}{n_a - \mathrm{tr}_a H} $$

    over parameters $\theta$, first poses $g_i$ and first velocities $w_i$; $\hat z_k$ is the discrete orbit, z are
    poses or angular velocities. Derivatives are exact (`rollout`). Each kind a of number (position, turn, rate) has a
    separate noise level by restricted likelihood, from its residuals r, their number, and the trace of the hat
    matrix H over them. The model is the discrete map, which misses the continuous motion by $O(h^2)$: a time step that
    is a part of that of the samples makes this small.

    For small samples of a kind (seven headings) the covariance has the correction of Kenward and Roger, and the
    `degrees` of freedom of the intervals follow Satterthwaite's formula. The search uses only parameters for which
    `system_of` returns a body. A failed search begins again with a short first part of the record and
    extends it, which keeps a model of another frequency in phase. `Fit.outcome` records how it ended.

    A free motion does not determine the unit of mass. Fix one mass; otherwise the fit raises an error.

    In coordinates x, y and z form one kind. Every other coordinate is a separate kind. The heading counts up to full
    turns. A coordinate that is not measured may have any value, and its first one is fitted; coordinates that are
    neither measured nor contained in the equations begin at 0. A start is a first configuration and a first momentum.
    For forces and prescribed motions, time 0 is the first sample.

    Args:
        system_of: Makes the system, with a left-invariant constraint on SE(2), SO(3) or SE(3), from the parameters by
            name, which JAX traces; or returns `system.with_parameters(**p)` of a `LagrangeDAlembert` or, with turns
            measured, of a `GroupLagrangeDAlembert`. The same function is compiled once for all data, with `parameters`
            once for each time step.
        measurements: An orbit, a pandas DataFrame, an xarray Dataset, a dictionary of columns, the path of a CSV file
            with a header, a list of such trials, or an ensemble. Columns: `t`; `x`, `y`, (`z`); `theta` or `heading` in
            the plane; `qw`, `qx`, `qy`, `qz` or `quaternion` in space; angular velocities in the body `omega`, or
            `omega_x`, `omega_y`, `omega_z`; in coordinates the names of the coordinates. NaN marks what was not
            measured, and kinds may have different rates. Positions alone determine the pose of a body that moves
            forward in the plane; without poses trials start at the identity. A CSV file has at most 256 MB.
        guess: The parameters to begin with, numbers or arrays.
        time_step: h; by default the smallest time between two samples. Samples lie on multiples of it.
        noise: Standard deviations that are known, by kind ("position", "turn", "rate", a coordinate), or one for all;
            the levels of other kinds are estimated.
        bounds: Least and largest value of parameters by name, for an array of all its entries. A parameter between 0
            and infinity is searched by its logarithm, which finds it from guesses that are far off.
        loss: "linear", $\rho(z) = z^2$, or "soft_l1", $2\sqrt{1 + z^2} - 2$, under which outliers count little. With
            it levels and covariance are those of Huber, for normal noise with outliers.

    Returns:
        The fitted body with its uncertainty.

    Raises:
        ValueError: The measurements are empty, do not lie on time steps, or do not fit in memory. The guess has no
            motion or violates its bounds. The measurements do not determine a parameter or a noise level.

    Sources: [patterson-thompson-1971], [kenward-roger-1997], [satterthwaite-1946], [huber-1981].

    Example:
        >>> truth = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=0.7, a=0.4), 0.05)
        >>> orbit = nh.simulate(truth, restricted_velocity=(1.0, 0.5), steps=60)
        >>> noise = np.random.default_rng(0).normal(scale=1e-3, size=(61, 3))
        >>> record = dict(zip(("x", "y", "theta"), np.c_[orbit.position, orbit.heading].T + noise.T), t=orbit.time)
        >>> def sleigh(p):
        ...     return nh.ChaplyginSleigh(mass=1.0, inertia=p["inertia"], a=p["a"])
        >>> fit = nh.fit(sleigh, record, {"inertia": 1.0, "a": 0.3})
        >>> abs(fit.parameters["a"] - 0.4) < 0.01
        True
        >>> low, high = fit.profile("a").interval
        >>> low < 0.4 < high
        True
    """
    function("fit(system_of=...)", system_of, "parameters")
    choice("fit(loss=...)", loss, LOSSES)
    numbers, shapes = _vector(guess)
    ranges = _ranges(bounds, shapes, numbers)
    with needs("jax", "fit"):
        from nonholo.analysis.inverse._models import model_of
    model = model_of(system_of, shapes, numbers)
    step = None if time_step is None else float(scale("fit(time_step=...)", time_step, "Pass the time step."))
    kinds, h = kinds_of(model.names, measurements, step, model.each(len(numbers)))
    trials = [{kind: rows[i] for kind, rows in kinds.items()} for i in range(len(next(iter(kinds.values()))))]
    starting = functools.partial(model.first, h, is_robust=loss != LOSSES[0])
    poses, starts = map(np.array, zip(*map(starting, trials), strict=True))
    residuals_of = functools.partial(model.residuals, model.program(system_of, shapes, h))
    problem = Problem(residuals_of, poses, kinds, len(numbers), starts.shape)
    levels = _noise_levels(noise, problem)
    search = Search(problem, ranges, lambda point: system_of(by_name(shapes, point[: len(numbers)])), loss, levels)
    begin = np.concatenate([numbers, starts.ravel()])
    if len(problem.kind_of) <= len(begin):
        got = f"{len(problem.kind_of)} numbers for {len(begin)} unknowns"
        raise error(WHERE, "hold more numbers than there are unknowns", got, "Record for longer.")
    if not np.isfinite(problem.rows(begin)).all():
        remedy = "Begin nearer to the body, or with a smaller time step."
        raise error("fit(guess=...)", "have a motion through the measurements", "an orbit that ends", remedy)
    return _result(search, search.run(begin), begin, shapes, functools.partial(model.orbit, h=h))


def _noise_levels(noise: Any, problem: Problem) -> np.ndarray:
    """Return the noise levels that are given by kind, NaN for those to be estimated."""
    where, remedy, kinds = "fit(noise=...)", "Pass a number, or numbers by kind.", list(problem.there)
    if noise is None:
        return np.full(len(kinds), np.nan)
    levels = noise if isinstance(noise, Mapping) else dict.fromkeys(kinds, noise)
    for kind in levels:
        choice(where, kind, tuple(kinds), "Name kinds that are measured.")
    return np.array([float(scale(where, levels[kind], remedy)) if kind in levels else np.nan for kind in kinds])


def _ranges(bounds: Any, shapes: Shapes, numbers: np.ndarray) -> Ranges:
    """Return the bounds of the parameters, refused where the guess is not between them."""
    where, remedy = "fit(bounds=...)", "Pass {name: (low, high)} around the guess; an end may be infinite."
    names = np.array([name for name, shape in shapes for _ in range(int(np.prod(shape)))])
    low, high = np.full((2, len(names)), [[-np.inf], [np.inf]])
    for name, ends in instance(where, bounds or {}, Mapping, "be a dictionary", remedy).items():
        at = names == choice(where, name, tuple(dict(shapes)), "Name parameters of the guess.")
        infinite = [isinstance(x, float) and np.isinf(x) for x in pair(where, ends)]
        low[at], high[at] = (x if free else number(where, x) for x, free in zip(ends, infinite, strict=True))
        if not ((low < numbers) & (numbers < high))[at].all():
            raise error(where, "have the guess between them", f"{name} = {numbers[at]} of {ends}", remedy)
    return low, high


def _result(search: Search, solution: Solution, begin: np.ndarray, shapes: Shapes, orbit_of: Callable[..., Any]) -> Fit:
    problem, point, P = search.problem, solution.point, search.problem.count
    _check_determined(search, solution, shapes)
    covariance, plain, degrees = (x[..., :P] for x in solution.estimate.covariance(~np.isfinite(search.levels)))
    covariance, plain = covariance[:P], plain[:P].diagonal()
    system, parameters = search.system_at(point), by_name(shapes, point[:P])
    parameters = {name: x if np.ndim(x) else float(x) for name, x in parameters.items()}
    rows = {kind: np.where(there, problem.at(point)[kind][0], np.nan) for kind, there in problem.there.items()}
    residuals = tuple({kind: part[i] for kind, part in rows.items()} for i in range(len(problem.poses)))
    starts, steps = point[P:].reshape(problem.shape), next(iter(problem.kinds.values())).shape[1] - 1
    rows_of = zip(starts, problem.poses, strict=True)
    orbits = [orbit_of(system, start=start, pose=pose, steps=steps) for start, pose in rows_of]
    levels = {kind: float(x) for kind, x in zip(rows, solution.noise, strict=True)}
    minimum = search.minimum(solution, degrees, np.sqrt(plain), np.sqrt(covariance.diagonal() / plain))
    outcome = search.outcome_of(solution, begin[:P], np.sqrt(covariance.diagonal()))
    orbit = tuple(orbits) if len(orbits) > 1 else orbits[0]
    free = len(problem.kind_of) - len(point)
    return Fit(parameters, covariance, system, orbit, residuals, levels, outcome, degrees, free, minimum)


def _check_determined(search: Search, solution: Solution, shapes: Any) -> None:
    """Refuse a record where a combination of numbers changes nothing, and before it a kind that the fit uses up.

    The noise of such a kind cannot be seen. The search for it may end anywhere, also where nothing is determined.
    """
    estimate, (_, sizes, directions) = solution.estimate, np.linalg.svd(solution.estimate.triangle)
    is_flat = not estimate.lengths.all() or bool(sizes[-1] < _FLAT * sizes[0])
    is_used_up = is_flat & (estimate.counts <= len(solution.point))
    free = np.where(np.isfinite(search.levels), np.inf, np.where(is_used_up, 0.0, estimate.free))
    if free.min() < _LEAST_FREE:
        at = int(free.argmin())
        kind, count = list(search.problem.there)[at], estimate.counts[at]
        got = f"{count} numbers of {kind}, of which {free[at]:.2g} are left by the fit"
        raise error(WHERE, "determine the noise of each kind", got, f"Pass noise={{{kind!r}: ...}}, or measure longer.")
    if is_flat:
        flat = np.abs(directions[-1] if estimate.lengths.all() else estimate.lengths == 0)[: search.problem.count]
        got = ", ".join(np.array(_names(shapes))[flat > 0.1 * flat.max()]) or "a start"
        remedy = "Fix one of them in system_of, such as a mass: a free motion does not determine the unit of mass."
        raise error(WHERE, "determine all parameters", f"none of {got} alone", remedy)


def _vector(guess: Any) -> tuple[np.ndarray, Any]:
    """Return the numbers of a guess one after the other, and their names with shapes."""
    where, remedy = "fit(guess=...)", "Pass a dictionary of numbers or arrays."
    if not isinstance(guess, Mapping) or not guess or not all(isinstance(name, str) for name in guess):
        raise error(where, "name the parameters", shown(guess), remedy)
    values = {name: array(where, value, (None,) * np.ndim(value), remedy) for name, value in guess.items()}
    return np.concatenate([x.ravel() for x in values.values()]), tuple((name, x.shape) for name, x in values.items())


def _names(shapes: Any) -> list[str]:
    """Return a name for each number of the parameters."""
    return [f"{name}[{i}]" if shape else name for name, shape in shapes for i in range(int(np.prod(shape)))]
