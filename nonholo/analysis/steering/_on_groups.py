"""The transcription of a motion on a group, from checked arguments of `steer`."""

import dataclasses
from typing import Any, cast

import numpy as np

from nonholo.analysis.steering._arguments import Guess, Limits
from nonholo.analysis.steering._ends import driven
from nonholo.analysis.steering._nodes import GroupNodes
from nonholo.analysis.steering._program import Program, Steps
from nonholo.analysis.steering._shooting import sizes
from nonholo.analysis.steering._state_bounds import body_states
from nonholo.analysis.steering._transcription import Problem, bounded
from nonholo.analysis.steering._way import Way, body_points, evenly, resampled
from nonholo.base.types import Float
from nonholo.discrete import Discretization
from nonholo.discrete.definition import Rollout, free_rows
from nonholo.groups import SE
from nonholo.systems import Forced


def group_problem(discrete: Discretization, ends: tuple[Any, ...], limits: Limits, way: Way, guess: Guess) -> Problem:
    """Return the problem of one member, from velocity and pose of the start, pose and velocity of the goal."""
    (w, g, to_pose, to_velocity), system, free = ends, discrete.system, discrete
    if system.is_forced:
        free = dataclasses.replace(discrete, system=cast(Forced, system).system)
    steps, n = len(limits[0]) // system.rank, system.group.size
    nodes = GroupNodes(free, discrete.forces, way.outline, to_pose)
    table = np.zeros((steps, system.group.dim)) if discrete.forces is None else discrete.forces.rows(np.arange(steps))
    first = np.append(_numbers(nodes, g), system.restricted_momentum(w))
    steps_alike = Steps(nodes, way.centers, way.radii, np.float64(discrete.time_step), way.bounds)
    program = Program(steps_alike, first, table)
    fixed = {step: {row * n + n - 1: number for row, number in enumerate(place)} for step, place in way.via.items()}
    if to_velocity is not None:
        momenta = enumerate(system.restricted_momentum(to_velocity), len(first) - system.rank)
        fixed[steps] = fixed.get(steps, {}) | dict(momenta)
    poses, forces = _begun(discrete, (g, to_pose), way, steps, guess)

    def first_guess(rng: np.random.Generator, spread: float) -> np.ndarray:
        spread *= guess.trust
        noise = spread * sizes(discrete, steps).reshape(steps, -1) * rng.normal(size=(steps, system.rank))
        bent = _bent(discrete, poses, spread * rng.normal(size=system.group.dim), way)
        return _unknowns(nodes, bent, forces + noise)

    def missed(forces: np.ndarray) -> float:
        covectors = forces @ np.linalg.pinv(system.constraint_subspace).T
        return _missed(discrete, ends, way, driven(discrete, covectors[None], (w[None], g[None])))

    return Problem(program, bounded(program, limits, fixed), first_guess, missed)


def _missed(discrete: Discretization, ends: tuple[Any, ...], way: Way, orbits: Rollout) -> float:
    """Return by what the orbit of one member misses its goal, obstacles and places; infinity where it ends before."""
    system, (poses,), last = discrete.system, orbits.configuration, orbits.restricted_momentum[0, -1]
    off, (_, _, to_pose, to_velocity) = [way.missed(body_points(poses, way.outline), poses[:, :-1, -1])], ends
    if not np.isfinite(last).all():
        return np.inf
    off.append(way.outside(body_states(poses, orbits.restricted_momentum[0])))
    if to_pose is not None:
        off.append(np.abs(system.group.log(system.group.inverse(to_pose) @ poses[-1])).max())
    if to_velocity is not None:
        off.append(np.abs(system.restricted_velocity(last) - to_velocity).max())
    return float(max(off))


def _numbers(nodes: GroupNodes, poses: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "... x"]:
    rows = free_rows(nodes.free.system.group)
    return poses[..., :rows, :].reshape(*poses.shape[:-2], -1)


def _begun(
    discrete: Discretization, ends: tuple[Any, Any], way: Way, steps: int, guess: Guess
) -> tuple[Float[np.ndarray, "K N N"], Float[np.ndarray, "steps k"]]:
    """Return poses and forces of a guess: by default evenly from the start to the goal, through places on the way.

    In the plane the body looks along a path.
    """
    group, (g, to_pose), rows = discrete.system.group, ends, np.asarray(discrete.system.constraint_subspace)
    if guess.configuration is not None:
        return guess.configuration, guess.controls @ rows.T
    last = g if to_pose is None else to_pose
    poses = g @ group.exp(np.linspace(0, 1, steps + 1)[:, None] * group.log(group.inverse(g) @ last))
    if group.is_affine:
        known = {0: g[:-1, -1]} | ({} if to_pose is None else {steps: last[:-1, -1]})
        poses[:, :-1, -1] = evenly(known | way.via, steps) if guess.path is None else resampled(guess.path, steps)
    if group == SE(2) and (way.via or guess.path is not None):
        ahead = np.gradient(poses[:, 0, 2] + 1j * poses[:, 1, 2])
        poses[:, :2, :2] = group.exp(np.angle(ahead)[:, None] * [1.0, 0.0, 0.0])[:, :2, :2]
    return poses, np.zeros((steps, len(rows)))


def _bent(discrete: Discretization, poses: np.ndarray, aside: np.ndarray, way: Way) -> np.ndarray:
    """Return poses bent aside between their ends; lengths are in proportion to what there is on the way."""
    group, scale = discrete.system.group, np.ones(discrete.system.group.dim)
    if group.is_affine:
        n = group.size - 1
        places = np.concatenate([poses[:, :n, n], way.centers])
        scale[-n:] = np.linalg.norm(np.ptp(places, axis=0)) / 2 or 1.0
    bow = np.sin(np.linspace(0, np.pi, len(poses)))[:, None]
    return poses @ group.exp(bow * aside * scale)


def _unknowns(nodes: GroupNodes, poses: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Return unknowns whose charts and momenta are about those of poses."""
    free = nodes.free
    system, group, frame = free.system, free.system.group, free.system.frame
    W = group.inverse(poses[:-1]) @ poses[1:]
    charts = np.array([free.variety.coordinates(each) for each in group.inverse(frame) @ W @ frame])
    velocities = group.log(W) @ np.linalg.pinv(system.constraint_subspace) / float(free.time_step)
    momenta = np.array([system.restricted_momentum(w) for w in velocities])
    return np.concatenate([charts, forces, _numbers(nodes, poses[1:]), momenta], axis=1).ravel()
