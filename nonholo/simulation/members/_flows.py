"""Ensembles of flows: starts and parameters of many continuous motions, solved side by side."""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.base.checks import error, flow_times, flow_tolerances
from nonholo.base.limits import within_memory
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.continuous import ContinuousFlow, Solved, members_by_series, solver_of
from nonholo.discrete import Discretization, discretize
from nonholo.orbit import Orbit
from nonholo.simulation.members._families import check_systems, inertias_and_frames
from nonholo.simulation.members._members import Members, checked_parameters
from nonholo.simulation.members._reduce import Reduced, joined
from nonholo.simulation.members._result import Ensemble
from nonholo.simulation.members._run import Report, counting, in_threads, threads_to_use
from nonholo.simulation.members._start import are_others, checked_rows, first_momenta
from nonholo.systems import Start, System

_PART = 1024  # members in a piece of work of one thread,
_NUMBERS = 1 << 20  # and the most numbers in their states


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class FlowEnsemble(Ensemble):
    """Continuous motions of M members at K times, from `ensemble` of a system: as `Ensemble`, with no displacements.

    Attributes:
        times: The requested times, (K,).
        turned: Headings on SE(2), unwrapped, (M, K).

    Example:
        >>> sleigh = nh.ChaplyginSleigh(1.0, 1.0, 0.5)
        >>> batch = nh.ensemble(sleigh, restricted_velocity=[[1, 0], [0, 1]], times=(0.0, 5.0))
        >>> batch.heading.round(6)
        array([[0.      , 3.036242],
               [0.      , 0.      ]])
    """

    times: Float[np.ndarray, "K"] = dataclasses.field(default_factory=lambda: np.zeros(0))
    turned: Float[np.ndarray, "M K"] | None = None

    @property
    def time(self) -> Float[np.ndarray, "M K"]:
        """Times of the states."""
        return np.broadcast_to(self.times, self.cayley.shape[:2])

    @property
    def heading(self) -> Float[np.ndarray, "M K"]:
        """Unwrapped angles of the body on SE(2)."""
        return super().heading if self.turned is None else self.turned

    def _states(self, discrete: Discretization, time: np.ndarray, rows: Any) -> Orbit:
        turned = None if self.turned is None else self.turned[rows]
        momenta, poses = self.reduced_momentum[rows], np.asarray(self.canonical_pose)[rows]
        return Orbit(ContinuousFlow(discrete.system), time, momenta, None, poses, turned=turned)


def ensemble_of_flows(
    system: System,
    start: Start,
    times: Any,
    rtol: Any,
    *,
    parameters: Any,
    reduce: Callable[[Ensemble], Reduced] | None,
    progress: bool,
) -> Any:
    """Return the flows of many members, or what a function makes of them block by block."""
    time, (rtol, _) = flow_times(times), flow_tolerances(1e-14 if rtol is None else rtol, 1.0)
    discrete = discretize(system, 1.0)  # never stepped: it knows what starts and parameters may be
    checked = checked_parameters(discrete, parameters)
    if "time_step" in checked:
        raise error("ensemble(parameters=...)", "name fields of the system", "'time_step'", "A flow has no time step.")
    rows = checked_rows(system, checked, start)
    members = Members(discrete, checked, len(rows))
    check_systems(members)
    momenta, size = first_momenta(members, start.name, rows), system.rank + system.group.pose_size + 1
    block = max(1, 8 * _NUMBERS // (size * len(time))) if reduce else len(rows)
    within_memory("ensemble(times=...)", 16.0 * block * size * len(time), "Ask for fewer times, or pass reduce=...")
    if start.name == "momentum" and rows.shape[1] != system.rank:
        _check_momenta(rows, _solved(members, momenta, time[:1], rtol, lambda _: None).momentum[:, 0])
    with progress_bar("members", progress) as show:
        report = counting(show, len(rows))
        if reduce is None:
            return _solved(members, momenta, time, rtol, report)
        parts = [slice(begin, begin + block) for begin in range(0, len(rows), block)]
        batches = (_solved(members.part(part), momenta[part], time, rtol, report) for part in parts)
        return joined(len(rows), ((len(batch), reduce(batch)) for batch in batches))


def _check_momenta(given: np.ndarray, full: np.ndarray) -> None:
    """Refuse full momenta that no admissible velocity has."""
    wrong = are_others(given, full)
    if wrong.any():
        member = int(np.argmax(wrong))
        remedy = f"With the same components along the constraint that of member {member} is {full[member].tolist()}."
        got = f"{given[member].tolist()}"
        raise error("ensemble(momentum=...)", "belong to admissible velocities", got, remedy)


def _solved(members: Members, momenta: np.ndarray, time: np.ndarray, rtol: float, report: Report) -> FlowEnsemble:
    """Solve for a block of members, pieces of it in threads."""
    count, pieces, system = len(members), {}, members.discrete.system
    numbers = system.rank + system.group.pose_size

    def work(part: slice, stop: np.ndarray) -> None:
        own = members.part(part)
        inertias, frames = inertias_and_frames(own)
        poses = np.broadcast_to(frames, (len(own), frames.shape[1]))

        def each(member: int) -> Callable[..., Solved]:
            return solver_of(own.of(member).system, None, float(time[0]), reconstruct=True)[0]

        given = momenta[part], poses, time - time[0], rtol, stop
        pieces[part.start] = members_by_series(system, inertias, each, *given)

    size = max(1, min(_PART, _NUMBERS // (numbers * len(time)), -(-count // 8)))
    parts = [slice(begin, min(begin + size, count)) for begin in range(0, count, size)]
    in_threads(work, parts, threads_to_use(), report)
    states, reached = zip(*(pieces[part.start] for part in parts), strict=True)
    momenta_of, poses_of = (np.concatenate([getattr(part, name) for part in states]) for name in ("momenta", "poses"))
    turned = None if states[0].turned is None else np.concatenate([part.turned for part in states])
    good = np.concatenate(reached)
    codes = np.where(good == len(time), int(Outcome.successful), int(Outcome.not_converged))
    charts = np.zeros((count, len(time), 0))
    return FlowEnsemble(
        members, len(time) - 1, 1, momenta_of, charts, poses_of, codes, good - 1, momenta, times=time, turned=turned
    )
