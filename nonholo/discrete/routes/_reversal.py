"""The distance by which one step forward and one back miss the state they began at."""

import functools

import numpy as np

from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.discrete.routes._base import AbstractCompiledRoute, matrices_of
from nonholo.orbit import Orbit


def reversal_defects(route: AbstractCompiledRoute, states: Orbit) -> Float[np.ndarray, "K"]:
    """Return, for each state, the relative miss of one step forward and one back.

    Infinite where the step back cannot be computed, NaN where there is no step forward.
    """
    return _of_single_steps(route, states) if route.order == 2 else _of_compositions(route, states)


def _of_single_steps(route: AbstractCompiledRoute, states: Orbit) -> Float[np.ndarray, "K"]:
    """Return them for steps back to the inverse displacement.

    The map is multivalued and its principal value is not always the way back: the nearest value counts.
    """
    r, cayley = route.encode(states.reduced_momentum), route.to_kernel(states.canonical_chart)
    poses = matrices_of(states)
    momenta, charts, ahead = route.step_each((r, cayley, poses), cayley, principal_only=True)
    if poses is None:
        after, _, _ = route.step_each((momenta, charts, None), charts, principal_only=False)
        returning = (-after, -charts, None)
    else:
        returning = (-momenta, -charts, _two_ahead(states, charts))
    back, charts_back, behind = route.step_each(returning, -cayley, principal_only=False)
    distances = np.maximum(
        _largest(charts_back + cayley) / _largest(cayley), _largest(back + momenta) / _largest(momenta)
    )
    return np.where(ahead != 0, np.nan, np.where(behind != 0, np.inf, distances))


def _two_ahead(states: Orbit, following: np.ndarray) -> Float[np.ndarray, "K size"]:
    """Return the poses two steps after each state, from where a right-invariant constraint is run back."""
    U, V = states.motion.displaced(states.canonical_chart), states.motion.displaced(following)
    return np.ascontiguousarray((V @ U @ states.configuration).reshape(len(states), states.system.group.size**2))


def _of_compositions(route: AbstractCompiledRoute, states: Orbit) -> Float[np.ndarray, "K"]:
    """Return them for steps back from the opposite momentum."""
    r, group = states.reduced_momentum, states.system.group
    moves = states.system.is_spatial
    g = states.configuration if moves else np.broadcast_to(group.identity, (len(r), group.size, group.size))
    after, there, ahead = route.whole_steps(r, g)
    good = ahead == Outcome.successful
    back, _, behind = route.whole_steps(-after[good], there[good])
    distances = np.full(len(r), np.nan)
    far = _largest(back + r[good]) / _largest(r[good])
    distances[good] = np.where(behind == Outcome.successful, far, np.inf)
    return distances


def _largest(rows: np.ndarray) -> np.ndarray:
    return functools.reduce(np.maximum, np.abs(rows).T, np.zeros(len(rows)))
