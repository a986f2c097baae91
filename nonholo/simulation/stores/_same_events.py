"""Whether the events given to resume a stored run are those of the store, which holds no functions."""

import json
from typing import TYPE_CHECKING, Any

from nonholo import io
from nonholo.base.checks import error
from nonholo.discrete import PRINCIPAL
from nonholo.simulation.events import Watch, checked_events, search, watched
from nonholo.simulation.runs import CompiledRun, RunState
from nonholo.simulation.stores._stored_events import descriptions, seen_by

if TYPE_CHECKING:
    from nonholo.io import Stream

_SAME = 1e-9  # of 1 + the value at the first state: rounding on another processor is far less


def watch_of_store(owner: str, stream: "Stream", run: CompiledRun, events: Any) -> Watch | None:
    """Return what the run of a store looks for; refused if it is not what the store says."""
    stored, where = io.read_attributes(stream.path).get("events"), f"{owner}(events=...)"
    chosen = [] if events is None else events
    if stored is None and not checked_events(owner, chosen):
        return None
    asked = io.described(json.loads(stored)) if stored is not None else "no events"
    if events is None and stored != "[]":
        remedy = "Pass events=[...] again, in that order with these directions and stops: a store holds no functions."
        raise error(where, f"be the events of the store, {asked}", f"None for '{stream.path}'", remedy)
    watch = watched(owner, run.discrete, chosen, PRINCIPAL.name, run.reconstruct)
    given = descriptions(watch.events)
    if stored is None or given != json.loads(stored):
        raise error(
            where, f"be the events of the store, {asked}", io.described(given), "Pass the ones it was run with."
        )
    _refuse_other_functions(where, stream, run, watch)
    return watch


def _refuse_other_functions(where: str, stream: "Stream", run: CompiledRun, watch: Watch) -> None:
    """Refuse functions that have other values at the first state than the store says."""
    try:
        first = stream.checkpoint(0)
    except io.DamagedError:
        return  # whoever needs it to continue says so
    if first.seen is None:
        return
    found, _ = search(watch, run.first(RunState.of(first.vector, run.sizes)))
    for name, now, then in zip(watch.events, seen_by(found, 0).values, first.seen.values, strict=True):
        if abs(now - then) > _SAME * (1 + abs(then)):
            got = f"another one of {name!r}: {now:.17g} instead of {then:.17g} at the first state"
            raise error(where, "be the functions of the store", got, "Pass those it was run with.")
