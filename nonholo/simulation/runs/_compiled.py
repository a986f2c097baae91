"""Stretches of a compiled run: from one state of the kernel to a later one, with the rows saved on the way."""

import dataclasses
import time
from collections.abc import Callable
from typing import ClassVar

import numpy as np

from nonholo.base.checks import error, shown
from nonholo.base.results import Outcome, finished
from nonholo.base.types import Float
from nonholo.discrete import PRINCIPAL, AbstractBranchRule, AbstractCompiledRoute, Discretization, check_first_state
from nonholo.io import Plan
from nonholo.orbit import Orbit
from nonholo.simulation.runs._first_state import FirstState
from nonholo.simulation.runs._state import Rows, RunState

_FIRST, _PIECE = 256, 1 << 20  # steps between two reports of progress; Ctrl-C waits for them,
_SOON, _LATE = 0.1, 0.3  # seconds: from one to the next they are doubled and halved


@dataclasses.dataclass(frozen=True, eq=False)
class CompiledRun:
    """A discretization with its compiled route, and what a run of it keeps.

    Attributes:
        discrete: The discretization.
        route: Its compiled route.
        every: Steps between saved states.
        reconstruct: Whether poses are kept.
    """

    discrete: Discretization
    route: AbstractCompiledRoute
    every: int
    reconstruct: bool
    most_steps: ClassVar[int] = 1 << 23  # in a block, about a second
    lead: ClassVar[int] = 1  # a block continues from the last row of the one before

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of momenta, chart coordinates and pose entries of a row."""
        momenta, charts, pose = self.route.sizes
        return momenta, charts, pose if self.reconstruct or self.route.needs_pose else 0

    def start(self, first: FirstState) -> tuple[RunState, Outcome]:
        """Return the state of a run at its first one, and the outcome of the first root."""
        scaled, pose = self.route.encode(first.reduced), first.pose
        coded = self.route.encode_poses(pose) if pose.size else pose
        code, kernel = self.route.start(scaled, coded)
        return RunState((scaled, self.route.chart_of(kernel), coded), kernel), Outcome(code)

    def state_of(self, vector: Float[np.ndarray, "L"]) -> RunState:
        """Return the state in a vector of a store."""
        return RunState.of(vector, self.sizes)

    def first(self, state: RunState) -> Orbit:
        """Return the first row of a state as an orbit at time zero."""
        momenta, charts, poses = (row[None] for row in state.row)
        return self.orbit((momenta, charts, poses), 0, True, Outcome.successful)

    def stretch(
        self, state: RunState, plan: Plan, block: int, report: Callable[[int], object]
    ) -> tuple[Orbit, RunState, int]:
        """Compute a block of a plan from the state where it begins; return rows, state and last good step."""
        begun, stop, opening = plan.begin(block), plan.stop(block), block == 0
        first, kernel = int(opening), state.kernel.copy()
        rows = tuple(np.empty((first + (stop - begun) // self.every, width)) for width in self.sizes)
        for row, start in zip(rows, state.row, strict=True):
            row[:first] = start
        done, code, pace = begun, 0, _FIRST
        while code == 0 and done < stop:
            free, since = first + (done - begun) // self.every, time.monotonic()
            piece, every = self._piece(done - begun, stop - begun, pace)
            room = (rows[0][free:], rows[1][free:], rows[2][free:])
            good, code = self.route.advance(kernel, piece, every, room)
            done += good
            report(done)
            pace = _paced(pace, time.monotonic() - since)
        kept = first + (done - begun) // self.every
        orbit = self.orbit((rows[0][:kept], rows[1][:kept], rows[2][:kept]), begun, opening, Outcome(code))
        return orbit, RunState(state.row, kernel), done

    def _piece(self, done: int, total: int, pace: int) -> tuple[int, int]:
        """Return how many steps to take at once, and after how many of them to save.

        A piece is a number of whole rows, or a part of one that is saved at its end, where the next part overwrites it.
        """
        if pace >= self.every and done % self.every == 0:
            return min(pace // self.every * self.every, total - done), self.every
        piece = min(pace, self.every - done % self.every, total - done)
        has_row = done // self.every < total // self.every
        return piece, piece if has_row else piece + 1

    def orbit(self, rows: Rows, begun: int, opening: bool, outcome: Outcome) -> Orbit:
        """Return rows of the kernel as an orbit."""
        momenta, charts, poses = rows
        number = begun // self.every + (0 if opening else 1)
        step = self.every * np.arange(number, number + len(momenta))
        pose = self.route.decode_poses(poses) if self.reconstruct else None
        momenta, charts = self.route.decode(momenta), self.route.from_kernel(charts)
        time = self.discrete.time_step * step
        return Orbit(self.discrete, time, momenta, charts, pose, outcome, self.every, step=step)


def _paced(pace: int, seconds: float) -> int:
    """Return how many steps to take next, after that many took so long."""
    if seconds < _SOON:
        return min(2 * pace, _PIECE)
    return max(1, pace // 2) if seconds > _LATE else pace


def closed_step(
    discrete: Discretization, rule: AbstractBranchRule = PRINCIPAL, backend: str = "auto"
) -> AbstractCompiledRoute | None:
    """Return the compiled route of a run, None if it runs by a rule or by the definition."""
    return discrete.route.compiled if rule.is_principal and backend != "jax" else None


def compiled_run(
    where: str, discrete: Discretization, closed: AbstractCompiledRoute | None, every: int, posed: bool
) -> CompiledRun:
    """Return the run in blocks of a compiled step; only compiled runs have a state that can be kept."""
    if closed is None:
        got = f"another branch, backend='jax', a force in Python or difference {shown(discrete.difference)}"
        remedy = "Use branch='principal', difference='matrix' and backend='auto', or simulate without it."
        raise error(where, "have a compiled run", got, remedy)
    return CompiledRun(discrete, closed, every, posed)


def opened(run: CompiledRun, start: FirstState, steps: int, throw: bool) -> tuple[RunState, Orbit | None]:
    """Return a run at its start, and its empty orbit (or an error) if it cannot continue from there."""
    state, outcome = run.start(start)
    if outcome != Outcome.successful:
        empty = dataclasses.replace(run.first(state).chosen(slice(0, 0)), outcome=outcome)
        return state, finished(empty, float(run.discrete.time_step), 0, steps, throw)
    if start.demanded is not None:
        first = run.first(state)
        check_first_state(start.demanded, first.displacement[0], first.momentum[0])
    return state, None
