"""Events of a motion that is already there, and ready events."""

import dataclasses
from typing import Any

import numpy as np

from nonholo.base.checks import error
from nonholo.base.types import Float
from nonholo.discrete import Discretization
from nonholo.orbit import Crossings, Orbit, as_orbit
from nonholo.simulation.events._event import Event
from nonholo.simulation.events._watched import searched, watched


def crossings(orbit: Orbit, event: Any) -> Crossings:
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
    orbit = as_orbit("crossings(orbit=...)", orbit, "pass states and your own functions otherwise.")
    if not isinstance(orbit.motion, Discretization) or not orbit.has_every_step:
        got = "one with steps left out" if isinstance(orbit.motion, Discretization) else "a flow or given poses"
        raise error("crossings(orbit=...)", "have every single step of a discrete run", got, "Pass events= to the run.")
    watch = watched("crossings", orbit.motion, [event], orbit.branch, orbit.canonical_pose is not None)
    return searched(watch, dataclasses.replace(orbit, events=None))[0].log()[0]


def _forward_speed(orbit: Orbit) -> Float[np.ndarray, "K"]:
    system = orbit.system
    if not system.has_blade:
        got, remedy = type(system).__name__, "Write your own event: a function of the orbit."
        raise error("cusp", "watch a sleigh", got, remedy)
    return system.restricted_velocity(orbit.restricted_momentum)[:, -1]


cusp = Event(_forward_speed, name="cusp")
r"""The event of a sleigh whose velocity $v_1$ along the blade changes sign: its path in the plane has a cusp there."""
