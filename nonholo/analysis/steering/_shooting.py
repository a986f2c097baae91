"""Forces of many members at once that lead to goals, by shooting from random controls."""

from typing import Any

import numpy as np

from nonholo.analysis.steering._arguments import BLOCK, Ends, Limits
from nonholo.analysis.steering._ends import missed_goals
from nonholo.analysis.steering._least_effort import Missed, least_effort
from nonholo.base.progress import go_on
from nonholo.discrete import Discretization

SPREAD = (1.0, 2.0, 0.5, 4.0, 1.0, 2.0, 0.5, 4.0)  # of the random controls from which a goal is looked for, in turn
TOLERANCE = 1e-8  # of the goal
_LEVEL = 1e-4  # of the gradient at a minimum


def shot(discrete: Discretization, ends: Ends, limits: Limits) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the forces of members, (members, steps k), what they miss, and whether they are of least effort."""
    k, block = discrete.system.rank, min(BLOCK, len(ends[0]))
    steps = len(limits[0]) // k

    def missed(forces: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        go_on()
        return missed_goals(discrete, forces.reshape(-1, steps, k), chosen(ends, at), block)

    return best(missed, sizes(discrete, steps), len(ends[0]), limits)


def sizes(discrete: Discretization, steps: int) -> np.ndarray:
    """Return how large forces are that move a body by about one unit, or turn it by one radian."""
    each = discrete.system.constrained_inertia.diagonal()
    return np.tile(np.sqrt(steps) * each / (steps * float(discrete.time_step)) ** 2, steps)


def best(missed: Missed, size: np.ndarray, members: int, limits: Limits) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the forces of least effort, or those that come nearest, what they miss, and whether they are least."""
    rng, left = np.random.default_rng(0), np.arange(members)
    forces, gap, is_least = np.zeros((members, len(size))), np.full(members, np.inf), np.zeros(members, dtype=bool)
    for spread in SPREAD:
        first = spread * size * rng.normal(size=(len(left), len(size)))
        there = left
        near, miss, rest = least_effort(lambda f, at, there=there: missed(f, there[at]), first, limits)
        better = miss < gap[left]
        now = left[better]
        forces[now], gap[now] = near[better], miss[better]
        is_least[now] = (miss < TOLERANCE)[better] & (rest < _LEVEL)[better]
        left = left[~is_least[left]]
        if not len(left):
            break
    return forces, gap, is_least


def chosen(parts: Any, at: Any) -> Any:
    """Return members of arrays."""
    return parts if parts is None else parts[at] if hasattr(parts, "shape") else tuple(chosen(x, at) for x in parts)
