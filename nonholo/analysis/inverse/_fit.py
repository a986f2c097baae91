r"""`fit`: the numbers of a body, and how it started, from recorded motion, by least squares with exact derivatives."""

import dataclasses
import functools
import importlib
from collections.abc import Callable, Mapping
from typing import Any, cast

import numpy as np
from scipy.optimize import least_squares
from scipy.special import stdtrit

from nonholo.analysis.inverse._measurements import Trial, trials_of
from nonholo.analysis.inverse._problem import Problem
from nonholo.analysis.inverse._profile import Minimum, Profile, profile_of
from nonholo.base.checks import array, choice, error, function, needs, positive, shown
from nonholo.base.types import Array, Float
from nonholo.discrete import discretize
from nonholo.groups import SO, AbstractMatrixGroup
from nonholo.orbit import Orbit
from nonholo.simulation import simulate
from nonholo.systems import AbstractSystem, System

_ROUNDS = 6  # of noise levels that follow from residuals, and residuals from noise levels
_SETTLED = 1e-3  # relative change of noise levels
_FLAT = 1e-10  # least singular value of scaled derivatives, relative to the largest
_NEAR = 5  # nodes between the poses that a first velocity is taken from


@dataclasses.dataclass(frozen=True, eq=False)
class Fit:
    """A body fitted to recorded motion.

    Attributes:
        parameters: The fitted numbers by name.
        covariance: Of all of them, in the order of the guess, arrays row by row; the starts are marginalized.
        system: `system_of(parameters)`.
        orbit: The fitted motion, a discrete orbit; of several trials a tuple of them. Time 0 is the first sample's.
        residuals: Measured minus fitted numbers of each trial by kind, "position", "turn" and "rate", (K, ...); NaN
            where nothing was measured. A turn in space is the vector of the rotation from the fitted pose.
        noise: Standard deviation of the residuals of each kind.
        samples: Measured numbers less fitted ones: the degrees of freedom of the residuals.
        minimum: The sum of squares about the fitted point, parameters, then starts, for profiles; None after pickling.
    """

    parameters: dict[str, Any]
    covariance: Float[np.ndarray, "P P"]
    system: System
    orbit: Orbit | tuple[Orbit, ...]
    residuals: tuple[dict[str, np.ndarray], ...] = dataclasses.field(repr=False)
    noise: dict[str, float]
    samples: int
    minimum: Minimum | None = dataclasses.field(repr=False)

    def __getstate__(self) -> dict[str, Any]:
        """Leave out what calls functions of the user's: a fit is sent and kept without it."""
        return {**vars(self), "minimum": None}

    @property
    def intervals(self) -> dict[str, tuple[Any, Any]]:
        """Intervals that hold each parameter with a probability of 95 %, if the noise is normal and the model right.

        They are those of the linearized model. `profile` has those of the likelihood itself.
        """
        half, found, at = stdtrit(self.samples, 0.975) * np.sqrt(self.covariance.diagonal()), {}, 0
        for name, value in self.parameters.items():
            width = half[at : at + np.size(value)].reshape(np.shape(value))
            found[name], at = (value - width, value + width), at + np.size(value)
        return found

    def profile(self, name: str, level: float = 0.95) -> Profile:
        r"""Return the likelihood profile of a parameter, and the interval that it gives.

        $$ \tau(\theta) = \pm\sqrt{S(\theta) - S(\hat\theta)},\qquad |\tau| \le t_\nu\bigl(\tfrac{1 + p}2\bigr), $$

        where S is the least sum of squared residuals over all other numbers, in units of the noise levels of the fit,
        and t the quantile of Student's distribution at $\nu$ = `samples` degrees of freedom: $\tau^2$ is compared with
        $F_{1,\nu}$, which chi-squared takes the place of where the noise is known. Of a linear model this is the usual
        interval, exactly; where the model is curved, it needs no parabola, and may be lopsided or without bound.

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
            raise error("Fit.profile(...)", "be asked where the fit was made", "a fit from elsewhere", "Fit again.")
        return profile_of(self.minimum, names.index(name), name, level)

    def plot(self) -> Any:
        """Draw the residuals of every kind against time; return the matplotlib figure."""
        return importlib.import_module("nonholo.plotting.motion").fit_residuals(self)


def fit(
    system_of: Callable[[dict[str, Array]], System],
    measurements: Any,
    guess: Mapping[str, Any],
    *,
    time_step: Any = None,
) -> Fit:
    r"""Fit the numbers of a body to recorded motion, and the start of each trial with them.

    $$ \min \sum_i \sum_k \Bigl|\frac{z_{ik} - \hat z_k(\theta, g_i, w_i)}{\sigma}\Bigr|^2 $$

    over parameters $\theta$, first poses $g_i$ and first velocities $w_i$; $\hat z_k$ is the discrete orbit, z are
    poses or angular velocities. Derivatives are exact (`rollout`). Each kind of number (position, turn, rate) has a
    noise level of its own, estimated from its residuals; the covariance is that of Gauss and Newton. The model is the
    discrete map, which misses the continuous motion by $O(h^2)$: a time step that is a part of that of the samples
    makes this small.

    A free motion does not know its unit of mass: fix one mass, or the fit is refused as undetermined.

    Args:
        system_of: Makes the system, with a left-invariant constraint on SE(2), SO(3) or SE(3), from the parameters by
            name, which JAX traces. The same function is compiled once, whatever the data.
        measurements: A pandas DataFrame, an xarray Dataset, a dictionary of columns, the path of a CSV file with a
            header, or a list of such trials. Columns: `t`; `x`, `y`, (`z`); `theta` or `heading` in the plane, `qw`,
            `qx`, `qy`, `qz` or `quaternion` in space; angular velocities in the body `omega`, or `omega_x`, `omega_y`,
            `omega_z`. NaN marks what was not measured. Without poses, trials start at the identity.
        guess: The parameters to begin with, numbers or arrays.
        time_step: h; by default the smallest time between two samples. Samples lie on multiples of it.

    Returns:
        The fitted body with its uncertainty.

    Raises:
        ValueError: Measurements that are none or do not lie on steps, a guess without a motion, parameters that the
            measurements do not determine.

    Example:
        >>> truth = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=0.7, a=0.4), 0.05)
        >>> orbit = nh.simulate(truth, restricted_velocity=(1.0, 0.5), steps=60)
        >>> noise = np.random.default_rng(0).normal(scale=1e-3, size=(61, 3))
        >>> record = dict(zip(("x", "y", "theta"), np.c_[orbit.position, orbit.heading].T + noise.T), t=orbit.time)
        >>> def sleigh(p):
        ...     return nh.ChaplyginSleigh(mass=1.0, inertia=p["inertia"], a=p["a"])
        >>> found = nh.fit(sleigh, record, {"inertia": 1.0, "a": 0.3})
        >>> abs(found.parameters["a"] - 0.4) < 0.01
        True
        >>> low, high = found.profile("a").interval
        >>> low < 0.4 < high
        True
    """
    function("fit(system_of=...)", system_of)
    with needs("jax", "fit"):
        from nonholo.analysis.inverse._residuals import missed

    numbers, shapes = _vector(guess)
    system = _system(system_of, numbers, shapes)
    step = None if time_step is None else float(positive("fit(time_step=...)", time_step, "Pass the time step."))
    trials, h = trials_of("fit(measurements=...)", system.group, measurements, step)
    poses, starts = map(np.array, zip(*(_first(system, trial, h) for trial in trials), strict=True))
    kinds = {kind: np.array([trial.kinds[kind] for trial in trials]) for kind in trials[0].kinds}
    problem = Problem(functools.partial(missed, system_of, shapes, h), poses, kinds, len(numbers), starts.shape)
    point, weights = _minimum(problem, np.concatenate([numbers, starts.ravel()]))
    return _result(problem, point, weights, (system_of, shapes, h))


def _minimum(problem: Problem, point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the best point, and the noise levels of the kinds, each from the other until both have settled."""
    noise = np.ones(len(problem.kinds))
    free = len(problem.kind_of) - len(point)
    if free < 1:
        got = f"{len(problem.kind_of)} numbers for {len(point)} unknowns"
        raise error("fit(measurements=...)", "be more than the unknowns", got, "Measure longer.")
    if not np.isfinite(problem.rows(point)).all():
        remedy = "Begin nearer to the body, or with a smaller time step."
        raise error("fit(guess=...)", "have a motion through the measurements", "an orbit that ends", remedy)
    for _ in range(_ROUNDS):
        scale = noise[problem.kind_of]
        found = least_squares(
            lambda x, s=scale: problem.rows(x) / s,
            point,
            cast(Any, lambda x, s=scale: problem.slope(x) / s[:, None]),
            x_scale="jac",
            xtol=1e-12,
            ftol=1e-12,
            gtol=1e-12,
        )
        point, rows, before = found.x, problem.rows(found.x), noise
        part = free / len(problem.kind_of)
        noise = np.array([np.sqrt(np.mean(rows[problem.kind_of == i] ** 2) / part) for i in range(len(noise))])
        noise = np.maximum(noise, np.finfo(np.float64).tiny)
        if np.abs(noise / before - 1).max() < _SETTLED:
            break
    return point, noise


def _result(problem: Problem, point: np.ndarray, noise: np.ndarray, made: Any) -> Fit:
    system_of, shapes, h = made
    covariance = _covariance(problem, point, noise, shapes)
    parameters = _parameters(shapes, point[: problem.count])
    system = system_of(parameters)
    rows = {kind: np.where(there, problem.at(point)[kind][0], np.nan) for kind, there in problem.there.items()}
    residuals = tuple({kind: part[i] for kind, part in rows.items()} for i in range(len(problem.poses)))
    starts, steps = point[problem.count :].reshape(problem.shape), next(iter(problem.kinds.values())).shape[1] - 1
    orbits = [_orbit(system, h, *row, steps) for row in zip(starts, problem.poses, strict=True)]
    levels = {kind: float(x) for kind, x in zip(problem.kinds, noise, strict=True)}

    def exists(numbers: np.ndarray) -> bool:
        try:
            system_of(_parameters(shapes, numbers[: problem.count]))
        except ValueError:
            return False
        return True

    minimum = problem.minimum(point, noise, exists)
    orbit = tuple(orbits) if len(orbits) > 1 else orbits[0]
    return Fit(parameters, covariance, system, orbit, residuals, levels, minimum.free, minimum)


def _covariance(problem: Problem, point: np.ndarray, noise: np.ndarray, shapes: Any) -> np.ndarray:
    """Return the covariance of the parameters, refused where a combination of them changes nothing."""
    slope = problem.slope(point) / noise[problem.kind_of][:, None]
    lengths = np.linalg.norm(slope, axis=0)
    _, sizes, directions = np.linalg.svd(slope / np.where(lengths > 0, lengths, 1.0), full_matrices=False)
    if not lengths.all() or sizes[-1] < _FLAT * sizes[0]:
        names = _names(shapes)
        flat = np.abs(directions[-1] if lengths.all() else lengths == 0)[: problem.count]
        got = ", ".join(np.array(names)[flat > 0.1 * flat.max()]) or "a start"
        remedy = "Fix one of them in system_of, such as a mass: a free motion does not know its unit."
        raise error("fit(measurements=...)", "determine all parameters", f"none of {got} alone", remedy)
    root = directions / sizes[:, None] / lengths
    return (root.T @ root)[: problem.count, : problem.count]


def _orbit(system: System, h: float, start: np.ndarray, pose: np.ndarray, steps: int) -> Orbit:
    """Return the motion of a trial."""
    k = system.rank
    g = pose @ system.group.exp(start[k:]) if len(start) > k else pose
    return simulate(discretize(system, h), restricted_velocity=start[:k], configuration=g, steps=steps)


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


def _parameters(shapes: Any, numbers: np.ndarray) -> dict[str, Any]:
    found, at = {}, 0
    for name, shape in shapes:
        size = int(np.prod(shape))
        found[name], at = numbers[at : at + size].reshape(shape) if shape else float(numbers[at]), at + size
    return found


def _system(system_of: Callable[..., Any], numbers: np.ndarray, shapes: Any) -> System:
    system = system_of(_parameters(shapes, numbers))
    if not isinstance(system, AbstractSystem) or system.is_spatial:
        remedy = "Return a SuslovTop, a sleigh or an LLSystem."
        raise error("fit(system_of=...)", "return a system with a left-invariant constraint", shown(system), remedy)
    return cast(System, system)


def _first(system: System, trial: Trial, h: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a first pose and a first start: velocity along the constraint and, with poses, a change of the pose."""
    group, S = system.group, system.constraint_subspace
    turn, rate = trial.kinds.get("turn"), trial.kinds.get("rate")
    if turn is None:
        seen = rate[np.isfinite(rate).all(axis=1)][:1].ravel() if rate is not None else np.zeros(0)
        return group.identity, np.linalg.lstsq(S[:, : len(seen)].T, seen)[0] if len(seen) else np.zeros(system.rank)
    poses, nodes = _poses(group, trial)
    far = min(len(nodes) - 1, max(1, int(np.searchsorted(nodes, nodes[0] + _NEAR, side="right")) - 1))
    span = (nodes[far] - nodes[0]) * h
    velocity = group.log(group.inverse(poses[0]) @ poses[far]) / span
    first = poses[0] @ group.exp(-velocity * nodes[0] * h)
    return first, np.concatenate([np.linalg.lstsq(S.T, velocity)[0], np.zeros(group.dim)])


def _poses(group: AbstractMatrixGroup, trial: Trial) -> tuple[np.ndarray, np.ndarray]:
    """Return the poses that are measured whole, with the numbers of their nodes."""
    turn, position = trial.kinds["turn"], trial.kinds.get("position", np.zeros((len(trial.kinds["turn"]), 0)))
    rows = np.concatenate([position, turn], axis=1)
    nodes = np.flatnonzero(np.isfinite(rows).all(axis=1))
    if len(nodes) < 2:
        remedy = "Leave the columns out that hold so little."
        raise error("fit(measurements=...)", "have two whole poses in each trial", f"{len(nodes)}", remedy)
    g = np.broadcast_to(group.identity, (len(nodes), group.size, group.size)).copy()
    n = position.shape[1]
    g[:, :n, n:] = position[nodes][:, :, None]
    if turn.shape[1] == 1:
        cos, sin = np.cos(turn[nodes, 0]), np.sin(turn[nodes, 0])
        g[:, :2, :2] = np.moveaxis(np.array([[cos, -sin], [sin, cos]]), -1, 0)
    else:
        g[:, :3, :3] = SO(3).matrix_from_pose(SO(3).normalize_pose(turn[nodes]))
    return g, nodes
