"""Which states of an orbit are drawn: enough for the eye, whatever the length of the run.

Curves are thinned evenly along the drawn line, so that a short transition in a long run is not lost.
"""

import numpy as np

from nonholo.base.types import Float, Int
from nonholo.orbit import Orbit

MOST_DOTS = 1500  # of most pictures


def evenly_spread(points: Float[np.ndarray, "K d"], most: int = MOST_DOTS) -> Int[np.ndarray, "L"]:
    """Return at most `most` + 2 indices, evenly along the polygon through the points, both ends kept.

    Example:
        >>> evenly_spread(np.array([[0.0], [0.0], [0.0], [1.0], [2.0]]), most=3).tolist()
        [0, 3, 4]
    """
    if len(points) <= most:
        return np.arange(len(points))
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    traveled = np.concatenate([[0.0], np.cumsum(steps)])
    picked = np.searchsorted(traveled, np.linspace(0.0, traveled[-1], most))
    return np.unique(np.concatenate([[0], picked, [len(points) - 1]]))


def evenly_in_box(points: Float[np.ndarray, "K d"], most: int = MOST_DOTS) -> Int[np.ndarray, "L"]:
    """Do the same after scaling each coordinate to its own range, as axes do."""
    extent = np.ptp(points, axis=0)
    return evenly_spread(points / np.where(extent > 0, extent, 1.0), most)


def some_states(orbit: Orbit, most: int) -> Orbit:
    """Return the orbit at about this many states, evenly in momentum and, as momentum may be conserved, in time."""
    evenly_in_time = np.linspace(0, len(orbit) - 1, min(most, len(orbit))).round().astype(int)
    return orbit.chosen(np.union1d(evenly_spread(orbit.reduced_momentum, most), evenly_in_time))


def transition(orbit: Orbit) -> int:
    """Return the state about which the momentum changes fastest; 0 if it does not change."""
    momentum = orbit.reduced_momentum
    change = np.abs(np.diff(momentum, axis=0)).sum(axis=1)
    moving = len(change) > 0 and change.max() > 1e-9 * np.abs(momentum).max(initial=0.0)
    return int(change.argmax()) if moving else 0


def turn_per_state(orbit: Orbit) -> float:
    """Return the largest angle, in radians, between saved states: greatest angular speed times distance in time."""
    if len(orbit) < 2:
        return 0.0
    speed = orbit.system.group.angle(some_states(orbit, 1000).body_velocity).max()
    return float(speed * np.abs(np.diff(orbit.time)).max())


def window(orbit: Orbit, step: float, finest: float, most: int) -> slice:
    """Return at most `most` states about the transition; they start at the first state if they can.

    Args:
        orbit: The orbit.
        step: How far a picture moves between two states.
        finest: How far it should move at least.
        most: Number of states.
    """
    stride = max(1, int(finest / step)) if step > 0 else max(1, len(orbit) // most)
    span = stride * most
    if len(orbit) <= span:
        return slice(0, len(orbit), stride)
    first = min(max(0, transition(orbit) - span // 2), len(orbit) - span)
    return slice(first, first + span, stride)
