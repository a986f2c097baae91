r"""States within a step of the discrete map: after a fraction s of it.

With momentum r and pose g at its beginning, W(s) is the principal root of $P(W)|_d = s\,r$. The pose is $g\,W(s)$,
the momentum $(\mathrm{Ad}^*_{W(s)}P(W(s)))|_d/s$. For a discrete Lagrangian $h\,l(\cdot)$, "matrix" or "logarithmic",
that is the step of length $s\,h$ from the same state. The roots W(s) are the very path that defines the principal
branch: W(0) is the identity, and W(1) the displacement of the whole step.
"""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.base.checks import needs
from nonholo.base.numerics import applied
from nonholo.base.types import Float
from nonholo.discrete import AbstractCompiledRoute, Discretization
from nonholo.orbit import Orbit

Between = Callable[[Any, Float[np.ndarray, "K"]], Any]


def between_states(discrete: Discretization) -> Between:
    """Return the function of states and fractions that gives what is reached after these parts of the steps.

    Where no whole step starts its displacement is NaN.
    """
    route = discrete.route.compiled
    moved = functools.partial(_by_definition, discrete) if route is None else functools.partial(_by_kernel, route)

    def between(states: Orbit, fractions: Float[np.ndarray, "K"]) -> Orbit:
        if not len(states):
            return states
        momenta, charts, poses = moved(states, fractions)
        time = states.time + fractions * discrete.time_step
        kept = dataclasses.replace(states, time=time, reduced_momentum=momenta, cayley=charts)
        poses = None if states.canonical_pose is None else poses
        return dataclasses.replace(kept, canonical_pose=poses, turned=_turned(states, poses))

    return between


def _turned(states: Orbit, poses: np.ndarray | None) -> np.ndarray | None:
    """Return the headings at poses less than half a turn from those of states."""
    if states.turned is None or poses is None:
        return None
    angles = np.arctan2(poses[:, 1], poses[:, 0])
    return angles + 2 * np.pi * np.rint((states.turned - angles) / (2 * np.pi))


def _by_kernel(route: AbstractCompiledRoute, states: Orbit, fractions: np.ndarray) -> tuple[np.ndarray, ...]:
    poses = _poses(route.needs_pose, states)
    poses = route.encode_poses(poses) if poses.size else poses
    rows = zip(route.encode(states.reduced_momentum), poses, fractions, strict=True)
    momenta, charts, moved = (np.array(x) for x in zip(*(_advanced(route, *row) for row in rows), strict=True))
    moved = route.decode_poses(moved) if moved.size else moved
    return route.decode(momenta), route.from_kernel(charts), moved


def _poses(needed: bool, states: Orbit) -> np.ndarray:
    """Return the poses of states; where they are not kept, any that the step can carry along, if it needs one."""
    system = states.system
    if states.canonical_pose is not None:
        return states.canonical_pose
    if not needed:
        return np.empty((len(states), 0))
    return np.broadcast_to(system.frame_pose, (len(states), system.group.pose_size))


def _advanced(
    route: AbstractCompiledRoute, momenta: np.ndarray, pose: np.ndarray, fraction: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return momenta, chart and pose of a kernel after a fraction of a step."""
    (after,), (moved,), (code,) = route.parts_of_steps(momenta[None], pose[None], fraction)
    if code != 0:
        return np.full(len(after), np.nan), np.full(route.sizes[1], np.nan), np.full(len(moved), np.nan)
    code, state = route.start(after, moved)
    chart = route.chart_of(state)
    return after, chart if code == 0 else np.full(len(chart), np.nan), moved


def _by_definition(discrete: Discretization, states: Orbit, fractions: np.ndarray) -> tuple[np.ndarray, ...]:
    with needs("jax", "simulate(events=...) of a step that is not compiled"):
        from nonholo.simulation.events._partial_step import partial_step

    group, frame, C = discrete.system.group, discrete.system.frame, discrete.system.frame_map
    g = group.matrix_from_pose(_poses(True, states)) @ group.inverse(frame)
    r = applied(discrete.system.inverse_frame_map, states.reduced_momentum)
    found = [partial_step(discrete, *row) for row in zip(fractions, r, g, strict=True)]
    momenta, charts, moved = (np.array(column) for column in zip(*found, strict=True))
    return applied(C, momenta), charts, group.pose_from_matrix(moved @ frame)
