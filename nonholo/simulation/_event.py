r"""Events: functions of the states of a run whose changes of sign are of interest, and what an impact does there.

An ideal wall gives the body an impulse along $\nu = n|_\mathfrak{d}$, the derivative of the gap along admissible
directions. With the inertia B along the constraint the gap grows at the rate $\nu\cdot B^{-1}r$.
"""

import dataclasses
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from nonholo.base.calls import call, check_result, numbers_of
from nonholo.base.checks import array, assign, checked_name, choice, count, error, function, is_name, number, shown
from nonholo.base.types import Float
from nonholo.orbit import AbstractOrbit
from nonholo.systems import Gravity, central_differences

_SCALES = 8.0 ** np.arange(-16, 17)  # of the offsets of differences, beside one unit
_ORDER_4 = np.array([40.0, -5.0, 0.0]) / 45  # weights of differences, by the first one of order 6
_ALIKE, _UNSEEN = 2.0**-26, 2.0**-14  # relative: differences of two orders, a derivative beside the largest one
_UNCERTAIN, _RESOLVED = 2.0**-38, 2.0**-10  # relative, of values whose difference is taken; of three differences
_GRAIN = 2.0**-44  # relative, of differences with the first offsets: the rounding of a place
_LOW = 7e-13  # relative to a place: the height of the last bounce, of whose gaps rounding leaves three digits


@dataclasses.dataclass(frozen=True, eq=False)
class Impact:
    r"""The reset of an `Event` whose function is a gap: where it becomes zero the body hits a wall without friction.

    The momentum r along the constraint, with inertia B, is reflected along $\nu = n|_\mathfrak{d}$,

    $$ r^+ = r - (1 + e)\,\frac{\nu\cdot B^{-1}r}{\nu\cdot B^{-1}\nu}\,\nu, \qquad
       \nu\cdot B^{-1}r^+ = -e\,\nu\cdot B^{-1}r. $$

    So the constraint holds after it, and with restitution $e = 1$ the kinetic energy is the same for every n; in
    general it falls by $\tfrac12(1 - e^2)(\nu\cdot B^{-1}r)^2/(\nu\cdot B^{-1}\nu)$. In a discrete map the step is cut
    there: the part of it that leads to the wall, the reflection, then the part of the length that is left, in which
    there may be more impacts. `orbit.events[name].states` are the states before the impacts, `.after` those after them.
    In coordinates the Lagrangian must be quadratic in velocities. Under a constraint $A v = b$ that moves, the velocity
    is reflected, and the wall keeps no energy.

    Reference: [brogliato-1999], Newton's rule in the kinetic metric; docs/theory/parts-of-a-step.md for the map.

    Args:
        normal: n, in the direction in which the gap grows: a spatial vector, the gap being that of the body's `point`
            from a plane across it; or a function from a configuration (N, N) to the derivatives (dim,) of the gap
            along body directions. In coordinates n numbers, or a function from coordinates to n numbers. By default
            these are taken from the function of the event by central differences of order 6, with offsets that fit it:
            their error is about 1e-12 in any unit of length, or what the rounding of the function leaves.
        restitution: e, from 0 to 1.
        point: The point of the body that touches, n body coordinates; by default their origin. Only with a vector.

    Raises:
        ValueError: A normal of another kind, a restitution beyond 0 and 1, a point without a vector.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=0.5, a=0.3), 0.05)
        >>> wall = nh.Event(lambda states: 1.0 - states.position[:, 0], name="wall", reset=nh.Impact())
        >>> orbit = nh.simulate(sleigh, body_velocity=(0.1, 1.0, 0.0), steps=100, events=[wall])
        >>> hits = orbit.events["wall"]
        >>> hits.time.round(3), hits.states.energy.round(12) == hits.after.energy.round(12)
        (array([1.]), array([ True]))
    """

    normal: Any = None
    restitution: Any = 1.0
    point: Any = None

    def __post_init__(self) -> None:
        bounce = number("Impact(restitution=...)", self.restitution)
        if not 0 <= bounce <= 1:
            remedy = "1 conserves the energy, 0 removes the normal velocity."
            raise error("Impact(restitution=...)", "lie between 0 and 1", f"{bounce}", remedy)
        assign(self, restitution=float(bounce))
        if self.normal is None or callable(self.normal):
            if self.point is not None:
                raise error("Impact(point=...)", "come with a spatial vector", shown(self.normal), "Leave it out.")
            return
        remedy = "Pass n spatial coordinates, a function of the configuration, or nothing."
        normal = array("Impact(normal=...)", self.normal, (None,), remedy)
        if not np.any(normal):
            raise error("Impact(normal=...)", "be no zero vector", shown(self.normal), remedy)
        place = np.zeros_like(normal) if self.point is None else self.point
        point = array("Impact(point=...)", place, normal.shape, "Pass as many numbers as the normal has.")
        assign(self, normal=normal, point=point)

    def check(self, where: str, states: AbstractOrbit) -> None:
        """Refuse a vector that is none of the space of a motion, and differences for a body without matrices."""
        group, system = states.group, states.system
        if self.normal is None and system.is_wide:
            raise error(where, "have a normal", f"none for {type(system).__name__}", "Pass a function.")
        if self.point is not None:
            size = states.body_velocity.shape[1] if group is None else group.point_size
            if len(self.point) != size or (group is None and self.point.any()):
                got = f"{len(self.point)} numbers and the point {self.point.tolist()} for {states.space}"
                remedy = "Pass a vector of the space of points; in coordinates one number for each, and no point."
                raise error(where, "have a normal of the space", got, remedy)
        states.refuse_reset(where)

    def covector(self, gap: Any, states: AbstractOrbit) -> Float[np.ndarray, "dim"]:
        """Return n at a state; `gap` gives the values of the event at states."""
        place, dim = states.configuration[0], states.body_velocity.shape[1]
        if self.point is not None:
            group = states.group
            return self.normal if group is None else Gravity(self.normal, self.point).covector(group, place)
        if callable(self.normal):
            return numbers_of("Impact(normal=...)", self.normal, (dim,), "Return a body covector.", place)
        return _slope_of(gap, states)

    def lowest_bounce(self, gap: Any, states: AbstractOrbit) -> float:
        """Return the height in a gap, as its rounding lets it be seen, from which on a bounce is one."""
        is_wide = states.system.is_wide
        return 0.0 if is_wide else _LOW * float(np.abs(self.covector(gap, states)) @ _reach(states))

    def struck(self, where: str, gap: Any, states: AbstractOrbit, direction: int) -> Any:
        """Return a state after an impact; None where the motion is not toward the wall, or cannot be.

        Args:
            where: The event, for messages.
            gap: Gives the values of the event at states.
            states: One state, at the wall.
            direction: That of the gap on the way through the wall.
        """
        normal = self.covector(gap, states)
        after, is_own = states.reflection(normal, self.restitution, direction), self.normal is not None
        # The motion may graze the wall, or the normal points where the gap falls.
        if after is None and is_own and not states.system.is_wide and normal @ _slope_of(gap, states) < 0:
            got, remedy = f"its opposite at time {states.time[0]:.17g}", "Pass the other direction."
            raise error(where, "have a normal in whose direction the function grows", got, remedy)
        return after


def _slope_of(gap: Any, states: AbstractOrbit) -> Float[np.ndarray, "dim"]:
    """Return the derivatives of a gap at a state by differences of order 6, whose offsets fit the gap.

    The first ones fit most gaps: differences of order 4 are alike there. Otherwise each direction takes the offset that
    is most like the ones before and after it; a gap does not depend on a direction in which none are alike.
    """
    reach = _reach(states)
    lengths = np.maximum(1.0, reach)
    slope, off = _differences(gap, states, lengths)
    if (off * lengths <= _ALIKE * np.maximum(np.abs(slope) * lengths, _UNSEEN * np.abs(slope * lengths).max())).all():
        return slope
    slopes = np.array([_differences(gap, states, scale * lengths)[0] for scale in _SCALES])
    with np.errstate(all="ignore"):
        steps = np.abs(np.diff(slopes, axis=0))
        off = np.maximum(steps[1:], steps[:-1]) / np.abs(slopes[1:-1])
    off += _GRAIN * (reach / lengths) / _SCALES[1:-1, None]
    off = np.where(np.isnan(off), np.inf, off)
    best, each = np.argmin(off, axis=0), np.arange(len(lengths))
    return np.where(off[best, each] < _RESOLVED, slopes[1:-1][best, each], 0.0)


def _reach(states: AbstractOrbit) -> Float[np.ndarray, "dim"]:
    """Return the lengths of the place of the first state in each direction: a radian, or how large its numbers are."""
    group, place = states.group, states.configuration[0]
    if group is None:
        return np.full(states.body_velocity.shape[1], np.abs(place).max())
    moves = group.basis[:, :, -1].any(axis=1) & group.is_affine
    return np.where(moves, np.abs(place[:-1, -1]).max(), 1.0)


def _differences(gap: Any, states: AbstractOrbit, lengths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return derivatives of a gap by differences, and the error of those of order 4; NaN where it is undefined."""
    offsets, weights = central_differences(len(lengths))
    rows = lengths * offsets.reshape(-1, len(lengths))
    beside = states.chosen(np.zeros(len(rows), dtype=int)).beside(rows)
    try:
        with np.errstate(all="ignore"):
            values = gap(beside).reshape(offsets.shape[:-1])
    except ValueError:
        return np.full(len(lengths), np.nan), np.full(len(lengths), np.nan)
    changes = (values[..., 0] - values[..., 1]) / lengths[:, None]
    rounding = _UNCERTAIN * np.ptp(values, axis=(1, 2)) / lengths
    return changes @ weights, np.abs(changes @ (weights - _ORDER_4 * weights[0])) + rounding * weights[0]


@dataclasses.dataclass(frozen=True)
class Event:
    r"""A function of the state whose changes of sign along a motion are of interest.

    With $f_k$ its value at state k, the motion crosses in the step from k to k + 1 if $f_k \ne 0$ and $f_{k+1}$ has
    another sign. So a zero exactly at a state counts once, when it is reached; a motion that stays at zero or starts
    there does not cross, and a motion that only touches zero at a state crosses. Two crossings in one step cannot be
    seen. A jump counts too: write sin(angle), not the angle modulo 2 pi; one of an impact does not.

    Attributes:
        function: Takes an `Orbit` with any number of states, with all its quantities, and returns one real number for
            each, which may depend on that state alone.
        direction: 1 for crossings from below, -1 from above, 0 for both.
        stop: Whether the motion ends at the first crossing, or at which one: stop=10 ends it at the tenth.
        name: Its name: a letter, then letters, digits and underscores, all ASCII. By default the name of
            the function, or "event 2" for a lambda at position 2.
        reset: An `Impact`: the function is the gap to a wall, of the pose alone, and at each crossing the momentum is
            reflected. A body that starts at the wall is on the side from which `direction` leads through it, if it is
            not 0. None leaves the motion as it is.

    Raises:
        ValueError: A function that cannot be called, another direction, a stop that is no count, or a reset that is no
            `Impact`.

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
        function("Event(function=...)", self.function, "orbit")
        remedy = "1 is from below, -1 from above, 0 both."
        assign(self, direction=choice("Event(direction=...)", self.direction, (-1, 0, 1), remedy))
        if self.name is not None:
            checked_name("Event(name=...)", self.name)
        if not isinstance(self.stop, bool):
            count("Event(stop=...)", self.stop, "Pass True for the first crossing, or which one.")
        if not isinstance(self.reset, Impact | None):
            raise error("Event(reset=...)", "be an impact", shown(self.reset), "Pass Impact(), or leave it out.")

    @property
    def last(self) -> float:
        """The number of the crossing that ends the motion; infinite if none does."""
        return float(self.stop) if self.stop else math.inf


def checked_events(owner: str, events: Any) -> dict[str, Event]:
    """Return events by name; a function is an event with the defaults."""
    where = f"{owner}(events=...)"
    if not isinstance(events, Sequence) or isinstance(events, str):
        raise error(where, "be a list of events or functions", shown(events), "Pass a list, also of a single one.")
    by_name: dict[str, Event] = {}
    for position, each in enumerate(events):
        event = each if isinstance(each, Event) else Event(each)
        own = getattr(event.function, "__name__", None)
        name = event.name or (str(own) if is_name(own) else f"event {position}")
        if name in by_name:
            raise error(where, "have different names", f"{name!r} twice", "Pass Event(function, name=...).")
        by_name[name] = event
    return by_name


def has_resets(events: dict[str, Event]) -> bool:
    """Return whether an event changes the motion."""
    return any(event.reset is not None for event in events.values())


def values_at(name: str, event: Event, states: AbstractOrbit) -> Float[np.ndarray, "K"]:
    """Return the values of an event at states, refused with the reason if they are not one real number for each."""
    where, size = f"Event(function=...) of {name!r}", len(states)
    remedy = "It gets an `Orbit`: return an array with one number for each of its states."
    try:
        values = call(where, event.function, states)
    except Exception as failure:
        got = f"{type(failure).__name__}: {str(failure).rstrip('.')}"
        raise error(where, f"take an orbit of {size} states", got, remedy) from failure
    words = f"one real number for each of {size} states", remedy
    return check_result(where, event.function, values, (size,), words, lambda at: f"time {states.time[at]:.17g}")
