"""Stretches of a compiled run: from one state of the kernel to a later one, with the rows saved on the way."""

import dataclasses
from collections.abc import Callable

import numpy as np

from nonholo import kernels
from nonholo._checks import error, shown
from nonholo._results import Outcome, finished
from nonholo.discrete import (
    PRINCIPAL,
    AbstractBranchRule,
    Discretization,
    Structured,
    check_first_state,
    compiled_step,
    decoded,
    decoded_poses,
    encoded,
    encoded_poses,
    from_kernel,
    is_secular,
)
from nonholo.orbit import Orbit
from nonholo.simulation.runs._first_state import FirstState
from nonholo.simulation.runs._state import Rows, RunState

_PIECE = 1 << 20  # steps between two reports of progress; Ctrl-C waits for them


@dataclasses.dataclass(frozen=True, eq=False)
class CompiledRun:
    """A discretisation with its compiled step, and what a run of it keeps.

    Attributes:
        discrete: The discretisation.
        closed: Its compiled step.
        every: Steps between saved states.
        reconstruct: Whether poses are kept.
    """

    discrete: Discretization
    closed: Structured
    every: int
    reconstruct: bool

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of momenta, chart coordinates and pose entries of a row."""
        momenta, charts, pose = kernels.sizes(self.closed.body)
        return momenta, charts, pose if self.reconstruct or not is_secular(self.discrete) else 0

    def start(self, first: FirstState) -> tuple[RunState, Outcome]:
        """Return the state of a run at its first one, and the outcome of the first root."""
        scaled, pose = encoded(self.closed, first.reduced), first.pose
        coded = encoded_poses(self.closed, self.discrete.system.group, pose) if pose.size else pose
        code, kernel = kernels.start(self.closed.body, scaled, coded)
        return RunState((scaled, kernels.chart_of(self.closed.body, kernel), coded), kernel), Outcome(code)

    def first(self, state: RunState) -> Orbit:
        """Return the first row of a state as an orbit at time zero."""
        momenta, charts, poses = (row[None] for row in state.row)
        return self.orbit((momenta, charts, poses), 0, True, Outcome.successful)

    def stretch(
        self, state: RunState, begun: int, stop: int, report: Callable[[int], object], *, opening: bool
    ) -> tuple[Orbit, RunState, int]:
        """Go on from step `begun`, a multiple of `every`, to step `stop`; return rows, state and step of the last good.

        The rows of an opening stretch begin with the first state.
        """
        first, kernel = int(opening), state.kernel.copy()
        rows = tuple(np.empty((first + (stop - begun) // self.every, width)) for width in self.sizes)
        for row, start in zip(rows, state.row, strict=True):
            row[:first] = start
        done, code = begun, 0
        while code == 0 and done < stop:
            free = first + (done - begun) // self.every
            piece = min(max(1, _PIECE // self.every) * self.every, stop - done)
            room = (rows[0][free:], rows[1][free:], rows[2][free:])
            good, code = kernels.advance(self.closed.body, kernel, piece, self.every, room)
            done += good
            report(done)
        kept = first + (done - begun) // self.every
        orbit = self.orbit((rows[0][:kept], rows[1][:kept], rows[2][:kept]), begun, opening, Outcome(code))
        return orbit, RunState(state.row, kernel), done

    def orbit(self, rows: Rows, begun: int, opening: bool, outcome: Outcome) -> Orbit:
        """Return rows of the kernel as an orbit."""
        momenta, charts, poses = rows
        number = begun // self.every + (0 if opening else 1)
        time = self.discrete.time_step * (self.every * np.arange(number, number + len(momenta)))
        pose = decoded_poses(self.closed, self.discrete.system.group, poses) if self.reconstruct else None
        momenta, charts = decoded(self.closed, momenta), from_kernel(self.closed, charts)
        return Orbit(self.discrete, time, momenta, charts, pose, outcome, self.every)


def closed_step(
    discrete: Discretization, rule: AbstractBranchRule = PRINCIPAL, backend: str = "auto"
) -> Structured | None:
    """Return the compiled step of a run, None if it runs by a rule or by the definition."""
    return compiled_step(discrete) if rule.is_principal and backend != "jax" else None


def compiled_run(
    where: str, discrete: Discretization, closed: Structured | None, every: int, posed: bool
) -> CompiledRun:
    """Return the run in blocks of a compiled step; only compiled runs have a state that can be kept."""
    if closed is None:
        got = f"another branch, backend='jax' or difference {shown(discrete.difference)}"
        remedy = "Use branch='principal', difference='matrix' and backend='auto', or simulate without it."
        raise error(where, "have a compiled run", got, remedy)
    return CompiledRun(discrete, closed, every, posed)


def opened(run: CompiledRun, start: FirstState, steps: int, throw: bool) -> tuple[RunState, Orbit]:
    """Return a run at its start and its first state as an orbit, empty (or an error) if there is none."""
    state, outcome = run.start(start)
    first = run.first(state)
    if outcome != Outcome.successful:
        empty = dataclasses.replace(first.chosen(slice(0, 0)), outcome=outcome)
        return state, finished(empty, float(run.discrete.time_step), 0, steps, throw)
    if start.demanded is not None:
        check_first_state(start.demanded, first.displacement[0], first.momentum[0])
    return state, first
