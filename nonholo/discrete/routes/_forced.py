"""Routes around another one, whose units, axes and poses they have: over substeps, or with half impulses.

Half impulses act at the nodes or, balanced, at the displacement: with numbers for a weight, friction and a table, on
matrices for any force.
"""

import contextlib
import dataclasses
import functools
from collections.abc import Callable
from operator import attrgetter
from typing import Any, ClassVar, cast

import numpy as np

from nonholo import kernels
from nonholo.base.calls import FunctionError, UndefinedError, note_fault, number_of
from nonholo.base.checks import error
from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Float
from nonholo.discrete._scheme import variety_of, weights
from nonholo.discrete.routes._base import AbstractCompiledRoute, Compact, plain, poses_of
from nonholo.groups import SE, SO
from nonholo.orbit import Orbit
from nonholo.systems import Forced

When = tuple[float, int, float]
"""The time, the number of the step and the fraction of it."""
_OF_SINGLE = "name needs_pose system time_step scale encode decode to_kernel from_kernel encode_poses decode_poses"
"""Properties that are those of the route inside."""


class AbstractOuterRoute(AbstractCompiledRoute):
    """A route that runs the kernel of another one, its `single`, and has its units, axes and poses."""

    name = scale = system = time_step = cast(Any, None)  # seen by type checkers
    locals().update((name, property(attrgetter(f"single.{name}"))) for name in _OF_SINGLE.split())


@dataclasses.dataclass(frozen=True, eq=False)
class ComposedRoute(AbstractOuterRoute):
    """Momenta, charts and poses are those of the route that is composed.

    Attributes:
        substep: The route of a step of order 2 with the same time step.
        order: 4, 6 or 8.
    """

    substep: AbstractCompiledRoute
    order: int

    @functools.cached_property
    def body(self) -> kernels.ComposedBody:
        """The body and the weights of the substeps."""
        return kernels.ComposedBody(self.single.body, weights(self.order).copy())

    single = property(attrgetter("substep"))


def forced_route(free: AbstractCompiledRoute, forced: Forced) -> AbstractCompiledRoute:
    """Return the route of a system with forces, by kicks at the nodes, around that of the free one."""
    if forced.forces is None:
        return free
    if free.order > 2:
        got = f"{free.order}: kicks around a composition leave it at order 2"
        remedy = "Use order=2, or the scheme 'energy', which has compositions."
        raise error("discretize(order=...)", "be 2 where forces act at the nodes", got, remedy)
    inside = free.compiled_route
    if inside is None or forced.is_spatial:
        return FunctionRoute(free, forced)
    return ForcedRoute(inside, forced)


@dataclasses.dataclass(frozen=True, eq=False)
class AbstractForcedRoute(AbstractOuterRoute):
    """A route whose steps depend on their numbers: there is none from a state alone.

    Attributes:
        free: The route of the free step.
        forced: The system with its forces.
        faults: Failures of the user's functions at the end of the last run.
    """

    free: AbstractCompiledRoute
    forced: Forced
    faults: dict[str, str] = dataclasses.field(default_factory=dict, repr=False, kw_only=True)
    part_needs_pose: ClassVar[bool] = True
    single = property(attrgetter("free"))

    @property
    def needs_pose(self) -> bool:
        """Whether it carries a pose along even where none is kept."""
        return self.free.needs_pose or self.forced.potential is not None or self.forced.function is not None

    def _part(self, m: np.ndarray, pose: np.ndarray, time: float, step: int, fraction: float) -> Compact | None:
        """Return the kernel's momenta, chart and pose after a fraction s of a step; None where there is no such step.

        Half the impulse of the part acts at each of its ends, at times t and t + s h, both of the row of the step. So
        at s = 1 it is the step itself.
        """
        half, free = float(self.free.time_step) / 2, self.free
        end = time + fraction * 2 * half
        with contextlib.suppress(OutcomeError):  # the midpoint rule of a half impulse may fail
            start = self.kick(m[None], pose[None], (time, step), fraction * half, {})
            after, place, (code,) = free.parts_of_steps(start, pose[None], fraction)
            if code == 0:
                after = self.kick(after, place, (end, step), fraction * half, {})
                m_half = self.kick(after, place, (end, step + int(fraction)), half, {})
                return free.ahead(after[0], place[0], m_half[0])
        return None

    def kick(
        self, m: np.ndarray, pose: np.ndarray, when: tuple[float, int], tau: float, faults: dict[str, str]
    ) -> np.ndarray:
        """Return one row of the kernel's momenta after impulses over a time; NaN where they are not finite."""
        free, forced, group, j = self.free, self.forced, self.forced.group, np.array(np.nan)
        g = group.matrix_from_pose(free.decode_poses(pose)) @ group.inverse(forced.frame)
        time, step = (np.array([number]) for number in when)
        with note_fault(faults, "potential"):
            j = forced.impulses(forced.from_canonical(free.decode(m.copy())), g, time, step, tau, faults)
        if not np.isfinite(j).all():
            return np.full_like(m, np.nan)
        return m + free.encode(forced.to_canonical(forced.restrict_at(j, g)))


@dataclasses.dataclass(frozen=True, eq=False)
class ForcedRoute(AbstractForcedRoute):
    """The loop of the kernel, for left-invariant constraints; in plain Python if it calls functions of Python."""

    @property
    def compiled_route(self) -> "ForcedRoute | None":  # type: ignore[override]
        """The route itself, if numba compiled all functions that it calls."""
        return self if self.forced.is_jitted and not exact_terms(self.forced) else None

    @functools.cached_property
    def body(self) -> kernels.ForcedBody:
        """The body and its half impulse."""
        free, forced = self.free, self.forced
        kick, along = _linear_part(free, forced)
        if forced.needs_function or exact_terms(forced):
            return kernels.ForcedBody(free.body, half_drive(free, forced, kick, along, self.faults))
        weight, arms = kick.weight, kick.arms
        if len(weight):
            arms = arms @ kernel_frame(free, forced).T
        if free.is_scalar and forced.group == SE(2):
            weight, arms = weight[:2], arms[:, :2]
        return kernels.ForcedBody(free.body, kick._replace(weight=plain(weight), arms=plain(arms)))


@dataclasses.dataclass(frozen=True, eq=False)
class FunctionRoute(AbstractForcedRoute):
    """In Python, by the definition of the impulses: for constraints fixed in space, and steps by the definition.

    Its state is that of the free step, one step ahead, and the number of the step.
    """

    needs_pose: ClassVar[bool] = True
    compiled_route: ClassVar[None] = None
    body = sizes = cast(Any, None)
    locals().update((name, property(attrgetter(f"free.{name}"))) for name in ("body", "sizes"))

    def start(self, momenta: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray, np.ndarray]:
        """Return the outcome of the first root, its chart and the state of a run."""
        failure, m_half = Outcome.no_half_impulse, np.array(momenta)
        with contextlib.suppress(OutcomeError):  # the midpoint rule of a half impulse may fail
            failure, m_half = None, self._after_half(0, 0, momenta, pose)
        code, chart, state = self.free.set_out(m_half, np.array(pose))
        return failure or code, chart, np.append(state, 0.0)

    def advance(self, state: np.ndarray, steps: int, every: int, rows: Compact) -> tuple[int, int]:
        """Take steps one by one, into rows of the kernel."""
        n, _, size = self.free.sizes
        with contextlib.suppress(OutcomeError):
            for good in range(steps):
                ahead, number = state[:-1].copy(), int(state[-1])
                place = ahead[2 * n : 2 * n + size].copy()
                m = self._after_half(number + 1, number, ahead[:n], place)
                ahead[:n] = self._after_half(number + 1, number + 1, m, place)
                code, chart = self.free.follow(ahead)
                if code != 0:
                    return good, code
                state[:] = np.append(ahead, number + 1)
                if (good + 1) % every == 0:
                    for column, entries in zip(rows, (m, chart, place), strict=True):
                        column[good // every] = entries
            return steps, 0
        return good, Outcome.no_half_impulse

    def _after_half(self, node: int, step: int, m: np.ndarray, pose: np.ndarray) -> np.ndarray:
        """Return the kernel's momenta after half the impulse of a step at a node."""
        half = float(self.free.time_step) / 2
        return self.kick(m[None], pose[None], (2 * half * node, step), half, self.faults)[0]


def half_drive(free: Any, forced: Forced, kick: kernels.Kick, along: np.ndarray, faults: Any) -> kernels.Drive:
    """Return half the impulse of functions; those that numba compiled are evaluated before a run."""
    exact = exact_terms(forced)
    has = forced.function is not None or bool(exact), forced.own_potential is not None
    moves, weights = forced.differences
    force, potential = functions_of(forced, exact, faults)
    return kernels.Drive(
        kick=kick,
        planar=(2 if forced.group == SE(2) else 3) if free.is_scalar else 0,
        turn=plain(kernel_frame(free, forced)),
        velocity=plain(velocities_of(free, forced)),
        along=plain(along.T),
        moves=plain(moves),
        weights=plain(weights),
        time_step=float(free.time_step),
        has=has,
        force=force,
        potential=potential,
    )


def exact_terms(forced: Forced) -> list[Any]:
    """Return the potentials whose covectors are known, unless there is a single weight, which a kernel takes."""
    return [] if forced.gravity is not None else [each for each in forced.terms if not callable(each)]


def functions_of(forced: Forced, exact: list[Any], faults: dict[str, str]) -> tuple[Any, Any]:
    """Return force and potential as kernels call them: addresses if numba compiled all of them, else in Python.

    The force has the covectors of potentials where they are known.
    """
    if not forced.is_jitted or exact:
        return _in_python(forced, exact, faults)
    shape = (forced.group.size, forced.group.dim)
    if not forced.needs_function:
        return 0, 0
    from nonholo.kernels.by_numba import function_of

    _check_compiled(forced)
    force = 0 if forced.function is None else function_of(forced.function, shape, 3)
    return force, 0 if forced.own_potential is None else function_of(forced.own_potential, shape, 1)


def _in_python(forced: Forced, exact: list[Any], faults: dict[str, str]) -> tuple[Any, Any]:
    """Return what writes force and potential by the definition: NaN where they are not finite, which is noted."""
    own: Any = forced.own_potential

    def force(time: float, g: np.ndarray, velocity: np.ndarray, out: np.ndarray) -> None:
        out[:] = np.nan
        with note_fault(faults, "force"):
            out[:] = forced.driving_force(time, g, velocity)
        for each in exact:
            out += each.covector(forced.group, g)

    def potential(time: float, g: np.ndarray, velocity: np.ndarray, out: np.ndarray) -> None:
        del time, velocity
        out[0] = np.nan
        with note_fault(faults, "potential"):
            out[0] = number_of("Forced(potential=...)", own, "Return U of a configuration.", g)

    return force, potential


def _check_compiled(forced: Forced) -> None:
    """Ask functions that numba compiled once: for their numbers, and whether they write to what they get.

    Their result at a place that is no place of a run does not count.
    """
    group, moving = forced.group, np.linspace(0.5, 1.0, forced.group.dim)
    rest, motion = (group.identity, 0 * moving, UndefinedError), (group.exp(moving / 8), moving, Exception)
    for g, velocity, harmless in (rest, motion):
        try:
            forced.driving_force(0.0, g, velocity)
            forced.potential_energy(g)
        except harmless as failure:
            if isinstance(failure, FunctionError) and not isinstance(failure, UndefinedError):
                raise


def _linear_part(free: AbstractCompiledRoute, forced: Forced) -> tuple[kernels.Kick, Float[np.ndarray, "dim k"]]:
    """Return what is linear, with the weight in the user's frame, and the momenta of body covectors.

    Of friction it is what half a step leaves of the kernel's momenta.
    """
    S, half, keep = np.asarray(forced.constraint_subspace), float(free.time_step) / 2, np.zeros((0, 0))
    to_kernel = free.encode(forced.to_canonical(np.eye(forced.rank)))
    if forced.friction is not None and free.is_scalar:
        rows, scale = (to_kernel / free.scale).T @ S, float(free.scale)
        C = rows @ forced.friction.matrix @ rows.T
        keep, push = np.reshape(kernels.friction_flow(free.body, C.ravel().tolist(), half), (2, 2, 2))
        along = rows.T @ (scale * push).T
    else:
        left, push, _ = forced.propagator(S.T, half)
        along = S.T @ push.T @ to_kernel
        if forced.friction is not None:
            keep = np.linalg.solve(to_kernel, left.T @ to_kernel).T
    weight, arms = np.zeros(0), np.zeros((forced.rank, 0))
    if forced.gravity is not None:
        weight, levers = forced.gravity.levers(forced.group)
        arms = sum_products(along, levers)
    rows = sum_products(forced.all_rows.T, along)
    return kernels.Kick(*map(plain, (keep, weight, arms, rows))), along


def sum_products(columns: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return the sum of outer products in their order, as by the kernel of a page."""
    return functools.reduce(np.add, map(np.multiply.outer, columns, rows))


def velocities_of(free: AbstractCompiledRoute, forced: Forced) -> Float[np.ndarray, "dim k"]:
    """Return the matrix from the kernel's momenta to body velocities."""
    S, momenta = np.asarray(forced.constraint_subspace), forced.from_canonical(free.decode(np.eye(forced.rank)))
    return S.T @ np.linalg.solve(S @ np.asarray(forced.inertia_operator) @ S.T, momenta.T)


def kernel_frame(free: AbstractCompiledRoute, forced: Forced) -> Float[np.ndarray, "N N"]:
    """Return T: a pose of the user is that of the kernel times T."""
    frame, group = free.encode_poses(forced.frame_pose[None]), forced.group
    matrix = group.matrix_from_pose(frame) if free.is_scalar else frame.reshape(-1, group.size, group.size)
    return np.linalg.inv(matrix[0])


def balanced_route(free: Any, matrix: Callable[[], Any], forced: Forced, order: int) -> "BalancedRoute":
    """Return the route of balanced half impulses around a free step, or for any force around that on matrices."""
    by_numbers = forced.function is None and (forced.gravity is not None or not forced.terms)
    return BalancedRoute(free if free.is_scalar and by_numbers and order == 2 else matrix(), forced, order, matrix)


@dataclasses.dataclass(frozen=True, eq=False)
class BalancedRoute(AbstractForcedRoute):
    """Equal half impulses at the displacement, by which T + U and every balance is exact; in one or several stages.

    Attributes:
        order: 2, 4, 6 or 8.
        matrix: Makes the route of the free step on matrices.
    """

    order: int = 2
    matrix: Any = dataclasses.field(default=None, repr=False)

    @property
    def compiled_route(self) -> "BalancedRoute | None":  # type: ignore[override]
        """The route itself, if numba compiled all functions that it calls."""
        return self if self.forced.is_jitted else None

    @functools.cached_property
    def body(self) -> kernels.ForcedBody:
        """The body and its half impulses."""
        forced, free = self.forced, self.free
        kick = pull(free, forced) if free.is_scalar else balance(free, forced, self.order, self.faults)
        return kernels.ForcedBody(free.body, kick)

    @functools.cached_property
    def general(self) -> "BalancedRoute":
        """The route of any force, whose step has parts."""
        return dataclasses.replace(self, free=self.matrix()) if self.free.is_scalar else self

    def parts(self, states: Orbit, fractions: Float[np.ndarray, "K"]) -> Compact:
        """Return momenta, charts and poses after fractions of the steps from states; NaN where none starts."""
        if self.general is self:
            return super().parts(states, fractions)
        momenta, charts, poses = self.general.parts(states, fractions)
        if self.forced.group == SO(3):  # of both quaternions of a pose that of a turn by less than a half
            ahead = (poses * poses_of(states, is_needed=True)).sum(axis=1, keepdims=True)
            poses = np.where(ahead < 0, -poses, poses)
        return momenta, charts, poses

    def _part(self, m: np.ndarray, pose: np.ndarray, time: float, step: int, fraction: float) -> Compact | None:
        k = len(m)
        code, state = self.after(np.array(m), np.array(pose), (time, step, fraction))
        if code != 0:
            return None
        after, place = state[:k].copy(), state[2 * k : 2 * k + len(pose)].copy()
        _, ahead = self.after(after, place, (time + fraction * float(self.free.time_step), step + int(fraction), 1.0))
        return after, self.runs.chart_of(self.body, ahead), place

    def after(self, m: np.ndarray, pose: np.ndarray, when: When, force: Any = None) -> tuple[int, np.ndarray]:
        """Return the outcome of a fraction of a step, and the kernel's state after it; a constant force may act too."""
        half, (time, step, fraction) = cast(kernels.Balanced, self.body.kick), when
        rows = half.c.rows[[min(step, len(half.c.rows) - 1), -1]]
        if force is not None:
            rows = rows + half.c.along @ force
        c = half.c._replace(stages=fraction * half.c.stages, begin=float(time), rows=rows)
        return self.runs.start(self.body._replace(kick=half._replace(c=c)), m, pose)

    def body_from(self, step: int) -> kernels.ForcedBody:
        """Return the body of a run that begins at a step."""
        kick = self.body.kick
        if isinstance(kick, kernels.Pull):
            return self.body._replace(kick=kick._replace(rows=kick.rows[min(step, len(kick.rows) - 1) :]))
        c = cast(kernels.Balanced, kick).c
        c = c._replace(rows=c.rows[min(step, len(c.rows) - 1) :], begin=step * float(self.free.time_step))
        return self.body._replace(kick=cast(kernels.Balanced, kick)._replace(c=c))


def pull(free: AbstractCompiledRoute, forced: Forced) -> kernels.Pull:
    """Return half impulses of a weight, friction and a table, for tops in space and sleighs in the plane."""
    half, inside, flat = float(free.time_step) / 2, 2 if forced.group == SE(2) else 3, np.eye(3)[:2]
    rows = (free.encode(forced.to_canonical(np.eye(2))) / free.scale).T @ np.asarray(forced.constraint_subspace)
    weight, arms, friction = np.zeros(0), np.zeros((2, 0)), np.zeros((0, 0))
    if forced.gravity is not None:  # levers of the point in the kernel's own axes: rounded ones would do work on loops
        weight, point = forced.gravity.homogeneous(forced.group)
        own = flat if inside == 2 else np.array([flat[1], -flat[0]])
        arms = half * free.scale * (own @ (forced.group.basis @ (kernel_frame(free, forced) @ point)))
        weight, arms = weight[:inside], arms[:, :inside]
    if forced.friction is not None:
        stiff = kernels.quadratic(free.body)[0] / kernels.inertia(free.body)[0]
        friction = half * stiff * (rows @ forced.friction.matrix @ rows.T)
    table = half * free.scale * sum_products(forced.all_rows.T, rows.T)
    return kernels.Pull(*map(plain, (weight, arms, friction, table)))


def balance(free: AbstractCompiledRoute, forced: Forced, order: int, faults: dict[str, str]) -> kernels.Balanced:
    """Return half the impulses at displacements in the units and axes of a kernel."""
    group, S, half = forced.group, np.asarray(forced.constraint_subspace), float(free.time_step) / 2
    to_kernel = free.encode(forced.to_canonical(np.eye(forced.rank)))
    velocity = velocities_of(free, forced)
    along, chart = half * to_kernel.T @ S, variety_of(forced.system, "skew").chart
    exact = [each for each in forced.terms if hasattr(each, "matrix_for")]
    springs = [each.numbers_for(group) for each in forced.terms if hasattr(each, "numbers_for")]
    linear = sum((each.matrix_for(group) for each in exact), np.zeros((group.size,) * 2 if exact else (0, 0)))
    C = np.zeros((0, 0)) if forced.friction is None else along @ forced.friction.matrix @ velocity
    moves, parts = forced.differences
    force, potential = functions_of(forced, [], faults)
    numbers = kernels.Impulses(
        turn=plain(kernel_frame(free, forced)),
        directions=plain(forced.from_canonical_frame(group.hat(free.from_kernel(np.eye(free.sizes[1])) @ chart))),
        velocity=plain(velocity),
        along=plain(along),
        levers=plain(np.einsum("kd,dab->kab", along, group.basis)),
        metric=plain(velocity.T @ np.asarray(forced.inertia_operator) @ velocity),
        linear=plain(linear),
        springs=plain(np.reshape(springs, (len(springs), 2 + 2 * group.size))),
        friction=plain(C),
        rows=plain(forced.all_rows @ along.T),
        moves=plain(moves),
        weights=plain(parts),
        time_step=float(free.time_step),
        begin=0.0,
        stages=plain(weights(order)),
    )
    has = forced.function is not None, forced.own_potential is not None
    return kernels.Balanced(numbers, has, force, potential)
