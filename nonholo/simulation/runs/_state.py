"""The state of a compiled run between two stretches."""

from typing import NamedTuple, TypeAlias

import numpy as np

from nonholo.base.types import Float

Rows: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray]  # momenta, charts, poses, as a kernel has them


class RunState(NamedTuple):
    """The state that a run continues from, with the same bits as if it had not stopped.

    Attributes:
        row: Momenta, chart and pose of its first state; with events those of the last state that was searched.
        kernel: The kernel's own state, with compensations and warm starts.
    """

    row: Rows
    kernel: Float[np.ndarray, "s"]

    @classmethod
    def of(cls, vector: Float[np.ndarray, "L"], sizes: tuple[int, int, int]) -> "RunState":
        """Return the state in a vector of a store."""
        momenta, chart, pose, kernel = np.split(vector, np.cumsum(sizes))
        return cls((momenta, chart, pose), kernel)

    @property
    def vector(self) -> Float[np.ndarray, "L"]:
        """The state as a store has it."""
        return np.concatenate((*self.row, self.kernel))
