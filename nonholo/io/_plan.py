"""The blocks of a stored run, and what is kept of the state between two of them."""

import json
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.results import Outcome
from nonholo.io._stored_events import Seen


class Plan(NamedTuple):
    """The blocks of a run: block b holds the saved states b * rows to (b + 1) * rows - 1.

    Attributes:
        steps: Steps in total.
        every: Steps between saved states.
        rows: Saved states in a block.
        lead: Saved states before a block at which its computation begins: one, or none where rows need the step after.

    Example:
        >>> plan = Plan(steps=100, every=10, rows=4)
        >>> plan.blocks, [(plan.begin(b), plan.stop(b)) for b in range(3)]
        (3, [(0, 30), (30, 70), (70, 100)])
    """

    steps: int
    every: int
    rows: int
    lead: int = 1

    @classmethod
    def of(cls, stored: dict[str, Any]) -> "Plan":
        """Return the plan of a store with these attributes."""
        run = json.loads(stored["run"])
        return cls(run["steps"], stored["save_every"], run["rows"], run["lead"])

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return -(-(1 + self.steps // self.every) // self.rows)

    def begin(self, block: int) -> int:
        """Return the step at which the computation of a block begins."""
        return max(0, (block * self.rows - self.lead) * self.every)

    def stop(self, block: int) -> int:
        """Return the step at which it ends; the last block also takes the steps after the last saved state."""
        return self.steps if block == self.blocks - 1 else self.begin(block + 1)

    def has_rows(self, block: int, done: int) -> bool:
        """Tell whether a block has saved states if the run stands at a step: it may fail before the first one."""
        return block * self.rows <= done // self.every


class Checkpoint(NamedTuple):
    """The state of a run: the last good step, the outcome so far, the vector to continue from, what its events saw."""

    done: int
    outcome: Outcome
    vector: np.ndarray
    seen: Seen | None = None

    @property
    def is_last(self) -> bool:
        """Whether the run ended here: it cannot continue, or an event ended it."""
        return self.outcome != Outcome.successful or self.is_stopped

    @property
    def is_stopped(self) -> bool:
        """Whether an event ended the run here."""
        return self.seen is not None and self.seen.stopped >= 0
