"""The run in blocks: from one state of the map to a later one, with the rows saved on the way."""

import dataclasses
from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

import numpy as np

from nonholo.base.limits import within_a_year
from nonholo.base.results import finished
from nonholo.base.types import Float
from nonholo.lagrange_dalembert._orbit import AbstractCoordinateOrbit
from nonholo.lagrange_dalembert._room import equations_of
from nonholo.lagrange_dalembert.runs._simulate import LEAST, Start, State, blocks, orbit_of


class RunState(NamedTuple):
    """The state that a run continues from, with the same bits as if it had not stopped.

    Attributes:
        motion: Configuration (with the time, of a driven system), velocity of its step, velocity of the step before.
        sign: The orientation to keep.
    """

    motion: State
    sign: np.ndarray

    @property
    def vector(self) -> Float[np.ndarray, "L"]:
        """The state as a store has it."""
        return np.concatenate([np.ravel(part) for part in (*self.motion, self.sign)])


@dataclasses.dataclass(frozen=True, eq=False)
class CoordinateRun:
    """A discretized system in coordinates or on a group, and what a run of it keeps.

    Attributes:
        discrete: The discretization.
        every: Steps between saved states.
    """

    discrete: Any
    every: int
    reconstruct: ClassVar[bool] = True
    most_steps: ClassVar[int] = 1 << 18  # in a block, seconds
    lead: ClassVar[int] = 0  # a block begins with its first row, whose impulse it needs

    def __post_init__(self) -> None:
        equations_of(self.discrete.system)  # refused by the system of a store without functions

    @property
    def sizes(self) -> tuple[int, ...]:
        """Numbers of the columns of a row but the time."""
        (place, rate), system = map(np.prod, self.discrete.system.shapes), self.discrete.system
        return int(place), int(place), int(rate), int(rate), system.constraints, 1, 1

    def state_of(self, vector: Float[np.ndarray, "L"]) -> RunState:
        """Return the state in a vector of a store."""
        (place, rate), driven = self.discrete.system.shapes, self.discrete.system.is_driven
        size = int(np.prod(place)) + driven
        q, v, before, sign = np.split(vector, np.cumsum([size, *rate, *rate]))
        return RunState((q if driven else q.reshape(place), v, before), sign.reshape(()))

    def opened(self, start: Start, steps: int, throw: bool) -> tuple[RunState, AbstractCoordinateOrbit | None]:
        """Return a run at its start, and its empty orbit (or an error) if it cannot continue from there."""
        within_a_year("simulate(steps=...)", LEAST * steps, "Pass fewer steps, or a larger time_step.")
        motion, sign, code = start
        state = RunState(motion, sign)
        if not code:
            return state, None
        empty = self._orbit([rows[:0] for rows in self._row(state)], 0, code)
        return state, finished(empty, self.discrete.time_step, 0, steps, throw)

    def first(self, state: RunState) -> AbstractCoordinateOrbit:
        """Return a state as an orbit at time zero."""
        return self._orbit(self._row(state), 0, 0)

    def stretch(
        self, state: RunState, plan: Any, block: int, report: Callable[[int], object]
    ) -> tuple[AbstractCoordinateOrbit, RunState, int]:
        """Compute a block of a plan from the state where it begins; return rows, state and last good step."""
        begun, start = plan.begin(block), (state.motion, state.sign, np.asarray(0))
        system, h = self.discrete.system, np.float64(self.discrete.time_step)
        run = blocks(system, h, start, plan.stop(block) - begun, self.every, plan.rows, lambda n, _: report(begun + n))
        columns, motion, code, done = next(run)
        return self._orbit(columns, begun // self.every, code), RunState(motion, state.sign), begun + done

    def _row(self, state: RunState) -> list[np.ndarray]:
        q, v, _ = state.motion
        return [np.asarray(q)[None], np.asarray(v)[None], np.empty((0, self.discrete.system.constraints))]

    def _orbit(self, columns: list[np.ndarray], first: int, code: Any) -> AbstractCoordinateOrbit:
        system, h = self.discrete.system, np.float64(self.discrete.time_step)
        return orbit_of(system, h, columns, first, self.every, code)
