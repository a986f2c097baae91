"""The routes of forced steps: another route with half an impulse at each end of its steps, compiled or in Python."""

import contextlib
import dataclasses
import functools
from collections.abc import Callable
from operator import attrgetter
from typing import Any, ClassVar, NoReturn

import numpy as np

from nonholo import kernels
from nonholo.base.calls import FunctionError, UndefinedError, noted
from nonholo.base.checks import error
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Float
from nonholo.discrete.routes._base import AbstractCompiledRoute, AbstractRoute, Rows, parts_by, posed
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
    if forced.is_spatial:
        return FunctionRoute(inside, forced)
    route = ForcedRoute(inside, forced)
    return route if forced.is_jitted else PythonRoute(route)


class AbstractForcedRoute(AbstractRoute):
    """A route whose steps depend on their numbers: there is none from a state alone.

    What functions of the user said of the end of the last run is `said`.
    """

    free: AbstractCompiledRoute
    said: Any
    forced: Forced
    order: ClassVar[int] = 2
    is_scalar: ClassVar[bool] = False

    @property
    def name(self) -> str:
        """The name of the route inside."""
        return self.free.name

    def parts(self, states: Orbit, fractions: Float[np.ndarray, "K"]) -> Rows:
        r"""Return momenta, charts and poses after fractions s of the steps from states; NaN where none starts.

        Half the impulse of the part acts at each of its ends, at times t and t + s h, both of the row of the step. So
        at s = 1 it is the step itself.
        """
        return parts_by(self.free, self._part, posed(states, needed=True), states, fractions)

    def _part(self, m: np.ndarray, pose: np.ndarray, time: float, step: int, fraction: float) -> Rows | None:
        half, free = float(self.free.time_step) / 2, self.free
        end = time + fraction * 2 * half

        def kicked(m: np.ndarray, pose: np.ndarray, time: float, step: int, tau: float) -> np.ndarray:
            return m + kick_of(free, self.forced, tau, np.array([time]), m, pose, np.array([step]))

        with contextlib.suppress(OutcomeError):  # the midpoint rule of a half impulse may fail
            after, moved, (code,) = free.parts_of_steps(
                kicked(m[None], pose[None], time, step, fraction * half), pose[None], fraction
            )
            if code == 0:
                after = kicked(after, moved, end, step, fraction * half)
                pushed = kicked(after, moved, end, step + int(fraction), half)
                return free.ahead(after[0], moved[0], pushed[0])
        return None

    def next_charts(self, states: Orbit) -> Float[np.ndarray, "K m"]:
        """Return the displacements that follow, one step from each state."""
        return self.parts(states, np.ones(len(states)))[1]

    def whole_steps(self, momenta: Any, g: Any) -> NoReturn:
        """Refuse: what follows a momentum and a pose depends on the number of the step."""
        del momenta, g
        raise error("A step from states alone", "be of a system without forces", "Forced", "Use simulate.")


@dataclasses.dataclass(frozen=True, eq=False)
class ForcedRoute(AbstractForcedRoute, AbstractOuterRoute):
    """The loop of the kernel, for left-invariant constraints; it calls functions that numba compiled.

    Attributes:
        free: The route of the free step.
        forced: The system with its forces.
    """

    free: AbstractCompiledRoute
    forced: Forced
    said: dict[str, str] = dataclasses.field(default_factory=dict, repr=False)

    @property
    def single(self) -> AbstractCompiledRoute:
        """The route of the free step."""
        return self.free

    @property
    def needs_pose(self) -> bool:
        """Whether it carries a pose along even where none is kept."""
        return self.free.needs_pose or self.forced.potential is not None or self.forced.function is not None

    @functools.cached_property
    def body(self) -> kernels.ForcedBody:
        """The body and its half impulse."""
        free, forced = self.free, self.forced
        half = half_drive(free, forced, self.said) if forced.needs_function else half_kick(free, forced)
        return kernels.ForcedBody(free.body, half)


@dataclasses.dataclass(frozen=True, eq=False)
class PythonRoute(AbstractForcedRoute):
    """The same loop in plain Python, for functions that are not compiled.

    Attributes:
        loop: The route of the kernel.
    """

    loop: ForcedRoute
    needs_pose: ClassVar[bool] = True
    compiled: ClassVar[None] = None
    free = property(attrgetter("loop.free"))  # type: ignore[assignment]
    forced = property(attrgetter("loop.forced"))  # type: ignore[assignment]

    @property
    def said(self) -> dict[str, str]:  # type: ignore[override]
        """What functions said of the end of the last run."""
        return self.loop.said

    def run(
        self, reduced: np.ndarray, pose: np.ndarray, steps: int, every: int, progress: bool
    ) -> tuple[Rows, Outcome, int]:
        """Run from canonical momenta and pose; return canonical rows, the outcome and the last good step."""
        free, done = self.free, 0
        self.said.clear()
        first = free.encode(reduced), free.encode_poses(pose)
        code, state = self.loop.start(*first)
        found = tuple(np.empty((1 + steps // every, width)) for width in free.sizes)
        for rows, row in zip(found, (first[0], self.loop.chart_of(state), first[1]), strict=True):
            rows[0] = row
        kept = int(code == 0)
        with progress_bar("steps", progress) as show:
            while code == 0 and done < steps:
                room = (found[0][kept:], found[1][kept:], found[2][kept:])
                good, code = self.loop.advance(state, min(every, steps - done), every, room)
                done += good
                kept += good // every
                show(done, steps)
        momenta, charts, poses = (rows[:kept] for rows in found)
        return (free.decode(momenta), free.from_kernel(charts), free.decode_poses(poses)), Outcome(code), done


@dataclasses.dataclass(frozen=True, eq=False)
class FunctionRoute(AbstractForcedRoute):
    """In Python, by the definition of the impulses: for constraints that are fixed in space.

    Attributes:
        free: The route of the free step.
        forced: The system with its forces.
    """

    free: AbstractCompiledRoute
    forced: Forced
    said: dict[str, str] = dataclasses.field(default_factory=dict, repr=False)
    needs_pose: ClassVar[bool] = True
    compiled: ClassVar[None] = None

    def impulse(self, node: int, step: int, m: np.ndarray, pose: np.ndarray) -> np.ndarray:
        """Return what half the impulse of a step at a node adds to the kernel's momenta."""
        half = float(self.free.time_step) / 2
        time, steps = np.array([2 * half * node]), np.array([step])
        return kick_of(self.free, self.forced, half, time, m[None], pose[None], steps, self.said)[0]

    def run(
        self, reduced: np.ndarray, pose: np.ndarray, steps: int, every: int, progress: bool
    ) -> tuple[Rows, Outcome, int]:
        """Run from canonical momenta and pose; return canonical rows, the outcome and the last good step."""
        free, (n, width, size), code, done, saved = self.free, self.free.sizes, 0, -1, []
        m, place, state = free.encode(reduced), free.encode_poses(pose), np.empty(0)
        room = np.empty((1, n)), np.empty((1, width)), np.empty((1, size))
        none = kernels.Kick(np.zeros((0, 0)), np.zeros(0), np.zeros((n, 0)), np.zeros((1, n)))
        body = kernels.ForcedBody(free.body, none)
        self.said.clear()
        with progress_bar("steps", progress) as show, contextlib.suppress(OutcomeError):
            while done < steps:
                code = Outcome.no_half_impulse  # the midpoint rule of a half impulse may say so
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
                    code, place = Outcome.no_half_impulse, state[2 * n : 2 * n + size].copy()
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
    steps: np.ndarray,
    said: dict[str, str] | None = None,
) -> np.ndarray:
    """Return what the impulses of a time add to momenta of a kernel; NaN where they are not finite."""
    group = forced.group
    g = group.matrix_from_pose(free.decode_poses(poses)) @ group.inverse(forced.frame)
    j, said = np.array(np.nan), {} if said is None else said
    with noted(said, "potential"):
        j = forced.impulses(forced.from_canonical(free.decode(momenta.copy())), g, time, steps, half, said)
    if not np.isfinite(j).all():
        return np.full_like(momenta, np.nan)
    return free.encode(forced.to_canonical(forced.restrict_at(j, g)))


def half_kick(free: AbstractCompiledRoute, forced: Forced) -> kernels.Kick:
    """Return half the impulse of a step in the units and axes of a kernel."""
    kick, _ = _linear_part(free, forced)
    weight, arms = kick.weight, kick.arms
    if len(weight):
        arms = arms @ _kernel_frame(free, forced).T
    if free.is_scalar and forced.group == SE(2):
        weight, arms = weight[:2], arms[:, :2]
    return kick._replace(weight=_plain(weight), arms=_plain(arms))


def half_drive(free: AbstractCompiledRoute, forced: Forced, said: dict[str, str]) -> kernels.Drive:
    """Return half the impulse of functions; those that numba compiled are asked before a run."""
    kick, along = _linear_part(free, forced)
    group, S, has = (
        forced.group,
        np.asarray(forced.constraint_subspace),
        (forced.function is not None, callable(forced.potential)),
    )
    momenta = forced.from_canonical(free.decode(np.eye(forced.rank)))
    velocity = S.T @ np.linalg.solve(S @ np.asarray(forced.inertia_operator) @ S.T, momenta.T)
    moves, weights = forced.differences
    force, potential = _in_python(forced, said)
    if forced.is_jitted:
        shape = (group.size, group.dim)
        _check_compiled(forced)
        force = kernels.function_of(forced.function, shape, 3) if has[0] else 0
        potential = kernels.function_of(forced.potential, shape, 1) if has[1] else 0
    return kernels.Drive(
        kick=kick,
        planar=(2 if group == SE(2) else 3) if free.is_scalar else 0,
        turn=_plain(_kernel_frame(free, forced)),
        velocity=_plain(velocity),
        along=_plain(along.T),
        moves=_plain(moves),
        weights=_plain(weights),
        time_step=float(free.time_step),
        has=has,
        force=force,
        potential=potential,
    )


def _in_python(forced: Forced, said: dict[str, str]) -> tuple[Callable[..., None], Callable[..., None]]:
    """Return what writes force and potential by the definition: NaN where they are not finite, which is noted."""

    def force(time: float, g: np.ndarray, velocity: np.ndarray, out: np.ndarray) -> None:
        out[:] = np.nan
        with noted(said, "force"):
            out[:] = forced.driving_force(time, g, velocity)

    def potential(time: float, g: np.ndarray, velocity: np.ndarray, out: np.ndarray) -> None:
        del time, velocity
        out[0] = np.nan
        with noted(said, "potential"):
            out[0] = forced.potential_energy(g)

    return force, potential


def _check_compiled(forced: Forced) -> None:
    """Ask functions that numba compiled once: for their numbers, and whether they write to what they get.

    What they say at a place that is no place of a run does not count.
    """
    group, moving = forced.group, np.linspace(0.5, 1.0, forced.group.dim)
    for g, velocity, ignored in (
        (group.identity, 0 * moving, UndefinedError),
        (group.exp(moving / 8), moving, Exception),
    ):
        try:
            forced.driving_force(0.0, g, velocity)
            forced.potential_energy(g)
        except ignored as failure:
            if isinstance(failure, FunctionError) and not isinstance(failure, UndefinedError):
                raise


def _linear_part(free: AbstractCompiledRoute, forced: Forced) -> tuple[kernels.Kick, Float[np.ndarray, "dim k"]]:
    """Return what is linear, with the weight in the user's frame, and the momenta of body covectors."""
    keep, along = _half_step(free, forced)
    weight, arms = np.zeros(0), np.zeros((forced.rank, 0))
    if forced.gravity is not None:
        weight, levers = forced.gravity.levers(forced.group)
        arms = _summed(along, levers)
    rows = _summed(forced.rows(np.arange(1 + (0 if forced.table is None else len(forced.table)))).T, along)
    return kernels.Kick(*map(_plain, (keep, weight, arms, rows))), along


def _summed(columns: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return the sum of outer products in their order, as by the kernel of a page."""
    return functools.reduce(np.add, map(np.multiply.outer, columns, rows))


def _half_step(free: AbstractCompiledRoute, forced: Forced) -> tuple[np.ndarray, Float[np.ndarray, "dim k"]]:
    """Return what friction leaves of the kernel's momenta in half a step, and the momenta of body covectors."""
    S, half = np.asarray(forced.constraint_subspace), float(free.time_step) / 2
    to_kernel = free.encode(forced.to_canonical(np.eye(forced.rank)))
    if forced.friction is not None and free.is_scalar:
        rows, scale = (to_kernel / free.scale).T @ S, float(free.scale)
        C = rows @ forced.friction.matrix @ rows.T
        keep, push = np.reshape(kernels.rubbed(free.body, C.ravel().tolist(), half), (2, 2, 2))
        return keep, rows.T @ (scale * push).T
    keep, push, _ = forced.propagator(S.T, half)
    kept = np.zeros((0, 0)) if forced.friction is None else np.linalg.solve(to_kernel, keep.T @ to_kernel).T
    return kept, S.T @ push.T @ to_kernel


def _kernel_frame(free: AbstractCompiledRoute, forced: Forced) -> Float[np.ndarray, "N N"]:
    """Return T: a pose of the user is that of the kernel times T."""
    frame, group = free.encode_poses(forced.frame_pose[None]), forced.group
    matrix = group.matrix_from_pose(frame) if free.is_scalar else frame.reshape(-1, group.size, group.size)
    return np.linalg.inv(matrix[0])


def _plain(array: np.ndarray) -> np.ndarray:
    """Return a writable copy row by row: every other layout would be compiled for itself."""
    return np.array(array, order="C")
