r"""Branch rules: which of the values of the discrete map a run takes, and its steps. One class a rule.

The values themselves come from `_values`, following one of them from `_equations`. Compiled and traced runs of
"principal" and "nearest" solve their steps where they are; all others ask `following`, in NumPy, on the sphere over the
displacement variety, where nothing is special at angle $\pi$.
"""

import abc
import dataclasses
import itertools
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, NamedTuple, TypeAlias

import numpy as np

from nonholo import kernels
from nonholo.base.calls import call
from nonholo.base.checks import choice, error, is_integer, shown
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.discrete._discretization import Discretization
from nonholo.discrete._scheme import legendre
from nonholo.discrete.branching import _values
from nonholo.discrete.branching._equations import Equations, Frame, follow, frame_of, has_frame, nearest_body
from nonholo.discrete.branching._roots import Root, distance
from nonholo.discrete.routes import AbstractBodyStepper
from nonholo.orbit import First, Rows, State, keep_row, write_first

Chooser: TypeAlias = Callable[[_values.Branches, np.ndarray], int | None]
BranchRule: TypeAlias = str | Chooser
_REGIONS = ("inner", "outer")
_TIED = 1e-9  # relative difference of two norms that rounding may have made


class Kick(NamedTuple):
    """A step of which all is known but its new displacement.

    Attributes:
        frame: The frame of the branches of the discretized system.
        point: The point over the present displacement.
        now: The equations that it solves.
        ahead: Those that the new one has to solve.
        momentum: The new canonical momentum along the constraint subspace.
        zeros: The roots over it, where they are known.
    """

    frame: Frame
    point: Float[np.ndarray, "m"]
    now: Equations
    ahead: Equations
    momentum: Float[np.ndarray, "k"]
    zeros: Sequence[Root] = ()


Following: TypeAlias = tuple[Outcome, Float[np.ndarray, "m"]]


class AbstractBranchRule(abc.ABC):
    """Which value of the map a step takes.

    Attributes:
        name: Its name in an orbit.
        is_principal: Whether it is the principal value, which has compiled runs, parts of steps and events.
        is_nearest: Whether it follows the present value, for which there is a kernel. All others choose among all
            values, which has to be done outside of a JAX transformation.
    """

    name: str
    is_principal: ClassVar[bool] = False
    is_nearest: ClassVar[bool] = False

    def check(self, where: str, discrete: Discretization) -> None:
        """Refuse a discretization that does not have the rule: by default one of whose values not all are known.

        Every discretization has the principal value, every left-invariant constraint the nearest one.
        """
        rule = shown(getattr(self, "function", self.name))
        if discrete.system.is_spatial and not self.is_principal:
            changing = "a right-invariant constraint, whose equations change with the pose from step to step"
            raise error(where, "be 'principal'", f"{rule} for {changing}", "Leave it out.")
        if not (self.is_principal or self.is_nearest or has_frame(discrete)):
            got = f"{rule} for {type(discrete.system).__name__}, of whose values not all are known"
            remedy = "All are known of a SuslovTop, ChaplyginSleigh or MultidimensionalSleigh with difference 'matrix'."
            raise error(where, "be 'principal' or 'nearest'", got, remedy)

    def check_start(self, where: str, discrete: Discretization, displacement: Float[np.ndarray, "N N"]) -> None:
        """Refuse a start that the rule cannot continue from; by default there is none."""
        del where, discrete, displacement

    def following(self, kick: Kick) -> Following:
        """Return the outcome and the point over the new displacement: the one value that is chosen, or why none is."""
        _, zeros, X = _values.roots_over(kick.frame, kick.ahead)
        values = _values.branches_of(kick.frame, kick.momentum, (kick.ahead, zeros, X))
        choices = self.choices(kick._replace(zeros=zeros), values)
        if not choices:
            return Outcome.no_real_branch, kick.point
        if len(choices) > 1 or values.multiplicity[choices[0]] > 1:
            return Outcome.branch_unverified, kick.point
        return Outcome.successful, zeros[choices[0]].point.real

    def choices(self, kick: Kick, values: _values.Branches) -> list[int]:
        """Return the numbers of the values that may be chosen; rules that follow one value do not ask."""
        raise NotImplementedError


@dataclasses.dataclass(frozen=True)
class Principal(AbstractBranchRule):
    """The root that momentum zero reaches along a ray."""

    name: str = "principal"
    is_principal: ClassVar[bool] = True

    def following(self, kick: Kick) -> Following:
        """Return the verified principal root."""
        return principal_point(kick.frame, kick.momentum)


@dataclasses.dataclass(frozen=True)
class Nearest(AbstractBranchRule):
    """The root that the present displacement reaches while the momentum moves along a segment."""

    name: str = "nearest"
    is_nearest: ClassVar[bool] = True

    def following(self, kick: Kick) -> Following:
        """Follow the present point."""
        return follow(kick.now, kick.ahead, kick.point)


@dataclasses.dataclass(frozen=True)
class Extreme(AbstractBranchRule):
    """The real value whose full momentum is smallest (sign 1) or largest (-1), in the body's unit of length."""

    name: str
    sign: int

    def choices(self, kick: Kick, values: _values.Branches) -> list[int]:
        """Choose by the norm; a tie is not decided."""
        real = np.flatnonzero(values.is_real)
        norms = self.sign * _values.momentum_sizes(kick.frame, values.momentum[real])
        return real[norms <= norms.min(initial=np.inf) + _TIED * np.abs(norms).max(initial=0.0)].tolist()


@dataclasses.dataclass(frozen=True)
class Region(AbstractBranchRule):
    """The value in one part of the invariant curve of a top; the nearest where there are several."""

    name: str

    def check(self, where: str, discrete: Discretization) -> None:
        """Refuse systems whose invariant curves have no parts."""
        super().check(where, discrete)
        if _values.regular_landscape(discrete) is None:
            kind = type(discrete.system).__name__
            got = f"{self.name!r} for {kind}, whose invariant curves have no inner and outer part"
            remedy = "Pass 'nearest'. Only a SuslovTop with n = 3 and det B > 2|c|^2 has regions."
            raise error(where, "be a rule without regions", got, remedy)

    def check_start(self, where: str, discrete: Discretization, displacement: Float[np.ndarray, "N N"]) -> None:
        """Refuse a start whose energy level is connected."""
        if _values.regions(discrete, displacement[None])[0] not in _REGIONS:
            high = "an energy from the saddle's on, where both parts of the invariant curve are connected"
            remedy = "Pass 'nearest', or start slower (`critical_energies` has the saddle's energy)."
            raise error(where, "have a start in the inner or the outer region", f"{self.name!r} and {high}", remedy)

    def choices(self, kick: Kick, values: _values.Branches) -> list[int]:
        """Choose by the region, then by continuation."""
        inside = np.flatnonzero(values.is_real & (values.region == self.name)).tolist()
        if len(inside) > 1:
            code, end = follow(kick.now, kick.ahead, kick.point)
            distances = [distance(kick.now, end, root.point) for root in kick.zeros]
            best = int(np.argmin(distances))
            if code == 0 and distances[best] <= _values.SAME and best in inside:
                return [best]
        return inside


@dataclasses.dataclass(frozen=True)
class Chosen(AbstractBranchRule):
    """The value that a function of the user chooses."""

    function: Chooser
    name: str = "callable"

    def choices(self, kick: Kick, values: _values.Branches) -> list[int]:
        """Ask the function, and refuse an answer that is no real value."""
        index = call("branch(branches, present)", self.function, values, displacement_at(kick.frame, kick.point))
        if index is None:
            return []
        if not is_integer(index) or not 0 <= index < len(values) or not values.is_real[index]:
            remedy = "Choose among np.flatnonzero(branches.is_real), or return None."
            raise error("branch(branches, present)", "return the index of a real branch or None", shown(index), remedy)
        return [int(index)]


PRINCIPAL = Principal()
_RULES = (PRINCIPAL, Nearest(), Extreme("smallest", 1), Extreme("largest", -1), *map(Region, _REGIONS))
_BY_NAME: dict[str, AbstractBranchRule] = {rule.name: rule for rule in _RULES}


def branch_rule(owner: str, branch: BranchRule) -> AbstractBranchRule:
    """Return the rule that a user names or gives as a function."""
    if callable(branch):
        return Chosen(branch)
    remedy = "Choose one of them, or pass a function of the branches and the present displacement."
    return _BY_NAME[choice(f"{owner}(branch=...)", branch, tuple(_BY_NAME), remedy)]


def checked_rule(owner: str, discrete: Discretization, branch: BranchRule) -> AbstractBranchRule:
    """Return a branch rule that a discretization has, or refuse it with the reason."""
    rule = branch_rule(owner, branch)
    rule.check(f"{owner}(branch=...)", discrete)
    return rule


def principal_point(frame: Frame, canonical: Float[np.ndarray, "k"]) -> Following:
    """Return the outcome and the point over the verified principal displacement of a canonical momentum."""
    code, X = _values.principal_increment(frame.discrete, canonical)
    return code, np.empty(0) if code != 0 else frame.point(X + frame.discrete.system.group.identity)


def displacement_at(frame: Frame, x: np.ndarray) -> Float[np.ndarray, "N N"]:
    """Return the displacement over a point, in the user's frame."""
    system = frame.discrete.system
    return system.from_canonical_frame(frame.increment(x)) + system.group.identity


class Place(NamedTuple):
    """A state: the point over the displacement, and the canonical momentum along the constraint subspace."""

    point: Float[np.ndarray, "m"]
    momentum: Float[np.ndarray, "k"]


def first_place(
    owner: str, frame: Frame, rule: AbstractBranchRule, canonical: np.ndarray, demand: Any
) -> tuple[Outcome, Place | None]:
    """Return the state of a start: of a displacement, of a full momentum, or else the principal one."""
    discrete = frame.discrete
    if demand is None:
        code, point = principal_point(frame, canonical)
        if code != 0:
            return code, None
        place = Place(point, canonical)
    else:
        W = demand if demand.ndim == 2 else _values.inverse_discrete_legendre(discrete, demand)
        k, x = len(frame.stiffness), frame.point(discrete.system.to_canonical_frame(W))
        rows = frame.equations(np.zeros(discrete.system.rank)).residual(x)[0]
        place = Place(x, frame.momentum(rows[:k], rows[k]) / discrete.time_step)
    rule.check_start(f"{owner}(branch=...)", discrete, displacement_at(frame, place.point))
    return Outcome.successful, place


def next_place(frame: Frame, rule: AbstractBranchRule, place: Place) -> tuple[Outcome, Place]:
    """Return the outcome and the state that follows by a rule; the present one where none follows."""
    h = frame.discrete.time_step
    now = frame.equations(h * place.momentum)
    momentum = place.momentum + frame.momentum(*now.kick(place.point)) / h
    code, x = rule.following(Kick(frame, place.point, now, frame.equations(h * momentum), momentum))
    return code, Place(x, momentum) if code == 0 else place


def step_by_rule(discrete: Discretization, rule: AbstractBranchRule, momentum: np.ndarray) -> tuple[np.ndarray, ...]:
    """Take a step from a state that need not be on the principal branch; return what `step` returns."""
    system = discrete.system
    frame = frame_of("step(discrete=...)", discrete)
    full = momentum if momentum.shape != (len(system.constraint_subspace),) else None
    canonical = system.to_canonical(momentum if full is None else system.restrict(full))
    code, place = first_place("step", frame, rule, canonical, full)
    after, W = np.full(system.group.dim, np.nan), np.full_like(system.group.identity, np.nan)
    multipliers = np.full(len(system.annihilator), np.nan)
    if place is not None:
        code, following = next_place(frame, rule, place)
        if code == 0:
            now, W = (displacement_at(frame, x.point) for x in (place, following))
            after = legendre(discrete, W - system.group.identity, "left")
            arriving = legendre(discrete, now - system.group.identity, "right")
            multipliers = (after - arriving) @ np.linalg.pinv(system.annihilator)
    return after, W, multipliers, np.asarray(int(code))


def goal_of(frame: Frame, momentum: Float[np.ndarray, "k"]) -> Float[np.ndarray, "g"]:
    """Return what the kernel of clear steps makes of a canonical momentum."""
    now = frame.equations(float(frame.discrete.time_step) * momentum)
    return now.target if now.lever is None else np.append(now.target, now.push)


_BATCH = 256  # steps to the nearest value between two poses that are freed of their rounding errors


@dataclasses.dataclass(frozen=True, eq=False)
class RuleStepper(AbstractBodyStepper):
    """Rows are canonical; its own numbers are those of `_Now`.

    Attributes:
        rule: Which value of the map a step takes.
    """

    rule: AbstractBranchRule

    @property
    def branch(self) -> str:  # type: ignore[override]
        """The name of the rule."""
        return self.rule.name

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of canonical momenta, chart coordinates and pose entries."""
        system = self.motion.system
        return system.rank, system.rank, system.group.pose_size

    def start(self, first: First) -> tuple[State, Outcome]:
        """Return the state of the first displacement, which may be demanded."""
        (reduced, pose), frame = first.numbers, frame_of("simulate", self.motion)
        code, place = first_place("simulate", frame, self.rule, reduced, first.demand)
        if place is None:
            return np.concatenate((reduced, np.full_like(reduced, np.nan), pose)), code
        g = self.motion.system.group.matrix_from_pose(pose)
        now = _Now(place, goal_of(frame, place.momentum), place.momentum, g, 0)
        return np.concatenate((place.momentum, frame.chart(place.point), pose, now.vector)), code

    def advance(self, state: State, steps: int, every: int, rows: Rows) -> tuple[int, int]:
        """Take steps by the rule, and carry the pose along."""
        write_first(state, rows)
        frame, group = frame_of("simulate", self.motion), self.motion.system.group
        good, code, often = 0, Outcome.successful, _BATCH if self.rule.is_nearest else 1
        now = self._now(frame, state)
        while code == 0 and good < steps:
            code, ahead, goal = self._following(frame, now, min(steps - good, often - now.step % often))
            if not (count := len(ahead.point)):
                break
            points = np.concatenate([now.place.point[None], ahead.point])
            W = frame.increment(points[:-1]) + group.identity
            matrices = np.array([*itertools.accumulate(W, np.matmul, initial=now.g)][1:])
            poses = group.normalize_pose(group.pose_from_matrix(matrices))
            at = good + 1 + np.arange(count)
            marks = np.flatnonzero(at % every == 0)
            for column, new in zip(rows, (ahead.momentum, frame.chart(ahead.point), poses), strict=True):
                column[at[marks] // every] = new[marks]
            good, step, place = good + count, now.step + count, Place(points[-1], ahead.momentum[-1])
            begin = now.begin
            if goal is None or step % often == 0:
                goal, begin = goal_of(frame, place.momentum), place.momentum
            g = matrices[-1] if step % often else group.matrix_from_pose(poses[-1])
            now = _Now(place, goal, begin, g, step)
        state[self.width :] = now.vector
        keep_row(state, rows, good // every)
        return good, int(code)

    def _following(self, frame: Frame, now: "_Now", most: int) -> tuple[Outcome, Place, np.ndarray | None]:
        """Return up to `most` states that follow as rows, and the goal of the last one if the kernel found them.

        The kernel takes the clear steps to the nearest value, `next_place` all others, one at a time. Momenta are
        summed from the one at which the goals began, so that they do not depend on how steps are cut.
        """
        if self.rule.is_nearest:
            h, k, (point, _) = float(self.motion.time_step), len(frame.stiffness), now.place
            first, body = goal_of(frame, now.begin), nearest_body(frame.equations(h * now.begin))
            goals, points = np.empty((most, len(now.goal))), np.empty((most, len(point)))
            if steps := kernels.advance_to_nearest(body, now.goal, point, goals, points):
                change = goals[:steps] - first
                momenta = now.begin + frame.momentum(change[:, :k], change[:, -1]) / h
                return Outcome.successful, Place(points[:steps], momenta), goals[steps - 1]
        code, following = next_place(frame, self.rule, now.place)
        return code, Place(*(x[None][: int(code == 0)] for x in following)), None

    def _now(self, frame: Frame, state: State) -> "_Now":
        """Return the numbers of a state."""
        k, size = self.motion.system.rank, self.motion.system.group.size
        own, goal = state[self.width :], len(goal_of(frame, state[:k]))
        ends = np.cumsum([len(own) - goal - k - size**2 - 1, goal, k, size**2])
        point, goals, begin, g, (step,) = np.split(own, ends)
        place = Place(point.copy(), state[:k].copy())
        return _Now(place, goals.copy(), begin.copy(), g.reshape(size, size).copy(), int(step))


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
