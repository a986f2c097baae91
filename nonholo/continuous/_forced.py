r"""The continuous motion under forces, by the Runge-Kutta method DOP853 of SciPy, and the reaction of the constraint.

With E(g) the admissible body directions ($S^T$, or $\mathrm{Ad}_{g^{-1}}S^T$ of a constraint fixed in space) and
$f = -dU + f(t, g, \omega)$

$$ \dot r = S\,\mathrm{ad}^*_\omega p + E^Tf \quad\text{(left)}, \qquad \dot r = E^Tf \quad\text{(right)}, \qquad
   \dot g = g\hat\omega, \quad \omega = E(E^T\mathbb{I}E)^{-1}r. $$
"""

from collections.abc import Callable

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.checks import error, number, trailing
from nonholo.base.numerics import applied
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.continuous._solution import PLANE, Solved, States, first_heading, on_same_turn
from nonholo.orbit import Orbit
from nonholo.systems import Forced

_LEAST_RTOL, _SHARE = 1e-13, 1e-3  # SciPy allows no less; absolute errors are that part of the relative ones


def by_runge_kutta(
    forced: Forced,
    begins: float,
    reduced_momentum: Float[np.ndarray, "k"],
    pose: Float[np.ndarray, "size"],
    elapsed: Float[np.ndarray, "K"],
    tolerances: tuple[float, float],
) -> Solved:
    """Solve the equations of a system with forces, from canonical momenta and pose at the time `begins`."""
    _refuse_table("flow", forced)
    group, k = forced.group, forced.rank
    r, g = forced.from_canonical(reduced_momentum), group.matrix_from_pose(pose) @ group.inverse(forced.frame)
    start = np.concatenate([r, g.ravel(), first_heading(group, pose)])
    field, rtol = _field(forced, begins, k), max(_LEAST_RTOL, tolerances[0])
    if len(elapsed) == 1:
        states = _states(forced, start[None])
        return Solved(states, Outcome.successful, lambda times: states.chosen(np.zeros(len(times), dtype=int)))
    found = scipy.integrate.solve_ivp(
        field, (0.0, elapsed[-1]), start, "DOP853", elapsed, True, rtol=rtol, atol=_SHARE * rtol
    )
    outcome = Outcome.successful if found.status == 0 else Outcome.not_converged
    steps, states = found.sol.ts[:-1], _states(forced, found.y.T)
    return Solved(states, outcome, lambda t: _states(forced, found.sol(t).T), lambda: steps)


def forced_field(forced: Forced) -> Callable[[float, np.ndarray], np.ndarray]:
    """Return the equations of motion as a function of time and states, as `vector_field` does."""
    _refuse_table("vector_field", forced)
    size = forced.rank + forced.group.size**2
    field = _field(forced, 0.0, forced.rank)

    def derivative(time: float, state: np.ndarray) -> np.ndarray:
        now = number("vector_field(...)(time=...)", time)
        remedy = "Pass momenta along the subspace, then the pose row by row."
        rows = trailing("vector_field(...)(state=...)", state, (size,), remedy, real=True)
        return np.apply_along_axis(lambda row: field(now, row), -1, rows)

    return derivative


def _refuse_table(owner: str, forced: Forced) -> None:
    """Refuse forces that belong to steps."""
    if forced.table is not None:
        remedy = "Discretize the system, or pass a function of time."
        raise error(f"{owner}(system=Forced(...))", "have forces at times", "one force for each step", remedy)


def _field(forced: Forced, begins: float, k: int) -> Callable[[float, np.ndarray], np.ndarray]:
    """Return the right-hand side: momenta along the rows of the user, the pose row by row, the heading in the plane."""
    group, inertia, N = forced.group, np.asarray(forced.inertia_operator), forced.group.size

    def derivative(time: float, state: np.ndarray) -> np.ndarray:
        g = state[k : k + N * N].reshape(N, N)
        E = forced.directions(g)
        velocity = E @ np.linalg.solve(E.T @ inertia @ E, state[:k])
        force = forced.potential_force(g) + forced.applied_force(begins + time, g, velocity)
        if not forced.is_spatial:
            force = force + group.coad(velocity, inertia @ velocity)
        moved = g @ group.hat(velocity)
        return np.concatenate([E.T @ force, moved.ravel(), velocity[: len(state) - k - N * N]])

    return derivative


def _states(forced: Forced, rows: Float[np.ndarray, "K size"]) -> States:
    group, k, N = forced.group, forced.rank, forced.group.size
    g = rows[:, k : k + N * N].reshape(-1, N, N)
    poses = group.normalize_pose(group.pose_from_matrix(g @ forced.frame))
    turned = on_same_turn(rows[:, -1], poses) if group == PLANE else None
    return States(forced.to_canonical(rows[:, :k]), poses, turned)


def forced_reaction(forced: Forced, states: Orbit) -> Float[np.ndarray, "K dim"]:
    r"""Return the forces of constraint $\mathbb{I}\dot\omega - \mathrm{ad}^*_\omega p - f$; on LR systems in space.

    They vanish along E, which determines the acceleration.
    """
    group, inertia = forced.group, np.asarray(forced.inertia_operator)
    g, velocity = states.configuration, states.body_velocity
    acting = [forced.applied_force(*row) for row in zip(states.time, g, velocity, strict=True)]
    force = group.coad(velocity, applied(inertia, velocity)) + forced.potential_force(g)
    force = force + np.reshape(acting, velocity.shape)
    E = forced.directions(g)
    along = np.swapaxes(E, -1, -2)
    acceleration = E @ np.linalg.solve(along @ inertia @ E, along @ force[..., None])
    missing = (inertia @ acceleration)[..., 0] - force
    return group.coadjoint(group.inverse(g), missing) if forced.is_spatial else missing
