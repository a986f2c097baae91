"""The routes of forced steps: another route with half an impulse at each end of its steps, compiled or in Python."""

import dataclasses
import functools
from typing import Any, ClassVar, NoReturn

import numpy as np

from nonholo import kernels
from nonholo.base.checks import error
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Float
from nonholo.discrete.routes._base import AbstractCompiledRoute, AbstractRoute, Rows
from nonholo.discrete.routes._outer import AbstractOuterRoute
from nonholo.orbit import Orbit
from nonholo.systems import Forced, Friction, Gravity, impulses, propagator


def forced_route(free: AbstractRoute, forced: Forced) -> AbstractRoute:
    """Return the route of a system with forces around that of the free one."""
    if forced.is_free:
        return free
    inside = free.compiled
    if inside is None or free.order > 2:
        remedy = "Use order=2, and the default difference and constraint of a system with a mass tensor."
        got = f"order {free.order}, route {free.name!r}"
        raise error("discretize(system=Forced(...))", "have a compiled step of order 2 inside", got, remedy)
    if forced.needs_function or forced.is_spatial:
        return FunctionRoute(inside, forced)
    return ForcedRoute(inside, forced)


class AbstractForcedRoute(AbstractRoute):
    """A route whose steps depend on their numbers: there is none from a state alone."""

    order: ClassVar[int] = 2
    is_scalar: ClassVar[bool] = False

    def next_charts(self, states: Orbit) -> NoReturn:
        """Refuse: what follows a state depends on the number of its step."""
        got = f"save_every {states.save_every}"
        raise error("Orbit.multipliers", "have every step of a run with forces", got, "Run with save_every=1.")

    def whole_steps(self, momenta: Any, g: Any) -> NoReturn:
        """Refuse, as `next_charts` does."""
        del momenta, g
        raise error("A step from states alone", "be of a system without forces", "Forced", "Use simulate.")


@dataclasses.dataclass(frozen=True, eq=False)
class ForcedRoute(AbstractForcedRoute, AbstractOuterRoute):
    """Compiled: gravity, friction and rows of a table, for left-invariant constraints.

    Attributes:
        free: The route of the free step.
        forced: The system with its forces.
    """

    free: AbstractCompiledRoute
    forced: Forced

    @property
    def single(self) -> AbstractCompiledRoute:
        """The route of the free step."""
        return self.free

    @property
    def needs_pose(self) -> bool:
        """Whether it carries a pose along even where none is kept."""
        return self.free.needs_pose or self.forced.potential is not None

    @functools.cached_property
    def body(self) -> kernels.ForcedBody:
        """The body and its half impulse."""
        return kernels.ForcedBody(self.free.body, half_kick(self.free, self.forced))


@dataclasses.dataclass(frozen=True, eq=False)
class FunctionRoute(AbstractForcedRoute):
    """In Python, by the definition of the impulses: functions, and constraints that are fixed in space.

    Attributes:
        free: The route of the free step.
        forced: The system with its forces.
    """

    free: AbstractCompiledRoute
    forced: Forced
    needs_pose: ClassVar[bool] = True
    compiled: ClassVar[None] = None

    @property
    def name(self) -> str:
        """The name of the route inside."""
        return self.free.name

    def kick(self, node: int, step: int, m: np.ndarray, pose: np.ndarray) -> np.ndarray:
        """Return the kernel's momenta after half the impulse of a step at a node."""
        forced, free, half = self.forced, self.free, float(self.free.time_step) / 2
        r = forced.from_canonical(free.decode(m[None].copy()))
        g = forced.group.matrix_from_pose(free.decode_poses(pose[None])) @ forced.group.inverse(forced.frame)
        j = impulses(forced, r, g, np.array([2 * half * node]), np.array([step]), half)
        if not np.isfinite(j).all():
            return np.full_like(m, np.nan)
        return m + free.encode(forced.to_canonical(forced.restrict_at(j, g)))[0]

    def run(
        self, reduced: np.ndarray, pose: np.ndarray, steps: int, every: int, progress: bool
    ) -> tuple[Rows, Outcome, int]:
        """Run from canonical momenta and pose; return canonical rows, the outcome and the last good step."""
        free, saved, done = self.free, [], -1
        with progress_bar("steps", progress) as show:

            def report(number: int, *row: np.ndarray) -> None:
                nonlocal done
                done = number
                show(number, steps)
                if number % every == 0:
                    saved.append([each.copy() for each in row])

            first = free.encode(reduced), free.encode_poses(pose)
            try:
                code = kernels.run_by_kicks(free.body, self.kick, *first, steps, report)
            except OutcomeError as failure:  # the midpoint rule of a half impulse
                code = failure.outcome
        momenta, charts, poses = (
            np.array([row[j] for row in saved]).reshape(len(saved), width) for j, width in enumerate(free.sizes)
        )
        rows = free.decode(momenta), free.from_kernel(charts), free.decode_poses(poses)
        return rows, Outcome(code), max(0, done)


def half_kick(free: AbstractCompiledRoute, forced: Forced) -> kernels.Kick:
    """Return half the impulse of a step in the units and axes of a kernel."""
    S, k, half = np.asarray(forced.constraint_subspace), forced.rank, float(free.time_step) / 2
    parts = propagator(forced, S.T, half)
    to_kernel = free.encode(forced.to_canonical(np.eye(k)))
    push = parts.push.T @ to_kernel
    keep = np.linalg.solve(to_kernel, parts.keep.T @ to_kernel).T if isinstance(forced.force, Friction) else _none(2)
    pull, weight, stride = _pull(free, forced, S.T @ push)
    rows = np.zeros((0, k)) if forced.table is None else forced.table @ S.T @ push
    keep, pull, weight, rows = (np.array(x, order="C") for x in (keep, pull, weight, rows))
    return kernels.Kick(keep, pull, weight, rows, stride)


def _pull(
    free: AbstractCompiledRoute, forced: Forced, to_kernel: Float[np.ndarray, "dim k"]
) -> tuple[np.ndarray, np.ndarray, int]:
    """Return the matrix that takes a spatial force, seen from the kernel's body frame, to its momenta; the force."""
    gravity, group = forced.potential, forced.group
    if not isinstance(gravity, Gravity):
        return _none(2), _none(1), 0
    coded, N, n = free.encode_poses(forced.frame_pose[None])[0], group.size, len(gravity.force)
    frame = group.matrix_from_pose(coded) if free.is_scalar else coded.reshape(N, N)
    arms = gravity.arms(group) @ np.linalg.inv(frame).T
    return (arms[:, :n].T @ to_kernel).T, np.asarray(gravity.force), 0 if free.is_scalar else N


def _none(axes: int) -> np.ndarray:
    return np.zeros((0,) * axes)
