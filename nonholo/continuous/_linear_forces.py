r"""Weights and friction in the equations of the Taylor series, which stay quadratic.

A potential that is linear in the entries of the pose acts along the constraint by $Lu$, where constant vectors F in
space are seen from the body as $u = g^TF$. With a constant c = 1

$$ r' = S\,\mathrm{ad}^*_\omega p + c\,(Lu - Cw), \qquad u' = \sum_a w_a\hat S_a^Tu, \qquad c' = 0 : $$

rates of (r, u, c) are quadratic in (w, u, c), as those of r are in w. So (r, u, c) are solved for as momenta of a free
motion are; in another unit of time all of them are divided by one number.
"""

import functools
from typing import NamedTuple

import numpy as np

from nonholo.base.numerics import applied
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.continuous._forced import by_runge_kutta
from nonholo.continuous._series import body_equations, body_numbers, solve
from nonholo.continuous._solution import Solved
from nonholo.kernels import Quadratic
from nonholo.systems import Forced

_MOST = 10_000_000  # steps of a flow
_STIFF = 2e6  # of a flow, in times in which friction slows the body down: a step of the series has about five


class LinearForces(NamedTuple):
    """What acts along the canonical rows of the constraint.

    Attributes:
        vectors: F, vectors in space.
        turns: The rates of a vector seen from the body, as a matrix for each velocity.
        levers: L.
        friction: C.
        velocities: V of w = V r.
        fastest: The largest rate at which friction alone slows the body down.
    """

    vectors: Float[np.ndarray, "p N"]
    turns: Float[np.ndarray, "k n n"]
    levers: Float[np.ndarray, "k m"]
    friction: Float[np.ndarray, "k k"]
    velocities: Float[np.ndarray, "k k"]
    fastest: float


def _are_linear(forced: Forced) -> bool:
    """Tell whether all that acts is friction and a potential linear in the pose, and the constraint is in the body."""
    others = forced.function is not None or forced.table is not None or forced.is_spatial
    return not others and (forced.potential is None or hasattr(forced.potential, "levers"))


@functools.lru_cache(maxsize=16)
def _linear_forces(forced: Forced) -> LinearForces:
    """Return what acts, seen from the canonical frame."""
    group, body, rows = forced.group, forced.canonical, forced.frame_map @ np.asarray(forced.constraint_subspace)
    n = group.size - group.is_affine  # points have the last number 1, and levers none for it
    vectors, levers = np.zeros((0, group.size)), np.zeros((group.dim, 0, group.size))
    if forced.potential is not None:
        vectors, levers = forced.potential.levers(group)
        vectors, levers = vectors.reshape(-1, group.size), levers.reshape(group.dim, -1, group.size)
    body_levers = np.tensordot(rows, levers, 1) @ np.linalg.inv(forced.frame).T
    C = np.zeros((group.dim, group.dim)) if forced.friction is None else forced.friction.matrix
    V, _ = body_numbers(group, body.constraint_subspace, body.inertia_operator)
    friction, turns = rows @ C @ rows.T, group.hat(body.constraint_subspace).swapaxes(-1, -2)[:, :n, :n]
    fastest = np.linalg.eigvals(V @ friction).real.max(initial=0.0)
    return LinearForces(
        vectors, turns, body_levers[..., :n].reshape(len(rows), n * len(vectors)), friction, V, float(fastest)
    )


@functools.lru_cache(maxsize=16)
def quadratic_under(forced: Forced) -> Quadratic:
    """Return the equations of momenta, vectors seen from the body, and the constant behind the pose."""
    body, acting = forced.canonical, _linear_forces(forced)
    S, (k, m) = body.constraint_subspace, acting.levers.shape
    velocities, torques = np.eye(k + m + 1), np.zeros((k + m + 1,) * 3)
    velocities[:k, :k], torques[:k, :k, :k] = body_numbers(body.group, S, body.inertia_operator)
    torques[-1, :k, :k], torques[-1, k:-1, :k] = -acting.friction.T, acting.levers.T
    torques[:k, k:-1, k:-1] = np.kron(np.eye(len(acting.vectors)), acting.turns).swapaxes(-1, -2)
    return body_equations(body.group, S, velocities, torques, (k, m, 1))


def heads(
    forced: Forced, momenta: Float[np.ndarray, "M k"], poses: Float[np.ndarray, "M size"]
) -> tuple[Float[np.ndarray, "M K"], Float[np.ndarray, "M"]]:
    """Return momenta, vectors seen from the body and the constant at starts, divided by the unit of time, and this."""
    acting, one = _linear_forces(forced), np.ones((len(momenta), 1))
    V, n = acting.velocities, acting.turns.shape[-1]
    body_vectors = (acting.vectors @ forced.group.matrix_from_pose(poses))[..., :n].reshape(len(momenta), -1)
    pull, rub = (np.abs(V @ acts).max(initial=0.0) for acts in (acting.levers, acting.friction))
    rates = np.concatenate([applied(V, momenta), np.sqrt(pull * np.abs(body_vectors)), rub * one], axis=1)
    units = np.ldexp(1.0, np.frexp(np.abs(rates).max(axis=1))[1])  # as `power_of_two` of each
    return np.concatenate([momenta, body_vectors, one], axis=1) / units[:, None], units


def has_series_under(forced: Forced, span: float) -> bool:
    """Tell whether the flow over a time is solved by series: not where friction is much faster."""
    return _are_linear(forced) and bool(abs(span) * _linear_forces(forced).fastest <= _STIFF)


def under_forces(
    forced: Forced,
    begins: float,
    reduced_momentum: Float[np.ndarray, "k"],
    pose: Float[np.ndarray, "size"],
    elapsed: Float[np.ndarray, "K"],
    tolerances: tuple[float, float],
) -> Solved:
    """Solve the equations of a system with forces from the time `begins` on, by series where they serve."""
    if not has_series_under(forced, elapsed[-1]):
        start = forced, begins, reduced_momentum, pose
        return by_runge_kutta(*start, elapsed, tolerances, is_stiff=_are_linear(forced))
    (head,), (unit,) = heads(forced, reduced_momentum[None], pose[None])
    f, rank = quadratic_under(forced), forced.rank
    solution = solve(forced.group, f, head, rank, None, float(unit), pose, elapsed, tolerances, _MOST)
    return solution if solution.outcome == Outcome.successful else solution._replace(outcome=Outcome.too_stiff)
