"""Results of events in the members of an ensemble: how often, and the first and the last time."""

import dataclasses
from typing import Any

import numpy as np

from nonholo.base.types import Int
from nonholo.orbit import AbstractEventLog


@dataclasses.dataclass(frozen=True, eq=False)
class MemberCrossings:
    """The crossings of one event in the members of an ensemble.

    Attributes:
        count: How many each member has, (M,).
        first: The states at the first one, an ensemble of one state each; NaN, also its time, if there is none. Its
            `steps_done` are the steps with their fractions.
        last: The states at the last one.
    """

    count: Int[np.ndarray, "M"]
    first: Any
    last: Any


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class MemberEvents(AbstractEventLog[MemberCrossings]):
    """The crossings of all events in the members of an ensemble, by name or position.

    Attributes:
        names: The names of the events.
        found: Their crossings.
        stopped_by: The position of the event that ended each member, -1 if it ran its full length, (M,).

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> batch = nh.ensemble(sleigh, restricted_velocity=[[0.1, -1], [0.1, 1]], steps=200, events=[nh.cusp])
        >>> batch.events["cusp"].count, batch.events["cusp"].first.time[:, 0].round(3)
        (array([1, 0]), array([7.169,   nan]))
    """

    names: tuple[str, ...]
    found: tuple[MemberCrossings, ...]
    stopped_by: Int[np.ndarray, "M"]

    def __repr__(self) -> str:
        counts = ", ".join(f"{name}: {found.count.sum()}" for name, found in zip(self.names, self.found, strict=True))
        return f"<MemberEvents of crossings: {counts}, {np.sum(self.stopped_by >= 0)} members stopped>"
