"""The events of a run in a store and its checkpoints."""

import dataclasses
from typing import Any

import numpy as np

from nonholo.io import Seen
from nonholo.simulation.events import Event, Watch


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


def watch_at_checkpoint(watch: Watch | None, seen: Seen | None) -> tuple[Watch | None, int]:
    """Return what was known of a motion at a checkpoint, and how many chunks of crossings there were."""
    if watch is None or seen is None:
        return watch, 0
    counts, values = tuple(map(int, seen.counts)), seen.values[:, None]
    return dataclasses.replace(watch, counts=counts, values=values, heading=seen.heading), seen.chunks
