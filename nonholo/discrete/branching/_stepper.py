r"""Steps of tops and sleighs by a branch rule other than the principal one, in NumPy.

Steps by a branch rule, on the sphere over the displacement variety: the start, the next state, one whole step.

For tops and sleighs. In its coordinates nothing is special at angle $\pi$.
"""

import dataclasses
import functools
from typing import Any, NamedTuple

import numpy as np

from nonholo import kernels
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.discrete._discretization import Discretization
from nonholo.discrete.branching._branches import inverse_discrete_legendre
from nonholo.discrete.branching._equations import Frame, frame_of, nearest_body
from nonholo.discrete.branching._rules import AbstractBranchRule, Kick, displacement_at, principal_point
from nonholo.discrete.routes import AbstractBodyStepper, Compact
from nonholo.orbit import First, Rows, State, keep_row, write_first


class Place(NamedTuple):
    """A state: the point over the displacement, and the canonical momentum along the constraint subspace."""

    point: Float[np.ndarray, "m"]
    momentum: Float[np.ndarray, "k"]


def first_place(
    owner: str,
    discrete: Discretization,
    frame: Frame,
    rule: AbstractBranchRule,
    canonical: Float[np.ndarray, "k"],
    demand: np.ndarray | None,
) -> tuple[Outcome, Place | None]:
    """Return the state of a start: of a displacement, of a full momentum, or else the principal one."""
    if demand is None:
        code, point = principal_point(discrete, frame, canonical)
        if code != 0:
            return code, None
        place = Place(point, canonical)
    else:
        W = demand if demand.ndim == 2 else inverse_discrete_legendre(discrete, demand)
        place = _place_of(discrete, frame, W)
    rule.check_start(f"{owner}(branch=...)", discrete, displacement_at(discrete, frame, place.point))
    return Outcome.successful, place


def _place_of(discrete: Discretization, frame: Frame, W: Float[np.ndarray, "N N"]) -> Place:
    """Return the state with a displacement of the variety."""
    system, k = discrete.system, len(frame.stiffness)
    x = frame.point(system.group.inverse(system.frame) @ W @ system.frame)
    rows = frame.equations(np.zeros(len(system.constraint_subspace))).residual(x)[0]
    return Place(x, frame.momentum(rows[:k], rows[k]) / discrete.time_step)


def next_place(discrete: Discretization, frame: Frame, rule: AbstractBranchRule, place: Place) -> tuple[Outcome, Place]:
    """Return the outcome and the state that follows by a rule; the present one where none follows."""
    h = discrete.time_step
    now = frame.equations(h * place.momentum)
    momentum = place.momentum + frame.momentum(*now.kick(place.point)) / h
    code, x = rule.following(Kick(discrete, frame, place.point, now, frame.equations(h * momentum), momentum))
    return code, Place(x, momentum) if code == 0 else place


def goal_of(discrete: Discretization, frame: Frame, momentum: Float[np.ndarray, "k"]) -> Float[np.ndarray, "g"]:
    """Return what the kernel of clear steps makes of a canonical momentum."""
    now = frame.equations(float(discrete.time_step) * momentum)
    return now.target if now.lever is None else np.append(now.target, now.push)


def clear_places(
    discrete: Discretization,
    frame: Frame,
    begin: Float[np.ndarray, "k"],
    goal: Float[np.ndarray, "g"],
    point: Float[np.ndarray, "m"],
    count: int,
) -> tuple[Place, Float[np.ndarray, "C g"]]:
    """Return the states that follow by clear steps to the nearest value, up to `count` of them, and their goals.

    Momenta are summed from the one at which the goals began, so that they do not depend on how steps are cut.
    """
    h, k = float(discrete.time_step), len(frame.stiffness)
    first, now = goal_of(discrete, frame, begin), frame.equations(h * begin)
    goals, points = np.empty((count, len(goal))), np.empty((count, len(point)))
    steps = kernels.advance_to_nearest(nearest_body(now), goal, point, goals, points)
    change = goals[:steps] - first
    return Place(points[:steps], begin + frame.momentum(change[:, :k], change[:, -1]) / h), goals[:steps]


_BATCH = 256  # steps to the nearest value between two poses that are freed of their rounding errors


@dataclasses.dataclass(frozen=True, eq=False)
class RuleStepper(AbstractBodyStepper):
    """Rows are canonical; its own numbers are those of `_Now`.

    Attributes:
        motion: The discretization.
        rule: Which value of the map a step takes.
        with_poses: Whether poses are saved.
    """

    motion: Any
    rule: AbstractBranchRule
    with_poses: bool
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
        code, place = first_place("simulate", self.motion, frame, self.rule, reduced, first.demand)
        if place is None:
            return np.concatenate((reduced, np.full_like(reduced, np.nan), pose)), code
        now = _Now(place, *self._origin(frame, place.momentum), group.matrix_from_pose(pose), 0)
        return np.concatenate((place.momentum, frame.chart(place.point), pose, now.vector)), code

    def advance(self, state: State, steps: int, every: int, rows: Rows) -> tuple[int, int]:
        """Take steps by the rule, and carry the pose along."""
        write_first(state, rows)
        frame, group, good, code = self._frame, self.motion.system.group, 0, Outcome.successful
        width, often = self.width, _BATCH if self.rule.is_nearest else 1
        now = self._now(frame, state)
        while code == 0 and good < steps:
            code, ahead, goal = self._following(frame, now, min(steps - good, often - now.step % often))
            if not (count := len(ahead.point)):
                break
            points = np.concatenate([now.place.point[None], ahead.point])
            matrices = _poses_after(now.g, frame.increment(points[:-1]) + group.identity)
            poses = group.normalize_pose(group.pose_from_matrix(matrices))
            at = good + 1 + np.arange(count)
            marks = np.flatnonzero(at % every == 0)
            for column, new in zip(rows, (ahead.momentum, frame.chart(ahead.point), poses), strict=True):
                column[at[marks] // every] = new[marks]
            good, step, place = good + count, now.step + count, Place(points[-1], ahead.momentum[-1])
            begin = now.begin
            if goal is None or step % often == 0:
                goal, begin = self._origin(frame, place.momentum)
            g = matrices[-1] if step % often else group.matrix_from_pose(poses[-1])
            now = _Now(place, goal, begin, g, step)
        state[width:] = now.vector
        keep_row(state, rows, good // every)
        return good, int(code)

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

    def _origin(self, frame: Frame, momentum: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the goal and the momentum at which clear steps begin to be summed."""
        return goal_of(self.motion, frame, momentum), momentum

    def _now(self, frame: Frame, state: State) -> "_Now":
        """Return the numbers of a state."""
        k, size = self.motion.system.rank, self.motion.system.group.size
        own, goal = state[self.width :], len(self._origin(frame, state[:k])[0])
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


def _poses_after(g: np.ndarray, displacements: np.ndarray) -> np.ndarray:
    """Return the matrices of poses after displacements, one after another."""
    matrices = np.empty_like(displacements)
    for step, W in enumerate(displacements):
        g = matrices[step] = g @ W
    return matrices
