"""The motion of a body with a constraint fixed in it by Taylor series: its equations are quadratic."""

import functools

import numpy as np

from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.continuous._integration import Solved, on_same_turn
from nonholo.groups import SE, AbstractMatrixGroup
from nonholo.kernels import SERIES_LANES, Quadratic, solve_series
from nonholo.systems import AbstractSystem

_COMPACT = 40
"""Poses of more numbers are integrated as matrices, whose rates need not be tried."""
_GUARD = 1 / 64
"""The error of a step as a share of what was asked for, so that rounding is all that is left at the default."""

Rates = tuple[np.ndarray, np.ndarray, np.ndarray]
r"""Of a pose: $c_{am}$ and the places (a, b, m) and values of $C_{abm}$ in $x_m' = \sum_a w_a(c_{am} + C_{abm}x_b)$."""


def by_series(
    system: AbstractSystem,
    reduced_momentum: Float[np.ndarray, "k"],
    pose: Float[np.ndarray, "size"],
    elapsed: Float[np.ndarray, "K"],
    tolerances: tuple[float, float],
) -> Solved:
    """Return momenta, poses, on SE(2) the heading without ambiguity of full turns, and the outcome.

    Times elapse from zero. After a failure only the good states are returned. The unit of time is the power of two
    that brings the velocities near to one, so that no coefficient over- or underflows without need.
    """
    group, k, planar = system.group, len(reduced_momentum), system.group == SE(2)
    compact = group.pose_size <= _COMPACT
    g = pose if compact else group.matrix_from_pose(pose).ravel()
    turned = np.arctan2(pose[1:2], pose[0:1]) if planar else np.zeros(0)
    unit = np.ldexp(1.0, np.frexp(np.abs(system.restricted_velocity(reduced_momentum)).max(initial=0.0))[1])
    start = np.concatenate([reduced_momentum / unit, g, turned])
    rows = solve_series(quadratic(system), start, elapsed * unit, tolerances[0] * _GUARD)
    found = rows[:, k : k + len(g)]
    poses = group.normalize_pose(found if compact else group.pose_from_matrix(found.reshape(-1, *group.identity.shape)))
    outcome = Outcome.successful if len(rows) == len(elapsed) else Outcome.not_converged
    return rows[:, :k] * unit, poses, on_same_turn(rows[:, -1], poses) if planar else None, outcome


@functools.lru_cache(maxsize=16)
def quadratic(system: AbstractSystem) -> Quadratic:
    """Return the equations of momentum, pose and, in the plane, heading."""
    group, S = system.group, system.constraint_subspace
    k, compact = len(S), group.pose_size <= _COMPACT
    torques = _torques(group, S, S @ system.inertia_operator.T)
    lone, places, values = _compact_rates(group, S) if compact else _matrix_rates(group.hat(S))
    if group == SE(2):
        lone = np.concatenate([lone, S[:, :1]], axis=1)
    (a, i), (c, b, m), (d, o, n) = np.nonzero(lone), places, np.nonzero(torques)
    # places in z: velocities from 0, the one at k, momenta and pose from k + 1
    left, right = np.concatenate([d, a, c]), np.concatenate([o, np.full(len(a), k), b + 2 * k + 1])
    targets, factors = np.concatenate([n, i + k, m + k]), np.concatenate([torques[d, o, n], lone[a, i], values])
    pairs, products = np.unique(np.stack([left, right], axis=-1), axis=0, return_inverse=True)
    pairs = np.concatenate([pairs, np.zeros((-len(pairs) % SERIES_LANES, 2), dtype=np.int64)])
    blocks, closed = _blocks(k, lone, places)
    velocities = np.linalg.solve(S @ system.inertia_operator @ S.T, np.eye(k))
    integers = (np.ascontiguousarray(x, dtype=np.int64) for x in (*pairs.T, targets, products.ravel()))
    return Quadratic(velocities, *integers, factors, blocks, closed)


def _torques(group: AbstractMatrixGroup, S: np.ndarray, momenta: np.ndarray) -> Float[np.ndarray, "k k k"]:
    """Return the coefficients of w_a w_b, a <= b, in the rates of the momenta along S."""
    torques = np.stack(
        [group.coad(np.broadcast_to(row, momenta.shape), momenta) @ S.T for row in S] or [np.zeros((0, 0))]
    )
    both = torques + torques.transpose(1, 0, 2) if len(S) else torques.reshape(0, 0, 0)
    halves = np.triu(np.ones((len(S), len(S)))) - np.eye(len(S)) / 2
    return both * halves[..., None]


def _compact_rates(group: AbstractMatrixGroup, S: np.ndarray) -> Rates:
    """Return the rates of a compact pose, which is bilinear in velocity and (1, pose)."""
    units = np.eye(group.pose_size)
    lone = np.stack([group.pose_rate(np.zeros(len(units)), row) for row in S]) if len(S) else np.zeros((0, len(units)))
    both = [
        group.pose_rate(units, np.broadcast_to(row, (len(units), group.dim))) - c
        for row, c in zip(S, lone, strict=True)
    ]
    rates = np.stack(both) if both else np.zeros((0, len(units), len(units)))
    places = np.nonzero(rates)
    return lone, np.stack(places), rates[places]


def _matrix_rates(hats: Float[np.ndarray, "k N N"]) -> Rates:
    """Return the rates of a matrix row by row, g' = g X: each row moves for itself."""
    k, N, _ = hats.shape
    a, i, j = np.nonzero(hats)
    rows = N * np.arange(N)[:, None]
    places = np.stack([np.broadcast_to(a, (N, len(a))), rows + i, rows + j]).reshape(3, -1)
    return np.zeros((k, N * N)), places, np.tile(hats[a, i, j], N)


def _blocks(k: int, lone: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the block of each component of momenta, pose and heading, and whether a block moves itself.

    Two components are in a block if each moves the other. One that nothing moves is as good as one that moves itself.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    (_, sources, targets), size = places, lone.shape[1]
    ones = np.ones(len(sources))
    count, labels = connected_components(coo_array((ones, (sources, targets)), (size, size)), connection="strong")
    driven = np.zeros(count + 1, dtype=np.bool_)
    driven[1 + labels[np.concatenate([targets, np.nonzero(lone)[1]])]] = True
    driven[1 + labels[targets[labels[sources] == labels[targets]]]] = False
    return np.concatenate([np.zeros(k, dtype=np.int64), 1 + labels]).astype(np.int64), ~driven
