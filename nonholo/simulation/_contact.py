"""Steps with impacts: the part to the wall, the reflection, the part that is left, in which there may be more impacts.

At a wall nothing is known of a gap but rounding. So the part that is left is looked at in its halves, down to where the
body has left the wall; from there on the sign of the gap can be trusted.
"""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.base.results import Outcome
from nonholo.base.types import Bool, Float
from nonholo.orbit import Crossings, Orbit
from nonholo.simulation.events import Watch, search, struck, values_of

_MOST = 200  # impacts in a step
_LEAST = 2.0**-52  # of the part that is left, where the body is looked at
_SHORT = 2.0**-36  # of a step: too short for the sign of a gap
_ROUNDING = 2.0**-54  # of a step, that is left and gone at least


def after_contact(
    begin: Callable[[Orbit], tuple[Any, Outcome]], watch: Watch, there: Orbit, number: int, gone: float
) -> tuple[Any, Watch, Outcome]:
    """Take the part of a step that is left after an impact, or a step from a node at a wall.

    Args:
        begin: Gives the state of a run that begins at a state of an orbit, and the outcome.
        watch: What is known.
        there: One state: after the impact, or at the node.
        number: The number of the step.
        gone: The part of it that is gone.

    Returns:
        The state at its end, None if it is not reached; what is known then, and the outcome.
    """
    for _ in range(_MOST):
        there = dataclasses.replace(there.with_headings(watch.heading), step=np.array([number]))
        if (outcome := begin(there)[1]) != Outcome.successful:
            return None, watch, outcome
        watch, end, outcome = _moved(watch, there, gone)
        if outcome != Outcome.successful or watch.stopped_by is not None:
            return None, watch, outcome
        if watch.reset_by is None:
            state, outcome = begin(end)
            return state if outcome == Outcome.successful else None, watch, outcome
        hit = watch.impact
        there, gone = hit.after, float(hit.fraction[0] + hit.step[0] - number)
    return None, watch, Outcome.lasting_contact


def _moved(watch: Watch, there: Orbit, gone: float) -> tuple[Watch, Orbit, Outcome]:
    """Continue to the next impact or to the end of the step; return what is known, the state at the end, the outcome.

    A motion that the curve of the step alone leads through a wall, while its velocity turns away from it, is let go.
    """
    rest, grazes = max(1 - gone, _ROUNDING), watch.grazes
    places, looks, inside = _looks(watch, there, rest)
    end, watch = looks.chosen(slice(-1, None)), dataclasses.replace(watch, reset_by=None)
    if not np.isfinite(looks.reduced_momentum).all():
        return watch, end, Outcome.not_converged
    if inside.any():
        watch = _struck_here(watch, there, max(gone, _ROUNDING), inside)
        if watch.reset_by is not None:
            return watch, end, Outcome.successful
        leaves = grazes and _struck_here(watch, end, 1.0, inside).reset_by is None
        return watch.seen_at(end), end, Outcome.successful if leaves else Outcome.lasting_contact
    if rest < _SHORT:
        return watch.seen_at(end), end, Outcome.successful
    return _searched(watch, there, places, looks, gone), end, Outcome.successful


def _looks(watch: Watch, there: Orbit, rest: float) -> tuple[np.ndarray, Orbit, Bool[np.ndarray, "E 1"]]:
    """Return fractions of what is left of a step, the states there, and which walls the body has not left at any."""

    def look(place: float) -> Orbit:
        return watch.part(there, np.array([place * rest]))

    places, looks, inside = [1.0], [look(1.0)], np.zeros((len(watch.events), 1), dtype=bool)
    if rest >= _SHORT and np.isfinite(looks[0].reduced_momentum).all():
        inside = watch.is_beyond(values_of(watch.events, looks[0]))
    while inside.any() and places[-1] > _LEAST:
        places.append(places[-1] / 2)
        looks.append(look(places[-1]))
        inside &= watch.is_beyond(values_of(watch.events, looks[-1]))
    return np.array([0.0, *places[::-1]]), there.joined(looks[::-1]), inside


def _struck_here(watch: Watch, there: Orbit, gone: float, inside: Bool[np.ndarray, "E 1"]) -> Watch:
    """Return what is known after an impact of one of several walls at a place, where the motion is toward one."""
    sides = np.sign(watch.values).astype(np.int64)  # type: ignore[call-overload]
    for position, name in enumerate(watch.events):
        if inside[position] and (after := struck(watch, name, there, -sides[position])) is not None:
            found = [known.chosen(slice(0, 0)) for known in watch.parts[0]]
            found[position] = Crossings(there.step, np.array([gone]), -sides[position], there, after)
            known = dataclasses.replace(watch.after_stretch(tuple(found)), reset_by=name)
            return known.after_impact(watch.values)  # type: ignore[arg-type]
    return watch


def _searched(watch: Watch, there: Orbit, places: np.ndarray, looks: Orbit, gone: float) -> Watch:
    """Return what is known after the search of what is left of a step."""
    widths, rest = np.diff(places, append=1.0), 1 - gone

    def between(states: Orbit, fractions: Float[np.ndarray, "K"]) -> Orbit:
        parts = places[states.step] + fractions * widths[states.step]
        moved = watch.part(there.chosen(np.zeros(len(states), dtype=int)), rest * parts)
        return dataclasses.replace(moved, step=states.step)

    def placed(found: Crossings) -> Crossings:
        fraction = gone + rest * (places[found.step] + found.fraction * widths[found.step])
        step = there.step[0] + (fraction == 1)
        own = {
            name: None if (rows := getattr(found, name)) is None else dataclasses.replace(rows, step=step)
            for name in ("states", "after")
        }
        return Crossings(step, np.where(fraction == 1, 0.0, fraction), found.direction, **own)

    alone = dataclasses.replace(watch, part=between, parts=())
    known, _ = search(alone, dataclasses.replace(looks, step=np.arange(len(looks))))
    found = tuple(map(placed, known.parts[0]))
    parts = (*watch.parts, found) if any(map(len, found)) else watch.parts
    return dataclasses.replace(known, part=watch.part, parts=parts)
