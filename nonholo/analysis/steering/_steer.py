"""`steer`: the controls that take a body from one state to another, by shooting over the exact step or by IPOPT."""

import dataclasses
import functools
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from nonholo.analysis.steering import _arguments
from nonholo.analysis.steering._arguments import BLOCK, Ends, Limits, StateBounds, Way
from nonholo.base.checks import choice, count, flags, needs, refuse_given, within_memory
from nonholo.base.memo import Keeper
from nonholo.base.progress import interruptibly, progress_bar
from nonholo.base.results import result
from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization, as_discretization
from nonholo.simulation import check_forces, refuse_many_matrices, simulate
from nonholo.systems import AbstractCoordinateDiscretization, Forced, in_coordinates, refuse_fixed_in_space

_PER_ENTRY = 24.0  # bytes of a second derivative: its value, and where it stands


@result
class Steering(Keeper):
    """Controls that lead to a goal; of many members at once every array has an axis of them in front.

    Attributes:
        discrete: The steered system.
        start: First velocities along the constraint, and poses; in coordinates velocity and configuration.
        controls: Body covectors, (steps, dim), as `rollout` takes them; in coordinates forces on them.
        cost: Half the time integral of the squared forces along the rows of the constraint subspace.
        missed: The largest of the numbers by which the orbit under the controls misses the goal, a place on the way,
            the clearance of an obstacle, or bounds of states: angles, lengths over that of the body, velocities over
            those that pass these in the time of the motion. In coordinates its size is that of the way.
        outcome: "converged": nothing is missed by 1e-8, and the cost is at a minimum nearby. "not least": nothing is
            missed, but there may be less cost. "infeasible": from every guess IPOPT came to where the equations and
            bounds contradict each other, which proves nothing of other ways. "not found": none of these.
    """

    discrete: Any
    start: tuple[np.ndarray, np.ndarray]
    controls: Float[np.ndarray, "... steps dim"]
    cost: Float[np.ndarray, "..."]
    missed: Float[np.ndarray, "..."]
    outcome: Array

    @property
    def converged(self) -> Any:
        """Whether nothing is missed by 1e-8 and the cost is at a minimum nearby."""
        return self.outcome == "converged"

    @property
    def failures(self) -> int:
        """How many members have not converged."""
        return int(np.sum(~self.converged))

    @functools.cached_property
    def orbit(self) -> Any:
        """The motion under the controls as far as it goes, an orbit; of many members a `Rollout`."""
        if self.controls.ndim < 3:
            return driven(self.discrete, self.start, self.controls)
        with needs("jax", "Steering.orbit"):
            from nonholo.analysis.steering._shooting import driven_side_by_side

        return driven_side_by_side(self.discrete, self.controls, self.start)


def driven(motion: Any, start: tuple[np.ndarray, np.ndarray], controls: Float[np.ndarray, "steps dim"]) -> Any:
    """Return the orbit under forces that act besides those of the system, as far as it goes."""
    velocity: Any = {"body_velocity" if in_coordinates(motion) else "restricted_velocity": start[0]}
    motion = dataclasses.replace(motion, system=Forced(motion.system, force=controls))
    return simulate(motion, configuration=start[1], **velocity, steps=len(controls), throw=False)


def steer(
    discrete: Any,
    start: Mapping[str, Any],
    goal: Mapping[str, Any],
    *,
    steps: int,
    bounds: Any = None,
    cost: str = "effort",
    method: str | None = None,
    obstacles: Any = None,
    outline: Any = None,
    via: Any = None,
    state_bounds: Any = None,
    guess: Any = None,
    progress: bool = False,
) -> Steering:
    r"""Find forces along the constraint that take a body from a start to a goal with little effort.

    $$ \min_f\ \tfrac h2\sum_k |f_k|^2 \quad\text{with}\quad (g_N, w_N) = \text{goal}, $$

    where $f_k$ are the components of the control of step k along the rows of the constraint subspace: for a sleigh
    the torque and the thrust along the blade. The orbit is the exact discrete one and its derivatives are exact, so the
    goal is met to rounding, not to the error of a transcription. Minima are local.

    "shooting" has the forces alone as unknowns, of many members at once, by derivatives of `rollout`: Newton's method
    on the equations of the minimum begins at random controls, and again where it fails. "ipopt" has all states as
    unknowns too, and the equations of all steps as sparse conditions with exact first and second derivatives, one
    member after the other; it keeps clear of obstacles, and it also solves long motions.

    Starts and goals may have a leading axis of members. One without it holds for all members.

    A system in coordinates (`LagrangeDAlembert`) is steered by "ipopt", one member, with a force on each coordinate:
    `bounds` select those with motors. So is a `GroupLagrangeDAlembert`, by body covectors.

    Args:
        discrete: The discretized system, of order 2, with a left-invariant constraint; or one in coordinates, or by
            functions on a group. JAX must trace a potential that is a function.
        start: `configuration` and `restricted_velocity`, `body_velocity` or `momentum`; by default the identity, at
            rest. In coordinates `configuration` and `body_velocity` or `momentum`.
        goal: The same, in coordinates no momentum; components that it does not name are free. In coordinates a
            configuration may name some of them alone: {"x": 1.0, "theta": 0.0}.
        steps: Number of steps N.
        bounds: Least and largest force, numbers or one for each row; zero for both where there is no motor.
        cost: "effort".
        method: "shooting" or "ipopt" (extra `steer`); by default "ipopt" where only it can solve the problem.
        obstacles: Discs or balls: their centers (obstacles, n), and one radius or one for each. States keep clear of
            them; between two states a track may cut into one by up to $s^2/8\rho$ on a step of length s.
        outline: Body points (points, n) that keep clear; by default the origin of the body frame. In coordinates also a
            function of q, written with `jax.numpy`, that returns them: those of a trailer, which must not cut a disc.
        via: Positions of the body frame on the way, by number of steps: {40: (1.0, 0.5)}.
        state_bounds: The least and the largest value of components of the state, by name: {"x": (0, 3), "theta": (-1,
            1)}. On groups "x", "y", "z"; "theta" in the plane, of the heading up to full turns; "restricted_velocity",
            a number or one for each row. In coordinates their names; "body_velocity" of each step, a number or one for
            each coordinate. Bounds may be infinite. They hold at every state, also at the goal.
        guess: Where "ipopt" begins: positions (points, n) of a path, or a `Steering` of one member.
        progress: Show a progress bar of the members on standard error.

    Returns:
        The controls. `converged` is False where no way to the goal was found, and `outcome` names the reason;
        `failures` counts these members.

    Raises:
        ValueError: A bad argument.
        MissingExtraError: "ipopt" without the extra `steer`.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.2), 0.1)
        >>> aside = np.array([[1.0, 0, 0], [0, 1, 1], [0, 0, 1]])
        >>> rest = {"configuration": aside, "restricted_velocity": (0.0, 0.0)}
        >>> parked = nh.steer(sleigh, {"restricted_velocity": [(0.0, 0.0), (0.0, 0.5)]}, rest, steps=40)
        >>> parked.controls.shape, parked.failures, bool(parked.missed.max() < 1e-8)
        ((2, 40, 3), 0, True)

        Around a disc:

        >>> around = nh.steer(sleigh, {}, rest, steps=40, obstacles=([(0.0, 0.5)], 0.3))
        >>> str(around.outcome), bool(around.cost > parked.cost[0])
        ('converged', True)
    """
    is_on_group = not isinstance(discrete, AbstractCoordinateDiscretization)
    discrete = as_discretization("steer(discrete=...)", discrete, forced=True) if is_on_group else discrete
    steps = count("steer(steps=...)", steps, "Pass the number of steps.")
    choice("steer(cost=...)", cost, ("effort",))
    flags("steer", progress=progress)
    way = Way.of(discrete.system, steps, obstacles, outline, via, guess)
    extras = {"obstacles": obstacles, "outline": outline, "via": via, "state_bounds": state_bounds, "guess": guess}
    method = _method(discrete, method, extras)
    if not is_on_group:
        return _steered_in_coordinates(discrete, (start, goal), (bounds, state_bounds), way, steps)
    subject = _in_jax(discrete, steps, "jax" if method == "shooting" else "steer")
    ends, is_one = _arguments.checked_ends(discrete.system, start, goal, bool(way.via))
    _refuse_too_many(discrete, steps, method, min(len(ends[0]), BLOCK))
    duration = steps * float(discrete.time_step)
    way = way._replace(bounds=_arguments.bounds_of_body(state_bounds, discrete.system, ends, duration))
    limits = _arguments.limits_of_steps(bounds, steps, discrete.system.rank)
    with progress_bar("members", progress) as report:
        by = functools.partial(_by_ipopt, way=way, report=report) if method == "ipopt" else _by_shooting
        forces, gap, outcome = interruptibly(lambda: by(subject, ends, limits))
    controls = forces @ np.linalg.pinv(discrete.system.constraint_subspace).T
    effort = float(discrete.time_step) * (forces**2).sum(axis=(-2, -1)) / 2
    results = *ends[:2], controls, effort, gap, outcome
    w, g, *rest = (np.asarray(each[0]) for each in results) if is_one else results
    return Steering(discrete, (w, g), *rest)


def _method(discrete: Any, method: Any, extras: dict[str, Any]) -> str:
    """Return a method for this problem, or refuse the one that is named."""
    where = "steer(method=...)"
    choice(where, method, (None, "shooting", "ipopt"))
    if method == "shooting":
        for name, value in extras.items():
            refuse_given("steer", "be left out of shooting", 'Use method="ipopt".', **{name: (value, None)})
    if in_coordinates(discrete):
        choice(where, method, (None, "ipopt"), "Systems in coordinates are steered by IPOPT.")
        return "ipopt"
    return method or ("shooting" if all(each is None for each in extras.values()) else "ipopt")


def _in_jax(discrete: Discretization, steps: int, extra: str) -> Discretization:
    """Return a discretization that JAX sees into, none with a constraint fixed in space or what `rollout` refuses."""
    with needs(extra, "steer"):
        from nonholo.simulation.traced import with_traced_potential
    refuse_fixed_in_space("steer(discrete=...)", discrete.system, "Steer it by `nh.rollout`.")
    subject = with_traced_potential("steer", discrete)
    check_forces("steer", subject, steps, in_jax=True)
    return subject


def _refuse_too_many(discrete: Discretization, steps: int, method: str, members: int) -> None:
    """Refuse more steps than memory holds: derivatives of all of a block of members, or windows of unknowns of one."""
    where, remedy, system = "steer(steps=...)", "Pass fewer steps.", discrete.system
    if method == "shooting":
        return refuse_many_matrices(where, discrete, members * steps, remedy, derivatives=system.rank)
    window = 2 * system.group.size**2 + 4 * system.rank
    return within_memory(where, _PER_ENTRY * steps * window**2, remedy)


def _by_shooting(discrete: Discretization, ends: Ends, limits: Limits) -> tuple[Any, ...]:
    """Return forces along the rows, what is missed, and outcomes of members, all at once."""
    with needs("jax", "steer"):
        from nonholo.analysis.steering._shooting import shot
    return shot(discrete, ends, limits)


def _by_ipopt(
    discrete: Discretization, ends: Ends, limits: Limits, way: Way, report: Callable[[int, int], None]
) -> tuple[Any, ...]:
    """Return forces along the rows, what is missed, and outcomes of members, one after the other."""
    with needs("steer", "steer(method='ipopt')"):
        from nonholo.analysis.steering._problems import group_problem
        from nonholo.analysis.steering._transcription import transcribe
    for name, poses in (("start", ends[1]), ("goal", ends[2])):
        way.check(name, poses if poses is None else _arguments.body_points(poses, way.outline))
    results = []
    for member in range(len(ends[0])):
        one = tuple(each if each is None else each[member] for each in ends)
        results.append(transcribe(*group_problem(discrete, one, limits, way)))
        report(member + 1, len(ends[0]))
    return tuple(np.array(part) for part in zip(*results, strict=True))


def _steered_in_coordinates(
    discrete: Any, ends: tuple[Any, Any], bounds: tuple[Any, Any], way: Way, steps: int
) -> Steering:
    """Return the result for a system in coordinates."""
    with needs("steer", "steer"):
        from nonholo.analysis.steering import _problems
        from nonholo.analysis.steering._transcription import transcribe
    n, start = discrete.system.dimension, _problems.checked_start(discrete, ends[0])
    q, v = start[0][: discrete.system.shapes[0][0]], start[1]
    if callable(way.outline):
        way = way._replace(outline=_problems.moving_outline(discrete.system, way.outline))
    within_memory("steer(steps=...)", _PER_ENTRY * steps * (7.0 * n) ** 2, "Pass fewer steps.")
    limits = _arguments.limits_of_steps(bounds[0], steps, n)
    goal = _problems.checked_goal(discrete, ends[1], is_free=bool(way.via))
    both = {"start": np.append(v, q), "goal": goal.numbers(discrete.system)}
    unit, far = _problems.extent_of_way(discrete, start, goal, way, steps)
    names = _arguments.coordinate_numbers(discrete.system, far * unit, steps * float(discrete.time_step))
    way = way._replace(bounds=StateBounds.of(bounds[1], names, both))
    problem = _problems.coordinate_problem(discrete, (start, goal), limits, way, (unit, far))
    forces, gap, outcome = interruptibly(lambda: transcribe(*problem))
    effort = float(discrete.time_step) * (forces**2).sum() / 2
    return Steering(discrete, (v, q), forces, *map(np.asarray, (effort, gap, outcome)))
