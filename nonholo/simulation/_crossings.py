"""Events of a motion that is already there, of a flow between its steps and the requested times; ready events."""

import dataclasses
import functools
from typing import Any

import numpy as np

from nonholo.base.checks import error, instance
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.orbit import AbstractOrbit, AbstractStepper, Crossings, EventLog, Orbit
from nonholo.simulation._event import Event, checked_events, has_resets, values_at
from nonholo.simulation._search import Part, Watch, piece_of, search


def watch_for(owner: str, stepper: AbstractStepper[Any], events: Any) -> Watch:
    """Return what a run looks for, refused where parts of its steps are not defined, or none begins at an impact."""
    by_name = checked_events(owner, events)
    if stepper.part_refused is not None:
        remedy = "Look for changes of sign in the states yourself."
        demand = "be left out where a part of a step is not defined"
        raise error(f"{owner}(events=...)", demand, stepper.part_refused, remedy)
    motion = stepper.motion
    if not getattr(stepper, "with_poses", True):
        refuse_resets(owner, by_name, "impacts of a run without poses: reconstruct=False")
    if (forced := motion.forces) is not None and (forced.table is not None or forced.function is not None):
        refuse_resets(owner, by_name, f"impacts under {forced.names}: a force of the time, whose steps begin at nodes")
    return Watch(by_name, motion.after_parts, functools.partial(_with_step, stepper))


def refuse_resets(owner: str, events: dict[str, Event], got: str) -> None:
    """Refuse events with resets."""
    if has_resets(events):
        remedy = "Leave the reset out, or run one body by `simulate`, `iterate` or `flow`."
        raise error(f"{owner}(events=...)", "have no reset", got, remedy)


def check_resets(events: dict[str, Event], there: Any) -> None:
    """Refuse normals of another space, and gaps that differ at another momentum and time: not of the pose alone."""
    if not has_resets(events) or not len(there):
        return
    others = {name: 1 - 0.6 * getattr(there, name) for name in there.momenta}
    other: Any = dataclasses.replace(there, time=there.time + 1, **others)
    for name, event in events.items():
        if event.reset is not None:
            event.reset.check(f"Event(reset=...) of {name!r}", there)
            now, then = (values_at(name, event, states) for states in (there, other))
            if now[0] != then[0]:
                got = f"{now[0]:.17g}, and {then[0]:.17g} at another velocity and time"
                remedy = "Write the gap of the configuration."
                raise error(f"Event(reset=...) of {name!r}", "depend on the pose alone", got, remedy)


def _with_step(stepper: AbstractStepper[Any], states: Any) -> Any:
    """Return a state with the step that begins there."""
    state, outcome = stepper.start(states.as_start())
    split = np.split(state[: stepper.width], np.cumsum(list(stepper.columns.values()))[:-1])
    rows = tuple(row[None] for row in split)
    return states.with_step(stepper.orbit(rows, 0, 1, stepper.settle(rows)), outcome)


def crossings(orbit: AbstractOrbit, event: Any) -> Crossings:
    """Find where an orbit crosses zero of a function of its states.

    As `simulate(..., events=[event])`, for an orbit with every single step: consecutive states are compared, and the
    crossing between two of them is located by parts of the step from the first one.

    Args:
        orbit: A discrete orbit on the principal branch, of which no step is left out.
        event: An `Event` or a function of an orbit. If it stops, crossings after that are left out.

    Returns:
        The crossings.

    Raises:
        ValueError: Another orbit, or a function that does not return one real number for each state.

    Example:
        >>> top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
        >>> orbit = nh.simulate(nh.discretize(top, 0.1), body_velocity=(0.4, 0.9, 0.0), steps=200)
        >>> level = nh.crossings(orbit, lambda states: states.configuration[:, 2, 2])
        >>> len(level), bool(np.abs(level.states.configuration[:, 2, 2]).max() < 1e-15)
        (6, True)
    """
    orbit = instance("crossings(orbit=...)", orbit, AbstractOrbit, "be an orbit", "Pass what `simulate` returned.")
    if not orbit.is_discrete or orbit.is_measured or not orbit.has_every_step:
        got = "a flow or given poses" if orbit.has_every_step else "one with steps left out, or with impacts"
        raise error("crossings(orbit=...)", "have every single step of a discrete run", got, "Pass events= to the run.")
    stepper = orbit.motion.stepper(with_poses=orbit.has_poses)
    if orbit.branch != stepper.branch:
        got, remedy = f"branch {orbit.branch!r}", "Look for changes of sign in the states yourself."
        raise error("crossings(orbit=...)", "have parts of a step", got, remedy)
    refuse_resets("crossings", checked_events("crossings", [event]), "an impact on a finished orbit")
    watch, piece = watch_for("crossings", stepper, [event]), piece_of(stepper.columns.values())
    for begin in range(0, max(1, len(orbit) - 1), piece):
        watch, _ = search(watch, orbit.chosen(slice(begin, begin + piece + 1)))
        if watch.stopped_by:
            break
    return watch.log()[0]


def _forward_speed(orbit: Orbit) -> Float[np.ndarray, "K"]:
    system = orbit.system
    if not system.has_blade:
        got, remedy = type(system).__name__, "Write your own event: a function of the orbit."
        raise error("cusp", "watch a sleigh", got, remedy)
    return system.restricted_velocity(orbit.restricted_momentum)[:, -1]


cusp = Event(_forward_speed, name="cusp")
r"""The event of a sleigh whose velocity $v_1$ along the blade changes sign: its path in the plane has a cusp there."""


def flow_with_events(events: dict[str, Event], orbit: Any, steps: Float[np.ndarray, "steps"]) -> Any:
    """Return the states of a flow up to the event that ends it, with what was found.

    Args:
        events: The events, by name.
        orbit: The flow.
        steps: Times at which steps of its solver begin, where events are evaluated too.
    """
    forward = 1.0 if orbit.time[-1] >= orbit.time[0] else -1.0
    outputs = forward * orbit.time
    inside = steps[(forward * steps > outputs[0]) & (forward * steps < outputs[-1])]
    times = np.unique(np.concatenate([outputs, forward * inside]))
    looks = orbit.at(forward * times).on_group() if len(inside) else orbit
    watch, last = search(Watch(events, between_times(looks, forward)), looks)
    outcome, log = Outcome.successful if watch.stopped_by else looks.outcome, watch.log()
    count = int(np.searchsorted(outputs, forward * looks.time[last - 1], "right"))
    log = of_requested(log, outputs, forward)
    return dataclasses.replace(orbit.chosen(slice(0, count)), outcome=outcome, events=log)


def between_times(looks: AbstractOrbit, forward: float) -> Part:
    """Return the function of states and fractions that gives those on a part of the way to the next."""
    times, spans = forward * looks.time, np.diff(looks.time)

    def between(states: Any, fractions: Float[np.ndarray, "K"]) -> Any:
        if not len(states):
            return states
        begin = np.searchsorted(times, forward * states.time)
        return looks.at(forward * np.minimum(forward * (states.time + fractions * spans[begin]), times[-1]))

    return between


def of_requested(log: EventLog, outputs: np.ndarray, forward: float, **fields: Any) -> EventLog:
    """Return crossings with the numbers of the requested times before them, and other fields of their states."""
    gaps, each = np.append(np.diff(outputs), np.inf), []
    for crossings in log.found:
        times = forward * crossings.time
        step = np.searchsorted(outputs, times, "right") - 1
        each.append(crossings.of_steps(step, (times - outputs[step]) / gaps[step], **fields))
    return dataclasses.replace(log, found=tuple(each))
