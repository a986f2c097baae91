"""The search of a stretch of states for crossings: changes of sign first, then where between two states they are."""

import dataclasses
import functools
import operator
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple, cast

import numpy as np

from nonholo.base.types import Bool, Float, Int
from nonholo.orbit import AbstractOrbit, Crossings, EventLog, joined_crossings
from nonholo.simulation.events._event import Event, Impact, has_resets, values_at

Part = Callable[[Any, Float[np.ndarray, "K"]], Any]
"""Gives what is reached from states after fractions of the steps that begin there."""

_PIECE, _NUMBERS = 1 << 14, 1 << 20  # at most in a stretch that is searched at once: states, numbers in an array
_ROUNDING = 2.0**-54  # of a step, beside its end
_TOUCH = 5e-324  # the value of an event at a wall, with the sign of the side where the body is


@dataclasses.dataclass(frozen=True, eq=False)
class Watch:
    """The state of the search of a motion, stretch by stretch.

    Attributes:
        events: What is looked for, by name.
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
        done = self.counts or (0,) * len(self.events)
        left = [event.last - count for event, count in zip(self.events.values(), done, strict=True)]
        return [rest if event.reset is None else 1.0 for event, rest in zip(self.events.values(), left, strict=True)]

    @property
    def has_walls(self) -> bool:
        """Whether an event has a reset."""
        return has_resets(self.events)

    @property
    def is_at_wall(self) -> bool:
        """Whether the last state is at a wall."""
        return self.has_walls and self.values is not None and bool((abs(self.values) == _TOUCH).any())

    @property
    def impacts(self) -> list[Any]:
        """The states after impacts, in their order."""
        hits = (found for part in self.parts for found in part if found.after is not None)
        return [found.after for found in hits if len(found)]

    @property
    def impact(self) -> Crossings:
        """The impact that is the last thing that was seen."""
        return self.parts[-1][tuple(self.events).index(self.reset_by or "")].chosen(slice(-1, None))

    @property
    def grazes(self) -> bool:
        """Whether the last thing that was seen is the crossing of a wall that the motion was not toward."""
        if self.reset_by is None:
            return False
        return np.array_equal(self.impact.states.reduced_momentum, self.impact.after.reduced_momentum)

    def begun_at(self, last: int) -> tuple[Any, int, float]:
        """Return the state after the impact, the step that is cut, and how much of it is gone; `last` came before it.

        One at the end of a step cuts that one.
        """
        hit = self.impact
        exact = hit.fraction[0] == 0
        return hit.after, last - int(exact), 1.0 if exact else float(hit.fraction[0])

    def after_stretch(self, found: tuple[Crossings, ...]) -> "Watch":
        """Return what is known after another stretch, but for what is known of its last state."""
        counts = tuple(map(operator.add, self.counts or (0,) * len(found), map(len, found)))
        parts = (*self.parts, found) if not self.parts or any(map(len, found)) else self.parts
        return dataclasses.replace(self, parts=parts, counts=counts, reset_by=None)

    def after_impact(self, before: np.ndarray) -> "Watch":
        """Return what is known at the impact that was seen last, from values before it: nothing is beyond a wall."""
        hit, before = self.impact, np.array(before)
        before[tuple(self.events).index(self.reset_by or "")] = -hit.direction
        return dataclasses.replace(self, values=before).seen_at(hit.after)

    def seen_at(self, there: Any) -> "Watch":
        """Return what is known at a state so near to the last one that no side of a wall was left."""
        values = values_of(self.events, there)
        values = np.where(self.is_beyond(values), _TOUCH * np.sign(self.values), values)  # type: ignore[arg-type]
        return dataclasses.replace(self, values=values, heading=None if there.turned is None else there.turned[-1])

    def is_beyond(self, values: Float[np.ndarray, "E 1"]) -> Bool[np.ndarray, "E 1"]:
        """Tell of which events values mean that the body is beyond a wall, or at one, before which it was last."""
        side = np.sign(self.values)  # type: ignore[call-overload]
        guards = [(event.reset is not None, event.direction) for event in self.events.values()]
        has_wall, direction = np.array(guards).T[:, :, None]
        return (has_wall != 0) & (direction * side <= 0) & (side != 0) & (np.sign(values) != side)

    def log(self) -> EventLog:
        """Return what has been found."""
        found = tuple(joined_crossings(column) for column in zip(*self.parts, strict=True))
        return EventLog(tuple(self.events), found, self.stopped_by)


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
        values[:, :1] = _begun(watch.events, values[:, :1])
    owner, left = np.zeros(len(stretch), dtype=int), np.array([watch.left]).T
    places = crossed(watch.events, stretch, values, owner, left, watch.part)
    first, kept = int(places.stopped[0]), len(stretch)
    if first >= 0:
        kept = 1 + int(places.end[0] - stretch.step[0])
    found = tuple(
        _seen(watch, first, position, stretch, row, at)
        for position, (row, at) in enumerate(zip(values, places.at, strict=True))
    )
    known = watch.after_stretch(found)
    if len(stretch):
        known = dataclasses.replace(known, values=values[:, kept - 1 : kept])
    heading = float(stretch.turned[kept - 1]) if stretch.turned is not None else None
    known = dataclasses.replace(known, heading=heading)
    if first < 0:
        return known, kept
    name, event = tuple(watch.events.items())[first]
    if event.reset is None or known.counts[first] >= event.last:
        return dataclasses.replace(known, stopped_by=name), kept
    known = dataclasses.replace(known, reset_by=name)
    _, before, _ = known.begun_at(kept - 1)  # at a wall a gap says nothing of sides
    return known.after_impact(values[:, before : before + 1]), kept


def _seen(watch: Watch, first: int, position: int, stretch: Any, values: np.ndarray, at: np.ndarray) -> Crossings:
    """Return the crossings of one event, with the states after its impacts; of two walls at a moment the first acts."""
    name, event = tuple(watch.events.items())[position]
    if event.reset is not None and position != first:
        at = at[:0]
    found = located(name, event, stretch, values, at, watch.part)
    if event.reset is None:
        return found
    after = struck(watch, name, found.states, found.direction) if len(found) else None
    return dataclasses.replace(found, after=found.states if after is None else after)


def struck(watch: Watch, name: str, states: Any, direction: Int[np.ndarray, "1"]) -> Any:
    """Return the state after the impact of an event at a state; None where the motion is not toward the wall."""
    event, where = watch.events[name], f"Event(reset=...) of {name!r}"
    gap = functools.partial(values_at, name, event)
    after = cast(Impact, event.reset).struck(where, gap, states, int(direction[0]))
    return None if after is None else watch.begin(after)


def _begun(events: dict[str, Event], values: Float[np.ndarray, "E K"]) -> Float[np.ndarray, "E K"]:
    """Return values at the first state: one at a wall with a direction is on the side that leads through it."""
    side = [[-event.direction * (event.reset is not None)] for event in events.values()]
    return np.where(values == 0, _TOUCH * np.reshape(side, (-1, 1)), values)


def values_of(events: dict[str, Event], states: AbstractOrbit) -> Float[np.ndarray, "E K"]:
    """Return the values of all events at states."""
    values = [values_at(name, event, states) if len(states) else np.empty(0) for name, event in events.items()]
    return np.array(values).reshape(len(events), len(states))


class Crossed(NamedTuple):
    """Where some motions cross, up to their ends.

    Attributes:
        at: For every event the states before its crossings.
        stopped: The position of the event that ends each motion, -1 where none does.
        end: The step with which it ends.
    """

    at: list[Int[np.ndarray, "C"]]
    stopped: Int[np.ndarray, "M"]
    end: Int[np.ndarray, "M"]


def crossed(
    events: dict[str, Event],
    states: AbstractOrbit,
    values: Float[np.ndarray, "E K"],
    owner: Int[np.ndarray, "K"],
    left: Float[np.ndarray, "E M"],
    part: Part,
) -> Crossed:
    """Return where motions cross, none of it after a crossing that ends one.

    Args:
        events: What is looked for, by name.
        states: Consecutive states of one motion after another.
        values: Values of the events there.
        owner: The motion of each state.
        left: The number of further crossings of every event that ends a motion; infinite if none does.
        part: Gives the states after parts of steps.
    """
    joined, count = owner[1:] == owner[:-1], left.shape[1]
    at = [np.flatnonzero(changes(event, row) & joined) for event, row in zip(events.values(), values, strict=True)]
    ending = [x[_rank(owner[x]) == most[owner[x]] - 1] for x, most in zip(at, left, strict=True)]
    done = Crossed(at, np.full(count, -1), np.zeros(count, dtype=int))
    return _ended(events, states, values, owner, done, ending, part) if any(map(len, ending)) else done


def _rank(owner: Int[np.ndarray, "C"]) -> Int[np.ndarray, "C"]:
    """Return how many crossings the same motion has before each."""
    return np.arange(len(owner)) - np.searchsorted(owner, owner)


def _ended(
    events: dict[str, Event],
    states: AbstractOrbit,
    values: np.ndarray,
    owner: np.ndarray,
    done: Crossed,
    ending: list[np.ndarray],
    part: Part,
) -> Crossed:
    """Leave out crossings after those that end a motion, by where they are in its last step."""
    _, stopped, end = done
    limit, moment = np.full(len(end), len(owner)), np.full(len(end), np.inf)
    for at in ending:
        np.minimum.at(limit, owner[at], at)
    kept = [at[at <= limit[owner[at]]] for at in done.at]
    within = [at[at == limit[owner[at]]] for at in kept]
    found = [
        located(name, event, states, row, at, part)
        for (name, event), row, at in zip(events.items(), values, within, strict=True)
    ]
    gone = [each.step - states.step[at] + each.fraction for each, at in zip(found, within, strict=True)]
    for event, (at, past) in enumerate(zip(within, gone, strict=True)):
        ends = np.isin(at, ending[event]) & (past < moment[owner[at]])
        who = owner[at[ends]]
        moment[who], stopped[who], end[who] = past[ends], event, found[event].step[ends]
    late = [at[past > moment[owner[at]]] for at, past in zip(within, gone, strict=True)]
    return Crossed([np.setdiff1d(at, out) for at, out in zip(kept, late, strict=True)], stopped, end)


def changes(event: Event, values: Float[np.ndarray, "... K"]) -> Bool[np.ndarray, "... L"]:
    """Tell for each state but the last whether the motion crosses in the step from there."""
    sign = np.sign(values)
    before, after = sign[..., :-1], sign[..., 1:]
    crosses = (before != 0) & (after != before)
    return crosses & (event.direction * (after - before) >= 0)


def located(
    name: str,
    event: Event,
    stretch: AbstractOrbit,
    values: Float[np.ndarray, "K"],
    at: Int[np.ndarray, "C"],
    part: Part,
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


def _roots(
    name: str, event: Event, base: AbstractOrbit, ends: tuple[np.ndarray, np.ndarray], part: Part
) -> Float[np.ndarray, "C"]:
    """Return the fractions of steps at which an event is zero, between ends where its signs differ.

    Chandrupatla's bracketing method, for all of them at once, to the last bits.
    """
    begin, end = ends

    def value(fraction: np.ndarray, which: np.ndarray) -> np.ndarray:
        at = which.astype(int)
        known = np.where(fraction == 0, begin[at], end[at])
        inner = (fraction > 0) & (fraction < 1)
        known[inner] = values_at(name, event, part(base.chosen(at[inner]), fraction[inner])) if inner.any() else 0.0
        return known

    if not len(base):
        return np.empty(0)
    from scipy.optimize import elementwise  # loads slowly

    count = np.arange(len(base), dtype=np.float64)
    whole = np.zeros(len(base)), np.ones(len(base))
    found = elementwise.find_root(value, whole, args=(count,), tolerances={"xatol": _ROUNDING})
    return np.maximum(found.x, _ROUNDING)


def piece_of(widths: Iterable[int]) -> int:
    """Return the number of states, with arrays of these widths, that are searched at once."""
    return max(1, min(_PIECE, _NUMBERS // max(1, *widths)))
