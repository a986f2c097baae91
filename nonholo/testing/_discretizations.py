"""Whether a discretization follows its equations and keeps what it should, and has the order that it claims."""

import dataclasses
import functools
from collections.abc import Callable, Iterator
from typing import Any, cast

import numpy as np
import scipy.integrate

from nonholo.analysis import Convergence, compare, invariants
from nonholo.base.checks import count, flags, generator, instance, positive, refuse_given
from nonholo.base.results import OutcomeError
from nonholo.base.types import Float
from nonholo.continuous import vector_field
from nonholo.discrete import Discretization, discrete_legendre, refuse_composition
from nonholo.orbit import Orbit
from nonholo.simulation import flow, refuse_many_matrices, simulate
from nonholo.systems import AbstractCoordinateDiscretization, AbstractSystem, Forced, force_of, refuse_slip
from nonholo.testing import _report as report
from nonholo.testing._coordinates import MAP, CoordinateSamples
from nonholo.testing._report import Check, Report, derivative, gap, largest, measures, need, relative, run_checks

PATH = 1.0  # norm of the matrix of that path
STEP = 0.2  # norm of the matrix of one step of the orbit, unless it folds


class OrbitSamples:
    """Orbits and the functions that judge them.

    Args:
        discrete: The discretization.
        rng: Where the start comes from.
        steps: Number of steps of the orbit.
    """

    def __init__(self, discrete: Discretization, rng: np.random.Generator, steps: int) -> None:
        self.discrete, self.system, self.group = discrete, discrete.system, discrete.system.group
        self.spatial, self.steps = self.system.is_spatial, steps
        self.forced = discrete.forces
        self.free = dataclasses.replace(discrete, system=self.system.inside)
        h = float(discrete.time_step)
        self.step = min(STEP, h) if self.forced else STEP
        self.span = min(PATH, report.COUNTS[0] * h) if self.forced else h
        self.path = self.span if self.forced else PATH
        self.S, self.A = np.asarray(self.system.constraint_subspace), np.asarray(self.system.annihilator)
        self.pose = self.group.random(rng)
        self._rows = rng.normal(size=len(self.S))

    def start(self, size: float) -> dict[str, Any]:
        """Return a start with steps of the given size."""
        return self.moving(size / self.discrete.time_step)

    def moving(self, norm: float) -> dict[str, Any]:
        """Return a start with a velocity of the given norm."""
        need(len(self.S), "the constraint forbids all motion")
        speed = np.linalg.norm(self.group.hat(self.directions.T @ self._rows), 2)
        return {"restricted_velocity": self._rows * (norm / speed), "configuration": self.pose}

    @functools.cached_property
    def directions(self) -> Float[np.ndarray, "k dim"]:
        """The admissible directions in the body at the start."""
        return self.S @ self.system.carried(np.linalg.inv(self.pose)).T

    @functools.cached_property
    def run(self) -> tuple[list[Orbit], float] | Exception:
        """An orbit of moderate energy and the norm of its path, or why there is none."""
        return self._try([self.steps], self.steps * self.step)

    @property
    def orbit(self) -> Orbit:
        """The orbit."""
        return report.result_of(self.run, "the orbit failed")[0][0]

    @property
    def first(self) -> dict[str, Any]:
        """The start of the orbit."""
        return self.start(report.result_of(self.run, "the orbit failed")[1] / self.steps)

    @functools.cached_property
    def W(self) -> Float[np.ndarray, "K N N"]:
        """Its displacements."""
        return self.orbit.displacement

    @functools.cached_property
    def finer(self) -> tuple[list[Orbit], float] | Exception:
        """One path in more and more steps and its norm, or why there is none."""
        return self._try(list(report.COUNTS), self.path)

    @property
    def paths(self) -> list[Orbit]:
        """The path in more and more steps."""
        return report.result_of(self.finer, "the finer orbits failed")[0]

    def _try(self, counts: list[int], norm: float, halvings: int = 5) -> Any:
        """Run a path of a norm in several numbers of steps; where it meets a fold, one of half the norm."""
        try:
            return [self._path(n, norm, len(counts) > 1) for n in counts], norm
        except OutcomeError as fold:
            return self._try(counts, norm / 2, halvings - 1) if halvings else fold
        except Exception as other:  # the code under test is a user's and may raise anything
            return other

    def _path(self, count: int, norm: float, divides: bool) -> Orbit:
        if self.forced is None or not divides:
            return simulate(self.discrete, steps=count, **self.start(norm / count))
        need(not callable(self.discrete.difference), "a discrete Lagrangian of one time step under forces")
        if (forced := self.forced).table is not None:
            rows = np.repeat(forced.rows(np.arange(report.COUNTS[0])), count // report.COUNTS[0], axis=0)
            forced = dataclasses.replace(forced, force=force_of(forced.parts | {"table": rows}))
        discrete = dataclasses.replace(self.discrete, system=forced, time_step=np.float64(self.span / count))
        return simulate(discrete, steps=count, **self.moving(norm / self.span))

    @functools.cached_property
    def kicks(self) -> tuple[Float[np.ndarray, "K dim"], Float[np.ndarray, "K dim"]]:
        """The impulses of forces at both ends of the steps, body covectors; zero of a free system."""
        orbit = self.orbit
        if self.forced is None:
            return np.zeros((len(orbit), self.group.dim)), np.zeros((len(orbit), self.group.dim))
        return impulses_of(self.forced, orbit, self.momentum(self.W), float(self.discrete.time_step))

    @property
    def impulses(self) -> Float[np.ndarray, "K dim"]:
        """The impulses of the constraint at the nodes between two steps."""
        kicks = self.kicks[0][1:] + self.kicks[1][:-1]
        return self.impulse(self.W[:-1], self.W[1:], self.orbit.configuration[1:], kicks)

    @functools.cached_property
    def reverses(self) -> bool:
        """Whether forces allow the motion backwards: potentials, and those that a reversal leaves as they are."""
        if self.forced is None or self.forced.force is None:
            return True
        velocity = self._rows @ self.directions
        acting = [self.forced.applied_force(t, self.pose, w) for t in (0.0, 0.7) for w in (velocity, -velocity)]
        return self.forced.table is None and bool(np.ptp(acting, axis=0).max() == 0.0)

    @functools.cached_property
    def exact(self) -> tuple[Float[np.ndarray, "3 N N"], Float[np.ndarray, "k"], Float[np.ndarray, "N N"]]:
        """The continuous path: its first displacements, one for each count, its last momentum and pose."""
        norm = report.result_of(self.finer, "the finer orbits failed")[1]
        k, h, start = len(self.S), self.span, self.moving(norm / self.span)
        r = self.directions @ (self.system.inertia_operator @ (start["restricted_velocity"] @ self.directions))
        options: Any = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13 * (1 + np.abs(r).max())}
        state, states = np.concatenate([r, self.pose.ravel()]), np.zeros((0, k + self.pose.size))
        for field, ends in fields_of(self.system, [h / n for n in reversed(report.COUNTS)], h):
            rows = scipy.integrate.solve_ivp(field, (ends[0], ends[-1]), state, t_eval=ends[1:], **options).y.T
            state, states = rows[-1], np.concatenate([states, rows])
        states = states[[0, 1, 2, -1]]
        poses = states[:, k:].reshape(-1, *self.pose.shape)
        return np.linalg.inv(self.pose) @ poses[-2::-1], states[-1, :k], poses[-1]

    def lagrangian(self, W: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "..."]:
        """Return the discrete Lagrangian by its definition."""
        kind, h = self.discrete.difference, self.discrete.time_step
        if callable(kind):
            return _of_jax(kind, W)
        if kind == "matrix":
            X = W - self.group.identity
            G = np.eye(self.group.size) if self.group.form is None else self.group.form
            J = np.asarray(self.system.homogeneous_mass_tensor) @ np.linalg.inv(G)  # tr(X J X*), X* = G^-1 X^T G
            return np.einsum("...ab,bc,...dc,da->...", X, J, X, G) / (2 * h)
        x = self.group.log(W)
        return np.einsum("...a,ab,...b->...", x, np.asarray(self.system.inertia_operator), x) / (2 * h)

    def forbidden(self, W: Float[np.ndarray, "K N N"], g: Float[np.ndarray, "K N N"]) -> Float[np.ndarray, "K s"]:
        """Return what the constraint wants to be zero, by its definition, of displacements at poses."""
        group, kind = self.group, self.discrete.constraint
        D = g @ W @ np.linalg.inv(g) if self.spatial else W
        if not isinstance(kind, str):
            D = np.linalg.inv(self.system.frame) @ D @ self.system.frame
            return np.stack([_of_jax(f, D) for f in kind], axis=-1)
        if kind == "exponential":
            return group.log(D) @ self.A.T
        return group.vee((D - np.linalg.inv(D)) / 2 if kind == "skew" else D - group.identity) @ self.A.T

    def impulse(self, before: np.ndarray, after: np.ndarray, g: np.ndarray, kick: Any) -> Float[np.ndarray, "K dim"]:
        """Return P(after) - Ad* P(before), less impulses of forces, of displacements that meet at g.

        In space if the constraint is.
        """
        jump = self.momentum(after) - (self.group.coadjoint(before, self.momentum(before)) + kick)
        return self.group.coadjoint(np.linalg.inv(g), jump) if self.spatial else jump

    def momentum(self, W: np.ndarray) -> Float[np.ndarray, "K dim"]:
        """Return the discrete momenta of displacements."""
        return discrete_legendre(self.free, W)


def _of_jax(function: Callable[[Any], Any], W: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "..."]:
    """Return the values of a function of one JAX matrix; JAX loads slowly, and only callables need it."""
    from nonholo.discrete.definition import map_each

    return map_each(function, W.reshape(-1, *W.shape[-2:])).reshape(W.shape[:-2])


def impulses_of(
    forced: Forced, orbit: Orbit, leaving: Float[np.ndarray, "K dim"], time_step: float
) -> tuple[Float[np.ndarray, "K dim"], Float[np.ndarray, "K dim"]]:
    r"""Return the half impulses before and after each step of an orbit, from its own momenta.

    A kick takes r to $r + E^Tj$. Friction acts all the while, $\dot j = F(r + E^Tj)$; any other force with the
    velocity of the mean of both momenta, if need be beside it. Balanced forces give the same impulse twice.

    Args:
        forced: The system.
        orbit: Its orbit, with all steps; the momenta of its states are those at the nodes.
        leaving: Momenta of the displacements.
        time_step: h.
    """
    group, g, W = forced.group, orbit.configuration, orbit.displacement
    if orbit.motion.is_balanced:
        half = time_step / 2 * forced.mean_force(g, W, time_step, forced.rows(orbit.step), orbit.time)
        return half, half
    ends, arriving = np.concatenate([g[1:], g[-1:] @ W[-1:]]), group.coadjoint(W, leaving)
    time, nodes, half = orbit.time.tolist(), orbit.restricted_momentum, time_step / 2
    before = [forced.directions(pose).T @ momentum for pose, momentum in zip(ends, arriving, strict=True)]
    after = [forced.directions(pose).T @ momentum for pose, momentum in zip(g, leaving, strict=True)]
    first = [_impulse(forced, g[k], time[k], nodes[k], after[k], k, half) for k in range(len(g))]
    last = [_impulse(forced, ends[k], time[k + 1], before[k], nodes[k + 1], k, half) for k in range(len(g) - 1)]
    return np.array(first), np.array([*last, np.full(group.dim, np.nan)])


def _impulse(
    forced: Forced, g: np.ndarray, time: float, before: np.ndarray, after: np.ndarray, step: int, tau: float
) -> Float[np.ndarray, "dim"]:
    E = forced.directions(g)
    to_velocity = E @ np.linalg.inv(E.T @ np.asarray(forced.inertia_operator) @ E)
    constant = forced.potential_force(g) + forced.rows(np.array([step]))[0]
    constant = constant + forced.driving_force(time, g, to_velocity @ ((before + after) / 2))
    if (friction := forced.friction) is None:
        return tau * constant

    def rate(_: Any, j: np.ndarray) -> np.ndarray:
        return constant + friction.covector(to_velocity @ (before + E.T @ j))

    size = 1e-14 * (1.0 + np.abs(before).max())
    return scipy.integrate.solve_ivp(rate, (0.0, tau), np.zeros(len(E)), "DOP853", rtol=1e-13, atol=size).y[:, -1]


def fields_of(system: AbstractSystem, times: list[float], end: float) -> Iterator[tuple[Any, list[float]]]:
    """Give vector fields with the times at which each is wanted: one, of a table a field for each of ten rows."""
    forced, pieces = system.forces, 10
    if forced is None or forced.table is None:
        yield vector_field(system), [0.0, *times, end]
        return
    for k, row in enumerate(forced.rows(np.arange(pieces))):
        acting = dataclasses.replace(forced, force=lambda *state, row=row: row + forced.applied_force(*state))
        yield vector_field(acting), [0.0, *times] if k == 0 else [k * end / pieces, (k + 1) * end / pieces]


_MANY = 1000  # halvings; more than any memory holds


def check_order(
    discrete: Discretization,
    body_velocity: Float[np.ndarray, "dim"],
    *,
    steps: int = 20,
    halvings: int = 2,
    tolerance: float = 0.2,
    throw: bool = True,
) -> Convergence:
    r"""Check that momenta and poses converge to the continuous motion with the order of a discretization.

    $$ \max_k|r_k - r(t_k)| = O(h^p), \qquad \max_k\|g_k^{-1}g(t_k) - I\| = O(h^p), \qquad p = 2, 4, 6, 8. $$

    The same motion is run with the time step, a half of it, a fourth and so on, and compared with `nh.flow`. Errors
    that are only rounding have no order and pass; take larger steps to see one. `plot()` of what is returned draws the
    errors over the time step.

    Args:
        discrete: Made by `discretize` for a system on a group, with the largest time step.
        body_velocity: The start; it satisfies the constraint.
        steps: Length of the run with the largest time step.
        halvings: How often the time step is halved.
        tolerance: The largest distance of the slopes of $\log$ error over $\log h$ from the order.
        throw: Raise if they are farther; otherwise only the result reports it.

    Returns:
        The errors of all runs, with `order` and `plot`.

    Raises:
        ValueError: `discrete` is no discretization of a system on a group, or the start is refused.
        OutcomeError: A run cannot continue: take a smaller time step.
        AssertionError: With `throw`: an order that is not the one claimed.

    Example:
        >>> sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)
        >>> nh.testing.check_order(nh.discretize(sleigh, 0.2), (1.0, 0.5, 0.0))
        <Convergence over 3 time steps, order: momentum 2.01, pose 2.00, energy at rounding>
    """
    where, remedy = "check_order(discrete=...)", "Pass `discretize(system, time_step)` of a system on a group."
    instance(where, discrete, Discretization, "be a discretization of a system on a group", remedy)
    number = count("check_order(steps=...)", steps, "Pass the length of the first run.")
    finer = count("check_order(halvings=...)", halvings, "Pass 1 or more.")
    most = float(positive("check_order(tolerance=...)", tolerance, "Pass a positive number."))
    flags("check_order", throw=throw)
    where, all_steps = "check_order(steps=..., halvings=...)", number * 2 ** (min(finer, _MANY) + 1)
    refuse_many_matrices(where, discrete, all_steps, "Pass fewer of them.")
    h = float(discrete.time_step)
    exact = flow(discrete.system, body_velocity=body_velocity, times=(0.0, number * h))
    maps = [dataclasses.replace(discrete, time_step=h / 2**k) for k in range(finer + 1)]
    runs = [simulate(each, body_velocity=body_velocity, steps=number * 2**k) for k, each in enumerate(maps)]
    study = compare(runs, exact)
    wrong = [slope for slope in (study.order.momentum, study.order.pose) if abs(slope - discrete.order) > most]
    if throw and wrong:
        raise AssertionError(f"`check_order(...)` must find order {discrete.order} +- {most:g}. Got {study}.")
    return study


def check_discretization(
    discrete: Discretization,
    *,
    rng: int | np.random.Generator = 0,
    steps: int = 20,
    definition: bool = True,
    configuration: Any = None,
    tolerance_factor: float = 1.0,
    throw: bool = True,
) -> Report:
    r"""Check that a discretization follows its equations, is of second order and keeps what is claimed of it.

    $$ \langle P(W), x\rangle = \tfrac{d}{dt}l_d(e^{tx}W)\big|_0, \qquad
       P_{k+1} - \mathrm{Ad}^*_{W_k}P_k = \sum_j\lambda_j a^j, \qquad g_{k+1} = g_kW_k. $$

    Measured on short orbits from a random admissible start: momenta against differences of the discrete Lagrangian;
    variety and tangent space; momentum equation and multipliers; order against the continuous flow; the step back.
    Reversal is required of the named differences with "skew" or "exponential", constant energy where
    `discrete.conserves_energy`; elsewhere both are reported, as is whether $l_d(W^{-1}) = l_d(W)$.

    Under forces the impulses $f^-_k$, $f^+_k$ at the ends of steps are added by their definition; the balance
    of energy and work is of order 2, friction adds no energy, and without forces the bits are those of the system
    inside. Reversal is required under potentials and under forces that do not depend on time and are even in the
    velocity. The order is measured at velocities of norm one, from the given time step on.

    Args:
        discrete: Made by `discretize` for a system on a group, or one by functions (`LagrangeDAlembert`).
        rng: A generator of the start, or an integer that makes one.
        steps: Length of the orbit.
        definition: Also compare compiled steps with the definition; JAX compiles it, which takes seconds.
        configuration: Where motions begin, of a system by functions; random by default.
        tolerance_factor: On every tolerance, for badly scaled units.
        throw: Raise if a check fails; otherwise only the report has it.

    Returns:
        What was measured.

    Raises:
        ValueError: `discrete` is not a discretization of order 2 of such a system.
        AssertionError: With `throw`: names every check that failed, what is required and what was measured.

    Example:
        >>> sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)
        >>> exact = nh.testing.check_discretization(nh.discretize(sleigh, 0.1), definition=False)
        >>> exact["energy"].status, exact["order of poses"].value < 0.1
        ('ok', True)
    """
    owner, where = "check_discretization", "check_discretization(discrete=...)"
    flags(owner, definition=definition, throw=throw)
    number = max(count(f"{owner}(steps=...)", steps, "Pass the length of the orbit."), 4)
    if isinstance(discrete, AbstractCoordinateDiscretization):
        system, h = discrete.system, discrete.time_step
        there = CoordinateSamples(system, generator(f"{owner}(rng=...)", rng), configuration, h, number)
        title = f"{owner}({there.system.name}, time_step={h:g}, {there.system.rule})"
        return run_checks(title, MAP, there, tolerance_factor, throw)
    refuse_given(owner, "be left out on a group", "Leave it out.", configuration=(configuration, None))
    instance(where, discrete, Discretization, "be a discretization", "Pass `discretize(system, time_step)`.")
    refuse_composition(where, discrete, "Check the discretization of order 2.")
    refuse_slip(where, discrete.system)
    refuse_many_matrices(f"{owner}(steps=...)", discrete, number, "Pass fewer steps.")
    samples = OrbitSamples(discrete, generator(f"{owner}(rng=...)", rng), number)
    forced = FORCED if discrete.system.is_forced else []
    checks = (*CHECKS, *forced, *checks_of_claims(samples), *((DEFINITION,) if definition else ()))
    return run_checks(_owner(discrete), checks, samples, tolerance_factor, throw)


def _owner(discrete: Discretization) -> str:
    choices = (discrete.difference, discrete.constraint)
    difference, constraint = (choice if isinstance(choice, str) else "callable" for choice in choices)
    system = type(discrete.system).__name__
    step = f"time_step={float(discrete.time_step):g}"
    return f"check_discretization({system} on {discrete.system.group!r}, {step}, {difference}, {constraint})"


CHECKS: list[Check] = []
FORCED: list[Check] = []
_AGREE = ("momentum", "displacement", "configuration")


@measures(CHECKS, "inertia", "h times the second derivative of l_d at I, along d, is I; P(I) = 0", 1e-8)
def inertia(s: OrbitSamples) -> float:
    """Return the distance of the second derivative of the discrete Lagrangian along the constraint from the inertia."""
    eye, D, h = s.group.identity, s.directions, s.discrete.time_step
    exact = D @ s.system.inertia_operator @ D.T
    need(len(D), "the constraint forbids all motion")
    slope = derivative(lambda t: s.momentum(s.group.exp(t * D))) @ D.T * h
    return max(relative(slope, exact), largest(s.momentum(eye) @ D.T) * h / largest(exact))


@measures(CHECKS, "left momentum", "<P(W), x> = d/dt l_d(exp(t x) W)", 1e-8)
def left_momentum(s: OrbitSamples) -> float:
    """Compare with the derivative of l_d(exp(t x) W)."""
    W, x = s.W[:3, None], np.eye(s.group.dim)
    return relative(s.momentum(s.W[:3]), derivative(lambda t: s.lagrangian(s.group.exp(t * x) @ W)))


@measures(CHECKS, "right momentum", "<Ad*_W P(W), x> = d/dt l_d(W exp(t x))", 1e-8)
def right_momentum(s: OrbitSamples) -> float:
    """Compare with the derivative of l_d(W exp(t x))."""
    W, x = s.W[:3, None], np.eye(s.group.dim)
    momentum = discrete_legendre(s.free, s.W[:3], "right")
    return relative(momentum, derivative(lambda t: s.lagrangian(W @ s.group.exp(t * x))))


@measures(CHECKS, "self-adjoint", "l_d(W^-1) = l_d(W): not required", None)
def self_adjointness(s: OrbitSamples) -> float:
    """Compare l_d(W) with l_d(W^-1)."""
    return relative(s.lagrangian(np.linalg.inv(s.W)), s.lagrangian(s.W))


@measures(CHECKS, "identity", "the identity lies on the variety", 1e-13)
def identity(s: OrbitSamples) -> float:
    """Return the forbidden part of the identity and the distance of the chart's origin from it."""
    eye, variety = s.group.identity, s.discrete.variety
    origin = gap(variety.displaced(np.zeros(len(variety.chart))), eye)
    return max(origin, largest(s.forbidden(eye[None], s.pose[None])))


@measures(CHECKS, "tangent space", "motions along d leave the variety to second order", 1e-8)
def tangent_space(s: OrbitSamples) -> float:
    """Return the rate at which admissible motions through the identity leave the variety."""
    need(len(s.S) * len(s.A), "nothing is forbidden, or everything")
    g = np.broadcast_to(s.pose, (len(s.S), *s.pose.shape))
    return largest(derivative(lambda t: s.forbidden(s.group.exp(t * s.directions), g)))


@measures(CHECKS, "transversality", "motions along the annihilator leave the variety", 0.0)
def transversality(s: OrbitSamples) -> float:
    """Return how many forbidden directions the equations of the variety do not see."""
    need(len(s.A), "nothing is forbidden")
    back = s.system.carried(np.linalg.inv(s.pose))
    g = np.broadcast_to(s.pose, (len(s.A), *s.pose.shape))
    slope = derivative(lambda t: s.forbidden(s.group.exp(t * s.A @ back.T), g))
    return float(len(s.A) - np.linalg.matrix_rank(slope, tol=1e-6 * largest(slope)))


@measures(CHECKS, "orbit", f"a run with steps of norm {STEP} goes through, or with a part of that: the divisor", 32.0)
def runs(s: OrbitSamples) -> float:
    """Return the share of the intended path that a short run covers, inverted; raise what it raised."""
    return s.steps * s.step / report.result_of(s.run)[1]


@measures(CHECKS, "finer orbits", f"one path in {report.COUNTS} steps goes through, or a part of it: the divisor", 32.0)
def runs_finer(s: OrbitSamples) -> float:
    """Return the same of runs in finer and finer steps."""
    return s.path / report.result_of(s.finer)[1]


@measures(CHECKS, "start", "P(W_0) along d is the momentum of the velocity", 1e-11)
def start(s: OrbitSamples) -> float:
    """Compare the first momentum along the constraint with that of the velocity at the start."""
    velocity = s.first["restricted_velocity"] @ s.directions
    leaving = s.momentum(s.W[:1]) - s.kicks[0][:1]
    return relative(leaving[0] @ s.directions.T, s.system.inertia_operator @ velocity @ s.directions.T)


@measures(CHECKS, "variety", "displacements lie on the variety", 1e-11)
def on_variety(s: OrbitSamples) -> float:
    """Return the largest forbidden part of a displacement."""
    return largest(s.forbidden(s.W, s.orbit.configuration))


measures(CHECKS, "group", "residual(g_k) = 0", 1e-11)(lambda s: largest(s.group.residual(s.orbit.configuration)))


@measures(CHECKS, "reconstruction", "g_(k+1) = g_k W_k", 1e-12)
def reconstruction(s: OrbitSamples) -> float:
    """Compare poses with products of displacements."""
    g = s.orbit.configuration
    return gap(g[1:], g[:-1] @ s.W[:-1])


@measures(CHECKS, "momentum equation", "P_(k+1) - Ad*_(W_k) P_k vanishes on d", 1e-11)
def momentum_equation(s: OrbitSamples) -> float:
    """Return the part of the impulses along the constraint, relative to the momenta."""
    return largest(s.impulses @ s.S.T) / largest(s.momentum(s.W))


@measures(CHECKS, "multipliers", "P_(k+1) - Ad*_(W_k) P_k = sum lambda_j a^j", 1e-11)
def multipliers(s: OrbitSamples) -> float:
    """Compare impulses with the sum over the multipliers, relative to the momenta."""
    return largest(s.impulses - s.orbit.multipliers @ s.A) / largest(s.momentum(s.W))


def reversal(s: OrbitSamples) -> float:
    """Return by how much the inverse displacements, in inverse order, miss the equations; of forces a run back."""
    if s.forced is not None:
        r, g = s.orbit.restricted_momentum, s.orbit.configuration
        back = simulate(s.discrete, steps=len(g) - 1, momentum=-r[-1], configuration=g[-1])
        return max(gap(back.configuration[::-1], g), relative(-back.restricted_momentum[::-1], r))
    g, back = s.orbit.configuration, np.linalg.inv(s.W)
    defect = s.impulse(back[1:], back[:-1], g[1:], 0.0) @ s.S.T
    return max(largest(defect) / largest(s.momentum(s.W)), largest(s.forbidden(back, g @ s.W)))


def compiled_reversal(s: OrbitSamples) -> float:
    """Return the miss of one compiled step forward and back."""
    need(s.discrete.route.compiled_route is not None, "the step is not compiled")
    need(s.discrete.forces is None, "forces act")
    return cast(float, invariants(s.orbit).reversal_defect)


def energy_drift(s: OrbitSamples) -> float:
    """Return the largest change of the constrained energy, relative to it."""
    return invariants(s.orbit).energy_drift


@measures(CHECKS, "order of the start", "the first step is exact to second order: 3 - slope", 0.3)
def order_of_start(s: OrbitSamples) -> float:
    """Return by how much the order of the first displacement falls short of three in one step."""
    errors = [largest(orbit.displacement[0] - W) for orbit, W in zip(s.paths, s.exact[0], strict=True)]
    return max(0.0, 3 - report.slope(errors)) if errors[-1] > report.EXACT else 0.0


@measures(CHECKS, "order of momenta", report.SECOND, 0.15)
def order_of_momenta(s: OrbitSamples) -> float:
    """Return the distance of the order of the momenta from two; free paths of n steps are n times slower."""
    ends = zip((1, 1, 1) if s.forced else report.COUNTS, s.paths, strict=True)
    return report.off_two([relative(n * orbit.restricted_momentum[-1], s.exact[1]) for n, orbit in ends])


@measures(CHECKS, "order of poses", report.SECOND, 0.15)
def order_of_poses(s: OrbitSamples) -> float:
    """Return the distance of the order of the poses from two."""
    return report.off_two([gap(orbit.configuration[-1], s.exact[2]) for orbit in s.paths])


def definition(s: OrbitSamples) -> float:
    """Compare three compiled steps with the definition, solved by JAX."""
    need(s.discrete.route.compiled_route is not None, "the step that runs is the definition")
    need(s.discrete.forces is None, "forces act: check the system inside")
    slow = simulate(s.discrete, steps=3, backend="jax", **s.first)
    return max(relative(getattr(s.orbit[:4], name), getattr(slow, name)) for name in _AGREE)


@measures(FORCED, "no forces", "with neither potential nor force the bits are those of the system inside", 0.0)
def without_forces(s: OrbitSamples) -> float:
    """Count the states that differ."""
    alone = [dataclasses.replace(s.free, system=each) for each in (Forced(s.free.system), s.free.system)]
    runs = [simulate(each, steps=s.steps, throw=False, **s.start(s.step)) for each in alone]
    states = [np.concatenate([each.restricted_momentum.ravel(), each.configuration.ravel()]) for each in runs]
    return float(np.sum(states[0] != states[1])) if states[0].shape == states[1].shape else np.inf


@measures(FORCED, "order of the balance", "energy less work changes by the square of the step: |slope - 2|", 0.15)
def order_of_balance(s: OrbitSamples) -> float:
    """Return the distance of the order of the balance's residual from two."""
    left = [orbit.energy - orbit.energy[0] - orbit.work for orbit in s.paths]
    return report.off_two([largest(each) / largest(orbit.energy) for each, orbit in zip(left, s.paths, strict=True)])


@measures(FORCED, "friction", "friction alone never adds energy: its largest growth, relative", 1e-12)
def friction(s: OrbitSamples) -> float:
    """Return the largest growth of the energy in one step, relative to the first energy."""
    forced = s.forced
    need(forced and [*forced.parts] == ["friction"] and forced.potential is None, "not friction alone")
    need(s.free.conserves_energy, "free steps do not keep the energy")
    return float(np.diff(s.orbit.energy).max() / s.orbit.energy[0])


def checks_of_claims(samples: OrbitSamples) -> tuple[Check, ...]:
    """Return the checks that depend on what the discretization claims."""
    discrete = samples.discrete
    is_named = isinstance(discrete.difference, str) and discrete.constraint in ("skew", "exponential")
    claims = (
        ("reversal", "the way back solves the equations", is_named and samples.reverses, 1e-11, reversal),
        ("compiled reversal", "one compiled step and one back lead home", is_named, 1e-11, compiled_reversal),
        ("energy", "the constrained energy is constant", discrete.conserves_energy, 1e-12, energy_drift),
    )
    return tuple(
        Check(name, words if is_claimed else f"{words}: not required", tolerance if is_claimed else None, measure)
        for name, words, is_claimed, tolerance, measure in claims
    )


DEFINITION = Check("definition", "compiled steps solve the equations that JAX solves", 1e-11, definition)
