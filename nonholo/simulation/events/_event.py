"""Events: functions of the states of a run whose changes of sign are of interest, with checks of what they return."""

import dataclasses
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from nonholo.base.calls import call, check_result
from nonholo.base.checks import choice, error, instance, is_name, natural, shown
from nonholo.base.checks import name as checked_name
from nonholo.base.types import Float
from nonholo.orbit import AbstractOrbit
from nonholo.simulation.events._impact import Impact


@dataclasses.dataclass(frozen=True)
class Event:
    r"""A function of the state whose changes of sign along a motion are of interest.

    With $f_k$ its value at state k, the motion crosses in the step from k to k + 1 if $f_k \ne 0$ and $f_{k+1}$ has
    another sign. So a zero exactly at a state counts once, when it is reached; a motion that stays at zero or starts
    there does not cross, and one that only touches zero at a state does. Two crossings in one step cannot be seen. A
    jump counts too: write sin(angle), not the angle modulo 2 pi; one of an impact does not.

    Attributes:
        function: Takes an `Orbit` with any number of states, with all its quantities, and returns one real number for
            each, which may depend on that state alone.
        direction: 1 for crossings from below, -1 for those from above, 0 for both.
        stop: Whether the motion ends at the first crossing, or at which one: stop=10 ends it at the tenth.
        name: What to call it; a letter, then letters, digits and underscores, all ASCII. By default that of the
            function, or "event 2" for a lambda at position 2.
        reset: An `Impact`: the function is the gap to a wall, of the pose alone, and at each crossing the momentum is
            reflected. A body that starts at the wall is on the side from which `direction` leads through it, if it is
            not 0. None leaves the motion as it is.

    Raises:
        ValueError: A function that is none, another direction, a stop that is no count, or a reset that is none.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1)
        >>> east = nh.Event(lambda orbit: np.sin(orbit.heading), direction=1, stop=3, name="east")
        >>> orbit = nh.simulate(sleigh, body_velocity=(4.0, 1.0, 0.0), steps=1000, events=[east])
        >>> orbit.events["east"].time.round(6), orbit.events.stopped_by, orbit.time[-1].round(6)
        (array([1.527552, 3.054768, 4.581318]), 'east', np.float64(4.5))
    """

    function: Callable[..., Any]
    direction: int = 0
    stop: bool | int = False
    name: str | None = None
    reset: Impact | None = None

    def __post_init__(self) -> None:
        if not callable(self.function):
            raise error("Event(function=...)", "be a function of an orbit", shown(self.function), "Pass a function.")
        choice("Event(direction=...)", self.direction, (-1, 0, 1), "1 is from below, -1 from above, 0 both.")
        if self.name is not None:
            checked_name("Event(name=...)", self.name)
        if not isinstance(self.stop, bool):
            natural("Event(stop=...)", self.stop, "Pass True for the first crossing, or which one.")
        if self.reset is not None:
            instance("Event(reset=...)", self.reset, Impact, "be an impact", "Pass Impact(), or leave it out.")

    @property
    def last(self) -> float:
        """The number of the crossing that ends the motion; infinite if none does."""
        return float(self.stop) if self.stop else math.inf


def checked_events(owner: str, events: Any) -> dict[str, Event]:
    """Return events by name; a function is an event with the defaults."""
    where = f"{owner}(events=...)"
    if not isinstance(events, Sequence) or isinstance(events, str):
        raise error(where, "be a list of events or functions", shown(events), "Pass a list, also of a single one.")
    named: dict[str, Event] = {}
    for position, given in enumerate(events):
        event = given if isinstance(given, Event) else Event(given)
        name = event.name or _name_of(event.function, position)
        if name in named:
            raise error(where, "have different names", f"{name!r} twice", "Pass Event(function, name=...).")
        named[name] = event
    return named


def has_resets(events: dict[str, Event]) -> bool:
    """Tell whether an event changes the motion."""
    return any(event.reset is not None for event in events.values())


def _name_of(function: Callable[..., Any], position: int) -> str:
    name = getattr(function, "__name__", None)
    return str(name) if is_name(name) else f"event {position}"


def values_at(name: str, event: Event, states: AbstractOrbit) -> Float[np.ndarray, "K"]:
    """Return the values of an event at states, refused with the reason if they are not one real number for each."""
    where, count = f"Event(function=...) of {name!r}", len(states)
    remedy = "It gets an `Orbit`: return an array with one number for each of its states."
    try:
        found = call(where, event.function, states)
    except Exception as failure:
        got = f"{type(failure).__name__}: {failure}"
        raise error(where, f"take an orbit of {count} states", got, remedy) from failure
    words = f"one real number for each of {count} states", remedy
    return check_result(where, event.function, found, (count,), words, lambda at: f"time {states.time[at]:.17g}")
