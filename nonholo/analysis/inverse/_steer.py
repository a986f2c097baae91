"""`steer`: the controls that take a body from one state to another, by shooting over the exact step."""

import dataclasses
import functools
from collections.abc import Mapping
from typing import Any, cast

import numpy as np

from nonholo.analysis.inverse._least_effort import Missed, least_effort
from nonholo.base.checks import array, choice, count, error, needs, pair, shape_of, shown
from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization, as_discretization
from nonholo.systems import System, in_group

_SPREAD = (1.0, 2.0, 0.5, 4.0, 1.0, 2.0, 0.5, 4.0)  # of the random controls from which a goal is looked for, in turn
_BLOCK = 32  # members in one call; of more JAX shares single operations among threads, which takes longer
_TOLERANCE, _LEVEL = 1e-8, 1e-4  # of the goal, and of the gradient at a minimum
Ends = tuple[np.ndarray, np.ndarray, np.ndarray | None, np.ndarray | None]
"""First velocities and poses of members, and the poses and velocities that they are to have, None where free."""


@dataclasses.dataclass(frozen=True, eq=False)
class Steering:
    """Controls that lead to a goal; of many members at once every array has an axis of them in front.

    Attributes:
        discrete: What was steered.
        start: First velocities along the constraint, and poses.
        controls: Body covectors, (steps, dim), as `rollout` takes them.
        cost: Half the time integral of the squared forces along the rows of the constraint subspace.
        missed: The largest of the numbers by which the goal is missed.
        converged: Whether the goal is reached to 1e-8 and the cost is at a minimum nearby.
    """

    discrete: Discretization
    start: tuple[np.ndarray, np.ndarray]
    controls: Float[np.ndarray, "... steps dim"]
    cost: Float[np.ndarray, "..."]
    missed: Float[np.ndarray, "..."]
    converged: Array

    @property
    def failures(self) -> int:
        """How many members have not converged."""
        return int(np.sum(~self.converged))

    @functools.cached_property
    def orbit(self) -> Any:
        """The motion under the controls, a `Rollout`."""
        with needs("jax", "Steering.orbit"):
            from nonholo.analysis.inverse._ends import driven
        w, g = self.start
        steps, dim = self.controls.shape[-2:]
        members = w.reshape(-1, w.shape[-1]), g.reshape(-1, *g.shape[-2:])
        orbits = driven(self.discrete, self.controls.reshape(-1, steps, dim), members)
        return orbits if self.controls.ndim == 3 else type(orbits)(*(x[0] for x in orbits))


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
    (`rollout`), so the goal is met to rounding, not to the error of a transcription. Newton's method on the equations
    of the minimum begins at random controls, anew where it fails; minima are local.

    Starts and goals may be many, with an axis of members in front: these are solved side by side. One that has no
    such axis is that of all of them.

    Args:
        discrete: The discretized system, of order 2, with a left-invariant constraint.
        start: `configuration` and `restricted_velocity`; by default the identity, at rest.
        goal: The same; what it does not name is free.
        steps: Number of steps N.
        bounds: Least and largest force, numbers or one for each row; zero for both where nothing pushes.
        cost: "effort".

    Returns:
        The controls. `converged` is False where no way to the goal was found; `failures` counts these members.

    Raises:
        ValueError: A bad argument.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.2), 0.1)
        >>> aside = np.array([[1.0, 0, 0], [0, 1, 1], [0, 0, 1]])
        >>> rest = {"configuration": aside, "restricted_velocity": (0.0, 0.0)}
        >>> parked = nh.steer(sleigh, {"restricted_velocity": [(0.0, 0.0), (0.0, 0.5)]}, rest, steps=40)
        >>> parked.controls.shape, parked.failures, bool(parked.missed.max() < 1e-8)
        ((2, 40, 3), 0, True)
    """
    as_discretization("steer(discrete=...)", discrete, forced=True)
    steps = count("steer(steps=...)", steps, "Pass the number of steps.")
    choice("steer(cost=...)", cost, ("effort",))
    system, k = discrete.system, discrete.system.rank
    if system.is_spatial:
        got = type(system).__name__
        raise error("steer(discrete=...)", "have a left-invariant constraint", got, "Steer it by `nh.rollout`.")
    (w, g), (to_velocity, to_pose) = (
        _end(f"steer({name}=...)", system, x) for name, x in (("start", start), ("goal", goal))
    )
    if to_pose is None and to_velocity is None:
        raise error("steer(goal=...)", "name a pose or a velocity", "neither", "Pass configuration=.")
    first = np.zeros(k) if w is None else w, system.group.identity if g is None else g
    ends, is_one = _members((*first, to_pose, to_velocity))
    limits = _limits(bounds, steps, k)
    with needs("jax", "steer"):
        from nonholo.analysis.inverse._ends import missed_goals
    block, size = min(_BLOCK, len(ends[0])), system.constrained_inertia.diagonal()
    size = np.tile(np.sqrt(steps) * size / (steps * float(discrete.time_step)) ** 2, steps)

    def missed(forces: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return missed_goals(discrete, forces.reshape(-1, steps, k), _chosen(ends, at), block)

    forces, gap, is_least = _best(missed, size, len(ends[0]), limits)
    controls = forces.reshape(-1, steps, k) @ np.linalg.pinv(system.constraint_subspace).T
    effort = float(discrete.time_step) * (forces**2).sum(axis=1) / 2
    found = ends[:2], controls, effort, gap, is_least
    return Steering(discrete, *cast(Any, _chosen(found, 0) if is_one else found))


def _best(
    missed: Missed, size: np.ndarray, members: int, limits: tuple[np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the forces of least effort, or those that come nearest, what they miss, and whether they are least."""
    rng, left = np.random.default_rng(0), np.arange(members)
    forces, gap, is_least = np.zeros((members, len(size))), np.full(members, np.inf), np.zeros(members, dtype=bool)
    for spread in _SPREAD:
        first = spread * size * rng.normal(size=(len(left), len(size)))
        there = left
        near, miss, rest = least_effort(lambda f, at, there=there: missed(f, there[at]), first, limits)
        better = miss < gap[left]
        now = left[better]
        forces[now], gap[now] = near[better], miss[better]
        is_least[now] = (miss < _TOLERANCE)[better] & (rest < _LEVEL)[better]
        left = left[~is_least[left]]
        if not len(left):
            break
    return forces, gap, is_least


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


def _end(where: str, system: System, given: Any) -> tuple[np.ndarray | None, np.ndarray | None]:
    """Return the velocities along the constraint and the poses that an end names, one or many of them."""
    if not isinstance(given, Mapping) or not set(given) <= {"configuration", "restricted_velocity"}:
        raise error(
            where, "name only configuration and restricted_velocity", shown(given), "Pass a dictionary of them."
        )
    w, g = given.get("restricted_velocity"), given.get("configuration")
    if w is not None:
        shape = (None,) * (len(shape_of(w)) - 1) + (system.rank,)
        w = array(f"{where}['restricted_velocity']", w, shape[-2:], "Pass one number for each admissible direction.")
    if g is not None:
        where, size = f"{where}['configuration']", system.group.identity.shape
        shape = (None,) * (len(shape_of(g)) - 2) + size
        g = array(where, g, shape[-3:], f"Pass elements of {system.group} as matrices.")
        for one in g.reshape(-1, *size):
            in_group(where, system.group, one)
    return w, g


def _members(ends: tuple[np.ndarray | None, ...]) -> tuple[Ends, bool]:
    """Return ends with an axis of members each, and whether none had one."""
    axes = (1, 2, 2, 1)
    sizes = {len(x) for x, axis in zip(ends, axes, strict=True) if x is not None and x.ndim > axis}
    if len(sizes) > 1 or 0 in sizes:
        got = f"{sorted(sizes)} of them"
        raise error("steer(start=..., goal=...)", "have as many members each", got, "Pass one, or one for each.")
    count = max(sizes, default=1)
    each = (x if x is None else np.broadcast_to(x, (count, *x.shape[-n:])) for x, n in zip(ends, axes, strict=True))
    return cast(Any, tuple(each)), not sizes


def _chosen(parts: Any, at: Any) -> Any:
    """Return members of arrays."""
    return parts if parts is None else parts[at] if hasattr(parts, "shape") else tuple(_chosen(x, at) for x in parts)
