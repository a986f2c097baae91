"""`steer`: the controls that take a body from one state to another, by shooting over the exact step."""

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any, cast

import numpy as np
from scipy.optimize import least_squares, minimize

from nonholo.base.checks import array, choice, count, error, needs, pair, shown
from nonholo.base.types import Float
from nonholo.discrete import Discretization, as_discretization
from nonholo.systems import in_group

_STARTS = 8  # random controls from which the goal is looked for
_LOOKS = 100  # evaluations from each of them
_TOLERANCE = 1e-8  # of the goal
_ENDS = ("configuration", "restricted_velocity")
_Missed = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclasses.dataclass(frozen=True, eq=False)
class Steering:
    """Controls that lead to a goal.

    Attributes:
        controls: Body covectors, (steps, dim), as `rollout` takes them.
        orbit: The motion under them, a rollout.
        cost: Half the time integral of the squared forces along the rows of the constraint subspace.
        missed: The largest of the numbers by which the goal is missed.
        converged: Whether the goal is reached to 1e-8 and the cost is at a minimum nearby.
    """

    controls: Float[np.ndarray, "steps dim"]
    orbit: Any
    cost: float
    missed: float
    converged: bool


def steer(
    discrete: Discretization,
    start: Mapping[str, Any],
    goal: Mapping[str, Any],
    *,
    steps: int,
    bounds: Any = None,
    cost: str = "effort",
) -> Steering:
    r"""Find forces along the constraint that take a body from a start to a goal with little effort.

    $$ \min_f\ \tfrac h2\sum_k |f_k|^2 \quad\text{with}\quad (g_N, w_N) = \text{goal}, $$

    where $f_k$ are the components of the control of step k along the rows of the constraint subspace: of a sleigh the
    torque and the thrust along the blade. The orbit is the exact discrete one and its derivatives are exact
    (`rollout`), so the goal is met to rounding, not to the error of a transcription. Least squares look for the goal
    from random controls, sequential quadratic programming for the least effort; minima are local.

    Args:
        discrete: The discretized system, of order 2, with a left-invariant constraint.
        start: `configuration` and `restricted_velocity`; by default the identity, at rest.
        goal: The same; what it does not name is free.
        steps: Number of steps N.
        bounds: Least and largest force, numbers or one for each row; zero for both where nothing pushes.
        cost: "effort".

    Returns:
        The controls. `converged` is False where no way to the goal was found.

    Raises:
        ValueError: A bad argument.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.2), 0.1)
        >>> aside = np.array([[1.0, 0, 0], [0, 1, 1], [0, 0, 1]])
        >>> rest = {"configuration": aside, "restricted_velocity": (0.0, 0.0)}
        >>> parked = nh.steer(sleigh, {}, rest, steps=40)
        >>> parked.converged, bool(np.abs(parked.orbit.configuration[-1] - aside).max() < 1e-8)
        (True, True)
    """
    as_discretization("steer(discrete=...)", discrete)
    steps = count("steer(steps=...)", steps, "Pass the number of steps.")
    choice("steer(cost=...)", cost, ("effort",))
    system, k = discrete.system, discrete.system.rank
    if system.is_spatial:
        got = type(system).__name__
        raise error("steer(discrete=...)", "have a left-invariant constraint", got, "Steer it by `nh.rollout`.")
    g, w = _end("steer(start=...)", discrete, start)
    to_pose, to_velocity = _end("steer(goal=...)", discrete, goal)
    if to_pose is None and to_velocity is None:
        raise error("steer(goal=...)", "name a pose or a velocity", "neither", "Pass configuration=.")
    limits = _limits(bounds, steps, k)
    with needs("jax", "steer"):
        from nonholo.analysis.inverse._ends import missed_goal
        from nonholo.simulation.traced import rollout
    g, w = system.group.identity if g is None else g, np.zeros(k) if w is None else w
    known: dict[bytes, Any] = {}

    def missed(forces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        key = forces.tobytes()
        if key not in known:
            known.clear()
            known[key] = missed_goal(discrete, forces.reshape(steps, k), w, g, to_pose, to_velocity)
        return known[key]

    forces, is_least = _least(missed, limits)
    controls = forces.reshape(steps, k) @ np.linalg.pinv(system.constraint_subspace).T
    start_at = {"restricted_velocity": w, "configuration": g}
    orbit = rollout(discrete, **start_at, controls=controls, steps=steps)
    gap = float(np.abs(missed(forces)[0]).max())
    effort = float(discrete.time_step) * float(forces @ forces) / 2
    return Steering(controls, orbit, effort, gap, bool(is_least and gap < _TOLERANCE))


def _least(missed: _Missed, limits: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, bool]:
    """Return forces of least effort among those that meet the goal, and whether they are; else those that come near."""
    low, high = limits
    free, rng, best = high > low, np.random.default_rng(0), np.zeros(len(low))

    def whole(x: np.ndarray) -> np.ndarray:
        forces = low.copy()
        forces[free] = x
        return forces

    box = list(zip(low[free], high[free], strict=True))
    for _ in range(_STARTS):
        first = np.clip(rng.normal(size=int(free.sum())), *np.transpose(box))
        slope = cast(Any, lambda x: missed(whole(x))[1][:, free])
        near = least_squares(
            lambda x: missed(whole(x))[0], first, slope, bounds=(low[free] - 1e-12, high[free] + 1e-12), max_nfev=_LOOKS
        )
        best = whole(np.clip(near.x, *np.transpose(box)))
        if np.abs(near.fun).max() > 1e-6:
            continue
        goal = {"type": "eq", "fun": lambda x: missed(whole(x))[0], "jac": slope}
        options = {"ftol": 1e-14, "maxiter": 300}
        found = minimize(
            lambda x: (x @ x / 2, x),
            best[free],
            jac=True,
            bounds=box,
            constraints=goal,
            method="SLSQP",
            options=options,
        )
        if np.abs(missed(whole(found.x))[0]).max() < _TOLERANCE:
            best = whole(found.x)
            if found.success:
                return best, True
    return best, False


def _limits(bounds: Any, steps: int, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the least and the largest force of each step and row, one after the other."""
    where, remedy = "steer(bounds=...)", "Pass the least and the largest force, numbers or one for each row."
    if bounds is None:
        return np.full(steps * k, -np.inf), np.full(steps * k, np.inf)
    both = [array(where, end, (k,) if np.ndim(end) else (), remedy) for end in pair(where, bounds)]
    low, high = (np.tile(np.broadcast_to(end, (k,)), steps) for end in both)
    if not (low <= high).all() or not (low < high).any():
        raise error(where, "leave room between them", shown(bounds), remedy)
    return low, high


def _end(where: str, discrete: Discretization, given: Any) -> tuple[np.ndarray | None, np.ndarray | None]:
    """Return the pose and the velocity along the constraint that an end names."""
    if not isinstance(given, Mapping) or not set(given) <= set(_ENDS):
        raise error(where, f"name only {' and '.join(_ENDS)}", shown(given), "Pass a dictionary of them.")
    pose, velocity = (given.get(name) for name in _ENDS)
    g = None if pose is None else in_group(f"{where}['configuration']", discrete.system.group, pose)
    remedy = "Pass one number for each admissible direction."
    return g, None if velocity is None else array(
        f"{where}['restricted_velocity']", velocity, (discrete.system.rank,), remedy
    )
