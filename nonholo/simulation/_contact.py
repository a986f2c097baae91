"""Steps and flows with impacts: up to the wall, the reflection, and the rest, in which there may be more impacts.

At a wall nothing is known of a gap but rounding. So the rest of the step is halved again and again, down to
where the body has left the wall; from there on the sign of the gap can be trusted. A flow begins again with the
reflected momentum.
"""

import dataclasses
import functools
import itertools
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.results import Outcome
from nonholo.base.types import Bool, Float
from nonholo.continuous import ContinuousFlow, Problem, Solved, States, solver_of
from nonholo.orbit import Crossings, Orbit
from nonholo.simulation._crossings import between_times, of_requested
from nonholo.simulation._search import Events, Watch, search

_TURN = 2 * np.pi
_MOST = 200  # impacts in a step
_LEAST = 2.0**-52  # of the part that is left, where the body is looked at
_SHORT = 2.0**-36  # of a step: too short for the sign of a gap
_ROUNDING = 2.0**-54  # of a step, that is left and gone at least
_NO_TIME = 8  # units in the last place of a time
_AHEAD = 2.0 ** np.arange(-10, 1)  # of a step, where the rate of a gap says whether the body is pressed


def after_contact(begin: Callable[[Any], tuple[Any, Outcome]], watch: Watch, node: Orbit) -> tuple[Any, Watch, Outcome]:
    """Take a step from a node at a wall, or what is left of it after the impact that was seen last.

    Args:
        begin: Gives the state of a run that begins at a state of an orbit, and the outcome.
        watch: The search for events.
        node: The state at the beginning of the step.

    Returns:
        The state at its end, None if it is not reached; what is known then, and the outcome. A body stays that comes
        back to a wall in no time, at once or from others without restitution.
    """
    there, share, times = node, 0.0, dict[str, float]()
    for _ in range(_MOST):
        if (wall := watch.reset_by) is not None:
            hit = watch.impact
            there, share = hit.after, float(hit.fraction[0] + (hit.step[0] - node.step[0]))
            if there.time[0] - times.get(wall, -np.inf) <= _NO_TIME * np.spacing(abs(there.time[0])):
                break
            times = {wall: there.time[0]} | (times if watch.restitution(wall) == 0 else {})
        there = dataclasses.replace(there.with_headings(watch.heading), step=node.step)
        if (outcome := begin(there)[1]) == Outcome.successful:
            watch, end, outcome = _move_on(watch, there, share)
        if outcome != Outcome.successful or watch.stopped_by is not None:
            return None, watch, outcome
        if watch.reset_by is None:
            state, outcome = begin(end)
            return state if outcome == Outcome.successful else None, watch, outcome
    return None, watch, Outcome.lasting_contact


def _move_on(watch: Watch, there: Orbit, share: float) -> tuple[Watch, Orbit, Outcome]:
    """Continue to the next impact or to the end of the step; return what is known, the state at the end, the outcome.

    A motion that the curve of the step alone, or rounding, leads through a wall to which it is not pressed is let go.
    """
    if _stays(watch, there):
        return watch, there, Outcome.lasting_contact
    rest = max(1 - share, _ROUNDING)
    if not _is_finite(end := watch.part(there, np.array([rest]))):
        return watch, end, Outcome.not_converged
    watch = dataclasses.replace(watch, reset_by=None, sliding=watch.slides_at(there) & watch.slides_at(end))
    if rest < _SHORT:
        return watch.seen_at(end), end, Outcome.successful
    places, looks, inside = _looks(watch, there, end, rest)
    if inside.any():
        new_watch = _struck_here(watch, there, max(share, _ROUNDING), inside)
        walls = itertools.compress(watch.events, inside[:, 0])
        if new_watch.reset_by is not None:
            return new_watch, end, Outcome.successful
        is_pressed = any(rate > 0 for name in walls for _, rate in _rates_ahead(watch, there, name))
        return watch.seen_at(end), end, Outcome.lasting_contact if is_pressed else Outcome.successful
    new_watch = _search_rest(watch, there, places, looks, share)
    if new_watch.reset_by is None:
        values = np.where(watch.slides_at(end), watch.values, new_watch.values)  # type: ignore[arg-type]
        new_watch = dataclasses.replace(new_watch, values=values, sliding=False)
    return new_watch, end, Outcome.successful


def _stays(watch: Watch, there: Orbit) -> bool:
    """Return whether a body stays at the wall that was struck last: it is pressed, and no bounce of it can be seen.

    From the speed u away from the wall and the acceleration a toward it the height of a bounce is u^2/2a.
    """
    if (name := watch.reset_by) is None or watch.restitution(name) == 1:
        return False
    speed = watch.rate_toward(name, there)
    end, rate = next(_rates_ahead(watch, there, name), (there, speed))
    time = end.time[0] - there.time[0]
    return bool(rate > speed and speed**2 * time <= 2 * (rate - speed) * watch.lowest_bounce(name, there))


def _rates_ahead(watch: Watch, there: Orbit, name: str) -> Iterator[tuple[Orbit, float]]:
    """Give states ahead of one at a wall, with the rates toward it, where they are seen."""
    for place in _AHEAD:
        if _is_finite(end := watch.part(there, np.array([place]))) and (rate := watch.rate_toward(name, end)):
            yield end, rate


def _looks(watch: Watch, there: Orbit, end: Orbit, rest: float) -> tuple[np.ndarray, Orbit, Bool[np.ndarray, "E 1"]]:
    """Return fractions of what is left of a step, the states there, and which walls the body has not left at any."""
    places, looks, inside = [1.0], [end], watch.is_beyond(watch.values_there(end))
    while inside.any() and places[-1] > _LEAST:
        places.append(places[-1] / 2)
        looks.append(watch.part(there, np.array([places[-1] * rest])))
        inside &= watch.is_beyond(watch.values_there(looks[-1]))
    return np.array([0.0, *places[::-1]]), there.joined(looks[::-1]), inside


def _is_finite(there: Orbit) -> bool:
    return bool(np.isfinite(getattr(there, there.momenta[0])).all())


def _struck_here(watch: Watch, there: Orbit, share: float, inside: Bool[np.ndarray, "E 1"]) -> Watch:
    """Return what is known after an impact of one of several walls at a place, where the motion is toward one."""
    sides = np.sign(watch.values).astype(np.int64)  # type: ignore[call-overload]
    for position, name in enumerate(watch.events):
        if inside[position] and (after := watch.struck(name, there, -sides[position])) is not None:
            crossings = [each.chosen(slice(0, 0)) for each in watch.parts[0]]
            crossings[position] = Crossings(there.step, np.array([share]), -sides[position], there, after)
            return watch.after_stretch(tuple(crossings)).after_impact(name, watch.values)  # type: ignore[arg-type]
    return watch


def _search_rest(watch: Watch, there: Orbit, places: np.ndarray, looks: Orbit, share: float) -> Watch:
    """Return what is known after the search of what is left of a step."""
    widths, rest = np.diff(places, append=1.0), 1 - share

    def between(states: Orbit, fractions: Float[np.ndarray, "K"]) -> Orbit:
        parts = places[states.step] + fractions * widths[states.step]
        ends = watch.part(there.chosen(np.zeros(len(states), dtype=int)), rest * parts)
        return dataclasses.replace(ends, step=states.step)

    def place(crossings: Crossings) -> Crossings:
        fraction = share + rest * (places[crossings.step] + crossings.fraction * widths[crossings.step])
        step = there.step[0] + (fraction == 1)
        return crossings.of_steps(step, np.where(fraction == 1, 0.0, fraction))

    alone = dataclasses.replace(watch, part=between, parts=())
    new_watch, _ = search(alone, dataclasses.replace(looks, step=np.arange(len(looks))))
    crossings = tuple(map(place, new_watch.parts[0]))
    parts = (*watch.parts, crossings) if any(map(len, crossings)) else watch.parts
    return dataclasses.replace(new_watch, part=watch.part, parts=parts)


class BodyFlights(NamedTuple):
    """The flows from states of a body, by a method and to tolerances; `lagrange_dalembert` has those in coordinates."""

    system: Any
    method: str | None
    tolerances: tuple[float, float]

    def fly(self, there: Orbit, elapsed: np.ndarray) -> tuple[Orbit, Outcome, str]:
        """Return the flow from a state at the requested times since then, the outcome and its message."""
        flow, solution = self._flow(there, elapsed)
        return flow, solution.outcome, solution.fault

    def joined(self, begins: list[Orbit], until: float) -> dict[str, Any]:
        """Return the field by which orbits know the motion from several states, each up to the next one."""
        states = functools.partial(self._states, begins)
        return {"motion": ContinuousFlow(self.system, (float(begins[0].time[0]), until), states)}

    def _flow(self, there: Orbit, elapsed: np.ndarray) -> tuple[Orbit, Solved]:
        """Return the flow from a state, with headings that continue from its own, where solver or caller looks."""
        begin, pose, elapsed = float(there.time[0]), there.canonical_pose[0], np.union1d(0.0, elapsed)  # type: ignore[index]
        solve, _ = solver_of(self.system, self.method, begin, reconstruct=True)
        solution, turns = solve(Problem(there.reduced_momentum[0], pose, elapsed, self.tolerances)), 0.0
        if there.turned is not None:
            turns = _TURN * np.rint((there.turned[0] - np.arctan2(pose[1], pose[0])) / _TURN)

        def turn(states: States) -> States:
            return states if states.turned is None else states._replace(turned=states.turned + turns)

        good_times, steps = elapsed[: len(solution.states.momenta)], solution.steps()
        inside = np.union1d(good_times, steps[(steps > 0) & (steps < good_times[-1])])
        motion = ContinuousFlow(self.system, (begin, begin + good_times[-1]), lambda times: turn(solution.at(times)))
        flow = dataclasses.replace(there, motion=motion).at(begin + inside)
        return flow, solution._replace(states=turn(solution.states))

    def _states(self, begins: list[Orbit], elapsed: Float[np.ndarray, "K"]) -> States:
        """Return the states at times since the first of several states, each from the last one before it."""
        times = np.concatenate([each.time for each in begins])
        at = times[0] + elapsed
        owner = np.searchsorted(times, at, "right") - 1
        each = [(begins[k], at[owner == k] - times[k]) for k in np.unique(owner)]
        places = [np.searchsorted(np.union1d(0.0, since), since) for _, since in each]  # a flow begins at zero
        flows = [self._flow(*one)[1].states.chosen(there) for one, there in zip(each, places, strict=True)]
        rows: Any = [None if column[0] is None else np.concatenate(column) for column in zip(*flows, strict=True)]
        return States(*rows)


_SPAN = 2.0  # times that from one impact to the next are solved for at first after it


def flow_through_impacts(first: Any, time: np.ndarray, flights: Any, events: Events) -> tuple[Any, str]:
    """Return the flow from its first state at requested times, by flights, and what a function said that ended it."""
    there, span, since, end = first.with_headings(None), np.inf, float(time[0]), float(time[-1])
    watch, _ = search(Watch(events, between_times(there, 1.0)), there)
    outcome, message, pace = Outcome.successful, "", 0.0
    while outcome == Outcome.successful and watch.stopped_by is None and there.time[0] < end:
        begin, before = float(there.time[0]), len(watch.impacts)
        until = min(begin + span, end)
        elapsed = np.append(time[(time > begin) & (time < until)], until) - begin
        looks, flown, fault = flights.fly(there, elapsed)
        looks = looks.on_group()
        there, watch, outcome = _pass_impact(flights, watch, looks, begin + pace)
        pace = float(there.time[0]) - begin if watch.is_at_wall else 0.0  # along a wall ends are not approached forever
        if len(watch.impacts) > before:
            span, since = _SPAN * float(there.time[0] - since), float(watch.impacts[-1].time[0])
        elif there.time[0] == looks.time[-1]:
            outcome, message, span = max(outcome, flown, looks.outcome), fault, 2 * span
    log, until = watch.log(), float(there.time[0])
    if log.stopped_by is not None:
        until = float(log[log.stopped_by].time[-1])
    motion = flights.joined([first.with_headings(None), *watch.impacts], until)  # each from the last impact before it
    orbit = dataclasses.replace(first, **motion).at(time[time <= until])
    return dataclasses.replace(orbit, outcome=outcome, events=of_requested(log, time, 1.0, **motion)), message


def _pass_impact(flights: Any, watch: Watch, looks: Orbit, least: float) -> tuple[Orbit, Watch, Outcome]:
    """Return the state after the first step between two looks with an impact, or the last one; what is known there.

    One that begins at a wall leads to the first look after the least time, or the last one.
    """
    at, last = 0, 1 + int(np.searchsorted(looks.time[1:-1], least))
    if len(looks) == 1 or not watch.is_at_wall:
        watch, last = search(dataclasses.replace(watch, part=between_times(looks, 1.0)), looks)
        if watch.reset_by is None:
            return looks.chosen(slice(last - 1, last)), watch, Outcome.successful
        at = watch.cut - looks.step[0]
        last = at + 1
    node, ends = looks.chosen(slice(at, at + 1)), looks.time[last : last + 1]
    there = node if watch.reset_by is None else watch.impact.after
    watch = dataclasses.replace(watch, part=functools.partial(_part, flights, float(ends[0] - node.time[0]), {}))
    after, watch, outcome = after_contact(lambda states: (states, Outcome.successful), watch, node)
    return there if after is None else dataclasses.replace(after, time=ends), watch, outcome


def _part(flights: Any, length: float, flows: dict[bytes, Any], states: Orbit, fractions: np.ndarray) -> Orbit:
    """Return what is reached from one state, in all rows, after fractions of a time; NaN if that is not solved for."""
    if not len(states):
        return states
    first, momentum = states.chosen(slice(0, 1)), states.momenta[0]
    place = getattr(first, momentum).tobytes()
    if place not in flows:
        flows[place] = flights.fly(first, np.array(length))
    flow, outcome, _ = flows[place]
    if outcome != Outcome.successful:
        return dataclasses.replace(states, **{momentum: np.full_like(getattr(states, momentum), np.nan)})
    return flow.at(np.minimum(first.time + length * fractions, flow.time[-1]))
