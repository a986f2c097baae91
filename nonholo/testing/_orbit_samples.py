"""Short orbits of a discretization, from one random admissible start, and the continuous motion to compare with.

Free equations are homogeneous: n steps with an n-th of the velocity trace the path of one time step. So the order is
measured at the given time step, which a discrete Lagrangian of the user's may contain. Under forces, which are no
functions of a user's Lagrangian, the time step is divided instead.

Impulses of forces by their definition, and the equations of motion piece by piece.
"""

import dataclasses
import functools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import scipy.integrate

from nonholo.base.checks import needs
from nonholo.base.results import OutcomeError
from nonholo.base.types import Float
from nonholo.continuous import vector_field
from nonholo.discrete import Discretization, discrete_legendre
from nonholo.orbit import Orbit
from nonholo.simulation import simulate
from nonholo.systems import AbstractSystem, Forced, force_of
from nonholo.testing._report import NotApplicableError, need

COUNTS = (10, 20, 40)  # steps for the path whose order is measured
EXACT = 1e-11  # errors below it are rounding, and have no order
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
        inside = getattr(self.system, "system", None)  # of a Forced
        self.free = dataclasses.replace(discrete, system=inside) if inside else discrete
        self.step = min(STEP, float(discrete.time_step)) if self.forced else STEP
        self.span = min(PATH, COUNTS[0] * float(discrete.time_step)) if self.forced else float(discrete.time_step)
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
        back = np.linalg.inv(self.pose)
        return self.S @ self.group.adjoint(back).T if self.spatial else self.S

    @functools.cached_property
    def run(self) -> tuple[list[Orbit], float] | Exception:
        """An orbit of moderate energy and the norm of its path, or why there is none."""
        return self._try([self.steps], self.steps * self.step)

    @property
    def orbit(self) -> Orbit:
        """The orbit."""
        return result_of(self.run, "the orbit failed")[0][0]

    @property
    def first(self) -> dict[str, Any]:
        """The start of the orbit."""
        return self.start(result_of(self.run, "the orbit failed")[1] / self.steps)

    @functools.cached_property
    def W(self) -> Float[np.ndarray, "K N N"]:
        """Its displacements."""
        return self.orbit.displacement

    @functools.cached_property
    def finer(self) -> tuple[list[Orbit], float] | Exception:
        """One path in more and more steps and its norm, or why there is none."""
        return self._try(list(COUNTS), self.path)

    @property
    def paths(self) -> list[Orbit]:
        """The path in more and more steps."""
        return result_of(self.finer, "the finer orbits failed")[0]

    def _try(self, counts: list[int], norm: float, halvings: int = 5) -> Any:
        """Run a path of a norm in several numbers of steps; where it meets a fold, one of half the norm."""
        try:
            return [self._path(n, norm, len(counts) > 1) for n in counts], norm
        except OutcomeError as fold:
            return self._try(counts, norm / 2, halvings - 1) if halvings else fold
        except Exception as other:  # the code under test is a user's and may raise anything
            return other

    def slower(self, count: int) -> int:
        """Return how many times slower than the flow a path of this many steps is."""
        return 1 if self.forced else count

    def _path(self, count: int, norm: float, divides: bool) -> Orbit:
        if self.forced is None or not divides:
            return simulate(self.discrete, steps=count, **self.start(norm / count))
        forced = self.forced
        if forced.table is not None:
            rows = np.repeat(forced.rows(np.arange(COUNTS[0])), count // COUNTS[0], axis=0)
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
    def node_kicks(self) -> Float[np.ndarray, "K dim"]:
        """The impulses of forces at the nodes between two steps."""
        return self.kicks[0][1:] + self.kicks[1][:-1]

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
        norm = result_of(self.finer, "the finer orbits failed")[1]
        k, h, start = len(self.S), self.span, self.moving(norm / self.span)
        velocity = start["restricted_velocity"] @ self.directions
        r = self.directions @ (self.system.inertia_operator @ velocity)
        times = [h / n for n in reversed(COUNTS)]
        options: Any = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13 * (1 + np.abs(r).max())}
        state, states = np.concatenate([r, self.pose.ravel()]), np.zeros((0, k + self.pose.size))
        for field, ends in fields_of(self.system, times, h):
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
        arriving = self.group.coadjoint(before, self.momentum(before)) + kick
        jump = self.momentum(after) - arriving
        return self.group.coadjoint(np.linalg.inv(g), jump) if self.spatial else jump

    def momentum(self, W: np.ndarray) -> Float[np.ndarray, "K dim"]:
        """Return the discrete momenta of displacements."""
        return discrete_legendre(self.free, W)


def result_of(outcome: Any, otherwise: str) -> Any:
    """Return what a run made; where it failed, one check has failed, and the others have nothing to judge."""
    if isinstance(outcome, Exception):
        raise NotApplicableError(str(outcome) if isinstance(outcome, NotApplicableError) else otherwise)
    return outcome


def result_or_raise(outcome: Any) -> Any:
    """Return what a run made, or raise what it raised."""
    if isinstance(outcome, Exception):
        raise outcome
    return outcome


def _of_jax(function: Callable[[Any], Any], W: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "..."]:
    """Return the values of a function of one JAX matrix; JAX loads slowly, and only callables need it."""
    with needs("jax", "check_discretization(...) with functions"):
        from nonholo.discrete.definition import map_each

    return map_each(function, W.reshape(-1, *W.shape[-2:])).reshape(W.shape[:-2])


def slope(errors: list[float]) -> float:
    """Return the order of errors in the numbers of steps, from the last two."""
    return float(np.log(errors[-2] / errors[-1]) / np.log(COUNTS[-1] / COUNTS[-2]))


def off_two(errors: list[float]) -> float:
    """Return the distance of the order of errors from two; zero of rounding."""
    return abs(slope(errors) - 2) if errors[-1] > EXACT else 0.0


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
    first, last = [], []
    for k in range(len(orbit)):
        first.append(_impulse(forced, g[k], time[k], nodes[k], forced.directions(g[k]).T @ leaving[k], k, half))
    for k in range(len(orbit) - 1):
        before = forced.directions(ends[k]).T @ arriving[k]
        last.append(_impulse(forced, ends[k], time[k + 1], before, nodes[k + 1], k, half))
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


def fields_of(
    system: AbstractSystem, times: list[float], end: float
) -> Iterator[tuple[Callable[..., Any], list[float]]]:
    """Give vector fields with the times at which each is wanted: one, of a table a field for each of ten rows."""
    forced, pieces = system.forces, 10
    if forced is None or forced.table is None:
        yield vector_field(system), [0.0, *times, end]
        return
    for k, row in enumerate(forced.rows(np.arange(pieces))):
        acting = dataclasses.replace(forced, force=lambda *state, row=row: row + forced.applied_force(*state))
        yield vector_field(acting), [0.0, *times] if k == 0 else [k * end / pieces, (k + 1) * end / pieces]
