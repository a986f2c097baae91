"""Tables of forces: a row for each step, which JAX and formulas look up."""

import dataclasses
import functools
from typing import ClassVar, Self

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.memo import Keeper
from nonholo.base.traced import rows_above
from nonholo.base.types import Array, Float, Int

ROWS = 1024
"""Saved states of one call of JAX: one size of table, one compilation."""


def _row_of_table(rows: Array, step: Array) -> Array:
    return rows[jnp.clip(jnp.rint(step).astype(int), -1, len(rows) - 1)]


LOOK_UP = "row of a table"  # no name of a function of the user's
_row_of_table.__name__ = LOOK_UP
_look_up = jax.jit(_row_of_table)


@dataclasses.dataclass(frozen=True, eq=False)
class ForceTable(Keeper):
    """Forces of the steps, one row a step; after the last one nothing acts.

    Attributes:
        rows: The forces with rows of zeros after them, so that few programs serve tables of all lengths.
    """

    rows: Float[np.ndarray, "rows n"]
    is_of_one_step: ClassVar[bool] = True

    @classmethod
    def of(cls, forces: Float[np.ndarray, "steps n"]) -> Self:
        """Return the table of forces."""
        return cls(np.pad(forces, ((0, max(ROWS, rows_above(len(forces) + 1)) - len(forces)), (0, 0))))

    def row(self, step: Array) -> Array:
        """Return the force of a step, whose number may carry rounding errors."""
        return _look_up(jnp.asarray(self.rows), step)

    def acting(self, steps: Int[np.ndarray, "K"]) -> Float[np.ndarray, "K n"]:
        """Return the forces of steps with these numbers."""
        return self.rows[np.clip(steps, -1, len(self.rows) - 1)]

    @property
    def nothing(self) -> Self:
        """The table of no forces, which stands for all."""
        return type(self)(np.zeros((1, self.rows.shape[1])))

    @property
    def address(self) -> Float[np.ndarray, "1 n"]:
        """Where formulas find the number of rows and the rows: each number is the place in memory, below 2^53."""
        return np.full((1, self.rows.shape[1]), float(self._memory.ctypes.data))

    @functools.cached_property
    def _memory(self) -> Float[np.ndarray, "size"]:
        return np.append(float(len(self.rows)), self.rows)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ForceTable) and np.array_equal(self.rows, other.rows)

    def __hash__(self) -> int:
        return hash(self.rows.shape)
