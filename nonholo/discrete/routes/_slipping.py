r"""The route of rows that may yield: at each step the step of the whole constraint, or one without these rows.

With the displacement W of the step that holds, and $\pi$ the momenta of the slip, the rows need the impulse
$\lambda = V(P(W) - \mathrm{Ad}^*_WP(W)) - hVf - \pi$ in total. They hold if $|\lambda| \le h\mu + \tfrac h2c|v|$ at
each contact. Otherwise some contacts slide with equal half impulses $\tfrac12j$, $-j \in h\mu\,\partial|x| + cx$ at the
slip x of the step, and the others hold by any impulse that is not beyond their bound.

Reference: docs/theory/forces.md, Theorem 18.4.
"""

import dataclasses
import functools
from operator import attrgetter
from typing import Any, ClassVar, NamedTuple, cast

import numpy as np

from nonholo.base.numerics import applied
from nonholo.base.results import OUTCOMES, Outcome
from nonholo.base.types import Bool, Float
from nonholo.discrete._scheme import Variety, variety_of
from nonholo.discrete.routes._base import AbstractBodyStepper, AbstractCompiledRoute, Compact, poses_of
from nonholo.discrete.routes._forced import AbstractForcedRoute, BalancedRoute, When
from nonholo.orbit import First, Orbit, Rows, State, configurations, keep_row, write_first
from nonholo.systems.forces import Widened, friction, update_slope

_MOST = 40  # corrections of a direction
_ROUNDING, _SETTLED = 1e-15, 1e-12  # relative, of an impulse; where it does not fall any more
_SEEN = 1e-8  # relative, of what changes a slope
_STRETCH = 512  # steps that hold, taken at once


Here = tuple[np.ndarray, np.ndarray]
"""Canonical momenta and a pose."""


class Beginning(NamedTuple):
    """How a step begins.

    Attributes:
        code: The outcome.
        chart: The canonical chart of its displacement.
        kernel: The state of a run whose rows hold; None of one that slides.
        after: Canonical momenta and pose after a step that slides.
        impulse: The impulse j of its friction.
        slip: Its slip x.
        rests: Which contacts hold in it.
    """

    code: int
    chart: np.ndarray
    kernel: np.ndarray | None = None
    after: tuple[np.ndarray, np.ndarray] | None = None
    impulse: Any = None
    slip: Any = None
    rests: Any = None


@dataclasses.dataclass(frozen=True, eq=False)
class SlipRoute(AbstractForcedRoute):
    """Steps that hold or slide; momenta, charts and poses are canonical ones of the body without the rows.

    Attributes:
        free: The route of steps that slide, but for the friction of the grip.
        hold: The route of steps that hold; its name is that of both.
        holding: The discretization of these.
    """

    free: BalancedRoute  # type: ignore[override]
    hold: AbstractCompiledRoute
    holding: Any
    needs_pose: ClassVar[bool] = True  # type: ignore[override]
    compiled_route: ClassVar[None] = None  # type: ignore[override]

    name = property(attrgetter("hold.name"))

    @functools.cached_property
    def body(self) -> Widened:
        """The body without the rows."""
        return cast(Widened, self.forced.free)

    @functools.cached_property
    def variety(self) -> Variety:
        """The variety of steps that slide."""
        return variety_of(self.body, "skew")

    @functools.cached_property
    def _wide(self) -> np.ndarray:
        """Charts without the rows from those with them."""
        charts = self.holding.variety.chart @ np.linalg.pinv(self.variety.chart)
        return np.where(np.abs(charts) < 1e-15, 0.0, charts)

    def stepper(self, motion: Any, *, with_poses: bool, branch: str = "principal") -> "SlipStepper":
        """Return what takes the steps."""
        del branch
        return SlipStepper(motion, with_poses, self)

    def wide(self, charts: np.ndarray) -> np.ndarray:
        """Return canonical charts of steps that hold as those of the body without the rows."""
        return self.hold.from_kernel(charts) @ self._wide

    def reaction(self, charts: np.ndarray, poses: np.ndarray, steps: np.ndarray) -> Float[np.ndarray, "K s"]:
        """Return the impulses that the rows need over steps that hold, from no slip."""
        holding, forced, h = self.holding, self.holding.forces, float(self.holding.time_step)
        decoder, charts = holding.displacement_decoder, self.hold.from_kernel(charts)
        jump = decoder.momentum(charts, "left") - decoder.momentum(charts, "right")
        if forced is not None:
            g, W = configurations(holding.system, self.hold.decode_poses(poses)), holding.displaced(charts)
            jump = jump - h * forced.mean_force(g, W, h, forced.rows(steps), steps * h)
        return applied(self.body.duals, jump)

    def grips(self, moving: Float[np.ndarray, "s"]) -> Float[np.ndarray, "contacts"]:
        """Return the largest impulses by which contacts hold: by the grip, and the viscous friction of what ends."""
        h = float(self.holding.time_step)
        each = self.forced.contacts.each
        return np.array([h * one.grip + h / 2 * one.viscous * np.linalg.norm(moving[at]) for at, one in each])

    def begin(self, r: np.ndarray, pose: np.ndarray, time: float, step: int) -> Beginning:
        """Begin the step from canonical momenta and a pose."""
        k = self.hold.sizes[0]
        own_pose = self.hold.encode_poses(pose)
        code, kernel = self.hold.runs.start(self.hold.body_from(step), self.hold.encode(r[:k]), own_pose)
        chart = self.hold.runs.chart_of(self.hold.body, kernel)
        if code != 0:
            return Beginning(code, self.wide(chart))
        impulses = self.reaction(chart[None], own_pose[None], np.array([step])) - r[k:]
        most = self.grips(np.linalg.solve(self.body.slip_inertia, r[k:]))
        if (self.forced.contacts.sizes(impulses) <= most).all():
            return Beginning(0, self.wide(chart), kernel)
        return self._yield((r, pose), (time, step, 1.0), impulses[0], most)

    def _yield(self, now: Here, when: When, impulses: np.ndarray, most: np.ndarray) -> Beginning:
        """Begin a step in which not every contact holds; those that do are at rest where impulses act on M alone."""
        (r, pose), half, s = now, float(self.holding.time_step) / 2, len(impulses)
        laws = [(at, size, half * one.viscous) for size, (at, one) in zip(most, self.forced.contacts.each, strict=True)]
        rests = ~self.forced.contacts.sizes(friction(self.body.slip_inertia, -impulses, laws)[0][None])[0].astype(bool)
        while True:
            start = np.append(r[:-s], self.forced.contacts.stop(r[-s:], rests))
            turning = impulses - (2 * start[-s:] - r[-s:])
            beginning = self.slide((start, pose), when, rests, turning, np.zeros_like(turning))
            if beginning.code != 0:
                return beginning
            yields = rests & (self.forced.contacts.sizes((beginning.impulse + start[-s:] - r[-s:])[None])[0] > most)
            if not yields.any():
                return beginning
            rests = rests & ~yields

    def slide(
        self, now: Here, when: When, rests: Bool[np.ndarray, "contacts"], impulse: np.ndarray, slip: Any = None
    ) -> Beginning:
        """Slide for a fraction of a step, from an impulse along the rows and the slip that it leaves, known or not.

        The friction of a slip x is the root of a model, $j = j_n + A(x - x_n)$, whose slope is corrected. Contacts that
        hold have no slip, by any impulse.
        """
        part, before = when[2] * float(self.holding.time_step), np.inf
        grips = np.where(rests, np.inf, [part * float(one.grip) for _, one in self.forced.contacts.each])
        laws = [(at, most, one.viscous) for most, (at, one) in zip(grips, self.forced.contacts.each, strict=True)]
        slope, way, goal = 2 / part * self.body.slip_inertia, np.ones(len(impulse)), impulse
        if slip is not None:
            way, goal = friction(slope, slope @ slip - impulse, laws)
        for _ in range(_MOST):
            beginning = self._push(now, when, goal)._replace(rests=rests)
            if beginning.code != 0:
                return beginning
            size = np.linalg.norm(goal) + np.linalg.norm(slope) * np.linalg.norm(beginning.chart)
            if slip is not None:
                slope = update_slope(slope, beginning.slip - slip, goal - impulse, _SEEN * float(size))
            impulse, slip = goal, beginning.slip
            if way.any():  # or none of the step has a slip
                way, goal = friction(slope, slope @ slip - impulse, laws)
            gap = np.linalg.norm(goal - impulse)
            if gap <= _ROUNDING * np.linalg.norm(goal) or before / 2 < gap <= _SETTLED * size:
                self._rest(beginning.after[0], now[0], way)  # type: ignore[index]
                return beginning
            before = gap
        return beginning._replace(code=Outcome.not_converged)

    def _rest(self, after: np.ndarray, start: np.ndarray, way: np.ndarray) -> None:
        """Clear the momenta after a step of what rounding adds: where it has no slip, velocities turn over."""
        s, rests = len(way), ~self.forced.contacts.sizes(way[None])[0].astype(bool)
        later = self.forced.contacts.stop(start[-s:] + after[-s:], rests) - start[-s:]
        places = self.forced.contacts.places(rests)
        after[-s:][places] = later[places]

    def _push(self, now: Here, when: When, impulse: np.ndarray) -> Beginning:
        """Take a fraction of a step that slides under an impulse along the rows."""
        route, (r, pose), part = self.free, now, when[2] * float(self.holding.time_step)
        own_pose, k = route.encode_poses(pose), len(r)
        code, state = route.after(route.encode(r), own_pose, when, self.body.rows.T @ impulse / part)
        chart = route.from_kernel(route.runs.chart_of(route.body, state))
        if code != 0:
            return Beginning(code, chart)
        place = route.decode_poses(state[2 * k : 2 * k + len(own_pose)])
        return Beginning(0, chart, None, (route.decode(state[:k]), place), impulse, self.slips(chart[None])[0])

    def slips(self, charts: Float[np.ndarray, "K m"]) -> Float[np.ndarray, "K s"]:
        """Return the slips x of displacements, A (W - W^-1)/2."""
        X = (self.variety.increment(charts) - self.variety.increment(-charts)) / 2
        return applied(self.body.canonical.rows, self.body.group.vee(X))

    def parts(self, states: Orbit, fractions: Float[np.ndarray, "K"]) -> Compact:
        """Return momenta, charts and poses after fractions of the steps from states; NaN where none starts."""
        poses, rows = poses_of(states, is_needed=True), []
        for place, fraction in enumerate(fractions):
            one = states.chosen(slice(place, place + 1))
            after, end = self._part(one, poses[place], float(fraction))  # type: ignore[arg-type]
            time, chart = float(one.time[0] + fraction * self.holding.time_step), np.full(self.free.sizes[1], np.nan)
            if np.isfinite(after).all():
                ahead = self.begin(after, end, time, int(one.step[0]) + int(fraction))
                chart = ahead.chart if ahead.code == 0 else chart
            rows.append((after, chart, end))
        return cast(Compact, tuple(np.array(column) for column in zip(*rows, strict=True)))

    def _part(self, one: Orbit, pose: np.ndarray, fraction: float) -> Any:  # type: ignore[override]
        """Return momenta and pose after a fraction of one step, which is of the kind of the whole."""
        r, k, nothing = one.reduced_momentum[0], self.hold.sizes[0], np.full(len(one.reduced_momentum[0]), np.nan)
        when = float(one.time[0]), int(one.step[0])
        whole = self.begin(r, pose, *when)
        if whole.code != 0:
            return nothing, np.full_like(pose, np.nan)
        if whole.kernel is not None:
            still = dataclasses.replace(one, reduced_momentum=one.reduced_momentum[:, :k], canonical_pose=pose[None])
            momenta, _, ends = self.hold.parts(still, np.array([fraction]))
            return np.append(momenta[0], np.zeros(len(r) - k)), ends[0]
        if fraction == 1:
            return whole.after
        start = np.append(r[:k], self.forced.contacts.stop(r[k:], whole.rests)), pose
        beginning = self.slide(start, (*when, fraction), whole.rests, fraction * whole.impulse)
        return beginning.after if beginning.code == 0 else (nothing, np.full_like(pose, np.nan))


@dataclasses.dataclass(frozen=True, eq=False)
class SlipStepper(AbstractBodyStepper):
    """The steps of rows that may yield: rows are canonical; steps that hold are taken many at once.

    Behind its row a state has momenta, pose and number of the next step, the step at which a run of the kernel that
    holds began, -1 without one, and the state of that run.

    Attributes:
        route: The route.
    """

    route: SlipRoute

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of canonical momenta, chart coordinates and pose entries."""
        return *self.route.free.sizes[:2], self.route.body.group.pose_size

    def start(self, first: First) -> tuple[State, Outcome]:
        """Return the state at the first root."""
        r, pose = first.numbers
        pose = pose if pose.size else self.route.body.frame_pose
        hold = self.route.hold
        beginning = self.route.begin(r, pose, 0.0, 0)
        size = len(hold.start(hold.encode(0 * r[: hold.sizes[0]]), hold.encode_poses(pose))[2])
        state = np.zeros(self.width + len(r) + len(pose) + 2 + size)
        state[: self.width] = np.concatenate(self._row(r, pose, beginning))
        self._keep(state, beginning, 0)
        return state, OUTCOMES[beginning.code]

    def advance(self, state: State, steps: int, every: int, rows: Rows) -> tuple[int, int]:
        """Take steps, those that hold many at once."""
        write_first(state, rows)
        good, code, most = 0, 0, 1
        while good < steps and code == 0:
            states, code = self._stretch(state, min(most, steps - good))
            for column, entries in zip(rows, states, strict=True):
                first = -(good + 1) % every
                column[(good + 1 + first) // every :][: len(entries[first::every])] = entries[first::every]
            most = min(2 * most, _STRETCH) if len(states[0]) == most else 1
            good += len(states[0])
        keep_row(state, rows, good // every)
        return good, code

    def _stretch(self, state: State, most: int) -> tuple[Rows, int]:
        """Take steps that hold, or one from a new beginning; return their rows and the outcome."""
        r, pose, (number, since), _ = self._own(state)
        if since >= 0:
            return self._hold(state, most)
        beginning = self.route.begin(r.copy(), pose.copy(), number * float(self.motion.time_step), int(number))
        if beginning.code != 0:
            return tuple(np.empty((0, size)) for size in self.sizes), beginning.code
        row = self._row(r, pose, beginning)
        self._keep(state, beginning, int(number))
        return tuple(column[None] for column in row), 0

    def _hold(self, state: State, most: int) -> tuple[Rows, int]:
        """Take steps of the kernel that holds, up to one whose rows yield."""
        (r, pose, places, kernel), hold = self._own(state), self.route.hold
        number, since, run = int(places[0]), int(places[1]), kernel.copy()
        rows = tuple(np.empty((most, size)) for size in hold.sizes)
        good, code = hold.runs.advance(hold.body_from(since), run, most, 1, rows)
        m, charts, poses = (column[:good] for column in rows)
        impulses = self.route.reaction(charts, poses, number + np.arange(good))
        fits = self.route.forced.contacts.sizes(impulses) <= self.route.grips(np.zeros(impulses.shape[1]))
        ends = np.flatnonzero(~fits.all(axis=1))
        momenta = np.concatenate([hold.decode(m), np.zeros((good, len(r) - m.shape[1]))], axis=1)
        states = momenta, self.route.wide(charts), hold.decode_poses(poses)
        if len(ends):
            r[:], pose[:], places[:] = states[0][ends[0]], states[2][ends[0]], (number + ends[0], -1)
            return tuple(column[: ends[0]] for column in states), 0
        kernel[:], places[0] = run, number + good
        return states, code

    def _row(self, r: np.ndarray, pose: np.ndarray, beginning: Beginning) -> tuple[np.ndarray, ...]:
        """Return the row of a step; of one that holds as the kernel has it."""
        if beginning.kernel is None:
            return r.copy(), beginning.chart, pose.copy()
        hold, k = self.route.hold, self.route.hold.sizes[0]
        along = np.append(hold.decode(hold.encode(r[:k])), r[k:])
        return along, beginning.chart, hold.decode_poses(hold.encode_poses(pose))

    def _keep(self, state: State, beginning: Beginning, number: int) -> None:
        """Write what follows the step that begins with a number."""
        r, pose, places, kernel = self._own(state)
        places[:] = number + 1, -1 if beginning.kernel is None else number
        if beginning.kernel is not None:
            kernel[:] = beginning.kernel
        elif beginning.after is not None:
            r[:], pose[:] = beginning.after

    def _own(self, state: State) -> tuple[np.ndarray, ...]:
        """Return momenta and pose of the next step, its number and that at which the kernel began, and its state."""
        k, _, size = self.sizes
        own = state[self.width :]
        return own[:k], own[k : k + size], own[k + size :][:2], own[k + size + 2 :]
