"""The steps of maps on groups, and those of compiled routes."""

import abc
import dataclasses
import functools
from typing import Any

import numpy as np

from nonholo.base.results import Outcome
from nonholo.orbit import AbstractStepper, First, Orbit, Rows, State

Compact = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Canonical momenta and charts, and compact canonical poses, of which each is empty where there are none."""


class AbstractBodyStepper(AbstractStepper[Orbit]):
    """The steps of a map on a group: rows are momenta, charts and poses in numbers of its own.

    Attributes:
        motion: The discretization.
        posed: Whether poses are saved.
    """

    motion: Any
    posed: bool

    @property
    def part_refused(self) -> str | None:
        """Why a step has no parts; None if it has."""
        if self.branch != "principal":
            return f"branch {self.branch!r}: only the principal branch has them"
        if self.motion.step_needs_pose and not self.posed:
            return "a step that depends on the pose, without reconstruct=True"
        return None

    @abc.abstractmethod
    def decode(self, rows: Rows) -> Compact:
        """Return rows as canonical momenta, charts and poses."""

    def orbit(self, rows: Rows, step: int, every: int, outcome: Outcome) -> Orbit:
        """Return rows as an orbit."""
        momenta, charts, poses = self.decode(rows)
        number, kept = step + every * np.arange(len(momenta)), poses if self.posed else None
        time = self.motion.time_step * number
        return Orbit(self.motion, time, momenta, charts, kept, outcome, every, branch=self.branch, step=number)


@dataclasses.dataclass(frozen=True, eq=False)
class CompiledStepper(AbstractBodyStepper):
    """The steps of a route with a kernel: rows are as the kernel has them.

    Attributes:
        motion: The discretization.
        route: The route.
        posed: Whether poses are saved.
    """

    motion: Any
    route: Any
    posed: bool

    @functools.cached_property
    def columns(self) -> dict[str, int]:  # type: ignore[override]
        """The names and sizes of what a row holds."""
        momenta, charts, pose = self.route.sizes
        pose = pose if self.posed or self.route.needs_pose else 0
        return {"reduced_momentum": momenta, "cayley": charts, "canonical_pose": pose}

    @property
    def in_threads(self) -> bool:  # type: ignore[override]
        """Whether `advance` releases the interpreter's lock."""
        return self.route.compiled is not None

    @property
    def block(self) -> int:  # type: ignore[override]
        """Steps of a block of a store, about a second."""
        return 1 << 23 if self.in_threads else 1 << 14

    def start(self, first: First) -> tuple[State, Outcome]:
        """Return the state at the first root."""
        reduced, pose = first.numbers
        getattr(self.route, "said", {}).clear()  # of the run before
        scaled = self.route.encode(reduced)
        coded = self.route.encode_poses(pose) if pose.size else pose
        code, kernel = self.route.start(scaled, coded)
        return np.concatenate((scaled, self.route.chart_of(kernel), coded, kernel)), Outcome(code)

    def advance(self, state: State, steps: int, every: int, rows: Rows) -> tuple[int, int]:
        """Take steps with the state of the kernel."""
        width = write_first(state, rows)
        good, code = self.route.advance(state[width:], steps, every, tuple(column[1:] for column in rows))
        keep_row(state, rows, good // every)
        return good, code

    def decode(self, rows: Rows) -> Compact:
        """Return rows of the kernel in canonical numbers."""
        momenta, charts, poses = rows
        decoded = self.route.decode_poses(poses) if self.posed else poses
        return self.route.decode(momenta), self.route.from_kernel(charts), decoded


def write_first(state: State, rows: Rows) -> int:
    """Write the row of a state to the first place of rows; return its width."""
    begin = 0
    for column in rows:
        column[0], begin = state[begin : begin + column.shape[1]], begin + column.shape[1]
    return begin


def keep_row(state: State, rows: Rows, place: int) -> None:
    """Write the row at a place of rows into a state."""
    np.concatenate([column[place] for column in rows], out=state[: sum(column.shape[1] for column in rows)])
