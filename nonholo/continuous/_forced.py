r"""The continuous motion under any forces, by Runge-Kutta methods of SciPy, and the reaction of the constraint.

With E(g) the admissible body directions ($S^T$, or $\mathrm{Ad}_{g^{-1}}S^T$ of a constraint fixed in space) and
$f = -dU + f(t, g, \omega)$

$$ \dot r = S\,\mathrm{ad}^*_\omega p + E^Tf \quad\text{(left)}, \qquad \dot r = E^Tf \quad\text{(right)}, \qquad
   \dot g = g\hat\omega, \quad \omega = E(E^T\mathbb{I}E)^{-1}r. $$
"""

import contextlib
from collections.abc import Callable
from typing import Any

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.calls import noted
from nonholo.base.checks import error, is_traced, number, trailing
from nonholo.base.numerics import applied
from nonholo.base.progress import late_bar
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.continuous._solution import PLANE, Solved, States, first_heading, on_same_turn
from nonholo.orbit import Orbit
from nonholo.systems import Forced

_LEAST_RTOL, _SHARE = 1e-13, 1e-3  # SciPy allows no less; absolute errors are that part of the relative ones
_LEAST_IMPLICIT = 1e-9  # relative, for some hundred steps of order 5
_FIRST, _FEW, _MOST = 1000, 10_000, 10_000_000  # steps tried before any judgment, and in total
_STABLE = 3.0  # half of h |lambda| at the bound of stability; smooth motions have less than 1
_PARTS = 1000  # of the time, for progress


def by_runge_kutta(
    forced: Forced,
    begins: float,
    reduced_momentum: Float[np.ndarray, "k"],
    pose: Float[np.ndarray, "size"],
    elapsed: Float[np.ndarray, "K"],
    tolerances: tuple[float, float],
    *,
    is_stiff: bool = False,
) -> Solved:
    """Solve the equations of a system with forces, from canonical momenta and pose at the time `begins`.

    By DOP853, or if they are known to be stiff by the implicit Radau.
    """
    _refuse_table("flow", forced)
    group, k = forced.group, forced.rank
    r, g = forced.from_canonical(reduced_momentum), group.matrix_from_pose(pose) @ group.inverse(forced.frame)
    start = np.concatenate([r, g.ravel(), first_heading(group, pose)])
    faults: dict[str, str] = {}
    field, rtol = _field(forced, begins, k, faults), max(_LEAST_IMPLICIT if is_stiff else _LEAST_RTOL, tolerances[0])
    nodes, pieces, outcome = _steps(field, start, float(elapsed[-1]), rtol, is_stiff=is_stiff)

    def at(times: Float[np.ndarray, "K"]) -> States:
        whole = scipy.integrate.OdeSolution(nodes, pieces) if pieces else lambda t: np.tile(start[:, None], len(t))
        return _states(forced, whole(times).T)

    good_times = elapsed[np.abs(elapsed) <= abs(nodes[-1])]
    why = " ".join(faults.values()) if outcome == Outcome.nonfinite else ""
    return Solved(at(good_times), outcome, at, lambda: np.array(nodes[:-1]), why)


def _steps(
    field: Callable[[float, np.ndarray], np.ndarray], start: np.ndarray, end: float, rtol: float, *, is_stiff: bool
) -> tuple[list[float], list[Any], Outcome]:
    """Return the ends of the steps from time zero, what interpolates within them, and the outcome.

    Steps are too many where the whole time needs more than `_MOST` at the rate so far, or `_FEW` if many of them are as
    short as they are for stability alone, or follow others that were too long, as over jumps.
    """
    nodes, pieces, tries, vain, first = [0.0], [], 0, 0, field(0.0, start)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"), late_bar("flow under forces") as report:
        if not np.isfinite(np.linalg.norm(first / (_SHARE + np.abs(start)) / rtol)):
            return nodes, pieces, Outcome.nonfinite
        method = scipy.integrate.Radau if is_stiff else scipy.integrate.DOP853
        solver: Any = method(field, 0.0, start, end, rtol=rtol, atol=_SHARE * rtol) if end else None
        while solver is not None and solver.status == "running":
            before = solver.nfev
            solver.step()
            attempts = 1 if is_stiff else (solver.nfev - before) // solver.n_stages
            if solver.status == "failed":
                return nodes, pieces, _failure(solver.f if is_stiff else solver.K)
            tries, vain = tries + attempts, vain + attempts - 1 + (not is_stiff and _is_short(solver))
            nodes.append(solver.t)
            pieces.append(solver.dense_output())
            report(int(_PARTS * solver.t / end), _PARTS)
            if tries > _FIRST and tries * end / solver.t > _most(tries, vain):
                return nodes, pieces, Outcome.too_stiff
    return nodes, pieces, Outcome.successful


def _failure(rates: np.ndarray) -> Outcome:
    """Return why a step with these last rates failed."""
    return Outcome.not_converged if np.isfinite(rates).all() else Outcome.nonfinite


def _most(tries: int, vain: int) -> int:
    """Return how many steps are too many, by those so far and those of them in vain."""
    return _FEW if vain > tries / 3 else _MOST


def _is_short(solver: Any) -> bool:
    """Tell whether a step is about as long as is stable, by two derivatives at its end, as Hairer's DOP853 does."""
    last = solver.n_stages - 1
    other = solver.y_old + solver.step_size * (solver.K[:last].T @ solver.A[last, :last])
    slope, gap = np.linalg.norm(solver.K[-1] - solver.K[last]), np.linalg.norm(solver.y - other)
    return bool(solver.step_size * slope > _STABLE * gap)


def forced_field(forced: Forced) -> Callable[[float, np.ndarray], np.ndarray]:
    """Return the equations of motion as a function of time and states, as `vector_field` does."""
    _refuse_table("vector_field", forced)
    size = forced.rank + forced.group.size**2
    field = _field(forced, 0.0, forced.rank, None)

    def derivative(time: float, state: np.ndarray) -> np.ndarray:
        now = number("vector_field(...)(time=...)", time)
        remedy = "Pass momenta along the subspace, then the pose row by row."
        rows = trailing("vector_field(...)(state=...)", state, (size,), remedy, real=True)
        if is_traced(rows):
            return rows.__array_namespace__().vectorize(lambda row: field(now, row), signature="(n)->(n)")(rows)
        return np.apply_along_axis(lambda row: field(now, row), -1, rows)

    return derivative


def _refuse_table(owner: str, forced: Forced) -> None:
    """Refuse forces that belong to steps."""
    if forced.table is not None:
        remedy = "Discretize the system, or pass a function of time."
        raise error(f"{owner}(system=Forced(...))", "have forces at times", "one force for each step", remedy)


def _field(
    forced: Forced, begins: float, k: int, faults: dict[str, str] | None
) -> Callable[[float, np.ndarray], np.ndarray]:
    """Return the right-hand side: momenta along the rows of the user, the pose row by row, the heading in the plane.

    Given a place to note it, what is not finite is NaN, so that the solver comes as near to it as it can.
    """
    group, inertia, N = forced.group, forced.inertia_operator, forced.group.size

    def derivative(time: float, state: np.ndarray) -> np.ndarray:
        xp = state.__array_namespace__()
        if faults is not None and not np.isfinite(state).all():
            return np.full_like(state, np.nan)
        g = state[k : k + N * N].reshape(N, N)
        E = forced.directions(g)
        velocity = E @ xp.linalg.solve(E.T @ inertia @ E, state[:k])
        force = np.full(group.dim, np.nan)
        with contextlib.nullcontext() if faults is None else noted(faults, "force"):
            force = forced.potential_force(g) + forced.applied_force(begins + time, g, velocity)
        if not forced.is_spatial:
            force = force + group.coad(velocity, inertia @ velocity)
        pose_rate = g @ group.hat(velocity)
        return xp.concatenate([E.T @ force, pose_rate.ravel(), velocity[: len(state) - k - N * N]])

    return derivative


def _states(forced: Forced, rows: Float[np.ndarray, "K size"]) -> States:
    group, k, N = forced.group, forced.rank, forced.group.size
    g = rows[:, k : k + N * N].reshape(-1, N, N)
    poses = group.normalize_pose(group.pose_from_matrix(g @ forced.frame))
    headings = on_same_turn(rows[:, -1], poses) if group == PLANE else None
    return States(forced.to_canonical(rows[:, :k]), poses, headings)


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
