"""What a checkpoint says of the events of a run, and the blocks of a stored run with events."""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.io import Checkpoint, Seen, Stream
from nonholo.orbit import Orbit
from nonholo.simulation._events import Event
from nonholo.simulation._events_pieces import watched_piece
from nonholo.simulation._events_scan import Watch
from nonholo.simulation._stretch import CompiledRun


def descriptions(events: dict[str, Event]) -> list[dict[str, Any]]:
    """Return what a store can hold of events: everything but their functions."""
    return [
        {"name": name, "direction": int(event.direction), "stop": int(event.stop)} for name, event in events.items()
    ]


def seen_by(watch: Watch, chunks: int) -> Seen:
    """Return what a checkpoint keeps of what is known of a motion."""
    values = np.empty(0) if watch.values is None else watch.values[:, 0]
    stopped = -1 if watch.stopped_by is None else tuple(watch.events).index(watch.stopped_by)
    return Seen(np.array(watch.counts, dtype=np.int64), values, watch.heading or 0.0, stopped, chunks)


def computed_with_events(
    run: CompiledRun, stream: Stream, watch: Watch, block: int, begin: Checkpoint, report: Callable[[int], object]
) -> tuple[Orbit, Checkpoint]:
    """Return a block of a run with its crossings, and the checkpoint at its end."""
    vector, plan, opening = begin.vector.copy(), stream.plan, block == 0
    going, chunks = _gone_on_from(watch, begin.seen)
    piece, now = watched_piece(run, vector, going, plan.begin(block), plan.stop(block), report, opening=opening)
    orbit = dataclasses.replace(run.orbit(piece.rows, piece.begun, opening, piece.outcome), events=piece.log)
    return orbit, Checkpoint(piece.done, piece.outcome, vector, seen_by(now, stream.chunks_after(chunks, piece.log)))


def _gone_on_from(watch: Watch, seen: Seen | None) -> tuple[Watch, int]:
    """Return what was known of a motion at a checkpoint, and how many chunks of crossings there were."""
    if seen is None:
        return watch, 0
    counts, values = tuple(map(int, seen.counts)), seen.values[:, None]
    return dataclasses.replace(watch, counts=counts, values=values, heading=seen.heading), seen.chunks
