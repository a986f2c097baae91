"""Events of a flow: sought between its steps and the requested times, located on the solution."""

import dataclasses
from typing import Any, cast

import numpy as np

from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Float
from nonholo.orbit import AbstractOrbit, Crossings, EventLog, Orbit
from nonholo.simulation.events._crossings import refuse_resets
from nonholo.simulation.events._event import Event, checked_events
from nonholo.simulation.events._search import Part, Watch, search, values_of


def flow_in_coordinates(system: Any, events: Any, **flow: Any) -> Any:
    """Solve the equations of a system in coordinates; return the orbit with what was found, if there are events."""
    if events is None:
        return system.flow(**flow)
    refuse_resets("flow", checked_events("flow", events), "those of a system in coordinates")
    named = checked_events("flow", events)
    try:
        orbit, failure = system.flow(**flow), None
    except OutcomeError as early:
        orbit, failure = cast(AbstractOrbit, early.orbit), early
    found = flow_with_events(named, orbit, cast(Any, orbit).solution.looks())
    if failure is not None and found.events.stopped_by is None:
        raise OutcomeError(failure.outcome, failure.where, found)
    return found


def flow_with_events(events: dict[str, Event], orbit: Any, steps: Float[np.ndarray, "steps"]) -> Any:
    """Return the states of a flow up to the event that ends it, with what was found.

    Args:
        events: What is looked for, by name.
        orbit: The flow.
        steps: Times at which steps of its solver begin: there, too, its states are looked at.
    """
    forward = _direction(orbit)
    requested = forward * orbit.time
    inside = steps[(forward * steps > requested[0]) & (forward * steps < requested[-1])]
    times = np.unique(np.concatenate([requested, forward * inside]))
    seen = orbit.at(forward * times) if len(inside) else orbit
    return _searched(orbit, seen, Watch(events, between_times(seen, forward)))


def _direction(orbit: AbstractOrbit) -> float:
    return 1.0 if orbit.time[-1] >= orbit.time[0] else -1.0


def _searched(orbit: Any, seen: Any, watch: Watch) -> Any:
    """Return the orbit up to the event that ends it, with what is found between the states that are looked at."""
    forward = _direction(orbit)
    requested, times = forward * orbit.time, forward * seen.time
    watch, kept = search(watch, seen)
    outcome = Outcome.successful if watch.stopped_by else orbit.outcome
    count = int(np.searchsorted(requested, times[kept - 1], "right"))
    log = watch.log()
    found = tuple(of_requested(part, requested, forward) for part in log.found)
    return dataclasses.replace(
        orbit.chosen(slice(0, count)), outcome=outcome, events=EventLog(log.names, found, log.stopped_by)
    )


def check_functions(events: dict[str, Event], first: Orbit) -> None:
    """Refuse events whose functions have no value at the first state."""
    values_of(events, first)


def between_times(seen: Orbit, forward: float) -> Part:
    """Return the function of states and fractions that gives those on a part of the way to the next."""
    times, spans = forward * seen.time, np.diff(seen.time)

    def between(states: Orbit, fractions: Float[np.ndarray, "K"]) -> Orbit:
        if not len(states):
            return states
        begin = np.searchsorted(times, forward * states.time)
        return seen.at(forward * np.minimum(forward * (states.time + fractions * spans[begin]), times[-1]))

    return between


def of_requested(crossings: Crossings, requested: np.ndarray, forward: float) -> Crossings:
    """Return crossings with the numbers of the requested times before them."""
    times = forward * crossings.time
    step = np.searchsorted(requested, times, "right") - 1
    gaps = np.append(np.diff(requested), np.inf)
    fraction, after = (times - requested[step]) / gaps[step], crossings.after
    states = dataclasses.replace(crossings.states, step=step)
    after = None if after is None else dataclasses.replace(after, step=step)
    return Crossings(step, fraction, crossings.direction, states, after)
