"""The routes of forced steps: another route with half an impulse at each end of its steps, compiled or in Python."""

import contextlib
import dataclasses
import functools
from typing import Any, ClassVar, NoReturn

import numpy as np

from nonholo import kernels
from nonholo.base.checks import error
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome, OutcomeError
from nonholo.discrete.routes._base import AbstractCompiledRoute, AbstractRoute, Rows
from nonholo.discrete.routes._outer import AbstractOuterRoute
from nonholo.groups import SE
from nonholo.orbit import Orbit
from nonholo.systems import Forced


def forced_route(free: AbstractRoute, forced: Forced) -> AbstractRoute:
    """Return the route of a system with forces around that of the free one."""
    if forced.forces is None:
        return free
    inside = free.compiled
    if inside is None or free.order > 2:
        remedy = "Use order=2, and the default difference and constraint of a system with a mass tensor."
        got = f"order {free.order}, route {free.name!r}"
        raise error("discretize(system=Forced(...))", "have a compiled step of order 2 inside", got, remedy)
    in_python = forced.needs_function or forced.is_spatial
    return FunctionRoute(inside, forced) if in_python else ForcedRoute(inside, forced)


class AbstractForcedRoute(AbstractRoute):
    """A route whose steps depend on their numbers: there is none from a state alone."""

    free: AbstractCompiledRoute
    order: ClassVar[int] = 2
    is_scalar: ClassVar[bool] = False

    @property
    def name(self) -> str:
        """The name of the route inside."""
        return self.free.name

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

    def parts_of_steps(self, momenta: np.ndarray, poses: np.ndarray, fraction: float = 1.0) -> Rows:
        """Take a step of a part of the length from each row; the forces must not depend on time."""
        half = fraction * float(self.time_step) / 2
        kick = functools.partial(kick_of, self.free, self.forced, half, np.zeros(len(momenta)))
        after, moved, codes = self.free.parts_of_steps(momenta + kick(momenta, poses), poses, fraction)
        return after + kick(after, moved), moved, codes


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

    def impulse(self, node: int, step: int, m: np.ndarray, pose: np.ndarray) -> np.ndarray:
        """Return what half the impulse of a step at a node adds to the kernel's momenta."""
        half = float(self.free.time_step) / 2
        time, steps = np.array([2 * half * node]), np.array([step])
        return kick_of(self.free, self.forced, half, time, m[None], pose[None], steps)[0]

    def run(
        self, reduced: np.ndarray, pose: np.ndarray, steps: int, every: int, progress: bool
    ) -> tuple[Rows, Outcome, int]:
        """Run from canonical momenta and pose; return canonical rows, the outcome and the last good step."""
        free, (n, width, size), code, done, saved = self.free, self.free.sizes, 0, -1, []
        m, place, state = free.encode(reduced), free.encode_poses(pose), np.empty(0)
        room = np.empty((1, n)), np.empty((1, width)), np.empty((1, size))
        none = kernels.Kick(np.zeros((0, 0)), np.zeros(0), np.zeros((n, 0)), np.zeros((1, n)))
        body = kernels.ForcedBody(free.body, none)
        with progress_bar("steps", progress) as show, contextlib.suppress(OutcomeError):
            while done < steps:
                code = Outcome.not_converged  # the midpoint rule of a half impulse may say so
                pushed = m + self.impulse(done + 1, done + 1, m, place)
                if done < 0:
                    code, state = kernels.start(body, pushed, place)
                    room[1][0] = kernels.chart_of(body, state)
                else:
                    state[:n] = pushed
                    _, code = kernels.advance(body, state, 1, 1, room)
                if code != 0:
                    break
                done += 1
                show(done, steps)
                saved += [(m, room[1][0].copy(), place)] * (done % every == 0)
                if done < steps:
                    code, place = Outcome.not_converged, state[2 * n : 2 * n + size].copy()
                    m = state[:n] + self.impulse(done + 1, done, state[:n], place)
        momenta, charts, poses = (np.array([row[j] for row in saved]).reshape(-1, w) for j, w in enumerate(free.sizes))
        return (free.decode(momenta), free.from_kernel(charts), free.decode_poses(poses)), Outcome(code), max(0, done)


def kick_of(
    free: AbstractCompiledRoute,
    forced: Forced,
    half: float,
    time: np.ndarray,
    momenta: np.ndarray,
    poses: np.ndarray,
    steps: np.ndarray | None = None,
) -> np.ndarray:
    """Return what the impulses of a time add to momenta of a kernel; NaN where they are not finite."""
    group, steps = forced.group, np.full(len(momenta), -1) if steps is None else steps
    g = group.matrix_from_pose(free.decode_poses(poses)) @ group.inverse(forced.frame)
    j = forced.impulses(forced.from_canonical(free.decode(momenta.copy())), g, time, steps, half)
    if not np.isfinite(j).all():
        return np.full_like(momenta, np.nan)
    return free.encode(forced.to_canonical(forced.restrict_at(j, g)))


def half_kick(free: AbstractCompiledRoute, forced: Forced) -> kernels.Kick:
    """Return half the impulse of a step in the units and axes of a kernel."""
    S, k, group = np.asarray(forced.constraint_subspace), forced.rank, forced.group
    keep, push, _ = forced.propagator(S.T, float(free.time_step) / 2)
    to_kernel = free.encode(forced.to_canonical(np.eye(k)))
    along, kept, weight, arms = S.T @ push.T @ to_kernel, np.zeros((0, 0)), np.zeros(0), np.zeros((k, 0))
    if forced.friction is not None:
        kept = np.linalg.solve(to_kernel, keep.T @ to_kernel).T
    if forced.gravity is not None:
        frame = free.encode_poses(forced.frame_pose[None])
        frame = group.matrix_from_pose(frame) if free.is_scalar else frame.reshape(-1, group.size, group.size)
        weight, levers = forced.gravity.levers(group)
        arms = along.T @ levers @ np.linalg.inv(frame[0]).T
    if free.is_scalar and group == SE(2):
        weight, arms = weight[:2], arms[:, :2]
    rows = forced.rows(np.arange(1 + (0 if forced.table is None else len(forced.table)))) @ along
    return kernels.Kick(*(np.array(part, order="C") for part in (kept, weight, arms, rows)))
