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
    needed, group = posed or not compiled or discrete.route.needs_pose, discrete.system.group
    g = start.pose(group) if needed or start.configuration is not None else None
    g = g if needed else None  # where neither the step nor the result needs one, which may be large
    reduced, demanded = initial_state(discrete, start, g)
    return FirstState(reduced, np.empty(0) if g is None else start.canonical_pose(discrete.system, g), demanded)
