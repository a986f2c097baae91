"""The first state of a run, before its first root is solved for."""

from typing import NamedTuple

import numpy as np

from nonholo.discrete import Discretization, initial_state
from nonholo.systems import Start


class FirstState(NamedTuple):
    """Canonical momenta, compact pose, and what the start demanded of the first step."""

    reduced: np.ndarray
    pose: np.ndarray
    demanded: np.ndarray | None


def first_state(discrete: Discretization, start: Start, *, posed: bool, compiled: bool) -> FirstState:
    """Return the checked first state of a run that keeps poses or not."""
    g = _first_pose(discrete, start, needed=posed or not compiled or discrete.route.needs_pose)
    reduced, demanded = initial_state(discrete, start, g)
    return FirstState(reduced, np.empty(0) if g is None else start.canonical_pose(discrete.system, g), demanded)


def _first_pose(discrete: Discretization, start: Start, *, needed: bool) -> np.ndarray | None:
    """Return the first pose; None where neither the step nor the result needs one, which may be large."""
    if not needed and start.configuration is None:
        return None
    g = start.pose(discrete.system.group)
    return g if needed else None
