"""Numerical integration of the pose by the compiled DOP853, in matrices whatever the group."""

from typing import TypeAlias

import numpy as np

from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.continuous._equations import body_of
from nonholo.continuous._heteroclinic import Heteroclinic
from nonholo.continuous._turning import Turning
from nonholo.groups import SE, AbstractMatrixGroup
from nonholo.kernels import SpaceFlow, solve
from nonholo.systems import AbstractSystem

Solved: TypeAlias = tuple[Float[np.ndarray, "K k"], Float[np.ndarray, "K size"], Float[np.ndarray, "K"] | None, Outcome]


def by_runge_kutta(
    system: AbstractSystem,
    reduced_momentum: Float[np.ndarray, "k"],
    pose: Float[np.ndarray, "size"],
    elapsed: Float[np.ndarray, "K"],
    tolerances: tuple[float, float],
) -> Solved:
    """Return momenta, poses, on SE(2) the heading without ambiguity of full turns, and the outcome.

    The constraint is fixed in space. Times elapse from zero. After a failure only the good states are returned.
    """
    group, planar = system.group, system.group == SE(2)
    g, turned = group.matrix_from_pose(pose).ravel(), np.arctan2(pose[1:2], pose[0:1]) if planar else np.zeros(0)
    motion = space_flow(system, reduced_momentum, planar)
    rows = solve(motion, np.concatenate([g, turned]), elapsed, tolerances)
    momenta, poses = np.tile(reduced_momentum, (len(rows), 1)), _poses(group, rows[:, : len(g)])
    outcome = Outcome.successful if len(rows) == len(elapsed) else Outcome.not_converged
    return momenta, poses, on_same_turn(rows[:, -1], poses) if planar else None, outcome


def integrate_pose(
    system: AbstractSystem,
    motion: Heteroclinic,
    pose: Float[np.ndarray, "size"],
    elapsed: Float[np.ndarray, "K"],
    tolerances: tuple[float, float],
) -> tuple[Float[np.ndarray, "K size"], Outcome]:
    """Return the poses of a body whose momentum is known in closed form."""
    group, (_, _, to_velocity) = system.group, body_of(system)
    across, along = group.hat(motion.across @ to_velocity), group.hat(motion.along @ to_velocity)
    turning = Turning(across, along, float(motion.start), float(motion.rate))
    rows = solve(turning, group.matrix_from_pose(pose).ravel(), elapsed, tolerances)
    return _poses(group, rows), Outcome.successful if len(rows) == len(elapsed) else Outcome.not_converged


def space_flow(system: AbstractSystem, momentum: Float[np.ndarray, "k"], planar: bool) -> SpaceFlow:
    """Return what the compiled rates need of a system with a constraint fixed in space."""
    rows = np.ascontiguousarray(system.group.hat(system.constraint_subspace))
    duals = np.ascontiguousarray(np.swapaxes(system.group.form_adjoint(rows), -1, -2))
    return SpaceFlow(np.asarray(momentum), rows, duals, np.ascontiguousarray(system.homogeneous_mass_tensor), planar)


def on_same_turn(headings: Float[np.ndarray, "K"], poses: Float[np.ndarray, "K 4"]) -> Float[np.ndarray, "K"]:
    """Return the angles of the poses, each on the turn that the integrated heading tells."""
    angles = np.arctan2(poses[:, 1], poses[:, 0])
    return angles + 2 * np.pi * np.rint((headings - angles) / (2 * np.pi))


def _poses(group: AbstractMatrixGroup, rows: Float[np.ndarray, "K entries"]) -> Float[np.ndarray, "K size"]:
    g = rows.reshape(len(rows), group.size, group.size)
    return group.normalize_pose(group.pose_from_matrix(g))
