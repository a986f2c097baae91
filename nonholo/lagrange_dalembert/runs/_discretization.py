"""What maps in coordinates and on groups share: blocks, stretches for stores, parts of steps."""

import dataclasses
from collections.abc import Iterator
from typing import Any

import numpy as np

from nonholo.base.types import Float
from nonholo.lagrange_dalembert._motion import CoordinateMotion
from nonholo.lagrange_dalembert._start import fixed_time_step
from nonholo.lagrange_dalembert.runs._partial_step import after_parts
from nonholo.lagrange_dalembert.runs._run import CoordinateRun
from nonholo.lagrange_dalembert.runs._simulate import checked_block, checked_counts, iterated, simulated
from nonholo.systems import AbstractCoordinateDiscretization, OrbitT


@dataclasses.dataclass(frozen=True, eq=False)
class AbstractLagrangeDAlembertMap(CoordinateMotion, AbstractCoordinateDiscretization[OrbitT]):
    """A discretized system: it says how a run starts.

    Attributes:
        system: What moves.
        time_step: h.
    """

    system: Any
    time_step: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "time_step", fixed_time_step(self.time_step))

    @property
    def _numbers(self) -> int:
        """Numbers that memory holds of a saved state."""
        return 2 * sum(int(np.prod(shape)) for shape in self.system.shapes)

    def _simulated(
        self, steps: Any, save_every: Any, throw: bool, progress: bool, configuration: Any, **starts: Any
    ) -> OrbitT:
        steps, every = checked_counts(steps, save_every, self._numbers)
        first = self.start(configuration, **starts)
        return simulated(self.system, np.float64(self.time_step), first, steps, every, throw, progress)

    def iterate(
        self,
        *,
        configuration: Any = None,
        steps: int,
        block_steps: int | None = None,
        body_velocity: Any = None,
        displacement: Any = None,
        momentum: Any = None,
        save_every: int = 1,
        throw: bool = True,
        progress: bool = False,
    ) -> Iterator[OrbitT]:
        """Run the map of `simulate`, and give its orbit block by block, in bounded memory.

        The blocks together are the orbit of `simulate`, bit for bit: no state is given twice.

        Args:
            configuration: As in `simulate`, and so are the others.
            steps: See `simulate`.
            block_steps: Steps of a block, a multiple of `save_every`; by default a thousand saved states.
            body_velocity: See `simulate`.
            displacement: See `simulate`.
            momentum: See `simulate`.
            save_every: See `simulate`.
            throw: Raise if the run cannot continue, after its last good block; otherwise that block's outcome says so.
            progress: See `simulate`.

        Returns:
            An iterator over orbits of `block_steps // save_every` states, the last one of those that are left.

        Raises:
            ValueError: A bad argument, before any work.
            OutcomeError: As in `simulate`; with `throw` its `orbit` is the last block.

        Example:
            >>> from nonholo.lagrange_dalembert import LagrangeDAlembert
            >>> free = LagrangeDAlembert(lambda q, v: v @ v / 2, None, dimension=2).discretize(0.5)
            >>> blocks = free.iterate(configuration=(0, 0), body_velocity=(1, 2), steps=10, block_steps=4)
            >>> [len(block) for block in blocks]
            [4, 4, 3]
        """
        starts = {"body_velocity": body_velocity, "displacement": displacement, "momentum": momentum}
        system, h = self.system, np.float64(self.time_step)
        steps, every = checked_counts(steps, save_every, 0)
        rows = self.rows_of_block(block_steps, every)
        first = self.start(configuration, **starts)
        return iterated(system, h, first, steps, every, rows, throw, progress)

    def run(self, every: int) -> CoordinateRun:
        """Return what computes blocks of a run that keeps one in `every` states."""
        return CoordinateRun(self, every)

    def rows_of_block(self, block_steps: Any, save_every: int) -> int:
        """Return the saved states of a block of `iterate`, refused where memory cannot hold them."""
        return checked_block(block_steps, save_every, self._numbers)

    def after_parts(self, states: OrbitT, fractions: Float[np.ndarray, "K"]) -> OrbitT:
        r"""Return what is reached from states after parts of the steps that begin there.

        After a fraction s that is the step of length s h from the same configuration and momentum: the definition of
        the map itself, with another time step.

        Args:
            states: States of an orbit of this map.
            fractions: Numbers in (0, 1), one for each.
        """
        return after_parts(self, states, fractions)
