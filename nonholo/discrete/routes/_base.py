"""The interface of every route, and what compiled ones share: units and axes of a kernel, runs, single steps."""

import abc
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from nonholo import kernels
from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Array, Float
from nonholo.discrete._composition import weights
from nonholo.discrete.routes._stepper import AbstractBodyStepper, CompiledStepper
from nonholo.orbit import Orbit
from nonholo.systems import System

Rows = tuple[np.ndarray, np.ndarray, np.ndarray]


class AbstractRoute(abc.ABC):
    """A way to compute the steps of a discretization.

    A route sees a system, its displacement variety and a time step. Momenta, charts and poses that it takes and returns
    are canonical.
    """

    order: int
    """Of the steps that it takes: 2, or that of a composition."""
    is_scalar: ClassVar[bool]
    """Whether it works with scalars, so that members of an ensemble can run side by side."""
    needs_pose: bool
    """Whether it carries a pose along even where none is kept."""

    @property
    @abc.abstractmethod
    def name(self) -> str:
        """Its name in stores; a composition has that of what is composed."""

    @property
    @abc.abstractmethod
    def compiled(self) -> "AbstractCompiledRoute | None":
        """The route itself if its runs are compiled; None if there is only the definition."""

    @abc.abstractmethod
    def stepper(self, motion: Any, *, posed: bool, branch: str = "principal") -> AbstractBodyStepper:
        """Return what takes the steps of a discretization, and saves poses or not."""

    @abc.abstractmethod
    def next_charts(self, states: Orbit) -> Float[np.ndarray, "K m"]:
        """Return the displacements that follow, one step of order 2 from each state."""

    @abc.abstractmethod
    def whole_steps(self, momenta: Float[np.ndarray, "K k"], g: Float[np.ndarray, "K N N"]) -> Rows:
        """Take one step from each row of momenta and poses of the user's frame; return both after it, and the outcomes.

        Rows that cannot continue are NaN.
        """

    @abc.abstractmethod
    def parts(self, states: Orbit, fractions: Float[np.ndarray, "K"]) -> Rows:
        """Return momenta, charts and poses after fractions of the steps from states; NaN where none starts."""


class AbstractCompiledRoute(AbstractRoute):
    """A route with a compiled kernel, which has units and perhaps axes of its own.

    Attributes:
        system: What moves.
        time_step: h.
    """

    system: System
    time_step: Array

    @property
    @abc.abstractmethod
    def body(self) -> Any:
        """The body as the kernel knows it, a `kernels.AnyBody`; made once."""

    @property
    @abc.abstractmethod
    def scale(self) -> Array:
        """The factor to the momenta of the kernel."""

    @property
    @abc.abstractmethod
    def single(self) -> "AbstractCompiledRoute":
        """The route of a step of order 2 with the same time step."""

    @abc.abstractmethod
    def encode(self, momenta: np.ndarray) -> np.ndarray:
        """Return the momenta of the kernel from canonical ones."""

    @abc.abstractmethod
    def decode(self, momenta: np.ndarray) -> np.ndarray:
        """Return canonical momenta from those of the kernel."""

    @abc.abstractmethod
    def to_kernel(self, charts: np.ndarray) -> np.ndarray:
        """Return the chart coordinates of the kernel from canonical ones."""

    @abc.abstractmethod
    def from_kernel(self, charts: np.ndarray) -> np.ndarray:
        """Return canonical chart coordinates from those of the kernel."""

    @abc.abstractmethod
    def encode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return the poses of the kernel from compact canonical ones."""

    @abc.abstractmethod
    def decode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return compact canonical poses from those of the kernel."""

    @property
    def compiled(self) -> "AbstractCompiledRoute":
        """The route itself."""
        return self

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of momenta, chart coordinates and pose entries of the kernel."""
        return kernels.sizes(self.body)

    def start(self, momenta: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray]:
        """Return the outcome of the first root, and the state of a run, from the kernel's momenta and pose."""
        return kernels.start(self.body, momenta, pose)

    def chart_of(self, state: np.ndarray) -> np.ndarray:
        """Return the kernel's chart coordinates of the displacement in the state of a run."""
        return kernels.chart_of(self.body, state)

    def advance(self, state: np.ndarray, steps: int, every: int, rows: Rows) -> tuple[int, int]:
        """Take up to `steps` steps into rows of the kernel; return how many were good and the outcome."""
        return kernels.advance(self.body, state, steps, every, rows)

    def step_each(
        self, states: tuple[np.ndarray, np.ndarray, np.ndarray | None], guesses: np.ndarray, *, principal_only: bool
    ) -> Rows:
        """Take one step from each of the kernel's momenta, charts and poses; return momenta, charts and outcomes."""
        return kernels.step_each(self.single.body, states, guesses, principal_only)

    def first_root(self, momenta: np.ndarray) -> tuple[Outcome, np.ndarray]:
        """Return the outcome of the principal root over canonical momenta, and its canonical chart coordinates."""
        one = self.single
        code, state = one.start(one.encode(momenta), one.encode_poses(self.system.frame_pose))
        return Outcome(code), one.from_kernel(one.chart_of(state))

    def stepper(self, motion: Any, *, posed: bool, branch: str = "principal") -> CompiledStepper:
        """Return what takes the steps with the kernel, to the principal value."""
        del branch
        return CompiledStepper(motion, self, posed)

    def next_charts(self, states: Orbit) -> Float[np.ndarray, "K m"]:
        """Return the displacements that follow, one step of order 2 from each state."""
        charts = self.to_kernel(states.canonical_chart)
        rows = (self.encode(states.reduced_momentum), charts, matrices_of(states))
        _, following, codes = self.step_each(rows, charts, principal_only=True)
        if codes.any():
            raise OutcomeError(Outcome(int(codes.max())), "Step after a saved state")
        return self.from_kernel(following)

    def whole_steps(self, momenta: Float[np.ndarray, "K k"], g: Float[np.ndarray, "K N N"]) -> Rows:
        """Take one step from each row of momenta and poses; return both after it, and the outcomes."""
        group, frame = self.system.group, self.system.frame
        poses = self.encode_poses(group.pose_from_matrix(g @ frame))
        after, moved, codes = self.parts_of_steps(self.encode(momenta), poses)
        after, moved = (np.where((codes == Outcome.successful)[:, None], rows, np.nan) for rows in (after, moved))
        ahead = group.matrix_from_pose(self.decode_poses(moved)) @ group.inverse(frame)
        return self.decode(after), ahead, codes

    def parts(self, states: Orbit, fractions: Float[np.ndarray, "K"]) -> Rows:
        """Return momenta, charts and poses after fractions of the steps from states; NaN where none starts."""
        return parts_by(self, self._part, posed(states, needed=self.needs_pose), states, fractions)

    def _part(self, m: np.ndarray, pose: np.ndarray, time: float, step: int, fraction: float) -> Rows | None:
        """Return the kernel's momenta, chart and pose after a fraction of a step; None where there is no such step."""
        del time, step  # a free step is the same at all times
        (after,), (moved,), (code,) = self.parts_of_steps(m[None], pose[None], fraction)
        return self.ahead(after, moved) if code == 0 else None

    def ahead(self, m: np.ndarray, pose: np.ndarray, pushed: np.ndarray | None = None) -> Rows:
        """Return the kernel's momenta, the chart of the step from them, or from pushed ones, and the pose."""
        code, state = self.start(m if pushed is None else pushed, pose)
        chart = self.chart_of(state)
        return m, chart if code == 0 else np.full(len(chart), np.nan), pose

    def parts_of_steps(self, momenta: np.ndarray, poses: np.ndarray, fraction: float = 1.0) -> Rows:
        """Take a fraction of a step from each of the kernel's momenta and poses; return both, and the outcomes."""
        parts = kernels.ComposedBody(self.single.body, fraction * weights(self.order))
        return kernels.whole_steps(parts, momenta, poses)


def parts_by(
    route: AbstractCompiledRoute,
    part: Callable[[np.ndarray, np.ndarray, float, int, float], Rows | None],
    poses: np.ndarray,
    states: Orbit,
    fractions: Float[np.ndarray, "K"],
) -> Rows:
    """Return canonical momenta, charts and poses after parts of steps, taken one by one with the numbers of a kernel.

    So the bits of each do not depend on the others.
    """
    poses = route.encode_poses(poses) if poses.size else poses
    given = route.encode(states.reduced_momentum), poses, states.time, states.step.tolist(), fractions
    nowhere = tuple(np.full(size, np.nan) for size in (*route.sizes[:2], poses.shape[1]))
    found = (part(*row) or nowhere for row in zip(*given, strict=True))
    momenta, charts, moved = (np.array(column) for column in zip(*found, strict=True))
    return route.decode(momenta), route.from_kernel(charts), route.decode_poses(moved) if moved.size else moved


def posed(states: Orbit, *, needed: bool) -> np.ndarray:
    """Return the compact poses of states; where they are not kept, any that the step can carry along, if it needs one.

    So it must not depend on which.
    """
    if states.canonical_pose is not None:
        return states.canonical_pose
    if not needed:
        return np.empty((len(states), 0))
    return np.broadcast_to(states.system.frame_pose, (len(states), states.system.group.pose_size))


def matrices_of(states: Orbit) -> Float[np.ndarray, "K size"] | None:
    """Return poses as rows of matrix entries where the step depends on them, for right-invariant constraints."""
    if not states.system.is_spatial:
        return None
    return states.configuration.reshape(len(states), states.system.group.size**2).copy()  # kernels write to none
