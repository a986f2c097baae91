"""Stretches of a compiled run: from one state of the kernel to a later one, with the rows saved on the way.

The state of a run is one vector: its first row as the kernel sees it (momenta, chart, pose), then the kernel's own
state with compensations and warm starts. So a run goes on from a vector with the same bits as if it had not stopped.
"""

import dataclasses
from collections.abc import Callable

import numpy as np

from nonholo import kernels
from nonholo._checks import error, shown
from nonholo._results import Outcome, finished
from nonholo.discrete import Discretization
from nonholo.discrete._branch_rules import PRINCIPAL, AbstractBranchRule
from nonholo.discrete._composition import compiled_step
from nonholo.discrete._start import check_first_state
from nonholo.discrete._structured import (
    Structured,
    decoded,
    decoded_poses,
    encoded,
    encoded_poses,
    from_kernel,
    is_secular,
)
from nonholo.orbit import Orbit
from nonholo.simulation.runs._prepared import Start

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

    def start(self, reduced: np.ndarray, pose: np.ndarray) -> tuple[np.ndarray, Outcome]:
        """Return the vector of a run at its first state, and the outcome of the first root."""
        group = self.discrete.system.group
        scaled = encoded(self.closed, reduced)
        coded = encoded_poses(self.closed, group, pose) if pose.size else pose
        code, state = kernels.start(self.closed.body, scaled, coded)
        return np.concatenate((scaled, kernels.chart_of(self.closed.body, state), coded, state)), Outcome(code)

    def first(self, vector: np.ndarray) -> Orbit:
        """Return the state in the first part of a vector as an orbit at time zero."""
        return self.stretch(vector, 0, 0, _silent, opening=True)[0]

    def stretch(
        self, vector: np.ndarray, begun: int, stop: int, report: Callable[[int], object], *, opening: bool
    ) -> tuple[Orbit, int]:
        """Go on from step `begun`, a multiple of `every`, to step `stop`; return the rows and the last good step.

        The vector becomes that of the last good step. The rows of an opening stretch begin with the first state.
        """
        widths, first = self.sizes, int(opening)
        rows = tuple(np.empty((first + (stop - begun) // self.every, width)) for width in widths)
        if opening:
            for row, given in zip(rows, np.split(vector[: sum(widths)], np.cumsum(widths)[:-1]), strict=True):
                row[0] = given
        state, done, code = vector[sum(widths) :], begun, 0
        while code == 0 and done < stop:
            free = first + (done - begun) // self.every
            piece = min(max(1, _PIECE // self.every) * self.every, stop - done)
            room = (rows[0][free:], rows[1][free:], rows[2][free:])
            good, code = kernels.advance(self.closed.body, state, piece, self.every, room)
            done += good
            report(done)
        kept = first + (done - begun) // self.every
        return self.orbit((rows[0][:kept], rows[1][:kept], rows[2][:kept]), begun, opening, Outcome(code)), done

    def orbit(
        self, rows: tuple[np.ndarray, np.ndarray, np.ndarray], begun: int, opening: bool, outcome: Outcome
    ) -> Orbit:
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


def opened(run: CompiledRun, start: Start, steps: int, throw: bool) -> tuple[np.ndarray, Orbit]:
    """Return the vector of a run at its start and its first state, an empty orbit (or an error) if there is none."""
    vector, outcome = run.start(start.reduced, start.pose)
    first = run.first(vector)
    if outcome != Outcome.successful:
        empty = dataclasses.replace(first.chosen(slice(0, 0)), outcome=outcome)
        return vector, finished(empty, float(run.discrete.time_step), 0, steps, throw)
    if start.demanded is not None:
        check_first_state(start.demanded, first.displacement[0], first.momentum[0])
    return vector, first


def _silent(done: int) -> None:
    """Report nothing."""
