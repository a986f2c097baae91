"""The transcription of a motion in coordinates, and its ends as arguments of `steer`."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from nonholo.analysis.steering._arguments import Guess, Limits
from nonholo.analysis.steering._nodes import CoordinateNodes
from nonholo.analysis.steering._program import Program, Steps
from nonholo.analysis.steering._transcription import Problem, bounded
from nonholo.analysis.steering._way import Way, evenly, planar_points, resampled
from nonholo.base.checks import array, error, shown
from nonholo.base.types import Float
from nonholo.discrete import discretize
from nonholo.lagrange_dalembert import (
    CoordinateDiscretization,
    CoordinateOrbit,
    LagrangeDAlembert,
    checked_state,
    equations,
    in_double,
    place,
)


class Goal(NamedTuple):
    """What is to be reached: coordinates by index, and a velocity where one is named."""

    coordinates: dict[int, float]
    velocity: Float[np.ndarray, "n"] | None

    def numbers(self, n: int) -> Float[np.ndarray, "2n"]:
        """Return velocities and coordinates, NaN where they are free."""
        both = np.full((2, n), np.nan)
        both[1, list(self.coordinates)] = list(self.coordinates.values())
        if self.velocity is not None:
            both[0] = self.velocity
        return both.ravel()


def checked_start(discrete: CoordinateDiscretization, start: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return place and velocity of the start."""
    given = _named("start", start)
    discrete.system.forced(None, np.zeros((1, discrete.system.dimension)))  # refuses a system that has forces
    velocity = given.get("body_velocity", np.zeros(discrete.system.dimension))
    return checked_state(discrete.system, given.get("configuration"), {"body_velocity": velocity}, 0.0, "steer")


def checked_goal(discrete: CoordinateDiscretization, goal: Any, is_free: bool) -> Goal:
    """Return the goal; its configuration may name some coordinates alone, a free one nothing."""
    where, system, given = "steer(goal=...)", discrete.system, _named("goal", goal)
    remedy = f"Pass {system.dimension} numbers, or some of them by name: {', '.join(system.coordinates)}."
    q, v = given.get("configuration", {}), given.get("body_velocity")
    if not isinstance(q, Mapping):
        q = dict(zip(system.coordinates, array(where, q, (system.dimension,), remedy), strict=True))
    if not set(q) <= set(system.coordinates):
        raise error(where, "name coordinates of the system", shown(sorted(map(str, q))), remedy)
    if not q and v is None and not is_free:
        raise error(where, "name coordinates or a velocity", "neither", remedy)
    numbers = array(where, list(q.values()), (len(q),), remedy)
    v = None if v is None else array(where, v, (system.dimension,), "Pass a rate for each coordinate.")
    return Goal(dict(zip(map(system.coordinates.index, q), numbers.tolist(), strict=True)), v)


def _named(name: str, end: Any) -> Mapping[str, Any]:
    if not isinstance(end, Mapping) or not set(end) <= {"configuration", "body_velocity"}:
        remedy = "Pass a dictionary of them."
        raise error(f"steer({name}=...)", "name only configuration and body_velocity", shown(end), remedy)
    return end


def driven_in_coordinates(
    discrete: CoordinateDiscretization, start: tuple[np.ndarray, np.ndarray], forces: Float[np.ndarray, "steps n"]
) -> CoordinateOrbit:
    """Return the orbit under forces, as far as it goes."""
    (v, q), table = start, discretize(discrete.system.forced(None, forces), discrete.time_step)
    return table.simulate(configuration=q, body_velocity=v, steps=len(forces), throw=False)


def coordinate_problem(
    discrete: CoordinateDiscretization,
    ends: tuple[tuple[np.ndarray, np.ndarray], Goal],
    limits: Limits,
    way: Way,
    steps: int,
    guess: Guess,
) -> Problem:
    """Return the problem of a system in coordinates, from place and velocity at the start and a goal."""
    ((x, v), goal), system, n = ends, discrete.system, discrete.system.dimension
    last = place(system, x[:n].copy(), steps * discrete.time_step)
    last[list(goal.coordinates)] = list(goal.coordinates.values())
    nodes = _nodes(discrete, way, last, goal.velocity)
    first = np.append(x, in_double(equations.momentum, system, x, v))
    program = Program(Steps(nodes, way.centers, way.radii, nodes.time_step, way.bounds), first, np.zeros((steps, n)))
    fixed: dict[int, dict[int, Any]] = {
        step: dict(zip(map(system.coordinates.index, "xy"), place, strict=True)) for step, place in way.via.items()
    }
    fixed[steps] = fixed.get(steps, {}) | goal.coordinates
    if way.outline.shape[-1]:
        way.check("start", planar_points(system, x[:n], way.outline))
    path, forces = _begun(system, (x[:n], last[:n]), way, steps, guess)

    def first_guess(rng: np.random.Generator, spread: float) -> np.ndarray:
        spread *= guess.trust
        bow = np.sin(np.linspace(0, np.pi, steps + 1))[:, None]
        return _unknowns(nodes, path + spread * bow * rng.normal(size=n), forces + spread * rng.normal(size=(steps, n)))

    def missed(forces: np.ndarray) -> float:
        return _missed(program, goal, way, driven_in_coordinates(discrete, (v, x[:n]), forces))

    return Problem(program, bounded(program, limits, fixed), first_guess, missed)


def _nodes(discrete: CoordinateDiscretization, way: Way, last: np.ndarray, velocity: np.ndarray | None) -> Any:
    """Return the unknowns of steps to a place, where the system is to have a velocity or none."""
    system, h = discrete.system.plain, np.float64(discrete.time_step)
    if velocity is None:
        return CoordinateNodes(system, h, way.outline, np.zeros((0, system.dimension)), np.zeros(system.dimension))
    directions = np.linalg.svd(in_double(equations.forms, system, last))[2][system.constraints :]
    return CoordinateNodes(system, h, way.outline, directions, velocity)


def _missed(program: Program, goal: Goal, way: Way, orbit: CoordinateOrbit) -> float:
    """Return by what an orbit misses its goal, obstacles and places; infinity where it ends before."""
    q, system = orbit.configuration, program.steps.nodes.system
    if len(orbit) <= len(program.rows):
        return np.inf
    off = [abs(q[-1, i] - number) for i, number in goal.coordinates.items()]
    off += np.abs(program.missed(np.append(place(system, q[-1], orbit.time[-1]), orbit.momentum[-1]))).tolist()
    off.append(way.outside(np.concatenate([orbit.body_velocity[:-1], q[1:]], axis=1)))
    if way.outline.shape[-1]:
        at = planar_points(system, q, np.zeros((1, 2)))[:, 0]
        off.append(way.missed(planar_points(system, q, way.outline), at))
    return float(max(off, default=0.0))


def _begun(
    system: LagrangeDAlembert, ends: tuple[np.ndarray, np.ndarray], way: Way, steps: int, guess: Guess
) -> tuple[np.ndarray, np.ndarray]:
    """Return configurations and forces of a guess: by default evenly from the start to the goal, through places."""
    if guess.configuration is not None and guess.controls is not None:
        return guess.configuration, guess.controls
    q = evenly({0: ends[0], steps: ends[1]}, steps)
    at = [system.coordinates.index(name) for name in "xy"] if way.outline.shape[-1] else []
    if guess.path is not None:
        q[:, at] = resampled(guess.path, steps)
    elif at:
        q[:, at] = evenly({0: ends[0][at], steps: ends[1][at]} | way.via, steps)
    return q, np.zeros((steps, len(q[0])))


def _unknowns(nodes: CoordinateNodes, q: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Return unknowns whose velocities are those of a path; impulses of constraint are zero."""
    system, steps, h = nodes.system, len(forces), float(nodes.time_step)
    times, v = h * np.arange(steps + 1), np.diff(q, axis=0) / h
    places = np.array([place(system, each, time) for each, time in zip(q, times, strict=True)])
    momenta = np.array([in_double(equations.momentum, system, *each) for each in zip(places[:-1], v, strict=True)])
    return np.concatenate([v, np.zeros((steps, system.constraints)), forces, places[1:], momenta], axis=1).ravel()
