"""The search of a stretch of states for crossings: changes of sign first, then where between two states they are."""

import dataclasses
import functools
import operator
from collections.abc import Callable, Iterable
from typing import Any, cast

import numpy as np

from nonholo.base.types import Bool, Float, Int
from nonholo.orbit import AbstractOrbit, Crossings, EventLog, joined_crossings
from nonholo.simulation._event import Event, Impact, values_at

Part = Callable[[Any, Float[np.ndarray, "K"]], Any]
"""Gives what is reached from states after fractions of the steps that begin there."""

Events = dict[str, Event]
_PIECE, _NUMBERS = 1 << 14, 1 << 20  # at most in a stretch that is searched at once: states, numbers in an array
_ROUNDING = 2.0**-54  # of a step, beside its end
_TOUCH = 5e-324  # the value of an event at a wall, with the sign of the side where the body is


@dataclasses.dataclass(frozen=True, eq=False)
class Watch:
    """The state of the search of a motion, stretch by stretch.

    Attributes:
        events: The events, by name.
        part: Gives the states after parts of steps.
        begin: Gives states with the displacements of steps that begin there; of a flow the states.
        parts: Crossings of every event in each stretch so far that has some, and in the first one.
        counts: How many there are of every event.
        values: Values of the events at the last state, (E, 1); None before the first stretch.
        heading: The heading at the last state, in the plane.
        stopped_by: The name of the event that ended the motion.
        reset_by: The name of the event whose impact is the last thing that was seen.
        sliding: Walls along which the body slides in the next stretch, whose gaps are rounding there.
    """

    events: dict[str, Event]
    part: Part
    begin: Callable[[Any], Any] = lambda states: states
    parts: tuple[tuple[Crossings, ...], ...] = ()
    counts: tuple[int, ...] = ()
    values: Float[np.ndarray, "E 1"] | None = None
    heading: float | None = None
    stopped_by: str | None = None
    reset_by: str | None = None
    sliding: Bool[np.ndarray, "E 1"] | bool = False

    @property
    def left(self) -> list[float]:
        """The number of further crossings of every event that ends the motion, or breaks it; infinite if none does."""
        counts = self.counts or (0,) * len(self.events)
        pairs = zip(self.events.values(), counts, strict=True)
        return [1.0 if event.reset is not None else event.last - count for event, count in pairs]

    @property
    def is_at_wall(self) -> bool:
        """Whether the last state is at a wall."""
        return bool(self.at_walls.any())

    @property
    def impacts(self) -> list[Any]:
        """The states after impacts, in their order."""
        return [each.after for part in self.parts for each in part if each.after is not None and len(each)]

    @property
    def impact(self) -> Crossings:
        """The impact that is the last thing that was seen."""
        return self.parts[-1][tuple(self.events).index(self.reset_by or "")].chosen(slice(-1, None))

    @property
    def cut(self) -> int:
        """The number of the step that this impact cuts; one at the end of a step cuts that one."""
        return int(self.impact.step[0] - (self.impact.fraction[0] == 0))

    def after_stretch(self, crossings: tuple[Crossings, ...]) -> "Watch":
        """Return what is known after another stretch, but for what is known of its last state."""
        counts = tuple(map(operator.add, self.counts or (0,) * len(crossings), map(len, crossings)))
        parts = (*self.parts, crossings) if not self.parts or any(map(len, crossings)) else self.parts
        return dataclasses.replace(self, parts=parts, counts=counts, reset_by=None)

    def after_impact(self, name: str, before: Float[np.ndarray, "E 1"]) -> "Watch":
        """Return what is known at the impact of an event that was seen last, from values before it."""
        watch = dataclasses.replace(self, reset_by=name, values=before)
        return watch.seen_at(watch.impact.after, np.array([[each == name] for each in self.events]))

    def seen_at(self, there: Any, is_struck: Bool[np.ndarray, "E 1"] | bool = False) -> "Watch":
        """Return what is known at a state so near to the last one that no side of a wall was left."""
        values = self.values_there(there)
        stays = is_struck | self.is_beyond(values) | self.slides_at(there)
        values = np.where(stays, _TOUCH * np.sign(self.values), values)  # type: ignore[arg-type]
        heading = None if there.turned is None else there.turned[-1]
        return dataclasses.replace(self, values=values, heading=heading, sliding=False)

    def values_there(self, states: Any) -> Float[np.ndarray, "E K"]:
        """Return the values of all events at states; along a wall the one before."""
        values = values_of(self.events, states)
        return values if self.values is None else np.where(self.sliding, self.values, values)

    @property
    def walls(self) -> Bool[np.ndarray, "E 1"]:
        """The events that are walls."""
        return np.array([event.reset is not None for event in self.events.values()], dtype=bool)[:, None]

    @property
    def at_walls(self) -> Bool[np.ndarray, "E 1"]:
        """The walls at which the last state is."""
        return self.walls & (abs(cast(Any, self.values)) == _TOUCH)

    def slides_at(self, there: Any) -> Bool[np.ndarray, "E 1"]:
        """Return the walls at which the last state is, and whose gaps do not change at a state."""
        pairs = zip(self.events, self.at_walls[:, 0], strict=True)
        return np.array([[bool(at) and self.rate_toward(name, there) == 0] for name, at in pairs])

    def is_beyond(self, values: Float[np.ndarray, "E 1"]) -> Bool[np.ndarray, "E 1"]:
        """Return the events whose values mean that the body is beyond a wall, or at one, before which it was last."""
        rows = np.hstack([cast(Any, self.values), values])
        return self.walls & [changes(event, row) for event, row in zip(self.events.values(), rows, strict=True)]

    def rate_toward(self, name: str, there: Any) -> float:
        """Return the rate at which a gap shrinks at a state; zero if it is rounding."""
        reset, gap = self._wall(name)
        side = np.sign(cast(Any, self.values)[tuple(self.events).index(name), 0])
        return float(-side * there.rate_along(reset.covector(gap, there)))

    def restitution(self, name: str) -> float:
        """Return the restitution of a wall."""
        return self._wall(name)[0].restitution

    def lowest_bounce(self, name: str, there: Any) -> float:
        """Return the height in the gap of a wall from which on a bounce at a state is one."""
        reset, gap = self._wall(name)
        return reset.lowest_bounce(gap, there)

    def struck(self, name: str, states: Any, direction: Int[np.ndarray, "1"]) -> Any:
        """Return the state after the impact of an event at a state; None where the motion is not toward the wall."""
        reset, gap = self._wall(name)
        after = reset.struck(f"Event(reset=...) of {name!r}", gap, states, int(direction[0]))
        return None if after is None else self.begin(after)

    def _wall(self, name: str) -> tuple[Impact, Callable[[Any], Float[np.ndarray, "K"]]]:
        """Return the impact of an event, and the function of states that gives its gap."""
        return cast(Impact, self.events[name].reset), functools.partial(values_at, name, self.events[name])

    def log(self) -> EventLog:
        """Return what has been found."""
        crossings = tuple(joined_crossings(column) for column in zip(*self.parts, strict=True))
        return EventLog(tuple(self.events), crossings, self.stopped_by)


def search(watch: Watch, stretch: AbstractOrbit) -> tuple[Watch, int]:
    """Search a stretch of consecutive states, which begins with the last one that was seen.

    Returns:
        What is known now, and how many states of the stretch belong to the motion: all, unless an event ended it.
    """
    stretch = stretch.with_headings(watch.heading)
    values = watch.values_there(stretch)
    if watch.values is not None:  # those of a state that was seen before stay what they were
        values[:, :1] = watch.values
    else:  # at a wall with a direction a body is on the side that leads through it
        sides = [-event.direction * (event.reset is not None) for event in watch.events.values()]
        values[:, :1] += _TOUCH * np.reshape(sides, (-1, 1)) * (values[:, :1] == 0)
    owner, left = np.zeros(len(stretch), dtype=int), np.array([watch.left]).T
    places, stopper, end = find_crossings(watch.events, stretch, values, owner, left, watch.part)
    first = int(stopper[0])
    count = len(stretch) if first < 0 else 1 + int(end[0] - stretch.step[0])
    each = enumerate(zip(values, places, strict=True))
    crossings = tuple(_crossings_of(watch, first, position, stretch, row, at) for position, (row, at) in each)
    last = values[:, count - 1 : count] if count else None
    heading = None if stretch.turned is None else float(stretch.turned[count - 1])
    new_watch = dataclasses.replace(watch.after_stretch(crossings), values=last, heading=heading)
    if first < 0:
        return new_watch, count
    name, event = tuple(watch.events.items())[first]
    if event.reset is None or new_watch.counts[first] >= event.last:
        return dataclasses.replace(new_watch, stopped_by=name), count
    hit = crossings[first]
    before = hit.step[-1] - (hit.fraction[-1] == 0) - stretch.step[0]  # at a wall a gap says nothing of sides
    return new_watch.after_impact(name, values[:, before : before + 1]), count


def _crossings_of(watch: Watch, first: int, position: int, stretch: Any, row: np.ndarray, at: np.ndarray) -> Crossings:
    """Return the crossings of one event, with the states after its impacts; of two walls at a moment the first acts."""
    name, event = tuple(watch.events.items())[position]
    if event.reset is not None and position != first:
        at = at[:0]
    crossings = locate(name, event, stretch, row, at, watch.part)
    if event.reset is None:
        return crossings
    after = watch.struck(name, crossings.states, crossings.direction) if len(crossings) else None
    return dataclasses.replace(crossings, after=crossings.states if after is None else after)


def values_of(events: Events, states: AbstractOrbit) -> Float[np.ndarray, "E K"]:
    """Return the values of all events, a row for each, at states."""
    values = [values_at(name, event, states) if len(states) else np.empty(0) for name, event in events.items()]
    return np.array(values).reshape(len(events), len(states))


def find_crossings(
    events: Events, states: AbstractOrbit, values: np.ndarray, owner: Int[np.ndarray, "K"], left: np.ndarray, part: Part
) -> tuple[list[Int[np.ndarray, "C"]], Int[np.ndarray, "M"], Int[np.ndarray, "M"]]:
    """Find where motions cross, none of it after a crossing that ends one.

    Args:
        events: The events, by name.
        states: Consecutive states of one motion after another.
        values: Values of the events there.
        owner: The motion of each state.
        left: The number of further crossings of every event that ends a motion; infinite if none does.
        part: Gives the states after parts of steps.

    Returns:
        For every event the states before its crossings; of each motion the position of the event that ends it, -1 where
        none does, and the step with which it ends.
    """
    is_same, count = owner[1:] == owner[:-1], left.shape[1]
    at = [np.flatnonzero(changes(event, row) & is_same) for event, row in zip(events.values(), values, strict=True)]
    ending = [x[_rank(owner[x]) == most[owner[x]] - 1] for x, most in zip(at, left, strict=True)]
    places = at, np.full(count, -1), np.zeros(count, dtype=int)
    return _cut_ends(events, states, values, owner, places, ending, part) if any(map(len, ending)) else places


def _rank(owner: Int[np.ndarray, "C"]) -> Int[np.ndarray, "C"]:
    """Return how many crossings the same motion has before each."""
    return np.arange(len(owner)) - np.searchsorted(owner, owner)


def _cut_ends(
    events: Events, states: Any, values: np.ndarray, owner: np.ndarray, places: Any, ending: Any, part: Part
) -> Any:
    """Leave out crossings after those that end a motion, by where they are in its last step."""
    each_at, stopper, end = places
    limit, moment = np.full(len(end), len(owner)), np.full(len(end), np.inf)
    for at in ending:
        np.minimum.at(limit, owner[at], at)
    early = [at[at <= limit[owner[at]]] for at in each_at]
    within = [at[at == limit[owner[at]]] for at in early]
    each = zip(events.items(), values, within, strict=True)
    crossings = [locate(name, event, states, row, at, part) for (name, event), row, at in each]
    moments = [each.step - states.step[at] + each.fraction for each, at in zip(crossings, within, strict=True)]
    for event, (at, past) in enumerate(zip(within, moments, strict=True)):
        ends = np.isin(at, ending[event]) & (past < moment[owner[at]])
        who = owner[at[ends]]
        moment[who], stopper[who], end[who] = past[ends], event, crossings[event].step[ends]
    late = [at[past > moment[owner[at]]] for at, past in zip(within, moments, strict=True)]
    return [np.setdiff1d(at, out) for at, out in zip(early, late, strict=True)], stopper, end


def changes(event: Event, values: Float[np.ndarray, "... K"]) -> Bool[np.ndarray, "... L"]:
    """Return for each state but the last whether the motion crosses in the step from there."""
    sign = np.sign(values)
    before, after = sign[..., :-1], sign[..., 1:]
    crosses = (before != 0) & (after != before)
    return crosses & (event.direction * (after - before) >= 0)


def locate(
    name: str, event: Event, stretch: AbstractOrbit, values: np.ndarray, at: Int[np.ndarray, "C"], part: Part
) -> Crossings:
    """Return the crossings in the steps from given states of a stretch; a zero at a state is that state."""
    exact = values[at + 1] == 0
    inside = at[~exact]
    fraction, step = np.zeros(len(at)), stretch.step[at] + exact
    base = stretch.chosen(inside)
    fraction[~exact] = _roots(name, event, base, (values[inside], values[inside + 1]), part)
    states = stretch.chosen(at[exact] + 1).joined([part(base, fraction[~exact])])
    order = np.argsort(np.concatenate([at[exact], inside]))
    direction = np.sign(values[at + 1] - values[at]).astype(np.int64)
    return Crossings(step, fraction, direction, states.chosen(order))


def _roots(name: str, event: Event, base: Any, ends: tuple[np.ndarray, np.ndarray], part: Part) -> np.ndarray:
    """Return the fractions of steps at which an event is zero, between ends where its signs differ.

    Chandrupatla's bracketing method, for all of them at once, to the last bits.
    """
    begin, end = ends

    def value(fraction: np.ndarray, which: np.ndarray) -> np.ndarray:
        at = which.astype(int)
        values = np.where(fraction == 0, begin[at], end[at])
        inner = (fraction > 0) & (fraction < 1)
        values[inner] = values_at(name, event, part(base.chosen(at[inner]), fraction[inner])) if inner.any() else 0.0
        return values

    if not len(base):
        return np.empty(0)
    from scipy.optimize import elementwise  # loads slowly

    count = np.arange(len(base), dtype=np.float64)
    whole = np.zeros(len(base)), np.ones(len(base))
    roots = elementwise.find_root(value, whole, args=(count,), tolerances={"xatol": _ROUNDING})
    return np.maximum(roots.x, _ROUNDING)


def piece_of(widths: Iterable[int]) -> int:
    """Return the number of states, with arrays of these widths, that are searched at once."""
    return max(1, min(_PIECE, _NUMBERS // max(1, *widths)))
