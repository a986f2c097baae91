"""The search of a stretch of states for crossings: changes of sign first, then where between two states they are."""

import dataclasses
import functools
import itertools
import operator
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple, cast

import numpy as np

from nonholo.base.types import Bool, Float, Int
from nonholo.orbit import AbstractOrbit, Crossings, EventLog, joined_crossings
from nonholo.simulation._event import Event, Impact, has_resets, values_at

Part = Callable[[Any, Float[np.ndarray, "K"]], Any]
"""Gives what is reached from states after fractions of the steps that begin there."""

Events = dict[str, Event]
Values = Float[np.ndarray, "E K"]
"""Of each event, a row, at each state."""
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

    @property
    def left(self) -> list[float]:
        """The number of further crossings of every event that ends the motion, or breaks it; infinite if none does."""
        counts = self.counts or (0,) * len(self.events)
        left = [event.last - count for event, count in zip(self.events.values(), counts, strict=True)]
        return [rest if event.reset is None else 1.0 for event, rest in zip(self.events.values(), left, strict=True)]

    @property
    def has_walls(self) -> bool:
        """Whether an event has a reset."""
        return has_resets(self.events)

    @property
    def is_at_wall(self) -> bool:
        """Whether the last state is at a wall."""
        return self.has_walls and self.values is not None and bool(self.at_walls.any())

    @property
    def impacts(self) -> list[Any]:
        """The states after impacts, in their order."""
        hits = (crossings for part in self.parts for crossings in part if crossings.after is not None)
        return [crossings.after for crossings in hits if len(crossings)]

    @property
    def impact(self) -> Crossings:
        """The impact that is the last thing that was seen."""
        return self.parts[-1][tuple(self.events).index(self.reset_by or "")].chosen(slice(-1, None))

    def begun_at(self, last: int) -> tuple[Any, int, float]:
        """Return the state after the impact, the step that is cut, and how much of it is gone; `last` came before it.

        One at the end of a step cuts that one.
        """
        hit = self.impact
        exact = hit.fraction[0] == 0
        return hit.after, last - int(exact), 1.0 if exact else float(hit.fraction[0])

    def after_stretch(self, crossings: tuple[Crossings, ...]) -> "Watch":
        """Return what is known after another stretch, but for what is known of its last state."""
        counts = tuple(map(operator.add, self.counts or (0,) * len(crossings), map(len, crossings)))
        parts = (*self.parts, crossings) if not self.parts or any(map(len, crossings)) else self.parts
        return dataclasses.replace(self, parts=parts, counts=counts, reset_by=None)

    def after_impact(self, before: np.ndarray) -> "Watch":
        """Return what is known at the impact that was seen last, from values before it: nothing is beyond a wall."""
        hit, before = self.impact, np.array(before)
        wall = tuple(self.events).index(self.reset_by or "")
        before[wall] = -hit.direction
        watch = dataclasses.replace(self, values=before).seen_at(hit.after)
        cast(Any, watch.values)[wall] = -_TOUCH * hit.direction
        return watch

    def along(self, walls: Bool[np.ndarray, "E 1"]) -> "Watch":
        """Return the search in which gaps of walls, along which the body slides, are not looked at."""
        events = dict(self.events)
        for name in itertools.compress(events, walls[:, 0]):
            value = float(cast(Any, self.values)[tuple(events).index(name), 0])
            events[name] = dataclasses.replace(
                events[name], function=lambda states, value=value: np.full(len(states), value)
            )
        return dataclasses.replace(self, events=events)

    def seen_at(self, there: Any) -> "Watch":
        """Return what is known at a state so near to the last one that no side of a wall was left."""
        values = values_of(self.events, there)
        stays = self.is_beyond(values) | self.slides_at(there)
        values = np.where(stays, _TOUCH * np.sign(self.values), values)  # type: ignore[arg-type]
        return dataclasses.replace(self, values=values, heading=None if there.turned is None else there.turned[-1])

    @property
    def at_walls(self) -> Bool[np.ndarray, "E 1"]:
        """The walls at which the last state is."""
        walls = np.array([[event.reset is not None] for event in self.events.values()])
        return walls & (abs(cast(Any, self.values)) == _TOUCH)

    def slides_at(self, there: Any) -> Bool[np.ndarray, "E 1"]:
        """Return the walls at which the last state is, and whose gaps do not change at a state."""
        pairs = zip(self.events.items(), self.at_walls[:, 0], strict=True)
        return np.array([[bool(at) and rate_of(*item, there) == 0] for item, at in pairs])

    def is_beyond(self, values: Float[np.ndarray, "E 1"]) -> Bool[np.ndarray, "E 1"]:
        """Return the events whose values mean that the body is beyond a wall, or at one, before which it was last."""
        side = np.sign(self.values)  # type: ignore[call-overload]
        guards = [(event.reset is not None, event.direction) for event in self.events.values()]
        has_wall, direction = np.array(guards).T[:, :, None]
        return (has_wall != 0) & (direction * side <= 0) & (side != 0) & (np.sign(values) != side)

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
    values = values_of(watch.events, stretch)
    if watch.values is not None:  # those of a state that was seen before stay what they were
        values[:, :1] = watch.values
    else:
        values[:, :1] = _opening_values(watch.events, values[:, :1])
    owner, left = np.zeros(len(stretch), dtype=int), np.array([watch.left]).T
    places = find_crossings(watch.events, stretch, values, owner, left, watch.part)
    first, count = int(places.stopper[0]), len(stretch)
    if first >= 0:
        count = 1 + int(places.end[0] - stretch.step[0])
    crossings = tuple(
        _crossings_of(watch, first, position, stretch, row, at)
        for position, (row, at) in enumerate(zip(values, places.at, strict=True))
    )
    new_watch = watch.after_stretch(crossings)
    if len(stretch):
        new_watch = dataclasses.replace(new_watch, values=values[:, count - 1 : count])
    heading = float(stretch.turned[count - 1]) if stretch.turned is not None else None
    new_watch = dataclasses.replace(new_watch, heading=heading)
    if first < 0:
        return new_watch, count
    name, event = tuple(watch.events.items())[first]
    if event.reset is None or new_watch.counts[first] >= event.last:
        return dataclasses.replace(new_watch, stopped_by=name), count
    new_watch = dataclasses.replace(new_watch, reset_by=name)
    _, before, _ = new_watch.begun_at(count - 1)  # at a wall a gap says nothing of sides
    return new_watch.after_impact(values[:, before : before + 1]), count


def _crossings_of(watch: Watch, first: int, position: int, stretch: Any, row: np.ndarray, at: np.ndarray) -> Crossings:
    """Return the crossings of one event, with the states after its impacts; of two walls at a moment the first acts."""
    name, event = tuple(watch.events.items())[position]
    if event.reset is not None and position != first:
        at = at[:0]
    crossings = locate(name, event, stretch, row, at, watch.part)
    if event.reset is None:
        return crossings
    after = struck(watch, name, crossings.states, crossings.direction) if len(crossings) else None
    return dataclasses.replace(crossings, after=crossings.states if after is None else after)


def rate_of(name: str, event: Event, there: Any) -> float:
    """Return the rate of the gap of a wall at a state; zero if it is rounding."""
    return there.rate_along(cast(Impact, event.reset).covector(functools.partial(values_at, name, event), there))


def struck(watch: Watch, name: str, states: Any, direction: Int[np.ndarray, "1"]) -> Any:
    """Return the state after the impact of an event at a state; None where the motion is not toward the wall."""
    event, where = watch.events[name], f"Event(reset=...) of {name!r}"
    gap = functools.partial(values_at, name, event)
    after = cast(Impact, event.reset).struck(where, gap, states, int(direction[0]))
    return None if after is None else watch.begin(after)


def _opening_values(events: Events, values: Values) -> Values:
    """Return values at the first state: one at a wall with a direction is on the side that leads through it."""
    side = [[-event.direction * (event.reset is not None)] for event in events.values()]
    return np.where(values == 0, _TOUCH * np.reshape(side, (-1, 1)), values)


def values_of(events: Events, states: AbstractOrbit) -> Values:
    """Return the values of all events at states."""
    values = [values_at(name, event, states) if len(states) else np.empty(0) for name, event in events.items()]
    return np.array(values).reshape(len(events), len(states))


class Crossed(NamedTuple):
    """Where some motions cross, up to their ends.

    Attributes:
        at: For every event the states before its crossings.
        stopper: The position of the event that ends each motion, -1 where none does.
        end: The step with which it ends.
    """

    at: list[Int[np.ndarray, "C"]]
    stopper: Int[np.ndarray, "M"]
    end: Int[np.ndarray, "M"]


def find_crossings(
    events: Events, states: AbstractOrbit, values: Values, owner: Int[np.ndarray, "K"], left: np.ndarray, part: Part
) -> Crossed:
    """Return where motions cross, none of it after a crossing that ends one.

    Args:
        events: The events, by name.
        states: Consecutive states of one motion after another.
        values: Values of the events there.
        owner: The motion of each state.
        left: The number of further crossings of every event that ends a motion; infinite if none does.
        part: Gives the states after parts of steps.
    """
    is_same, count = owner[1:] == owner[:-1], left.shape[1]
    at = [np.flatnonzero(changes(event, row) & is_same) for event, row in zip(events.values(), values, strict=True)]
    ending = [x[_rank(owner[x]) == most[owner[x]] - 1] for x, most in zip(at, left, strict=True)]
    places = Crossed(at, np.full(count, -1), np.zeros(count, dtype=int))
    return _cut_ends(events, states, values, owner, places, ending, part) if any(map(len, ending)) else places


def _rank(owner: Int[np.ndarray, "C"]) -> Int[np.ndarray, "C"]:
    """Return how many crossings the same motion has before each."""
    return np.arange(len(owner)) - np.searchsorted(owner, owner)


def _cut_ends(
    events: Events, states: AbstractOrbit, values: Values, owner: np.ndarray, places: Crossed, ending: Any, part: Part
) -> Crossed:
    """Leave out crossings after those that end a motion, by where they are in its last step."""
    _, stopper, end = places
    limit, moment = np.full(len(end), len(owner)), np.full(len(end), np.inf)
    for at in ending:
        np.minimum.at(limit, owner[at], at)
    early = [at[at <= limit[owner[at]]] for at in places.at]
    within = [at[at == limit[owner[at]]] for at in early]
    crossings = [
        locate(name, event, states, row, at, part)
        for (name, event), row, at in zip(events.items(), values, within, strict=True)
    ]
    moments = [each.step - states.step[at] + each.fraction for each, at in zip(crossings, within, strict=True)]
    for event, (at, past) in enumerate(zip(within, moments, strict=True)):
        ends = np.isin(at, ending[event]) & (past < moment[owner[at]])
        who = owner[at[ends]]
        moment[who], stopper[who], end[who] = past[ends], event, crossings[event].step[ends]
    late = [at[past > moment[owner[at]]] for at, past in zip(within, moments, strict=True)]
    return Crossed([np.setdiff1d(at, out) for at, out in zip(early, late, strict=True)], stopper, end)


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
