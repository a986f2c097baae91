"""The transcription of a motion on a group and in coordinates, from arguments of `steer`.

Both kinds of nodes offer the same functions. A state x is a pose with the momenta of its node, an inner part z what a
step has besides, a chart of the displacement or a velocity with multipliers; f are the forces of the step.
"""

import dataclasses
import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from nonholo import lagrange_dalembert
from nonholo.analysis.steering import _arguments
from nonholo.analysis.steering._arguments import Limits, Way
from nonholo.analysis.steering._shooting import driven_side_by_side, goal_gap, goal_units, sizes
from nonholo.analysis.steering._steer import driven
from nonholo.analysis.steering._transcription import Program, Steps, bounds_of
from nonholo.base.checks import array, error, shown
from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization
from nonholo.discrete.definition import Rollout, free_rows, in_double, step_residual
from nonholo.groups import SE
from nonholo.lagrange_dalembert import LagrangeDAlembert, equations, place
from nonholo.simulation.traced import rollout
from nonholo.systems import Forced


class GroupNodes(NamedTuple):
    """Steps on a group.

    Attributes:
        free: The discretization without forces.
        forced: The system with its forces, None where free.
        outline: Body points that keep clear of obstacles, (points, n).
        pose: The last pose, None where free.
    """

    free: Discretization
    forced: Forced | None
    outline: Float[Array, "points n"]
    pose: Array | None

    @property
    def sizes(self) -> tuple[int, int, int]:
        """How many numbers a state, an inner part and the forces of a step have."""
        group, k = self.free.system.group, self.free.system.rank
        return free_rows(group) * group.size + k, len(self.free.variety.chart), k

    def residual(self, x: Array, z: Array, f: Array, after: Array, row: Array) -> Array:
        """Return the equations of a step, under the row of a table of forces too."""
        covector = jnp.linalg.pinv(jnp.asarray(self.free.system.constraint_subspace)) @ f + row
        return step_residual(self.free, self.forced, self.state(x), z, self.state(after), covector)

    def goal_gap(self, x: Array) -> Array:
        """Return what vanishes at the goal and is no number of the state."""
        return goal_gap(self.free.system, (None, None, self.pose, None), *self.state(x))

    def places(self, x: Array) -> Array:
        """Return where the points of the outline are, (points, n)."""
        return _arguments.body_points(self.state(x)[0], self.outline)

    def numbers(self, _z: Array, x: Array) -> Array:
        """Return what bounds of states are about: entries of the pose, momenta."""
        g, momenta = self.state(x)
        return jnp.append(g, momenta)

    def state(self, x: Array) -> tuple[Array, Array]:
        """Return pose and momenta."""
        group = self.free.system.group
        rows = free_rows(group)
        g = jnp.concatenate([x[: rows * group.size].reshape(rows, -1), jnp.asarray(group.identity[rows:])])
        return g, x[rows * group.size :]


def moving_outline(system: LagrangeDAlembert, function: Callable[[Array], Array]) -> Any:
    """Return the checked points in axes of the body of a configuration, as JAX traces them."""
    where, of = "steer(outline=...)", f"{system.dimension} coordinates"
    outline = lagrange_dalembert.trace(where, function, of, (jax.ShapeDtypeStruct((system.dimension,), float),))
    if len(outline.shape) != 2 or outline.shape[1] != 2 or not outline.shape[0]:
        remedy = "Return points in axes of the body, x ahead."
        raise error(where, "return an array of shape (points, 2)", f"shape {outline.shape}", remedy)
    return outline


class CoordinateNodes(NamedTuple):
    """Steps in coordinates, or of a system by functions on a group.

    Attributes:
        system: The system.
        time_step: h.
        outline: Points in axes of the body that keep clear of obstacles, (points, n), or a `moving_outline`.
        unit: Units of velocities in which each has the same energy.
        directions: Rows span the admissible velocities near the goal, in these; none where its velocity is free.
        velocity: The last velocity.
        pose: The last pose, None where free and in coordinates.
    """

    system: Any
    time_step: Array
    outline: Any
    unit: Array
    directions: Array
    velocity: Array
    pose: Array | None

    @property
    def sizes(self) -> tuple[int, int, int]:
        """How many numbers a state, an inner part and the forces of a step have."""
        n = self.system.dimension
        return math.prod(self.system.place_shape) + n, n + self.system.constraints, n

    def residual(self, x: Array, z: Array, f: Array, after: Array, _row: Array) -> Array:
        """Return the equations of a step; there is no table of forces."""
        return equations.step_residual(self.system, self.state(x), z, self.state(after), f, self.time_step)

    def goal_gap(self, x: Array) -> Array:
        """Return by how much the last pose is missed, and the last momentum along the constraint."""
        (place, p), departure = self.state(x), self.system.places.departure
        off_pose = jnp.zeros(0) if self.pose is None else departure(self.pose, place[: len(self.pose)])
        rows = equations.forms(self.system, place) * self.unit
        off = (p - equations.momentum(self.system, place, self.velocity)) * self.unit
        along = self.directions @ (off - rows.T @ jnp.linalg.solve(rows @ rows.T, rows @ off))
        return jnp.append(off_pose, along)

    def places(self, x: Array) -> Array:
        """Return where the points of the outline are, (points, n)."""
        return _arguments.points_at(self.system, self.state(x)[0], self.outline)

    def numbers(self, z: Array, x: Array) -> Array:
        """Return what bounds of states are about: velocities of the step, coordinates or entries of the pose."""
        return jnp.append(z[: self.system.dimension], x[: math.prod(self.system.shapes[0])])

    def state(self, x: Array) -> tuple[Array, Array]:
        """Return place and momentum."""
        n = self.system.dimension
        return x[:-n].reshape(-1, *self.system.shapes[0][1:]), x[-n:]


class Goal(NamedTuple):
    """The goal: coordinates by index or a pose, and a velocity where one is named."""

    coordinates: dict[int, float]
    pose: Float[np.ndarray, "N N"] | None
    velocity: Float[np.ndarray, "n"] | None

    def numbers(self, system: Any) -> Float[np.ndarray, "x"]:
        """Return velocities, and coordinates or entries of the pose, NaN where they are free."""
        v, place = (np.full(shape, np.nan).ravel() for shape in system.shapes[::-1])
        place[list(self.coordinates)] = list(self.coordinates.values())
        ends = v if self.velocity is None else self.velocity, place if self.pose is None else self.pose.ravel()
        return np.concatenate(ends)

    def end(self, system: Any, x: np.ndarray, time: float) -> np.ndarray:
        """Return a place that meets it, else that of the start."""
        if not system.coordinates:
            return x if self.pose is None else place(system, self.pose, time)
        last = place(system, x[: system.dimension].copy(), time)
        last[list(self.coordinates)] = list(self.coordinates.values())
        return last


def checked_start(discrete: Any, start: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return place and velocity of the start."""
    _arguments.check_names("steer(start=...)", start, _arguments.VELOCITIES[1:])
    if discrete.system.force is not None:
        discrete.system.forced(None, np.zeros((1, discrete.system.dimension)))  # refuses a system that has forces
    motion = _arguments.velocities_of(start) or {"body_velocity": np.zeros(discrete.system.dimension)}
    return lagrange_dalembert.checked_state(discrete.system, start.get("configuration"), motion, 0.0, "steer.start")


def checked_goal(discrete: Any, goal: Any, is_free: bool) -> Goal:
    """Return the goal; its configuration may name some coordinates alone, a free one nothing."""
    where, system = "steer(goal=...)", discrete.system
    _arguments.check_names(where, goal, ("body_velocity",))
    q, v = goal.get("configuration"), goal.get("body_velocity")
    if q is None and v is None and not is_free:
        raise error(where, "name coordinates or a velocity", "neither", "Pass configuration=.")
    v = None if v is None else array(where, v, (system.dimension,), "Pass a rate for each coordinate.")
    if not system.coordinates:
        return Goal({}, None if q is None else system.places.configuration(where, q), v)
    q = {} if q is None else q
    remedy = f"Pass {system.dimension} numbers, or some of them by name: {', '.join(system.coordinates)}."
    if not isinstance(q, Mapping):
        q = dict(zip(system.coordinates, array(where, q, (system.dimension,), remedy), strict=True))
    if not set(q) <= set(system.coordinates):
        raise error(where, "name coordinates of the system", shown(sorted(map(str, q))), remedy)
    numbers = array(where, list(q.values()), (len(q),), remedy)
    return Goal(dict(zip(map(system.coordinates.index, q), numbers.tolist(), strict=True)), None, v)


Extent = tuple[Float[np.ndarray, "n"], float]
"""Units of velocities in which each has the same kinetic energy, and the way in these."""


def extent_of_way(discrete: Any, start: tuple[np.ndarray, np.ndarray], goal: Goal, way: Way, steps: int) -> Extent:
    """Return the size of the way to the goal and to places, or of that at the first velocity."""
    (x, v), system, duration = start, discrete.system, steps * float(discrete.time_step)
    unit, size = lagrange_dalembert.tangents.units(system.plain, x, v), system.shapes[0][0]
    q, last = x[:size], goal.end(system, x, duration)[:size]
    ways = [system.places.departure(q, last) / unit, duration * v / unit]
    at = _arguments.numbers_of_position(system)
    ways += [(place - q.ravel()[at]) / _of_position(system, unit) for place in way.via.values()]
    return unit, float(max(np.abs(each).max() for each in ways)) or 1.0


def _of_position(system: Any, numbers: Float[np.ndarray, "n"]) -> Float[np.ndarray, "_"]:
    """Return the numbers of coordinates, or of directions of a group, that belong to positions."""
    at = _arguments.numbers_of_position(system)
    return numbers[at] if system.coordinates else numbers[-len(at) :]


def coordinate_problem(
    discrete: Any, ends: tuple[tuple[np.ndarray, np.ndarray], Goal], limits: Limits, way: Way, extent: Extent
) -> tuple[Any, ...]:
    """Return the problem for `transcribe` of a system by functions, from place and velocity at the start and a goal."""
    ((x, v), goal), (unit, far), system, n = ends, extent, discrete.system, discrete.system.dimension
    steps, size = len(limits[0]) // n, system.shapes[0][0]
    sizes, duration = far * unit, steps * float(discrete.time_step)
    last = goal.end(system, x, duration)
    directions, velocity, h = np.zeros((0, n)), np.zeros(n), np.float64(discrete.time_step)
    if goal.velocity is not None:
        forms = lagrange_dalembert.in_double(equations.forms, system.plain, last)
        directions, velocity = np.linalg.svd(forms * unit)[2][system.constraints :], goal.velocity
    nodes = CoordinateNodes(system.plain, h, way.outline, unit, directions, velocity, goal.pose)
    first = np.append(x, lagrange_dalembert.momentum(system, x, v))
    program = Program(Steps(nodes, way.centers, way.radii, h, way.bounds), first, np.zeros((steps, n)))
    q, at = x[:size], _arguments.numbers_of_position(system)
    pins: dict[int, dict[int, Any]] = {step: dict(zip(at, place, strict=True)) for step, place in way.via.items()}
    pins[steps] = pins.get(steps, {}) | goal.coordinates
    if way.outline.shape[-1]:
        way.check("start", _arguments.points_at(system, q, way.outline))
    path, forces = _coordinate_guess(system, (q, last[:size]), way, steps)
    push = far / unit / duration**2

    def first_guess(rng: np.random.Generator, spread: float) -> np.ndarray:
        spread *= way.guess.trust
        bow = np.sin(np.linspace(0, np.pi, steps + 1))[:, None]
        bent = system.places.beside(path, spread * sizes * bow * rng.normal(size=n))
        noise = spread * push * rng.normal(size=(steps, n))
        return _coordinate_unknowns(nodes, bent, forces + noise)

    def gap_of(forces: np.ndarray) -> float:
        if system.discrete_lagrangian or system.discrete_constraints:  # compiled once for all forces
            orbit = rollout(discrete, configuration=q, body_velocity=v, steps=steps, controls=forces)
        else:
            orbit = driven(discrete, (v, q), forces)
        return _coordinate_gap(program, goal, way, sizes, far / duration, orbit)

    return program, bounds_of(program, limits, pins), first_guess, gap_of


def _coordinate_gap(program: Program, goal: Goal, way: Way, sizes: np.ndarray, speed: float, orbit: Any) -> float:
    """Return by what an orbit misses its goal, obstacles and places, in units; infinity where it ends before.

    Sizes are those of the way in each coordinate, or direction of a group.
    """
    q, nodes, system = orbit.configuration, program.steps.nodes, program.steps.nodes.system
    if len(q) <= len(program.rows) or not np.isfinite(q[-1]).all():
        return np.inf
    off = [abs(q[-1, i] - number) / sizes[i] for i, number in goal.coordinates.items()]
    last = np.append(place(system, q[-1], orbit.time[-1]), orbit.momentum[-1])
    units = np.append(sizes[: 0 if goal.pose is None else None], np.full(len(nodes.directions), speed))
    off += np.abs(in_double(nodes.goal_gap, last) / units).tolist()
    flat = q.reshape(len(q), -1)
    off.append(way.bounds.outside(np.concatenate([orbit.body_velocity[:-1], flat[1:]], axis=1)))
    if way.outline.shape[-1]:
        at = flat[:, _arguments.numbers_of_position(system)]
        off.append(way.gap(_arguments.points_at(system, q, way.outline), at) / _of_position(system, sizes).max())
    return float(max(off, default=0.0))


def _coordinate_guess(
    system: Any, ends: tuple[np.ndarray, np.ndarray], way: Way, steps: int
) -> tuple[Float[np.ndarray, "K ..."], Float[np.ndarray, "steps n"]]:
    """Return configurations and forces of a guess: by default evenly from the start to the goal, through places."""
    if way.guess.motion is not None:
        return way.guess.motion
    begin, end = ends
    q = system.places.beside(begin, np.linspace(0, 1, steps + 1)[:, None] * system.places.departure(begin, end))
    if way.outline.shape[-1]:
        flat, at = q.reshape(steps + 1, -1), _arguments.numbers_of_position(system)
        flat[:, at] = way.positions({0: begin.ravel()[at], steps: end.ravel()[at]}, steps)
    return q, np.zeros((steps, system.dimension))


def _coordinate_unknowns(nodes: CoordinateNodes, q: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Return unknowns whose velocities are those of a path; impulses of constraint are zero."""
    system, steps, h = nodes.system, len(forces), float(nodes.time_step)
    times, v = h * np.arange(steps + 1), system.places.departure(q[:-1], q[1:]) / h
    places = np.array([place(system, each, time) for each, time in zip(q, times, strict=True)])
    momenta = np.array([lagrange_dalembert.momentum(system, *each) for each in zip(places[:-1], v, strict=True)])
    impulses, after = np.zeros((steps, system.constraints)), places[1:].reshape(steps, -1)
    return np.concatenate([v, impulses, forces, after, momenta], axis=1).ravel()


def group_problem(discrete: Discretization, ends: tuple[Any, ...], limits: Limits, way: Way) -> tuple[Any, ...]:
    """Return the problem for `transcribe` of one member, from velocity and pose at the start and those of the goal."""
    (w, g, to_pose, to_velocity), system, group = ends, discrete.system, discrete.system.group
    free = dataclasses.replace(discrete, system=system.inside)
    steps, n = len(limits[0]) // system.rank, group.size
    nodes = GroupNodes(free, discrete.forces, way.outline, to_pose)
    table = np.zeros((steps, group.dim)) if discrete.forces is None else discrete.forces.rows(np.arange(steps))
    first = np.append(_numbers(nodes, g), system.restricted_momentum(w))
    steps_alike = Steps(nodes, way.centers, way.radii, np.float64(discrete.time_step), way.bounds)
    program = Program(steps_alike, first, table)
    pins = {step: {row * n + n - 1: number for row, number in enumerate(place)} for step, place in way.via.items()}
    if to_velocity is not None:
        momenta = enumerate(system.restricted_momentum(to_velocity), len(first) - system.rank)
        pins[steps] = pins.get(steps, {}) | dict(momenta)
    poses, forces = _group_guess(discrete, (g, to_pose), way, steps)
    lengths = system.displacement_units.copy()  # in proportion to what there is on the way
    if group.is_affine:
        places = np.concatenate([poses[:, :-1, -1], way.centers])
        lengths[1 - n :] = np.linalg.norm(np.ptp(places, axis=0)) / 2 or lengths[1 - n :]

    def first_guess(rng: np.random.Generator, spread: float) -> np.ndarray:
        spread *= way.guess.trust
        noise = spread * sizes(discrete, steps, ends).reshape(steps, -1) * rng.normal(size=(steps, system.rank))
        bow = np.sin(np.linspace(0, np.pi, len(poses)))[:, None]
        bent = poses @ group.exp(bow * (spread * rng.normal(size=group.dim)) * lengths)
        return _group_unknowns(nodes, bent, forces + noise)

    def gap_of(forces: np.ndarray) -> float:
        covectors = forces @ np.linalg.pinv(system.constraint_subspace).T
        return _group_gap(discrete, ends, way, driven_side_by_side(discrete, covectors[None], (w[None], g[None])))

    return program, bounds_of(program, limits, pins), first_guess, gap_of


def _group_gap(discrete: Discretization, ends: tuple[Any, ...], way: Way, orbits: Rollout) -> float:
    """Return by what the orbit of a member misses its goal, obstacles and places, in units; infinity where it ends."""
    system, (poses,), (momenta,) = discrete.system, orbits.configuration, orbits.restricted_momentum
    if not np.isfinite(momenta[-1]).all():
        return np.inf
    off = goal_gap(system, ends, poses[-1], momenta[-1]) / goal_units(discrete, len(poses) - 1, ends)
    too_near = way.gap(_arguments.body_points(poses, way.outline), poses[:, :-1, -1]) / system.displacement_units[-1]
    outside = way.bounds.outside(_arguments.body_states(poses, momenta))
    return float(np.abs(off).max(initial=max(too_near, outside)))


def _numbers(nodes: GroupNodes, poses: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "... x"]:
    rows = free_rows(nodes.free.system.group)
    return poses[..., :rows, :].reshape(*poses.shape[:-2], -1)


def _group_guess(
    discrete: Discretization, ends: tuple[Any, Any], way: Way, steps: int
) -> tuple[Float[np.ndarray, "K N N"], Float[np.ndarray, "steps k"]]:
    """Return poses and forces of a guess: by default evenly from the start to the goal, through places on the way.

    In the plane the body looks along a path.
    """
    group, (g, to_pose), guess = discrete.system.group, ends, way.guess
    rows = np.asarray(discrete.system.constraint_subspace)
    if guess.motion is not None:
        return guess.motion[0], guess.motion[1] @ rows.T
    last = g if to_pose is None else to_pose
    poses = g @ group.exp(np.linspace(0, 1, steps + 1)[:, None] * group.log(group.inverse(g) @ last))
    if group.is_affine:
        places = {0: g[:-1, -1]} | ({} if to_pose is None else {steps: last[:-1, -1]})
        poses[:, :-1, -1] = way.positions(places, steps)
    if group == SE(2) and (way.via or guess.path is not None):
        ahead = np.gradient(poses[:, 0, 2] + 1j * poses[:, 1, 2])
        poses[:, :2, :2] = group.exp(np.angle(ahead)[:, None] * [1.0, 0.0, 0.0])[:, :2, :2]
    return poses, np.zeros((steps, len(rows)))


def _group_unknowns(nodes: GroupNodes, poses: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Return unknowns whose charts and momenta are about those of poses."""
    free = nodes.free
    system, group, frame = free.system, free.system.group, free.system.frame
    W = group.inverse(poses[:-1]) @ poses[1:]
    charts = np.array([free.variety.coordinates(each) for each in group.inverse(frame) @ W @ frame])
    velocities = group.log(W) @ np.linalg.pinv(system.constraint_subspace) / float(free.time_step)
    momenta = np.array([system.restricted_momentum(w) for w in velocities])
    return np.concatenate([charts, forces, _numbers(nodes, poses[1:]), momenta], axis=1).ravel()
