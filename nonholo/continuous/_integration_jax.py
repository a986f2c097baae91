"""Momentum and pose by diffrax: a separate route beside `_series`. Imported on first use: it loads slowly."""

import functools
from typing import Any

import jax
import numpy as np

from nonholo.base.numerics import double_precision
from nonholo.base.numerics.time_sweep import State, good_rows, pad, sweep
from nonholo.base.progress import interruptibly
from nonholo.base.results import Outcome
from nonholo.base.types import Array
from nonholo.continuous._equations import body_of, momentum_rate, spatial_velocity
from nonholo.continuous._series import PLANE, Problem, Solved, States, first_heading
from nonholo.groups import AbstractMatrixGroup
from nonholo.orbit import turned_near
from nonholo.systems import AbstractSystem


def integrate_by_diffrax(system: AbstractSystem, problem: Problem) -> Solved:
    """Solve the equations of a system."""
    reduced_momentum, pose, elapsed, tolerances = problem
    start = (reduced_momentum, pose, first_heading(system.group, pose))
    in_space = system.constraint_subspace, system.homogeneous_mass_tensor
    numbers = in_space if system.is_spatial else body_of(system)

    def solve() -> list[np.ndarray]:
        with double_precision():
            rest, good = _sweep(system.group, system.is_spatial, start, numbers, pad(elapsed), tolerances)
        return good_rows(start, rest, good, len(elapsed))

    momenta, poses, headings = interruptibly(solve)
    outcome = Outcome.successful if len(momenta) == len(elapsed) else Outcome.not_converged
    poses = system.group.normalize_pose(poses)
    at = functools.partial(_solved_again, system, problem)
    angles = turned_near(headings[:, 0], poses) if system.group == PLANE else None
    return Solved(States(momenta, poses, angles), outcome, at)


def _solved_again(system: AbstractSystem, problem: Problem, elapsed: np.ndarray) -> States:
    times = np.unique(np.append(np.abs(elapsed), 0.0))
    backward = np.copysign(1.0, elapsed.sum())
    states = integrate_by_diffrax(system, problem._replace(elapsed=backward * times)).states
    return states.chosen(np.searchsorted(times, np.abs(elapsed)))


@functools.partial(jax.jit, static_argnums=(0, 1))
def _sweep(
    group: AbstractMatrixGroup, is_spatial: bool, state: State, numbers: Any, elapsed: Array, tolerances: Any
) -> tuple[State, Array]:
    def rate(_: Array, state: State) -> State:
        r, pose, heading = state
        if is_spatial:
            g = group.matrix_from_pose(pose)
            rate, velocity = 0 * r, group.adjoint(group.inverse(g)) @ spatial_velocity(group, *numbers, r=r, g=g)
        else:
            rate, velocity, _ = momentum_rate(group, numbers, r)
        return rate, group.pose_rate(pose, velocity), velocity[: heading.shape[0]]

    return sweep(rate, lambda end: end, state, elapsed, tolerances)
