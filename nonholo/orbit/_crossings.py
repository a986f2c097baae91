"""Results of events: the crossings of each, and which one ended the motion."""

import abc
import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any, Generic, TypeVar

import numpy as np

from nonholo.base.checks import selection
from nonholo.base.types import Float, Int


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Crossings:
    """The crossings of one event, in order of time.

    Attributes:
        step: Numbers k of the states before the crossings; of a flow, of the requested times before them. Shape (C,).
        fraction: Which part of the way to state k + 1 is gone, from 0 to 1. Shape (C,).
        direction: 1 for crossings from below, -1 from above. Shape (C,).
        states: The states at the crossings, an orbit of C states. At an impact they are those before it.
        after: The states after the impacts of an event with a reset, likewise; None without.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> orbit = nh.simulate(sleigh, body_velocity=(0.1, -1.0, 0.0), steps=100, events=[nh.cusp])
        >>> cusps = orbit.events["cusp"]
        >>> cusps.step, cusps.time.round(3), bool(np.all(abs(cusps.states.body_velocity[:, 1]) < 1e-15))
        (array([71]), array([7.169]), True)
    """

    step: Int[np.ndarray, "C"]
    fraction: Float[np.ndarray, "C"]
    direction: Int[np.ndarray, "C"]
    states: Any
    after: Any = None

    def __len__(self) -> int:
        return len(self.step)

    def __repr__(self) -> str:
        return f"<Crossings: {len(self)} at times {np.array2string(self.time, precision=6, threshold=6)}>"

    @property
    def time(self) -> Float[np.ndarray, "C"]:
        """Times of the crossings."""
        return self.states.time

    def chosen(self, which: slice | np.ndarray) -> "Crossings":
        """Return some of the crossings."""
        at = selection("Crossings.chosen(which=...)", which, len(self))
        after = None if self.after is None else self.after.chosen(at)
        return Crossings(self.step[at], self.fraction[at], self.direction[at], self.states.chosen(at), after)

    def of_steps(self, step: Int[np.ndarray, "C"], fraction: Float[np.ndarray, "C"], **fields: Any) -> "Crossings":
        """Return the same crossings in other steps; their states may have other fields."""
        rows = {"states": self.states} | ({} if self.after is None else {"after": self.after})
        states = {name: dataclasses.replace(each, step=step, **fields) for name, each in rows.items()}
        return dataclasses.replace(self, step=step, fraction=fraction, **states)


FoundT = TypeVar("FoundT")


class AbstractEventLog(abc.ABC, Generic[FoundT]):
    """The crossings of events, by name or position.

    Attributes:
        names: The names of the events.
        found: The crossings of each.
    """

    names: tuple[str, ...]
    found: tuple[FoundT, ...]

    def __getitem__(self, event: str | int) -> FoundT:
        if isinstance(event, str) and event not in self.names:
            raise KeyError(f"`events` has no event {event!r}. It has {', '.join(self.names)}.")
        return self.found[self.names.index(event) if isinstance(event, str) else event]

    def __len__(self) -> int:
        return len(self.names)

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class EventLog(AbstractEventLog[Crossings]):
    """The crossings of all events of a run, by name or position.

    Attributes:
        names: The names of the events.
        found: Their crossings.
        stopped_by: The name of the event that ended the motion; None if it ran its full length.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> nh.simulate(sleigh, body_velocity=(0.1, -1.0, 0.0), steps=100, events=[nh.cusp]).events
        <EventLog of crossings: cusp: 1>
    """

    names: tuple[str, ...]
    found: tuple[Crossings, ...]
    stopped_by: str | None = None

    @property
    def impact_steps(self) -> Int[np.ndarray, "I"]:
        """The numbers of the steps with an impact within them or at their end."""
        hits = [each.step - (each.fraction == 0) for each in self.found if each.after is not None]
        return np.unique(np.concatenate([np.empty(0, dtype=np.int64), *hits]))

    def joined(self, others: "Sequence[EventLog]") -> "EventLog":
        """Return the crossings with those of later parts of the same run."""
        columns = zip(*(log.found for log in (self, *others)), strict=True)
        return EventLog(self.names, tuple(map(joined_crossings, columns)), others[-1].stopped_by)

    def __repr__(self) -> str:
        counts = ", ".join(f"{name}: {len(crossings)}" for name, crossings in zip(self.names, self.found, strict=True))
        end = f", stopped by {self.stopped_by}" if self.stopped_by else ""
        return f"<EventLog of crossings: {counts}{end}>"


def joined_crossings(parts: Sequence[Crossings]) -> Crossings:
    """Return the crossings of stretches of a run one after another."""
    (first, *others), names = parts, ("step", "fraction", "direction")
    step, fraction, direction = (np.concatenate([getattr(part, name) for part in parts]) for name in names)
    after = None if first.after is None else first.after.joined([part.after for part in others])
    return Crossings(step, fraction, direction, first.states.joined([part.states for part in others]), after)
