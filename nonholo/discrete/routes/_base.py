"""The interface of every route and of its stepper, and what compiled ones share: units, axes, runs, single steps."""

import abc
import dataclasses
import functools
from typing import Any, ClassVar

import numpy as np

from nonholo import kernels
from nonholo.base.checks import is_moderate
from nonholo.base.numerics import applied
from nonholo.base.results import OUTCOMES, Outcome, OutcomeError
from nonholo.base.types import Array, Float
from nonholo.discrete._scheme import weights
from nonholo.groups import AbstractMatrixGroup
from nonholo.orbit import AbstractStepper, First, Orbit, Rows, State, keep_row, step_poses
from nonholo.systems import System

Compact = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Canonical momenta and charts, and compact canonical poses, of which each is empty where there are none."""


@dataclasses.dataclass(frozen=True, eq=False)
class AbstractBodyStepper(AbstractStepper[Orbit]):
    """The steps of a map on a group: rows are momenta, charts and poses in the numbers of the kernel.

    Attributes:
        motion: The discretization.
        with_poses: Whether poses are saved.
        sizes: Numbers of momenta, chart coordinates and pose entries that a row holds.
    """

    motion: Any
    with_poses: bool
    sizes: ClassVar[Any]

    @property
    def part_refused(self) -> str | None:
        """Why a step has no parts; None if it has."""
        if self.branch != "principal":
            return f"branch {self.branch!r}: only the principal branch has them"
        forced = self.motion.forces
        needs_pose = self.motion.system.is_spatial or (forced is not None and bool(forced.terms or forced.function))
        if needs_pose and not self.with_poses:  # of right-invariant constraints, and under some forces
            return "a step that depends on the pose, without reconstruct=True"
        return None

    in_threads = False

    @functools.cached_property
    def columns(self) -> dict[str, int]:  # type: ignore[override]
        """The names and sizes of what a row holds."""
        return dict(zip(("reduced_momentum", "cayley", "canonical_pose"), self.sizes, strict=True))

    def decode(self, momenta: np.ndarray, charts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return momenta and charts as canonical ones, which they are by default."""
        return momenta, charts

    def decode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return poses as compact canonical ones, which they are by default."""
        return poses

    def matrices(self, rows: Rows) -> Float[np.ndarray, "K N N"]:
        """Return poses as matrices."""
        return self.motion.system.group.matrix_from_pose(self.decode_poses(rows[2]))

    def settle(self, rows: Rows) -> Outcome:
        """Bring momenta and charts to canonical ones, in place; return whether all that is saved is finite."""
        momenta, charts, poses = rows
        momenta[:], charts[:] = self.decode(momenta, charts)
        good = is_moderate(momenta) and is_moderate(charts, np.inf)
        good = good and (not self.with_poses or is_moderate(poses, np.inf))
        return Outcome.successful if good else Outcome.nonfinite

    def orbit(self, rows: Rows, step: int, every: int, outcome: Outcome) -> Orbit:
        """Return settled rows as an orbit."""
        (momenta, charts, raw), poses = rows, None
        if self.with_poses and (poses := self.decode_poses(raw)) is not raw:
            outcome = outcome or (Outcome.successful if is_moderate(poses, np.inf) else Outcome.nonfinite)
        steps, motion = range(step, step + every * len(momenta), every), self.motion
        states = {"reduced_momentum": momenta, "cayley": charts, "canonical_pose": poses}
        return Orbit.of_run(steps, motion=motion, **states, outcome=outcome, save_every=every, branch=self.branch)


@dataclasses.dataclass(frozen=True, eq=False)
class CompiledStepper(AbstractBodyStepper):
    """The steps of a route with a kernel: rows are as the kernel has them.

    Attributes:
        route: The route.
    """

    route: Any

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of momenta and chart coordinates of the kernel, and of pose entries, which may be none."""
        momenta, charts, pose = self.route.sizes
        return momenta, charts, pose if self.with_poses or self.route.needs_pose else 0

    @property
    def in_threads(self) -> bool:  # type: ignore[override]
        """Whether `advance` releases the interpreter's lock."""
        return self.route.compiled_route is not None

    @property
    def block(self) -> int:  # type: ignore[override]
        """Steps of a block of a store, about a second."""
        return 1 << 23 if self.in_threads else 1 << 14

    def start(self, first: First) -> tuple[State, Outcome]:
        """Return the state at the first root."""
        reduced, pose = first.numbers
        getattr(self.route, "faults", {}).clear()  # of the run before
        momenta = self.route.encode(reduced)
        own_pose = self.route.encode_poses(pose) if pose.size else pose
        code, chart, kernel = self.route.start(momenta, own_pose)
        return np.concatenate((momenta, chart, own_pose, kernel)), OUTCOMES[code]

    def advance(self, state: State, steps: int, every: int, rows: Rows) -> tuple[int, int]:
        """Take steps with the state of the kernel."""
        width, begin = self.width, 0
        for column in rows:  # as `write_first` does, which stands in another room
            column[0], begin = state[begin : begin + column.shape[1]], begin + column.shape[1]
        good, code = self.route.advance(state[width:], steps, every, tuple([column[1:] for column in rows]))
        keep_row(state, rows, good // every)
        return good, code

    def decode(self, momenta: np.ndarray, charts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return momenta and charts of the kernel as canonical ones."""
        return self.route.decode(momenta), self.route.from_kernel(charts)

    def decode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return poses of the kernel as compact canonical ones."""
        return self.route.decode_poses(poses)


class AbstractCompiledRoute(abc.ABC):
    """A way to compute the steps of a discretization: a kernel, which has separate units and perhaps axes.

    A route sees a system, its displacement variety and a time step. Momenta, charts and poses that it takes and returns
    are canonical. Where there is no kernel the definition takes its place, in the same numbers.

    Attributes:
        system: The system.
        time_step: h.
        name: Its name in stores; a composition has that of what is composed.
        body: The body as the kernel knows it, a `kernels.AnyBody`; made once.
        scale: The factor to the momenta of the kernel.
    """

    system: System
    time_step: Array
    name: str
    body: Any
    scale: Array
    order: int = 2
    """Of the steps that it takes: 2, or that of a composition."""
    is_scalar: ClassVar[bool] = False
    """Whether it works with scalars, so that members of an ensemble can run side by side."""
    needs_pose: bool = True
    """Whether it carries a pose along even where none is kept."""
    part_needs_pose: ClassVar[bool] = False
    """Whether parts of its steps do."""

    @property
    def single(self) -> "AbstractCompiledRoute":
        """The route of a step of order 2 with the same time step: the route itself, if it is one."""
        return self

    @functools.cached_property
    def axes(self) -> "Axes":
        """The change from the canonical axes to those of the kernel; none unless a route has its own."""
        return Axes(self.system.group, None, None)

    def encode(self, momenta: np.ndarray) -> np.ndarray:
        """Return the momenta of the kernel from canonical ones."""
        return self.scale * self.axes.momenta(momenta)

    def decode(self, momenta: np.ndarray) -> np.ndarray:
        """Return canonical momenta from those of the kernel."""
        return self.axes.canonical_momenta(momenta / self.scale)

    def to_kernel(self, charts: np.ndarray) -> np.ndarray:
        """Return the chart coordinates of the kernel from canonical ones."""
        return self.axes.charts(charts)

    def from_kernel(self, charts: np.ndarray) -> np.ndarray:
        """Return canonical chart coordinates from those of the kernel."""
        return self.axes.canonical_charts(charts)

    def encode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return the poses of the kernel from compact canonical ones: by default matrices, row by row."""
        group = self.system.group
        return group.matrix_from_pose(poses).reshape(*poses.shape[:-1], group.size**2)

    def decode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return compact canonical poses from those of the kernel."""
        group = self.system.group
        return group.pose_from_matrix(poses.reshape(*poses.shape[:-1], group.size, group.size))

    @property
    def compiled_route(self) -> "AbstractCompiledRoute | None":
        """The route itself if its runs are compiled; None if there is only the definition."""
        return self

    @functools.cached_property
    def runs(self) -> Any:
        """The functions of the kernel, `kernels.runs_of`."""
        return kernels.runs_of(self.body)

    def body_from(self, step: int) -> Any:
        """Return the body of a run that begins at a step."""
        del step  # a free body is the same at all times
        return self.body

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of momenta, chart coordinates and pose entries of the kernel."""
        return self.runs.sizes(self.body)

    def start(self, momenta: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray, np.ndarray]:
        """Return the outcome of the first root, its chart and the state of a run, in numbers of the kernel."""
        code, state = self.runs.start(self.body, np.array(momenta), np.array(pose))
        return code, self.runs.chart_of(self.body, state), state

    def advance(self, state: np.ndarray, steps: int, every: int, rows: Compact) -> tuple[int, int]:
        """Take up to `steps` steps into rows of the kernel; return how many were good and the outcome."""
        return self.runs.advance(self.body, state, steps, every, rows)

    @functools.cached_property
    def _no_kick(self) -> kernels.ForcedBody:
        """The body with no half impulse, whose state is one step ahead of its rows."""
        n = self.sizes[0]
        nothing = kernels.Kick(np.zeros((0, 0)), np.zeros(0), np.zeros((n, 0)), np.zeros((1, n)))
        return kernels.ForcedBody(self.body, nothing)

    def set_out(self, momenta: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray, np.ndarray]:
        """Return the outcome of the first root, its chart, and a state one step ahead, where momenta may be pushed.

        In front it has momenta, their compensation and the pose.
        """
        body = self._no_kick
        code, state = kernels.runs_of(body).start(body, momenta, pose)
        return code, kernels.runs_of(body).chart_of(body, state), state

    def follow(self, state: np.ndarray) -> tuple[int, np.ndarray]:
        """Take the step from a state that is one ahead, in place; return the outcome and the chart of the step."""
        room, body = tuple(np.empty((1, size)) for size in self.sizes), self._no_kick
        _, code = kernels.runs_of(body).advance(body, state, 1, 1, room)
        return code, room[1][0]

    def step_each(self, states: Any, guesses: np.ndarray, *, principal_only: bool) -> Compact:
        """Take one step from each of the kernel's momenta, charts and poses; return momenta, charts and outcomes."""
        return kernels.step_each(self.single.body, states, guesses, principal_only)

    def first_root(self, momenta: np.ndarray) -> tuple[Outcome, np.ndarray]:
        """Return the outcome of the principal root over canonical momenta, and its canonical chart coordinates."""
        one = self.single
        code, chart, _ = one.start(one.encode(momenta), one.encode_poses(self.system.frame_pose))
        return Outcome(code), one.from_kernel(chart)

    def stepper(self, motion: Any, *, with_poses: bool, branch: str = "principal") -> AbstractBodyStepper:
        """Return what takes the steps of a discretization, and saves poses or not: the kernel."""
        del branch
        return CompiledStepper(motion, with_poses, self)

    def next_charts(self, states: Orbit) -> Float[np.ndarray, "K m"]:
        """Return the displacements that follow, one step of order 2 from each state."""
        charts = self.to_kernel(states.canonical_chart)
        rows = (self.encode(states.reduced_momentum), charts, matrices_of(states))
        _, following, codes = self.step_each(rows, charts, principal_only=True)
        if codes.any():
            raise OutcomeError(Outcome(int(codes.max())), "Step after a saved state")
        return self.from_kernel(following)

    def whole_steps(self, momenta: Float[np.ndarray, "K k"], g: Float[np.ndarray, "K N N"]) -> Compact:
        """Take one step from each row of momenta and poses of the user's frame; return both after it, and the outcomes.

        Rows that cannot continue are NaN.
        """
        group, frame = self.system.group, self.system.frame
        poses = self.encode_poses(group.pose_from_matrix(g @ frame))
        after, places, codes = self.parts_of_steps(self.encode(momenta), poses)
        after, places = (np.where((codes == Outcome.successful)[:, None], rows, np.nan) for rows in (after, places))
        ahead = group.matrix_from_pose(self.decode_poses(places)) @ group.inverse(frame)
        return self.decode(after), ahead, codes

    def parts(self, states: Orbit, fractions: Float[np.ndarray, "K"]) -> Compact:
        """Return momenta, charts and poses after fractions of the steps from states; NaN where none starts.

        They are taken one by one, with the numbers of the kernel. So the bits of each do not depend on the others.
        """
        poses = poses_of(states, is_needed=self.needs_pose or self.part_needs_pose)
        poses = self.encode_poses(poses) if poses.size else poses
        rows = self.encode(states.reduced_momentum), poses, states.time, states.step.tolist(), fractions
        nowhere = tuple(np.full(size, np.nan) for size in (*self.sizes[:2], poses.shape[1]))
        ends = (self._part(*row) or nowhere for row in zip(*rows, strict=True))
        momenta, charts, places = (np.array(column) for column in zip(*ends, strict=True))
        return self.decode(momenta), self.from_kernel(charts), self.decode_poses(places) if places.size else places

    def _part(self, m: np.ndarray, pose: np.ndarray, time: float, step: int, fraction: float) -> Compact | None:
        """Return the kernel's momenta, chart and pose after a fraction of a step; None where there is no such step."""
        del time, step  # a free step is the same at all times
        (after,), (place,), (code,) = self.parts_of_steps(m[None], pose[None], fraction)
        return self.ahead(after, place) if code == 0 else None

    def ahead(self, m: np.ndarray, pose: np.ndarray, m_half: np.ndarray | None = None) -> Compact:
        """Return the kernel's momenta, the chart of the step from them, or from pushed ones, and the pose."""
        code, chart, _ = self.start(m if m_half is None else m_half, pose)
        return m, chart if code == 0 else np.full(len(chart), np.nan), pose

    def parts_of_steps(self, momenta: np.ndarray, poses: np.ndarray, fraction: float = 1.0) -> Compact:
        """Take a fraction of a step from each of the kernel's momenta and poses; return both, and the outcomes."""
        parts = kernels.ComposedBody(self.single.body, fraction * weights(self.order))
        return kernels.whole_steps(parts, momenta, poses)


def poses_of(states: Orbit, *, is_needed: bool) -> np.ndarray:
    """Return the compact poses of states; where they are not kept, any that the step can carry along, if it needs one.

    So it must not depend on which.
    """
    if states.canonical_pose is not None:
        return states.canonical_pose
    if not is_needed:
        return np.empty((len(states), 0))
    return np.broadcast_to(states.system.frame_pose, (len(states), states.system.group.pose_size))


def plain(array: Any) -> np.ndarray:
    """Return a writable copy row by row: every other layout would be compiled for itself."""
    return np.array(array, dtype=np.float64, order="C")


def matrices_of(states: Orbit) -> Float[np.ndarray, "K size"] | None:
    """Return poses as rows of matrix entries where the step depends on them, for right-invariant constraints."""
    g = states.system.constraint_poses(states)
    return None if g is None else g.reshape(len(states), states.system.group.size**2).copy()  # kernels write to none


@dataclasses.dataclass(frozen=True, eq=False)
class Axes:
    """A change of the body frame and of the rows along the constraint; nothing is computed where there is none.

    Attributes:
        group: The group.
        frame: The axes of the kernel as seen from the canonical frame; None where they are the same.
        rows: C with m = C r for canonical momenta r, and y_canonical = y C for charts; None where rows are the same.
    """

    group: AbstractMatrixGroup
    frame: Float[np.ndarray, "... N N"] | None
    rows: Float[np.ndarray, "... k k"] | None

    def at(self, members: Any) -> "Axes":
        """Return the axes of some members, by slice or numbers, where they differ: with an axis of members in front."""
        frame, rows = (x if x is None or x.ndim == 2 else x[members] for x in (self.frame, self.rows))
        return self if frame is self.frame and rows is self.rows else Axes(self.group, frame, rows)

    def beside(self, more: int) -> "Axes":
        """Return the axes for numbers of members that have more axes behind that of members."""
        return self.at((slice(None), *(None,) * more))

    def momenta(self, canonical: np.ndarray) -> np.ndarray:
        """Return momenta along the kernel's rows."""
        return canonical if self.rows is None else applied(self.rows, canonical)

    def canonical_momenta(self, momenta: np.ndarray) -> np.ndarray:
        """Return momenta along the canonical rows."""
        return momenta if self.rows is None else applied(self.inverse, momenta)

    def charts(self, canonical: np.ndarray) -> np.ndarray:
        """Return charts along the kernel's rows."""
        return canonical if self.rows is None else applied(self.inverse.swapaxes(-1, -2), canonical)

    def canonical_charts(self, charts: np.ndarray) -> np.ndarray:
        """Return charts along the canonical rows."""
        return charts if self.rows is None else applied(self.rows.swapaxes(-1, -2), charts)

    def poses(self, canonical: np.ndarray) -> np.ndarray:
        """Return compact poses of the kernel's axes."""
        return canonical if self.frame is None else self.group.pose_product(canonical, self.turns[0])

    def canonical_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return compact poses of the canonical axes."""
        return poses if self.frame is None else self.group.pose_product(poses, self.turns[1])

    @functools.cached_property
    def turns(self) -> tuple[np.ndarray, np.ndarray]:
        """The frame and its inverse as compact poses."""
        frame = np.asarray(self.frame)
        return self.group.pose_from_matrix(frame), self.group.pose_from_matrix(self.group.inverse(frame))

    @functools.cached_property
    def inverse(self) -> np.ndarray:
        """The inverse of C."""
        return np.linalg.inv(np.asarray(self.rows))


def reversal_defects(route: AbstractCompiledRoute, states: Orbit) -> Float[np.ndarray, "K"]:
    """Return, for each state, the relative miss of one step forward and one back.

    Infinite where the step back cannot be computed, NaN where there is no step forward.
    """
    if route.order > 2:  # back from the opposite momentum
        r = states.reduced_momentum
        after, there, ahead = route.whole_steps(r, step_poses(states))
        good = ahead == Outcome.successful
        back, _, behind = route.whole_steps(-after[good], there[good])
        distances = np.full(len(r), np.nan)
        far = _largest(back + r[good]) / _largest(r[good])
        distances[good] = np.where(behind == Outcome.successful, far, np.inf)
        return distances
    # back to the inverse displacement by the nearest value of the map: its principal value is not always the way back
    r, cayley = route.encode(states.reduced_momentum), route.to_kernel(states.canonical_chart)
    poses = matrices_of(states)
    momenta, charts, ahead = route.step_each((r, cayley, poses), cayley, principal_only=True)
    if poses is None:
        after, _, _ = route.step_each((momenta, charts, None), charts, principal_only=False)
        returning = (-after, -charts, None)
    else:  # from two steps after each state a right-invariant constraint is run back
        U, V = states.motion.displaced(states.canonical_chart), states.motion.displaced(charts)
        returning = (-momenta, -charts, np.ascontiguousarray((V @ U @ states.configuration).reshape(poses.shape)))
    back, charts_back, behind = route.step_each(returning, -cayley, principal_only=False)
    gaps = _largest(back + momenta) / _largest(momenta)
    distances = np.maximum(_largest(charts_back + cayley) / _largest(cayley), gaps)
    return np.where(ahead != 0, np.nan, np.where(behind != 0, np.inf, distances))


def _largest(rows: np.ndarray) -> np.ndarray:
    return functools.reduce(np.maximum, np.abs(rows).T, np.zeros(len(rows)))
