"""The state of a run as what the mark of a block says of it, and back."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from nonholo.base.results import Outcome
from nonholo.io._chunks import DamagedError
from nonholo.io._stored_events import Checkpoint, Seen

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
