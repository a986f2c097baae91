"""Steps of tops and sleighs by a branch rule other than the principal one, in NumPy."""

import dataclasses
import functools
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.results import Outcome
from nonholo.discrete.branching._equations import Frame, frame_of
from nonholo.discrete.branching._rules import AbstractBranchRule
from nonholo.discrete.branching._steps import Place, clear_places, first_place, goal_of, next_place
from nonholo.discrete.routes import AbstractBodyStepper, Compact
from nonholo.orbit import First, Rows, State, keep_row, write_first

_BATCH = 256  # steps to the nearest value between two poses that are freed of their rounding errors


@dataclasses.dataclass(frozen=True, eq=False)
class RuleStepper(AbstractBodyStepper):
    """Rows are canonical; its own numbers are those of `_Now`.

    Attributes:
        motion: The discretization.
        rule: Which value of the map a step takes.
        posed: Whether poses are saved.
    """

    motion: Any
    rule: AbstractBranchRule
    posed: bool
    in_threads = False

    @property
    def branch(self) -> str:  # type: ignore[override]
        """The name of the rule."""
        return self.rule.name

    @functools.cached_property
    def columns(self) -> dict[str, int]:  # type: ignore[override]
        """The names and sizes of what a row holds."""
        k = self.motion.system.rank
        return {"reduced_momentum": k, "cayley": k, "canonical_pose": self.motion.system.group.pose_size}

    @property
    def _frame(self) -> Frame:
        return frame_of("simulate(discrete=...)", self.motion)

    def start(self, first: First) -> tuple[State, Outcome]:
        """Return the state of the first displacement, which may be demanded."""
        (reduced, pose), frame, group = first.numbers, self._frame, self.motion.system.group
        code, place = first_place("simulate", self.motion, frame, self.rule, reduced, first.demanded)
        if place is None:
            return np.concatenate((reduced, np.full_like(reduced, np.nan), pose)), code
        now = _Now(place, *self._begun(frame, place.momentum), group.matrix_from_pose(pose), 0)
        return np.concatenate((place.momentum, frame.chart(place.point), pose, now.vector)), code

    def advance(self, state: State, steps: int, every: int, rows: Rows) -> tuple[int, int]:
        """Take steps by the rule, and carry the pose along."""
        write_first(state, rows)
        frame, group, done, code = self._frame, self.motion.system.group, 0, Outcome.successful
        width, often = self.width, _BATCH if self.rule.is_nearest else 1
        now = self._now(frame, state)
        while code == 0 and done < steps:
            code, ahead, goal = self._following(frame, now, min(steps - done, often - now.step % often))
            if not (count := len(ahead.point)):
                break
            points = np.concatenate([now.place.point[None], ahead.point])
            matrices = _carried(now.g, frame.increment(points[:-1]) + group.identity)
            poses = group.normalize_pose(group.pose_from_matrix(matrices))
            at = done + 1 + np.arange(count)
            saved = np.flatnonzero(at % every == 0)
            for column, new in zip(rows, (ahead.momentum, frame.chart(ahead.point), poses), strict=True):
                column[at[saved] // every] = new[saved]
            done, step, place = done + count, now.step + count, Place(points[-1], ahead.momentum[-1])
            begin = now.begin
            if goal is None or step % often == 0:
                goal, begin = self._begun(frame, place.momentum)
            g = matrices[-1] if step % often else group.matrix_from_pose(poses[-1])
            now = _Now(place, goal, begin, g, step)
        state[width:] = now.vector
        keep_row(state, rows, done // every)
        return done, int(code)

    def _following(self, frame: Frame, now: "_Now", most: int) -> tuple[Outcome, Place, np.ndarray | None]:
        """Return states that follow as rows, and the goal of the last one if the kernel found them.

        The kernel takes the clear steps to the nearest value, `next_place` all others, one at a time.
        """
        if self.rule.is_nearest:
            ahead, goals = clear_places(self.motion, frame, now.begin, now.goal, now.place.point, most)
            if len(goals):
                return Outcome.successful, ahead, goals[-1]
        code, following = next_place(self.motion, frame, self.rule, now.place)
        rows = slice(0, int(code == 0))
        return code, Place(following.point[None][rows], following.momentum[None][rows]), None

    def _begun(self, frame: Frame, momentum: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the goal and the momentum at which clear steps begin to be summed."""
        return goal_of(self.motion, frame, momentum), momentum

    def _now(self, frame: Frame, state: State) -> "_Now":
        """Return the numbers of a state."""
        k, size = self.motion.system.rank, self.motion.system.group.size
        own, goal = state[self.width :], len(self._begun(frame, state[:k])[0])
        point, goals, begin, g, (step,) = np.split(
            own, np.cumsum([len(own) - goal - k - size**2 - 1, goal, k, size**2])
        )
        place = Place(point.copy(), state[:k].copy())
        return _Now(place, goals.copy(), begin.copy(), g.reshape(size, size).copy(), int(step))

    def decode(self, rows: Rows) -> Compact:
        """Return the rows, which are canonical."""
        momenta, charts, poses = rows
        return momenta, charts, poses


class _Now(NamedTuple):
    """The state between two steps: its place, the sums of clear steps, the pose as carried along, and the step."""

    place: Place
    goal: np.ndarray
    begin: np.ndarray
    g: np.ndarray
    step: int

    @property
    def vector(self) -> np.ndarray:
        """Its numbers behind the row."""
        return np.concatenate((self.place.point, self.goal, self.begin, self.g.ravel(), [self.step]))


def _carried(g: np.ndarray, displacements: np.ndarray) -> np.ndarray:
    """Return the matrices of poses after displacements, one after another."""
    matrices = np.empty_like(displacements)
    for step, W in enumerate(displacements):
        g = matrices[step] = g @ W
    return matrices
