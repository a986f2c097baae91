"""Records of coordinates: a first state from the first numbers, and what a motion misses of them; in JAX."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.analysis.inverse._first import at_nodes, ends_of, measured_rows
from nonholo.analysis.inverse._measurements import Names
from nonholo.analysis.inverse._problem import Shapes, named
from nonholo.base.checks import error
from nonholo.base.types import Array
from nonholo.discrete import discretize
from nonholo.discrete.definition import in_double
from nonholo.lagrange_dalembert import equations, place
from nonholo.lagrange_dalembert import in_double as of_system
from nonholo.simulation import simulate
from nonholo.simulation.traced import rollout

_SAMPLES = 3  # states at which coordinates that the equations do not contain are looked for


@dataclasses.dataclass(frozen=True)
class CoordinateModel:
    """Motions of a system in coordinates: what can be measured of them, and where they begin.

    A start is the momentum along admissible directions at the first state, and by what the first configuration is
    another one. A pose has beside the latter columns of both.

    Attributes:
        system: The system of the guess.
    """

    system: Any

    @property
    def names(self) -> Names:
        """The names of columns by kind: positions, and each other coordinate by itself."""
        own = self.system.coordinates
        place = tuple(name for name in "xyz" if name in own) if {"x", "y"} <= set(own) else ()
        known: Names = {"position": (place,)} if place else {}
        for name in (name for name in own if name not in place):
            known[name] = ((name,), ("heading",)) if name == self.system.heading else ((name,),)
        return known

    def each(self, count: int) -> float:
        """Return the bytes of a node under a number of parameters."""
        n = self.system.dimension
        return 8.0 * 8.0 * (1 + count + 2 * n) * 3 * n

    def columns(self, kind: str) -> list[int]:
        """Return the coordinates of a kind."""
        return [self.system.coordinates.index(name) for name in self.names[kind][0]]

    def first(self, h: float, kinds: dict[str, np.ndarray], *, is_robust: bool) -> tuple[np.ndarray, np.ndarray]:
        """Return a first pose and a first start, from straight lines between nodes."""
        system, heading = self.system, self.system.heading
        seen = {kind: rows for kind, rows in kinds.items() if np.isfinite(rows).any()}
        known = {kind: measured_rows(kind, rows, is_robust, is_angle=kind == heading) for kind, rows in seen.items()}
        ends = ends_of(known)
        if heading and "position" in known and heading not in known:
            known[heading] = np.array(ends), _course(ends, *known["position"])
        at = [i for kind in known for i in self.columns(kind)]
        both = np.concatenate([at_nodes(ends, *rows) for rows in known.values()], axis=1)
        rates = (both[1] - both[0]) / ((ends[1] - ends[0]) * h)
        q = np.zeros(system.dimension)
        q[at] = both[0] - rates * ends[0] * h
        for index, motion in system.plain.prescribed:
            q[index] = float(motion(np.float64(0.0)))
        x = place(system, q, 0.0)
        A, b = of_system(equations.forms, system, x), -of_system(equations.constraint, system, x, 0 * q)
        basis, v = np.linalg.svd(A)[2][len(A) :].T, np.linalg.pinv(A) @ b
        v = v + basis @ np.linalg.lstsq(basis[at], rates - v[at])[0]
        moved = np.eye(len(q))[:, self._free(at, x, v, h)]
        momentum = basis.T @ of_system(equations.momentum, system, x, v)
        return np.column_stack([q, basis, moved]), np.append(momentum, np.zeros(moved.shape[1]))

    def _free(self, measured: list[int], x: np.ndarray, v: np.ndarray, h: float) -> list[int]:
        """Return the coordinates whose beginning is fitted: those measured, and those that the equations contain."""
        rng, n = np.random.default_rng(0), len(v)
        xs, vs = x + rng.normal(0.0, 0.3, (_SAMPLES, len(x))), v + rng.normal(0.0, 0.3, (_SAMPLES, n))
        felt = np.abs(of_system(_slopes, self.system, xs, vs, np.float64(h))).max((0, 1))[:n] > 0
        fixed = {index for index, _ in self.system.prescribed}
        return [i for i in range(n) if (i in measured or felt[i]) and i not in fixed]

    def missed(
        self, system_of: Callable[..., Any], shapes: Shapes, time_step: float, numbers: Array, starts: Array, *data: Any
    ) -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Return by kind residuals (T, K, c), measured minus computed, with derivatives by numbers and by starts."""
        return in_double(_compiled(self, system_of, shapes, time_step), numbers, starts, *data)

    def orbit(self, system: Any, h: float, start: np.ndarray, pose: np.ndarray, steps: int) -> Any:
        """Return the motion of a trial."""
        q, p = _begin(system, start, pose)
        return simulate(discretize(system, h), momentum=p, configuration=q, steps=steps)

    def gap(self, kind: str, measured: Array, q: Array) -> Array:
        """Return measured minus computed numbers, zero where nothing was measured; of a heading less full turns."""
        there = jnp.isfinite(measured)
        gap = jnp.where(there, measured, 0.0) - q[:, np.array(self.columns(kind))]
        return jnp.where(there, jnp.arctan2(jnp.sin(gap), jnp.cos(gap)) if kind == self.system.heading else gap, 0.0)


def _course(ends: tuple[int, int], nodes: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return headings at two nodes of what moves forward, from the chords after them."""
    chords = np.diff(at_nodes((*ends, 2 * ends[1] - ends[0]), nodes, rows), axis=0)
    first, later = np.unwrap(np.arctan2(chords[:, 1], chords[:, 0]))
    return np.array([[1.5 * first - 0.5 * later], [0.5 * (first + later)]])


def _begin(system: Any, start: Array, pose: Array) -> tuple[Array, Array]:
    """Return the first configuration and momentum of a trial."""
    k = system.dimension - system.constraints
    return pose[:, 0] + pose[:, 1 + k :] @ start[k:], pose[:, 1 : 1 + k] @ start[:k]


def _slopes(system: Any, xs: Array, vs: Array, h: Array) -> Array:
    """Return the derivatives of the equations of steps by their places."""

    def of_step(x: Array, v: Array) -> Array:
        parts = *equations.momenta(system, x, v, h), equations.discrete_constraints(system, x, v, h)
        return jnp.concatenate([*parts, equations.forms(system, x).ravel()])

    return jax.vmap(jax.jacfwd(of_step))(xs, vs)


@functools.lru_cache(maxsize=8)
def _compiled(
    model: CoordinateModel, system_of: Callable[..., Any], shapes: Shapes, time_step: float
) -> Callable[..., Any]:
    def one(numbers: Array, start: Array, pose: Array, kinds: dict[str, Array]) -> tuple[Any, Any]:
        system = system_of(named(shapes, numbers))
        q, p = _begin(system, start, pose)
        steps = len(next(iter(kinds.values()))) - 1
        states = rollout(discretize(system, time_step), momentum=p, configuration=q, steps=steps)
        rows = {kind: model.gap(kind, measured, states.configuration) for kind, measured in kinds.items()}
        return rows, rows

    each = jax.vmap(jax.jacfwd(one, argnums=(0, 1), has_aux=True), in_axes=(None, 0, 0, 0))

    def by_kind(*arguments: Any) -> dict[str, tuple[Array, Array, Array]]:
        slopes, rows = each(*arguments)
        return {kind: (rows[kind], *slopes[kind]) for kind in rows}

    return jax.jit(by_kind)


def coordinate_model(system: Any, again: Any) -> CoordinateModel:
    """Return the model of a system that a function made twice; refused if it does not vary parameters alone."""
    if not (system.parameters and system.family == again.family):
        remedy = "Make the system once, with parameters=..., and return system.with_parameters(**p)."
        raise error("fit(system_of=...)", "vary the parameters of one system", type(system).__name__, remedy)
    if system.holonomic is not None:
        remedy = "Choose coordinates that satisfy them."
        raise error("fit(system_of=...)", "have no holonomic constraints", "some", remedy)
    return CoordinateModel(system)
