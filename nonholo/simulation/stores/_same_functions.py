"""Whether the functions given to resume a stored run in coordinates are those of the store, which holds none."""

from typing import TYPE_CHECKING, Any

import numpy as np

from nonholo import io
from nonholo.base.checks import error

if TYPE_CHECKING:
    from nonholo.io import Stream

_SAME = 1e-9  # of 1 + the largest number: rounding of other versions is far less


def refuse_other_functions(owner: str, stream: "Stream", run: Any) -> None:
    """Refuse a run whose first saved states of the last sound block are not those of the store, to the last bit.

    To rounding, if the store was begun with other versions.
    """
    block = _last_sound(stream)
    if block is None:
        return
    begin, reached = stream.checkpoint(block), stream.sound(block)
    plan = stream.plan._replace(steps=min(begin.done + run.every, reached.done))
    orbit, state, done = run.stretch(run.state_of(begin.vector), plan, block, lambda _: None)
    tolerance = _SAME if io.other_versions(io.read_attributes(stream.path)) else 0.0
    pairs = {
        name: (rows.values, stream.rows(name, block * plan.rows, len(orbit)))
        for name, rows in io.stored_variables(orbit).items()
    }
    pairs["the last step"] = np.array(done), np.array(plan.steps)
    if done == reached.done:
        pairs["the state"] = state.vector, reached.vector
    off, name = max((_difference(now, then), name) for name, (now, then) in pairs.items())
    if off > tolerance:
        got = f"{name} other by {off:.3g} of its size after step {begin.done}, which was computed again"
        remedy = "Pass the discretization it was run with, on the same kind of processor."
        raise error(f"{owner}(discrete=...)", "have the functions of the store", got, remedy)


def _difference(now: np.ndarray, then: np.ndarray) -> float:
    """Return the largest difference, relative to 1 + the largest number; impulses may be unknown on one side."""
    return np.nanmax(np.abs(now - then), initial=0.0) / (1 + np.nanmax(np.abs(then), initial=0.0))


def _last_sound(stream: "Stream") -> int | None:
    """Return the last block that took steps and is sound."""
    for block in sorted(stream.marked(), reverse=True):
        try:
            if stream.sound(block).done > stream.checkpoint(block).done:
                return block
        except io.DamagedError:
            continue  # whoever computes it again says so
    return None
