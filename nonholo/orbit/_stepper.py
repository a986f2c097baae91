"""The interface of every map that runs step by step: rows of columns from a state, which is one flat vector."""

import abc
import functools
from collections.abc import Mapping
from typing import Any, ClassVar, Generic, NamedTuple, Protocol, TypeAlias, runtime_checkable

import numpy as np

from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.orbit._base import OrbitT

Rows: TypeAlias = tuple[Float[np.ndarray, "_ _"], ...]
"""An array for each column, C-contiguous and writable, the entries of a row flattened."""
State: TypeAlias = Float[np.ndarray, "L"]
"""The row of the state, then the numbers of the stepper's own."""


class First(NamedTuple):
    """A checked start in the numbers of its motion, and what the first step must have.

    The starts of many members are one start, whose arrays have an axis of members in front.

    Attributes:
        numbers: Of a body its canonical momenta and compact pose, which is empty where none is needed; in coordinates
            momentum, place and velocity.
        demand: The displacement (N, N) or the full momentum (dim,) of the first step; None if the start leaves it.
    """

    numbers: tuple[np.ndarray, ...]
    demand: np.ndarray | None = None

    def of(self, members: int | slice) -> "First":
        """Return the start of one member, or the starts of some."""
        return First(tuple(x[members] for x in self.numbers), None if self.demand is None else self.demand[members])


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

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return -(-(1 + self.steps // self.every) // self.rows)

    def begin(self, block: int) -> int:
        """Return the step at which the computation of a block begins."""
        return max(0, (block * self.rows - self.lead) * self.every)

    def stop(self, block: int) -> int:
        """Return the step at which it ends; the last block also takes the steps after the last saved state."""
        return self.stretch(block)[1]

    def stretch(self, block: int) -> tuple[int, int, bool]:
        """Return where the computation of a block begins and ends, and whether it is the last one."""
        is_last = self.steps // self.every < (block + 1) * self.rows
        return self.begin(block), self.steps if is_last else self.begin(block + 1), is_last


class AbstractStepper(abc.ABC, Generic[OrbitT]):
    """A map with a way to compute its steps.

    Attributes:
        motion: The discretization.
        columns: The names of what a saved row holds, with the numbers of each.
        branch: The name of the branch rule.
        lead: 1 if a column belongs to the row that a step leads to; 0 if one belongs to the step ahead, known at its
            end.
        in_threads: Whether `advance` releases the interpreter's lock.
        pace: Steps of the first call, before the time of any is known.
        block: Steps of a block of a store, about a second.
    """

    motion: Any
    columns: Mapping[str, int]
    branch: str = "principal"
    lead: ClassVar[int] = 1
    in_threads: bool = True
    pace: ClassVar[int] = 256
    block: int = 1 << 14

    @functools.cached_property
    def has_poses(self) -> bool:
        """Whether its rows have poses, saved or not."""
        return self.columns.get("canonical_pose", 1) > 0

    @functools.cached_property
    def width(self) -> int:
        """How many numbers a row has."""
        return sum(self.columns.values())

    @property
    def part_refused(self) -> str | None:
        """Why a step has no parts; None if it has."""
        return None

    @abc.abstractmethod
    def start(self, first: First) -> tuple[State, Outcome]:
        """Solve for the first root; return the state there, and the outcome."""

    @abc.abstractmethod
    def advance(self, state: State, steps: int, every: int, rows: Rows) -> tuple[int, int]:
        """Take up to `steps` steps, in place; return how many were good, and the outcome.

        `rows` has 1 + steps // every places. Place 0 becomes the row of the state as it came, place i the row after
        i * every good steps. The row in the state is then that of the last place written, and its own numbers stand
        after the good steps. Columns of the step ahead are NaN at the last place. Bits do not depend on how steps are
        cut into calls.
        """

    @functools.cached_property
    def has_drift(self) -> bool:
        """Whether poses of its rows leave their group by rounding as they grow."""
        group = getattr(self.motion.system, "group", None)
        return group is not None and group.has_drift and self.has_poses

    @abc.abstractmethod
    def matrices(self, rows: Rows) -> Float[np.ndarray, "K N N"]:
        """Return the poses of rows, as `advance` writes them, on a group."""

    def states_on_group(self, rows: Rows) -> int:
        """Return how many of the first rows precede one whose pose has left its group by rounding."""
        return int(self.motion.system.group.leading_elements(self.matrices(rows)))

    def settle(self, rows: Rows) -> Outcome:
        """Bring rows to the numbers of an orbit, in place, as far as they fit; return what is known of them then."""
        del rows
        return Outcome.successful

    @abc.abstractmethod
    def orbit(self, rows: Rows, step: int, every: int, outcome: Outcome) -> OrbitT:
        """Return settled rows as an orbit, the first one after `step` steps, the others `every` steps apart.

        The column of the step ahead is a row shorter where the last row is the end of the run.
        """


def write_first(state: State, rows: Rows) -> None:
    """Write the row of a state to the first place of rows."""
    begin = 0
    for column in rows:
        column[0], begin = state[begin : begin + column.shape[1]], begin + column.shape[1]


def keep_row(state: State, rows: Rows, place: int) -> None:
    """Write the row at a place of rows into a state."""
    row = np.concatenate([column[place] for column in rows])
    state[: len(row)] = row


@runtime_checkable
class DiscreteMotion(Protocol[OrbitT]):
    """A discretized system: what `simulate`, `iterate` and stores ask of it.

    Attributes:
        starts: The names of its starts.
    """

    starts: ClassVar[tuple[str, ...]]

    @property
    def system(self) -> Any:
        """The system or map whose motion it steps."""

    @property
    def time_step(self) -> Any:
        """The time step h."""

    def first(self, start: Any, *, with_poses: bool) -> First:
        """Return a checked start, for rows with poses or without."""
        ...

    def stepper(self, *, with_poses: bool) -> AbstractStepper[OrbitT]:
        """Return what takes its steps, and saves poses or not."""
        ...

    def after_parts(self, states: Any, fractions: Any) -> Any:
        """Return what is reached from states after fractions of the steps that begin there; NaN where nothing is."""
        ...
