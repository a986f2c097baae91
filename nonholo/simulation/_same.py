"""Whether the functions given to resume a stored run are those of the store, which holds none."""

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from nonholo import io
from nonholo.base.checks import error
from nonholo.base.results import Outcome
from nonholo.orbit import AbstractStepper
from nonholo.simulation._run import Reached, Run, computed, orbit_at
from nonholo.simulation._stored import descriptions, seen_by
from nonholo.simulation.events import Watch, checked_events, search, watched

if TYPE_CHECKING:
    from nonholo.io import Stream

_SAME = 1e-9  # of 1 + the largest number: rounding of other versions and processors is far less


def watch_of_store(owner: str, stream: "Stream", stepper: AbstractStepper[Any], events: Any) -> Watch | None:
    """Return what the run of a store looks for; refused if it is not what the store says."""
    text, where = io.read_attributes(stream.path).get("events"), f"{owner}(events=...)"
    chosen, stored = [] if events is None else events, json.loads(text or "[]")
    if text is None and not checked_events(owner, chosen):
        return None
    wanted = f"be the events of the store, {io.described(stored)}"
    if events is None and stored:
        remedy = "Pass events=[...] again, in that order with these directions and stops: a store holds no functions."
        raise error(where, wanted, f"None for '{stream.path}'", remedy)
    watch = watched(owner, stepper, chosen)
    passed = [] if watch is None else descriptions(watch.events)
    if passed != stored:
        raise error(where, wanted, io.described(passed), "Pass the ones it was run with.")
    if watch is not None:
        _refuse_other_values(where, stream, stepper, watch)
    return watch


def _refuse_other_values(where: str, stream: "Stream", stepper: AbstractStepper[Any], watch: Watch) -> None:
    """Refuse events that have other values at the first state than the store says."""
    try:
        first = stream.checkpoint(0)
    except io.DamagedError:
        return  # whoever needs it to continue says so
    if first.seen is None:
        return
    seen, _ = search(watch, orbit_at(stepper, first.vector, 0))
    for name, now, then in zip(watch.events, seen_by(seen).values, first.seen.values, strict=True):
        if abs(now - then) > _SAME * (1 + abs(then)):
            got = f"another one of {name!r}: {now:.17g} instead of {then:.17g} at the first state"
            raise error(where, "be the functions of the store", got, "Pass those it was run with.")


def refuse_other_functions(owner: str, stream: "Stream", run: Run) -> None:
    """Refuse a run whose first saved states of the last sound block are not those of the store, to the last bit.

    To rounding, if the store was begun with other versions.
    """
    block = _last_sound(stream)
    if block is None:
        return
    begin, reached = stream.checkpoint(block), stream.sound(block)
    plan = stream.plan._replace(steps=min(begin.done + run.every, reached.done))
    orbit, again = computed(
        run.stepper, plan, block, Reached(begin.done, Outcome.successful, begin.vector, None), lambda *_: None
    )
    tolerance = _SAME if io.other_versions(io.read_attributes(stream.path)) else 0.0
    pairs = {
        name: (rows, stream.rows(name, block * plan.rows, len(orbit)))
        for name, rows in stream.columns(orbit, block * plan.rows).items()
    }
    pairs["the last step"] = np.array(again.done), np.array(plan.steps)
    if again.done == reached.done:  # of the row, which is among the variables, nothing is asked
        own = slice(sum(run.stepper.columns.values()), None)
        pairs["the state"] = again.state[own], reached.vector[own]
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
