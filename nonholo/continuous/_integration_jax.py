"""Momentum and pose by diffrax: a separate route beside `_series`. Imported on first use: it loads slowly."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import numpy as np

from nonholo.base.numerics import double_precision
from nonholo.base.numerics.time_sweep import State, good_rows, pad, sweep
from nonholo.base.progress import interruptibly
from nonholo.base.results import Outcome
from nonholo.base.types import Array
from nonholo.continuous._equations import Body, body_of, momentum_rate, spatial_velocity
from nonholo.continuous._series import PLANE, Problem, Solved, States, first_heading
from nonholo.groups import AbstractMatrixGroup
from nonholo.orbit import turned_near
from nonholo.systems import AbstractSystem

Rate = Callable[[AbstractMatrixGroup, Array, State, Any], State]


def integrate_by_diffrax(system: AbstractSystem, problem: Problem) -> Solved:
    """Solve the equations of a system."""
    reduced_momentum, pose, elapsed, tolerances = problem
    planar = system.group == PLANE
    start = (reduced_momentum, pose, first_heading(system.group, pose))
    if system.is_spatial:
        rate, numbers = _spatial_rate, (system.constraint_subspace, system.homogeneous_mass_tensor)
    else:
        rate, numbers = _motion_rate, body_of(system)

    def solve() -> list[np.ndarray]:
        with double_precision():
            rest, good = _sweep(rate, system.group, start, numbers, pad(elapsed), tolerances)
        return good_rows(start, rest, good, len(elapsed))

    momenta, poses, headings = interruptibly(solve)
    outcome = Outcome.successful if len(momenta) == len(elapsed) else Outcome.not_converged
    poses = system.group.normalize_pose(poses)
    at = functools.partial(_solved_again, system, problem)
    return Solved(States(momenta, poses, turned_near(headings[:, 0], poses) if planar else None), outcome, at)


def _solved_again(system: AbstractSystem, problem: Problem, elapsed: np.ndarray) -> States:
    times = np.unique(np.append(np.abs(elapsed), 0.0))
    backward = np.copysign(1.0, elapsed.sum())
    states = integrate_by_diffrax(system, problem._replace(elapsed=backward * times)).states
    return states.chosen(np.searchsorted(times, np.abs(elapsed)))


def _motion_rate(group: AbstractMatrixGroup, time: Array, state: State, body: Body) -> State:
    del time
    momentum, pose, heading = state
    rate, velocity, _ = momentum_rate(group, body, momentum)
    return rate, group.pose_rate(pose, velocity), velocity[: heading.shape[0]]


def _spatial_rate(group: AbstractMatrixGroup, time: Array, state: State, numbers: tuple[Array, Array]) -> State:
    del time
    momentum, pose, heading = state
    g = group.matrix_from_pose(pose)
    spatial = spatial_velocity(group, *numbers, momentum, g)
    velocity = group.adjoint(group.inverse(g)) @ spatial
    return jax.numpy.zeros_like(momentum), group.pose_rate(pose, velocity), velocity[: heading.shape[0]]


@functools.partial(jax.jit, static_argnums=(0, 1))
def _sweep(
    rate: Rate, group: AbstractMatrixGroup, state: State, numbers: Any, elapsed: Array, tolerances: tuple[Array, Array]
) -> tuple[State, Array]:
    return sweep(lambda time, current: rate(group, time, current, numbers), lambda end: end, state, elapsed, tolerances)
