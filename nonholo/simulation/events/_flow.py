"""Events of a flow: sought between the requested times, located by solving from the time before."""

import dataclasses
from collections.abc import Callable
from typing import Any, cast

import numpy as np

from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.orbit import Orbit, joined_states
from nonholo.simulation.events._between import Between
from nonholo.simulation.events._event import Event, values_at
from nonholo.simulation.events._search import Watch, search

Solve = Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[Any, Any, Any, Outcome]]


def flow_with_events(events: dict[str, Event], orbit: Orbit, solve: Solve) -> Orbit:
    """Return the states of a flow up to the event that ends it, with what was found."""
    watch, kept = search(Watch(events, _between_times(orbit.time, solve)), orbit, 0)
    outcome = Outcome.successful if watch.stopped_by else orbit.outcome
    return dataclasses.replace(orbit.chosen(slice(0, kept)), outcome=outcome, events=watch.log())


def check_functions(events: dict[str, Event], first: Orbit) -> None:
    """Refuse events whose functions have no value at the first state."""
    for name, event in events.items():
        values_at(name, event, first)


def _between_times(time: Float[np.ndarray, "K"], solve: Solve) -> Between:
    """Return the function of states at requested times and fractions that solves for a part of the way to the next."""
    spans, forward = np.diff(time), np.sign(time[-1] - time[0])

    def between(states: Orbit, fractions: Float[np.ndarray, "K"]) -> Orbit:
        at = np.searchsorted(forward * time, forward * states.time)
        parts = [_solved(states[i : i + 1], span, solve) for i, span in enumerate(fractions * spans[at])]
        return joined_states(parts) if parts else states

    return between


def _solved(state: Orbit, span: float, solve: Solve) -> Orbit:
    """Return what one state becomes after a time; NaN if the solver fails."""
    begun = state.reduced_momentum[0], cast(np.ndarray, state.canonical_pose)[0]
    momenta, poses, turned, outcome = solve(*begun, np.array([0.0, span]))
    lost = np.nan if outcome != Outcome.successful else 0.0
    if turned is not None and state.turned is not None:
        turned = turned[-1:] + 2 * np.pi * np.rint((state.turned - turned[:1]) / (2 * np.pi))
    return dataclasses.replace(
        state,
        time=state.time + span,
        reduced_momentum=momenta[-1:] + lost,
        canonical_pose=poses[-1:] + lost,
        turned=turned,
    )
