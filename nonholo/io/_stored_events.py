"""Crossings as rows of numbers, and checkpoints: the state of a run between two blocks, with what its events saw.

A row of `run/events` is the position of the event, the step, the fraction, the direction, then the state there; that
after an impact has a row of its own, of the position -1 - p for the event p. The
rows of a block begin with a chunk of their own; what is left of its last chunk is NaN. The functions are not stored.
"""

import dataclasses
import math
from collections.abc import Sequence
from typing import Any, NamedTuple, cast

import numpy as np

from nonholo.base.results import Outcome
from nonholo.base.types import Float, Int
from nonholo.io._chunks import DamagedError
from nonholo.orbit import AbstractOrbit, Crossings, EventLog

EVENTS = "run/events"
_PLACE = 4  # entries of a row before its state: event, step, fraction, direction


class Seen(NamedTuple):
    """The state of the events of a run at a checkpoint.

    Attributes:
        counts: Crossings of each so far.
        values: Values at the last state.
        heading: The heading there; 0 where there is none.
        stopped: Position of the event that ended the run, -1 if none did.
    """

    counts: Int[np.ndarray, "E"]
    values: Float[np.ndarray, "E"]
    heading: float
    stopped: int


class Checkpoint(NamedTuple):
    """The state of a run: the last good step, the outcome so far, the vector to continue from, what its events saw."""

    done: int
    outcome: Outcome
    vector: np.ndarray
    seen: Seen | None = None

    @property
    def is_last(self) -> bool:
        """Whether the run ended here: it cannot continue, or an event ended it."""
        return self.outcome != Outcome.successful or self.is_stopped

    @property
    def is_stopped(self) -> bool:
        """Whether an event ended the run here."""
        return self.seen is not None and self.seen.stopped >= 0


def rows_of(log: EventLog) -> Float[np.ndarray, "C width"]:
    """Return the crossings of a block as rows, one event after another."""
    parts = [_rows(event, found) for event, found in enumerate(log.found)]
    parts += [
        _rows(-1 - event, Crossings(found.step, found.fraction, found.direction, found.after))
        for event, found in enumerate(log.found)
        if found.after is not None
    ]
    return np.concatenate(parts) if parts else np.empty((0, _PLACE))


def _rows(event: int, found: Crossings) -> np.ndarray:
    rows = found.states.rows()
    states = [rows[name].reshape(len(found), math.prod(rows[name].shape[1:])) for name in rows if name != "step"]
    return np.column_stack([np.full(len(found), event), found.step, found.fraction, found.direction, *states])


def log_of(
    rows: Float[np.ndarray, "C width"], events: list[dict[str, Any]], orbit: AbstractOrbit, by: str | None
) -> EventLog:
    """Return the crossings in rows of an orbit's run of described events, and which event ended it."""
    found = [_found(rows[rows[:, 0] == event], orbit) for event in range(len(events))]
    for event, about in enumerate(events):
        if "restitution" in about:
            after = _found(rows[rows[:, 0] == -1 - event], orbit).states
            found[event] = dataclasses.replace(found[event], after=after)
    return EventLog(tuple(about["name"] for about in events), tuple(found), by)


def _found(rows: np.ndarray, orbit: AbstractOrbit) -> Crossings:
    shapes = {name: column.shape[1:] for name, column in orbit.rows().items() if name not in ("step", "turned")}
    columns = np.split(rows, np.cumsum([_PLACE, *map(math.prod, shapes.values())]), axis=1)
    place, *states, turned = map(np.ascontiguousarray, columns)
    kept: dict[str, Any] = {
        name: part.reshape(len(rows), *shapes[name]) for name, part in zip(shapes, states, strict=True)
    }
    step, direction = (place[:, entry].astype(np.int64) for entry in (1, 3))
    single: Any = dataclasses.replace(cast(Any, orbit), outcome=Outcome.successful, save_every=1, events=None)
    if single.turned is not None or turned.shape[1]:
        kept["turned"] = turned[:, 0] if turned.shape[1] else None
    return Crossings(step, np.ascontiguousarray(place[:, 2]), direction, single.of_rows({**kept, "step": step}))


def known(rows: Float[np.ndarray, "D width"], after: int = 0) -> Float[np.ndarray, "C width"]:
    """Return the rows of chunks that hold crossings, of them those after the state of a step."""
    step, fraction = rows[:, 1], rows[:, 2]
    return rows[np.isfinite(rows[:, 0]) & ((step > after) | ((step == after) & (fraction > 0)))]


def described(events: list[dict[str, Any]]) -> str:
    """Name events with their options.

    Example:
        >>> described([{"name": "cusp", "direction": 0, "stop": 0}, {"name": "east", "direction": 1, "stop": 3}])
        "'cusp', 'east' (direction=1, stop=3)"
    """
    return ", ".join(_described(event) for event in events) or "no events"


def _described(event: dict[str, Any]) -> str:
    options = ", ".join(f"{name}={event[name]}" for name in ("direction", "stop", "restitution") if event.get(name))
    return f"{event['name']!r}" + (f" ({options})" if options else "")


_NONE = "a mark without the state of a run"


def said_of(reached: Checkpoint) -> dict[str, Any]:
    """Return a checkpoint as what the mark of a block says; JSON has every bit of a number."""
    seen = None if reached.seen is None else _said_of_events(reached.seen)
    return {"done": int(reached.done), "outcome": reached.outcome.name, "state": reached.vector.tolist(), "seen": seen}


def _said_of_events(seen: Seen) -> dict[str, Any]:
    listed = {"counts": seen.counts.tolist(), "values": seen.values.tolist()}
    return {**listed, "heading": float(seen.heading), "stopped": int(seen.stopped)}


def checkpoint_of(about: dict[str, Any], events: Sequence[str] | None) -> Checkpoint:
    """Return the checkpoint of a mark, of a run that looks for these events; None if it looks for none.

    Raises:
        DamagedError: The mark says something else.

    Example:
        >>> reached = Checkpoint(7, Outcome.successful, np.array([0.1]), Seen(np.array([3]), np.array([0.3]), 1.2, -1))
        >>> checkpoint_of(said_of(reached), events=['cusp']).seen
        Seen(counts=array([3]), values=array([0.3]), heading=1.2, stopped=-1)
    """
    try:
        vector, seen = np.array(about["state"], dtype=np.float64), about["seen"]
        if seen is not None:
            counts, values = np.array(seen["counts"], dtype=np.int64), np.array(seen["values"], dtype=np.float64)
            seen = Seen(counts, values, float(seen["heading"]), int(seen["stopped"]))
        found = Checkpoint(int(about["done"]), Outcome[about["outcome"]], vector, seen)
    except (KeyError, TypeError, ValueError, OverflowError):
        raise DamagedError(_NONE) from None
    shapes = None if seen is None else (seen.counts.shape, seen.values.shape)
    if vector.ndim != 1 or shapes != (None if events is None else ((len(events),),) * 2):
        raise DamagedError(_NONE)
    return found
