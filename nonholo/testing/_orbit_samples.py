"""Short orbits of a discretization, from one random admissible start, and the continuous motion to compare with.

The equations are homogeneous: n steps with an n-th of the velocity trace the path of one time step. So the order is
measured at the given time step, which a discrete Lagrangian of the user's may contain.
"""

import functools
from collections.abc import Callable
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
from nonholo.testing._report import NotApplicableError, need

COUNTS = (10, 20, 40)  # steps for the path whose order is measured
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
        self.S, self.A = np.asarray(self.system.constraint_subspace), np.asarray(self.system.annihilator)
        self.pose = self.group.random(rng)
        self._rows = rng.normal(size=len(self.S))

    def start(self, size: float) -> dict[str, Any]:
        """Return a start with steps of the given size."""
        need(len(self.S), "the constraint forbids all motion")
        velocity = self.directions.T @ self._rows
        speed = np.linalg.norm(self.group.hat(velocity), 2)
        return {
            "restricted_velocity": self._rows * (size / speed / self.discrete.time_step),
            "configuration": self.pose,
        }

    @functools.cached_property
    def directions(self) -> Float[np.ndarray, "k dim"]:
        """The admissible directions in the body at the start."""
        back = np.linalg.inv(self.pose)
        return self.S @ self.group.adjoint(back).T if self.spatial else self.S

    @functools.cached_property
    def run(self) -> tuple[list[Orbit], float] | Exception:
        """An orbit of moderate energy and the norm of its path, or why there is none."""
        return self._tried([self.steps], self.steps * STEP)

    @property
    def orbit(self) -> Orbit:
        """The orbit."""
        return _made(self.run, "the orbit failed")[0][0]

    @property
    def first(self) -> dict[str, Any]:
        """The start of the orbit."""
        return self.start(_made(self.run, "the orbit failed")[1] / self.steps)

    @functools.cached_property
    def W(self) -> Float[np.ndarray, "K N N"]:
        """Its displacements."""
        return self.orbit.displacement

    @functools.cached_property
    def finer(self) -> tuple[list[Orbit], float] | Exception:
        """One path in more and more steps and its norm, or why there is none."""
        return self._tried(list(COUNTS), PATH)

    @property
    def paths(self) -> list[Orbit]:
        """The path in more and more steps."""
        return _made(self.finer, "the finer orbits failed")[0]

    def _tried(self, counts: list[int], norm: float, halvings: int = 5) -> Any:
        """Run a path of a norm in several numbers of steps; where it meets a fold, one of half the norm."""
        try:
            return [simulate(self.discrete, steps=n, **self.start(norm / n)) for n in counts], norm
        except OutcomeError as fold:
            return self._tried(counts, norm / 2, halvings - 1) if halvings else fold
        except Exception as other:  # the code under test is a user's and may raise anything
            return other

    @functools.cached_property
    def exact(self) -> tuple[Float[np.ndarray, "3 N N"], Float[np.ndarray, "k"], Float[np.ndarray, "N N"]]:
        """The continuous path: its first displacements, one for each count, its last momentum and pose."""
        norm = _made(self.finer, "the finer orbits failed")[1]
        k, h, start = len(self.S), float(self.discrete.time_step), self.start(norm)
        velocity = start["restricted_velocity"] @ self.directions
        r = self.directions @ (self.system.inertia_operator @ velocity)
        times = [h / n for n in reversed(COUNTS)]
        found = scipy.integrate.solve_ivp(
            vector_field(self.system),
            (0.0, h),
            np.concatenate([r, self.pose.ravel()]),
            method="DOP853",
            t_eval=[*times, h],
            rtol=1e-12,
            atol=1e-13 * (1 + np.abs(r).max()),
        ).y.T
        poses = found[:, k:].reshape(-1, *self.pose.shape)
        return np.linalg.inv(self.pose) @ poses[-2::-1], found[-1, :k], poses[-1]

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

    def impulse(self, before: np.ndarray, after: np.ndarray, g: np.ndarray) -> Float[np.ndarray, "K dim"]:
        """Return P(after) - Ad* P(before) of displacements that meet at g; in space if the constraint is."""
        arriving = self.group.coadjoint(before, self.momentum(before))
        jump = self.momentum(after) - arriving
        return self.group.coadjoint(np.linalg.inv(g), jump) if self.spatial else jump

    def momentum(self, W: np.ndarray) -> Float[np.ndarray, "K dim"]:
        """Return the discrete momenta of displacements."""
        return discrete_legendre(self.discrete, W)


def _made(found: Any, otherwise: str) -> Any:
    """Return what a run made; where it failed, one check has failed, and the others have nothing to judge."""
    if isinstance(found, Exception):
        raise NotApplicableError(str(found) if isinstance(found, NotApplicableError) else otherwise)
    return found


def _of_jax(function: Callable[[Any], Any], W: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "..."]:
    """Return the values of a function of one JAX matrix; JAX loads slowly, and only callables need it."""
    with needs("jax", "check_discretization(...) with functions"):
        from nonholo.discrete.definition import map_each

    return map_each(function, W.reshape(-1, *W.shape[-2:])).reshape(W.shape[:-2])
