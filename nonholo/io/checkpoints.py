"""Crossings as rows of numbers, and checkpoints: the state of a run between two blocks, with what its events saw.

A row of `run/events` is the position of the event, the step, the fraction, the direction, then the state there; the
state after an impact has a separate row, of the position -1 - p for the event p. The
rows of a block begin with a new chunk; what is left of its last chunk is NaN. The functions are not stored.
"""

import dataclasses
import math
from collections.abc import Sequence
from typing import Any, NamedTuple, cast

import numpy as np

from nonholo.base.results import Outcome
from nonholo.base.types import Float, Int
from nonholo.orbit import AbstractOrbit, Crossings, EventLog

EVENTS = "run/events"
Rows = Float[np.ndarray, "C width"]
_PLACE = 4  # entries of a row before its state: event, step, fraction, direction


class Seen(NamedTuple):
    """The state of the events of a run at a checkpoint.

    Attributes:
        counts: Crossings of each so far.
        values: Values at the last state.
        heading: The heading there; 0 where there is none.
        last_event: Position of the event that ended the run, -1 if none did.
    """

    counts: Int[np.ndarray, "E"]
    values: Float[np.ndarray, "E"]
    heading: float
    last_event: int


class Checkpoint(NamedTuple):
    """The state of a run: the last good step, the outcome so far, the vector to continue from, what its events saw."""

    done: int
    outcome: Outcome
    vector: np.ndarray
    of_events: Seen | None = None

    @property
    def is_last(self) -> bool:
        """Whether the run ended here: it cannot continue, or an event ended it."""
        return self.outcome != Outcome.successful or self.is_stopped

    @property
    def is_stopped(self) -> bool:
        """Whether an event ended the run here."""
        return self.of_events is not None and self.of_events.last_event >= 0


class DamagedError(Exception):
    """Damage of a part of a store; a reader reports it, or computes the part again."""


_NONE = "a mark without the state of a run"


def said_of(checkpoint: Checkpoint) -> dict[str, Any]:
    """Return a checkpoint as what the mark of a block says; JSON has every bit of a number."""
    events, state = checkpoint.of_events, checkpoint.vector.tolist()
    about = {"done": int(checkpoint.done), "outcome": checkpoint.outcome.name, "state": state, "seen": None}
    if events is not None:
        lists = {"counts": events.counts.tolist(), "values": events.values.tolist()}
        about["seen"] = {**lists, "heading": float(events.heading), "stopped": int(events.last_event)}
    return about


def checkpoint_of(about: dict[str, Any], events: Sequence[str] | None) -> Checkpoint:
    """Return the checkpoint of a mark, of a run that looks for these events; None if it looks for none.

    Raises:
        DamagedError: The mark says something else.

    Example:
        >>> reached = Checkpoint(7, Outcome.successful, np.array([0.1]), Seen(np.array([3]), np.array([0.3]), 1.2, -1))
        >>> checkpoint_of(said_of(reached), events=['cusp']).of_events
        Seen(counts=array([3]), values=array([0.3]), heading=1.2, last_event=-1)
    """
    try:
        vector, of_events = np.array(about["state"], dtype=np.float64), about["seen"]
        if of_events is not None:
            counts, values = np.array(of_events["counts"], np.int64), np.array(of_events["values"], np.float64)
            of_events = Seen(counts, values, float(of_events["heading"]), int(of_events["stopped"]))
        checkpoint = Checkpoint(int(about["done"]), Outcome[about["outcome"]], vector, of_events)
    except (KeyError, TypeError, ValueError, OverflowError):
        raise DamagedError(_NONE) from None
    shapes = None if of_events is None else (of_events.counts.shape, of_events.values.shape)
    if vector.ndim != 1 or shapes != (None if events is None else ((len(events),),) * 2):
        raise DamagedError(_NONE)
    return checkpoint


def rows_of(log: EventLog) -> Rows:
    """Return the crossings of a block as rows, one event after another."""
    parts = [_rows(event, crossings) for event, crossings in enumerate(log.found)]
    impacts = [(event, crossings) for event, crossings in enumerate(log.found) if crossings.after is not None]
    parts += [_rows(-1 - event, dataclasses.replace(each, states=each.after, after=None)) for event, each in impacts]
    return np.concatenate(parts) if parts else np.empty((0, _PLACE))


def _rows(event: int, crossings: Crossings) -> np.ndarray:
    rows = crossings.states.rows()
    states = [rows[name].reshape(len(crossings), math.prod(rows[name].shape[1:])) for name in rows if name != "step"]
    events = np.full(len(crossings), event)
    return np.column_stack([events, crossings.step, crossings.fraction, crossings.direction, *states])


def log_of(rows: Rows, events: list[dict[str, Any]], orbit: AbstractOrbit, by: str | None) -> EventLog:
    """Return the crossings in rows of an orbit's run of described events, and which event ended it."""
    crossings = [_crossings_of(rows[rows[:, 0] == event], orbit) for event in range(len(events))]
    for event, about in enumerate(events):
        if "restitution" in about:
            after = _crossings_of(rows[rows[:, 0] == -1 - event], orbit).states
            crossings[event] = dataclasses.replace(crossings[event], after=after)
    return EventLog(tuple(about["name"] for about in events), tuple(crossings), by)


def _crossings_of(rows: np.ndarray, orbit: AbstractOrbit) -> Crossings:
    shapes = {name: column.shape[1:] for name, column in orbit.rows().items() if name not in ("step", "turned")}
    columns = np.split(rows, np.cumsum([_PLACE, *map(math.prod, shapes.values())]), axis=1)
    place, *states, turns = map(np.ascontiguousarray, columns)
    parts = zip(shapes.items(), states, strict=True)
    columns_by_name: dict[str, Any] = {name: part.reshape(len(rows), *shape) for (name, shape), part in parts}
    step, direction = (place[:, entry].astype(np.int64) for entry in (1, 3))
    single: Any = dataclasses.replace(cast(Any, orbit), outcome=Outcome.successful, save_every=1, events=None)
    if single.turned is not None or turns.shape[1]:
        columns_by_name["turned"] = turns[:, 0] if turns.shape[1] else None
    states_again = single.of_rows({**columns_by_name, "step": step})
    return Crossings(step, np.ascontiguousarray(place[:, 2]), direction, states_again)


def events_text(events: list[dict[str, Any]]) -> str:
    """Name events with their options.

    Example:
        >>> events_text([{"name": "cusp", "direction": 0, "stop": 0}, {"name": "east", "direction": 1, "stop": 3}])
        "'cusp', 'east' (direction=1, stop=3)"
    """
    words = []
    for event in events:
        options = ", ".join(f"{name}={event[name]}" for name in ("direction", "stop", "restitution") if event.get(name))
        words.append(f"{event['name']!r}" + (f" ({options})" if options else ""))
    return ", ".join(words) or "no events"
