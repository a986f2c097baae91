"""Whether the functions given to resume a stored run in coordinates are those of the store, which holds none."""

from typing import TYPE_CHECKING, Any

import numpy as np

from nonholo import io
from nonholo.base.checks import error

if TYPE_CHECKING:
    from nonholo.io import Stream

_SAME = 1e-9  # of 1 + the largest number of a column: rounding of other versions is far less


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
    first = block * plan.rows
    pairs = {name: (each.values, stream.rows(name, first, len(orbit))) for name, each in io.stored_variables(orbit).items()}
    pairs["the last step"] = np.array(done), np.array(plan.steps)
    if done == reached.done:
        pairs["the state"] = state.vector, reached.vector
    for name, (now, then) in pairs.items():
        off = np.max(np.abs(np.nan_to_num(now - then)), initial=0.0)
        if off > tolerance * (1 + np.max(np.abs(np.nan_to_num(then)), initial=0.0)):
            got = f"{name} other by {off:.3g} after step {begin.done}, which was computed again"
            remedy = "Pass the system it was run with, on the same kind of processor."
            raise error(f"{owner}(discrete=...)", "have the functions of the store", got, remedy)


def _last_sound(stream: "Stream") -> int | None:
    """Return the last block that took steps and is sound."""
    for block in sorted(stream.marked(), reverse=True):
        try:
            if stream.sound(block).done > stream.checkpoint(block).done:
                return block
        except io.DamagedError:
            continue  # whoever computes it again says so
    return None
