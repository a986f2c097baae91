"""Residuals of measurements of motions, on groups and in coordinates, and first states: in JAX, compiled once."""

import abc
import dataclasses
import functools
from collections.abc import Callable
from typing import Any, cast

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.analysis.inverse import _measurements
from nonholo.analysis.inverse._likelihood import Shapes, by_name
from nonholo.analysis.inverse._measurements import WHERE, Names, Trial, first, names_of
from nonholo.base.checks import error, shown
from nonholo.base.traced import rows_above
from nonholo.base.types import Array
from nonholo.discrete import discretize
from nonholo.discrete.definition import in_double
from nonholo.groups import SE, matrix_from_quaternion
from nonholo.lagrange_dalembert import checked_state, equations, place, tangents, trace
from nonholo.lagrange_dalembert import in_double as of_system
from nonholo.orbit import Orbit
from nonholo.simulation import simulate
from nonholo.simulation.traced import rollout
from nonholo.systems import AbstractCoordinateSystem, reach_of, refuse_fixed_in_space

_COPIES = 8  # of matrices at a node, and their derivatives


@dataclasses.dataclass(frozen=True)
class AbstractModel(abc.ABC):
    """Motions of a system: what can be measured of them, and where they begin.

    Attributes:
        system: The system of the guess.
        maker: What makes the system, as JAX traces it.
    """

    system: Any
    maker: Any

    @property
    def names(self) -> Names:
        """The names of columns by kind."""
        return names_of(self.system.group)

    def residuals(self, program: Any, numbers: Array, starts: Array, poses: Array, kinds: Trial) -> dict[str, Any]:
        """Return by kind residuals (T, K, c), measured minus computed, with derivatives by numbers and by starts.

        Trials run on through nodes at which nothing is measured, so that few numbers of steps are compiled. A table of
        forces, which may end with the record, has its own number.
        """
        (run, time_step), nodes = program, next(iter(kinds.values())).shape[1]
        room = nodes if getattr(self.system, "table", None) is not None else rows_above(nodes)
        more = (0, 0), (0, room - nodes), (0, 0)
        longer = {kind: np.pad(rows, more, constant_values=np.nan) for kind, rows in kinds.items()}
        parts = in_double(run, time_step, numbers, starts, poses, longer)
        return {kind: tuple(x[:, :nodes] for x in part) for kind, part in parts.items()}


class GroupModel(AbstractModel):
    """Motions of a body on a group."""

    def each(self, count: int) -> float:
        """Return the bytes of a node under a number of parameters."""
        group = self.system.group
        return _COPIES * 8.0 * (1 + count + self.system.rank + group.dim) * group.size**2

    def first(self, h: float, kinds: Trial, *, is_robust: bool) -> tuple[np.ndarray, np.ndarray]:
        """Return a first pose and a first start."""
        return first(self.system.group, self.system.constraint_subspace, h, kinds, is_robust=is_robust)

    def program(self, system_of: Callable[..., Any], shapes: Shapes, time_step: float) -> tuple[Any, ...]:
        """Return compiled residuals of trials by kind with derivatives, and the time step."""
        return _compile(GroupModel(None, self.maker), system_of, shapes), time_step

    def orbit(self, system: Any, h: float, start: np.ndarray, pose: np.ndarray, steps: int) -> Orbit:
        """Return the motion of a trial."""
        return simulate(discretize(system, h), **self.first_state(system, start, pose), steps=steps)

    def first_state(self, system: Any, start: Array, pose: Array) -> dict[str, Array]:
        """Return the first velocity, and the pose that a start changes to; one along the constraint changes none."""
        k, dim, xp = system.rank, system.group.dim, start.__array_namespace__()
        if len(start) > k:
            pose = pose @ system.group.exp(xp.pad(start[k:], (0, k + dim - len(start))))
        return {"restricted_velocity": start[:k], "configuration": pose}

    def gap(self, kind: str, values: Array, system: Any, states: Any) -> Array:
        """Return measured minus computed numbers, zero where nothing was measured."""

        def velocity() -> Array:
            inertia = jnp.asarray(system.constrained_inertia)
            return jnp.linalg.solve(inertia, states.restricted_momentum.T).T @ system.constraint_subspace

        return _gap(system.group, kind, values, states, velocity)


@functools.lru_cache(maxsize=16)
def _compile(model: Any, system_of: Callable[..., Any], shapes: Shapes, own_step: float | None = None) -> Any:
    """Return compiled rows of trials by kind, with derivatives by numbers and starts, for a time step or for all."""

    def one(time_step: Array, numbers: Array, start: Array, pose: Array, kinds: Trial) -> tuple[Any, Any]:
        system, steps = system_of(by_name(shapes, numbers)), len(next(iter(kinds.values()))) - 1
        motion = discretize(system, own_step or time_step)
        states = rollout(motion, **model.first_state(system, start, pose), steps=steps)
        rows = {kind: model.gap(kind, values, system, states) for kind, values in kinds.items()}
        return rows, rows

    each = jax.vmap(jax.jacfwd(one, argnums=(1, 2), has_aux=True), in_axes=(None, None, 0, 0, 0))

    def by_kind(*arguments: Any) -> dict[str, tuple[Array, Array, Array]]:
        slopes, rows = each(*arguments)
        return {kind: (rows[kind], *slopes[kind]) for kind in rows}  # JAX sorts a dictionary: only names are kept

    return jax.jit(by_kind)


def _gap(group: Any, kind: str, values: Array, orbit: Any, velocity: Callable[[], Array]) -> Array:
    """Return measured minus computed numbers, zero where nothing was measured; of turns the vector of the rotation."""
    there = jnp.isfinite(values)
    values, g = jnp.where(there, values, 1.0), orbit.configuration
    if kind == "position":
        gap = values - g[:, :-1, -1]
    elif kind == "rate":
        gap = values - velocity()[:, : values.shape[1]]
    elif group == SE(2):
        cos, sin = g[:, 0, 0], g[:, 1, 0]
        c, s = jnp.cos(values[:, 0]), jnp.sin(values[:, 0])
        gap = jnp.arctan2(s * cos - c * sin, c * cos + s * sin)[:, None]
    else:
        turn = jnp.swapaxes(g[:, :3, :3], 1, 2) @ matrix_from_quaternion(values)
        odd = (turn - jnp.swapaxes(turn, 1, 2)) / 2
        gap, there = jnp.stack([odd[:, 2, 1], odd[:, 0, 2], odd[:, 1, 0]], axis=1), there[:, :3]
    return jnp.where(there, gap, 0.0)


_CORRECTIONS = 12  # of a first configuration, to holonomic constraints
_SAMPLES = 3  # states at which coordinates that the equations do not contain are looked for


class AbstractFunctionModel(AbstractModel):
    """Motions of a system by functions.

    A start is the momentum along admissible directions at the first state, and by what the first configuration is
    another one, along holonomic constraints. A pose has beside the latter both, and ways back to these.
    """

    @abc.abstractmethod
    def begin(self, h: float, kinds: Trial, *, is_robust: bool) -> tuple[np.ndarray, np.ndarray, list[int]]:
        """Return a first configuration or pose, rates, and the coordinates or directions of which these are."""

    def each(self, count: int) -> float:
        """Return the bytes of a node under a number of parameters."""
        n = self.system.dimension
        return 8.0 * 8.0 * (1 + count + 2 * n) * 3 * n

    def first(self, h: float, kinds: Trial, *, is_robust: bool) -> tuple[np.ndarray, np.ndarray]:
        """Return a first pose and a first start."""
        system, (q, rates, at) = self.system, self.begin(h, kinds, is_robust=is_robust)
        x, still = place(system, q, 0.0), np.zeros(system.dimension)
        A, b = of_system(equations.forms, system, x), -of_system(equations.constraint, system, x, still)
        basis, v = np.linalg.svd(A)[2][len(A) :].T, np.linalg.pinv(A) @ b
        v = v + basis @ np.linalg.lstsq(basis[at], rates - v[at])[0]
        free = np.eye(len(v))[:, self._free(at, x, v, h)]
        gradients = A[system.velocity_constraints : len(A) - len(system.prescribed)] @ free
        shifts, back = free @ np.linalg.svd(gradients)[2][len(gradients) :].T, free @ np.linalg.pinv(gradients)
        momentum = basis.T @ of_system(equations.momentum, system, x, v)
        pose = np.concatenate([np.ravel(part) for part in (q, basis, shifts, back)])
        return pose, np.append(momentum, np.zeros(shifts.shape[1]))

    def _free(self, at: list[int], x: np.ndarray, v: np.ndarray, h: float) -> list[int]:
        """Return the directions whose beginning is fitted: those measured, and those that the equations contain."""
        rng, n, units = np.random.default_rng(0), len(v), tangents.units(self.system, x, v)
        reach = reach_of(x[:n] if self.system.coordinates else np.zeros(n), units)
        speed = units * np.abs(v / units).max() if np.any(v) else reach
        sizes = np.append(reach, np.ones(int(self.system.is_driven)))
        xis = rng.normal(0.0, 0.3, (_SAMPLES, len(sizes))) * sizes
        vs = v + rng.normal(0.0, 0.3, (_SAMPLES, n)) * speed
        matters = np.abs(of_system(_slopes, self.system, x, xis, vs, np.float64(h))).max((0, 1))[:n] > 0
        driven = {index for index, _ in self.system.prescribed}
        return [i for i in range(n) if (i in at or matters[i]) and i not in driven]

    def program(self, system_of: Callable[..., Any], shapes: Shapes, time_step: float) -> tuple[Any, ...]:
        """Return compiled residuals of trials by kind with derivatives, and the time step."""
        return _compile(self, system_of, shapes, time_step), time_step

    def first_state(self, system: Any, start: Array, pose: Array) -> dict[str, Array]:
        """Return the first configuration and momentum of a trial."""
        q, p = _begin(system.plain, start, pose)
        return {"momentum": p, "configuration": q}

    def orbit(self, system: Any, h: float, start: np.ndarray, pose: np.ndarray, steps: int) -> Any:
        """Return the motion of a trial."""
        q, p = of_system(_begin, system, start, pose)
        return simulate(discretize(system, h), momentum=p, configuration=q, steps=steps)


class CoordinateModel(AbstractFunctionModel):
    """Motions in coordinates, of which positions are measured, and each other coordinate by itself."""

    @property
    def names(self) -> Names:
        """The names of columns by kind."""
        own = self.system.coordinates
        place = tuple(name for name in "xyz" if name in own) if {"x", "y"} <= set(own) else ()
        kinds: Names = {"position": (place,)} if place else {}
        for name in (name for name in own if name not in place):
            kinds[name] = ((name,), ("heading",)) if name == self.system.heading else ((name,),)
        return kinds

    def columns(self, kind: str) -> list[int]:
        """Return the coordinates of a kind."""
        return [self.system.coordinates.index(name) for name in self.names[kind][0]]

    def begin(self, h: float, kinds: Trial, *, is_robust: bool) -> tuple[np.ndarray, np.ndarray, list[int]]:
        """Return a first configuration and rates, from straight lines between nodes, and of what these are."""
        system, heading = self.system, self.system.heading
        series = {
            kind: _measurements.measured_rows(kind, rows, is_robust, is_angle=kind == heading)
            for kind, rows in kinds.items()
            if np.isfinite(rows).any()
        }
        ends = _measurements.ends_of(series)
        if heading and "position" in series and heading not in series:
            x, y = _measurements.chords_of(ends, *series["position"]).T
            early, late = np.unwrap(np.arctan2(y, x))  # in the middle of the chords
            series[heading] = np.array(ends), np.array([[1.5 * early - 0.5 * late], [0.5 * (early + late)]])
        at = [i for kind in series for i in self.columns(kind)]
        both = np.concatenate([_measurements.at_nodes(ends, *rows) for rows in series.values()], axis=1)
        rates = (both[1] - both[0]) / ((ends[1] - ends[0]) * h)
        q = np.zeros(system.dimension)
        q[at] = both[0] - rates * ends[0] * h
        for index, motion in system.plain.prescribed:
            q[index] = float(motion(np.float64(0.0)))
        if system.holonomic is not None:
            q = checked_state(system, q, {"body_velocity": 0 * q}, 0.0, "fit", project=True)[0][: len(q)]
        return q, rates, at

    def gap(self, kind: str, values: Array, _system: Any, states: Any) -> Array:
        """Return measured minus computed numbers, zero where nothing was measured; of a heading less full turns."""
        there = jnp.isfinite(values)
        gap = jnp.where(there, values, 0.0) - states.configuration[:, np.array(self.columns(kind))]
        return jnp.where(there, jnp.arctan2(jnp.sin(gap), jnp.cos(gap)) if kind == self.system.heading else gap, 0.0)


class PoseModel(AbstractFunctionModel):
    """Motions of a system by functions on a group, of which that is measured which is of bodies on groups."""

    def begin(self, h: float, kinds: Trial, *, is_robust: bool) -> tuple[np.ndarray, np.ndarray, list[int]]:
        """Return a first pose and body velocities, and of which directions these are."""
        group = self.system.group
        if not np.isfinite(kinds["turn"]).any():
            raise error(WHERE, "have turns where the constraint depends on the pose", "none", "Measure turns.")
        g, motion = first(group, np.eye(group.dim), h, kinds, is_robust=is_robust)
        count = len(motion) - group.dim  # of turns, which come first, and of positions where there are any
        return g, motion[:count], list(range(count))

    def gap(self, kind: str, values: Array, system: Any, states: Any) -> Array:
        """Return measured minus computed numbers, zero where nothing was measured."""
        velocity = jax.vmap(functools.partial(equations.inverse_legendre, system.plain))
        return _gap(system.group, kind, values, states, lambda: velocity(states.configuration, states.momentum))


def _begin(system: Any, start: Array, pose: Array) -> tuple[Array, Array]:
    """Return the first configuration and momentum of a trial."""
    k, n = system.dimension - system.constraints, system.dimension
    ends = np.cumsum([np.prod(system.shapes[0]), n * k, n * (len(start) - k)])
    q, *parts = jnp.split(pose, ends)
    basis, shifts, back = (part.reshape(n, -1) for part in parts)
    q, p = system.places.beside(q.reshape(system.shapes[0]), shifts @ start[k:]), basis @ start[:k]
    if system.holonomic is None:
        return q, p

    def onward(_: Any, q: Array) -> Array:
        x = jnp.append(q, 0.0) if system.is_driven else q
        slope = jax.lax.stop_gradient(jax.jacfwd(equations.holonomic, argnums=1)(system, x)[:, :n] @ back)
        return q - back @ jnp.linalg.solve(slope, equations.holonomic(system, x))

    return jax.lax.fori_loop(0, _CORRECTIONS, onward, q), p  # the last correction has the derivative of the root


def _slopes(system: Any, place: Array, xis: Array, vs: Array, h: Array) -> Array:
    """Return the derivatives of the equations of steps by their places, beside one."""

    def of_step(shift: Array, xi: Array, v: Array) -> Array:
        x = system.places.beside(system.places.beside(place, xi), shift)
        parts = *equations.momenta(system, x, v, h), equations.discrete_constraints(system, x, v, h)
        return jnp.concatenate([*parts, equations.forms(system, x).ravel()])

    return jax.vmap(functools.partial(jax.jacfwd(of_step), jnp.zeros(xis.shape[1])))(xis, vs)


def maker_of(system_of: Callable[..., Any], shapes: Shapes, numbers: np.ndarray) -> tuple[Any, ...]:
    """Return what a function makes of numbers, as JAX traces it now: another one where what it reads has changed.

    Forces and potentials that are functions count as themselves.
    """

    def parts(x: Array) -> tuple[Any, list[Any], list[Any]]:
        system = system_of(by_name(shapes, x))
        leaves, structure = jax.tree.flatten(system)
        own = system.parameters.values() if isinstance(system, AbstractCoordinateSystem) else leaves
        return structure, [each for each in own if not callable(each)], [each for each in leaves if callable(each)]

    def leaves(x: Array) -> Array:
        return jnp.concatenate([jnp.ravel(jnp.asarray(each)) for each in parts(x)[1]])

    structure, _, functions = parts(numbers)
    program = trace("fit(system_of=...)", leaves, "the parameters", (jax.ShapeDtypeStruct(numbers.shape, float),))
    return structure, tuple(functions), program


def model_of(system_of: Callable[..., Any], shapes: Shapes, numbers: np.ndarray) -> GroupModel | AbstractFunctionModel:
    """Return the motions of the system of a guess; refused if they do not vary its parameters alone."""
    where, system = "fit(system_of=...)", system_of(by_name(shapes, numbers))
    if not isinstance(system, AbstractCoordinateSystem):
        remedy = "Return a SuslovTop, a sleigh, an LLSystem or a LagrangeDAlembert."
        refuse_fixed_in_space(where, system, remedy, shown(system))
        return GroupModel(system, maker_of(system_of, shapes, numbers))
    if not (system.parameters and cast(Any, system).family == system_of(by_name(shapes, numbers)).family):
        remedy = "Make the system once, with parameters=..., and return system.with_parameters(**p)."
        raise error(where, "vary the parameters of one system", type(system).__name__, remedy)
    kind = CoordinateModel if getattr(system, "coordinates", ()) else PoseModel
    return kind(system, maker_of(system_of, shapes, numbers))
