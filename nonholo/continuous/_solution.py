"""Results of the solvers of the continuous equations."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.groups import SE, AbstractMatrixGroup

PLANE = SE(2)


class States(NamedTuple):
    """Compact states of a motion in the canonical frame.

    Attributes:
        momenta: Along the constraint subspace, (K, k).
        poses: (K, size), if they are solved for.
        turned: On SE(2) the heading without ambiguity of full turns, (K,).
    """

    momenta: Float[np.ndarray, "K k"]
    poses: Float[np.ndarray, "K size"] | None
    turned: Float[np.ndarray, "K"] | None

    def chosen(self, at: np.ndarray) -> "States":
        """Return the states at some places."""
        others = (None if rows is None else rows[at] for rows in (self.poses, self.turned))
        return States(self.momenta[at], *others)


class Problem(NamedTuple):
    """An initial value problem, in canonical numbers.

    Attributes:
        momentum: The reduced momentum at the start.
        pose: The compact pose there; None if it is not solved for.
        elapsed: Times since the start, from zero.
        tolerances: Relative and absolute.
    """

    momentum: Float[np.ndarray, "k"]
    pose: Any
    elapsed: Float[np.ndarray, "K"]
    tolerances: tuple[float, float]


class Solved(NamedTuple):
    """A solved motion.

    Attributes:
        states: At the requested times; after a failure only the good ones.
        outcome: How it ended.
        at: Gives the states at times since the start, up to the last good one, in the order of the requested times.
        steps: Gives where steps of the solver begin and, if they are long, times within; none if they do not depend
            on the motion.
        fault: The failure of a user's function that ended it.
    """

    states: States
    outcome: Outcome
    at: Callable[[Float[np.ndarray, "K"]], States]
    steps: Callable[[], Float[np.ndarray, "steps"]] = lambda: np.zeros(0)
    fault: str = ""


def first_heading(group: AbstractMatrixGroup, pose: Float[np.ndarray, "... size"]) -> Float[np.ndarray, "... j"]:
    """Return the angle of a pose in the plane as one number; none of other groups."""
    return np.arctan2(pose[..., 1:2], pose[..., :1]) if group == PLANE else pose[..., :0]
